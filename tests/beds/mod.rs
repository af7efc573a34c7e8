//! Small beds for tests: shorthand for the setups of the library, whose errors fail the test.
#![allow(dead_code, reason = "each test file uses a part")]

pub(crate) mod delayed;

use nalgebra::Vector3;
use std::f64::consts::PI;
use std::ops::{Deref, DerefMut};
use talcum::balance::Balance;
use talcum::contact::{
    ByPair, BySpecies, CohesionExpression, ContactModel, Exchanges, FrictionCap,
    LinearSpringDashpot, VanDerWaals,
};
use talcum::domain::{Bounds, EffectiveGravity, Face, RankGrid, Vibration};
use talcum::gas::volume_averaged::VolumeAveragedModel;
use talcum::gas::{BaseNode, ColumnGas, DragLaw, DragShare, Drive, GasModel};
use talcum::instruments::{Instrument, Layout, Needs, Readings, Stored, View};
use talcum::numbers::{Schedule, random_of, uniform};
use talcum::parallel::{Communicator, OneRank, ParticleRecord, run_on_threads};
pub(crate) use talcum::setup::Snapshot;
use talcum::setup::{self, Setup, Sphere};
use talcum::state::{Domain, Physics, SizeRange};
use talcum::time_step::StepError;

pub(crate) const PERIODIC: [Face; 2] = [Face::Periodic; 2];
pub(crate) const OPEN: [Face; 2] = [Face::Open; 2];
/// A plate below, nothing above.
pub(crate) const PLATE: [Face; 2] = [Face::Wall, Face::Open];

/// Everything that a test chooses before a run.
#[derive(Clone, Debug)]
pub(crate) struct Bench {
    pub(crate) domain: Domain,
    pub(crate) contact: LinearSpringDashpot,
    /// The contact model between particles, instead of `contact`.
    pub(crate) interface: Option<ContactModel>,
    /// The contact models at the walls, by their numbers; further walls have that of the particles.
    pub(crate) at_walls: Vec<ContactModel>,
    /// Contact models and attraction of several species, instead of all of these and of `cohesion`.
    pub(crate) mixture: Option<Mixture>,
    pub(crate) cohesion: Option<VanDerWaals>,
    pub(crate) gas: Option<ColumnGas>,
    /// The volume-averaged gas, in the place of the column gas.
    pub(crate) volume_averaged: Option<VolumeAveragedModel>,
    pub(crate) gravity: EffectiveGravity,
    pub(crate) time_step: f64,
    /// Skin of the neighbour lists; it follows from the speeds if none is given.
    pub(crate) skin: Option<f64>,
    pub(crate) balance: Option<Balance>,
    /// The largest force, if a closed form needs larger overlaps than a real case.
    pub(crate) force_limit: Option<f64>,
    pub(crate) density: f64,
    pub(crate) particles: Vec<ParticleRecord>,
}

/// Contact models and attraction between several species and at walls.
#[derive(Clone, Debug)]
pub(crate) struct Mixture {
    pub(crate) contact: ByPair<ContactModel>,
    pub(crate) at_walls: Vec<BySpecies<ContactModel>>,
    pub(crate) cohesion: Option<ByPair<VanDerWaals>>,
}

/// k_n, k_t of Poisson's ratio 0.3, e and mu; the friction cap without cohesion.
pub(crate) fn law(stiffness: f64, restitution: f64, friction: f64) -> LinearSpringDashpot {
    let tangential = LinearSpringDashpot::tangential_stiffness_of(stiffness, 0.3);
    LinearSpringDashpot::new(stiffness, tangential, restitution, friction, FrictionCap::Contact)
        .expect("the parameters of a test have a meaning")
}

/// Attraction of largest force `force` between spheres of diameter `diameter`, `at_wall` to walls.
pub(crate) fn attraction(
    (force, at_wall): (f64, f64),
    diameter: f64,
    (cut_off, range): (f64, f64),
) -> VanDerWaals {
    let per_force = cut_off * cut_off / (0.5 * diameter);
    VanDerWaals {
        hamaker_constant: Schedule::Constant(12.0 * force * per_force),
        wall_hamaker_constant: Schedule::Constant(6.0 * at_wall * per_force),
        cut_off,
        range,
        expression: CohesionExpression::NearContact,
    }
}

/// The paper's gas: St = 55, creeping Wen-Yu drag, dz = 1.5, density for the full law.
pub(crate) fn gas(superficial_velocity: f64) -> ColumnGas {
    ColumnGas {
        spacing: 1.5,
        drag: DragLaw::WEN_YU_CREEPING,
        drag_factor: 1.0,
        drag_share: DragShare::default(),
        viscosity: 1.0 / 55.0,
        density: 1.3e-3,
        parcel_size: 1.0,
        drive: Drive::Velocity(Schedule::Constant(superficial_velocity)),
        lateral_drag: false,
        base_node: BaseNode::FullCell,
        ambient_pressure: None,
    }
}

/// Gravity of magnitude 1 in the frame of a plate of acceleration Gamma and frequency f.
pub(crate) fn shaken(relative_acceleration: f64, frequency: f64) -> EffectiveGravity {
    let vibration = Vibration { relative_acceleration, frequency, start: 0.0 };
    EffectiveGravity { magnitude: 1.0, vibration: Some(vibration) }
}

/// The vector from one centre to the nearest image of another.
pub(crate) fn branch(
    bounds: &Bounds,
    one: &ParticleRecord,
    other: &ParticleRecord,
) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| {
        let (displacement, length) =
            (other.position[axis] - one.position[axis], bounds.lengths()[axis]);
        if bounds.is_periodic(axis) {
            displacement - length * (displacement / length).round()
        } else {
            displacement
        }
    })
}

impl Bench {
    /// An empty box with walls in its faces: the paper's powder (k_n 2e5, e 0.9, mu 0.1, density and diameter
    /// 1), without weight, gas and cohesion.
    pub(crate) fn new(lengths: [f64; 3], faces: [[Face; 2]; 3]) -> Self {
        Self {
            domain: Domain::of_box(Bounds::new(lengths.into(), faces)),
            contact: law(2.0e5, 0.9, 0.1),
            interface: None,
            at_walls: Vec::new(),
            mixture: None,
            cohesion: None,
            gas: None,
            volume_averaged: None,
            gravity: EffectiveGravity { magnitude: 0.0, vibration: None },
            time_step: 2.5e-4,
            skin: Some(0.15),
            balance: None,
            force_limit: None,
            density: 1.0,
            particles: Vec::new(),
        }
    }

    /// Adds a particle of the bench's density, without spin; its id is its number.
    pub(crate) fn add(&mut self, position: [f64; 3], velocity: [f64; 3], radius: f64) -> &mut Self {
        let quantum = self.domain.bounds.position_quantum();
        let position = quantum.round_vector(position.into()).into();
        let sphere = Sphere { position, velocity, radius, density: self.density };
        self.particles.push(sphere.record(self.particles.len() as u64));
        self
    }

    /// Layers of a square lattice of this spacing from `bottom` upwards, moved at random by up to `jitter`
    /// along each axis, at random velocities up to `speed`; the diameters follow each other.
    pub(crate) fn add_layers(
        &mut self,
        count: u64,
        (spacing, bottom): (f64, f64),
        diameters: &[f64],
        (jitter, speed): (f64, f64),
    ) -> &mut Self {
        let lengths = self.domain.bounds.lengths();
        let along = |axis: usize| ((lengths[axis] / spacing) as u64).max(1);
        let (nx, ny) = (along(0), along(1));
        for id in 0..count {
            let mut generator = random_of(5, id, "test bed");
            let mut vary = |width: f64| width * (2.0 * uniform(&mut generator) - 1.0);
            let cell = [id % nx, (id / nx) % ny, id / (nx * ny)].map(|index| index as f64);
            let position = [
                (cell[0] + 0.5) * lengths.x / nx as f64 + vary(jitter),
                (cell[1] + 0.5) * lengths.y / ny as f64 + vary(jitter),
                bottom + cell[2] * spacing + vary(jitter),
            ];
            let velocity = [vary(speed), vary(speed), vary(speed)];
            let diameter = diameters[id as usize % diameters.len()];
            self.add(position, velocity, 0.5 * diameter);
        }
        self
    }

    /// Sizes of all particles; those of a unit sphere if there are none.
    pub(crate) fn sizes(&self) -> SizeRange {
        let range = SizeRange::of(self.particles.iter().map(|it| (it.radius, it.mass)));
        let (smallest_diameter, largest_diameter) = (1.0, 1.0);
        let largest_mass = self.density * PI / 6.0;
        range.unwrap_or(SizeRange { smallest_diameter, largest_diameter, largest_mass })
    }

    fn physics(&self) -> Physics {
        let of_particles = self.interface.clone().unwrap_or_else(|| self.contact.into());
        let gas = match (&self.volume_averaged, &self.gas) {
            (Some(model), _) => GasModel::VolumeAveraged(model.clone()),
            (None, Some(gas)) => GasModel::Column(gas.clone()),
            (None, None) => GasModel::None,
        };
        let of_one_species = Mixture {
            contact: ByPair::of_all(of_particles),
            at_walls: self.at_walls.iter().cloned().map(BySpecies::of_all).collect(),
            cohesion: self.cohesion.clone().map(ByPair::of_all),
        };
        let Mixture { contact, at_walls, cohesion } =
            self.mixture.clone().unwrap_or(of_one_species);
        let (gravity, time_step) = (self.gravity, self.time_step);
        let exchanges = Exchanges::default();
        Physics { contact, at_walls, cohesion, exchanges, gas, gravity, time_step }
    }

    /// The setup of this bed in the library.
    pub(crate) fn setup(&self) -> Setup {
        let setup = Setup::in_domain(self.domain.clone(), self.physics())
            .particles(self.particles.iter().copied())
            .sizes(self.sizes());
        let setup = self.skin.into_iter().fold(setup, Setup::skin);
        let setup = self.balance.into_iter().fold(setup, Setup::balance);
        self.force_limit.into_iter().fold(setup, Setup::force_limit)
    }

    /// Everything at the bench's start, on this rank of a rank grid. Collective.
    pub(crate) fn start<'a>(&self, grid: RankGrid, ranks: &'a dyn Communicator) -> Run<'a> {
        Run(self.setup().start(grid, ranks).expect("the test's bed can start"))
    }

    /// The run that `end` is a state of, continued on this rank of any rank grid. Collective.
    pub(crate) fn resume<'a>(
        &self,
        end: &Snapshot,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Run<'a> {
        Run(self.setup().resume(end, grid, ranks).expect("the test's bed can continue"))
    }

    /// The run on one rank.
    pub(crate) fn alone(&self) -> Run<'static> {
        self.start(RankGrid([1, 1, 1]), &OneRank)
    }

    /// Does `work` with the run on a grid of thread ranks; returns the result of rank 0.
    pub(crate) fn on_ranks<T: Send>(
        &self,
        grid: [usize; 3],
        work: impl Fn(&mut Run) -> T + Sync,
    ) -> T {
        let grid = RankGrid(grid);
        let mut made = run_on_threads(grid.size(), |ranks| work(&mut self.start(grid, ranks)));
        made.swap_remove(0)
    }
}

/// A run whose errors fail the test.
pub(crate) struct Run<'a>(pub(crate) setup::Run<'a>);

impl<'a> Deref for Run<'a> {
    type Target = setup::Run<'a>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Run<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl Run<'_> {
    pub(crate) fn try_step(&mut self) -> Result<(), StepError> {
        self.0.step()
    }

    pub(crate) fn steps(&mut self, count: u64) -> &mut Self {
        self.0.steps(count).expect("the test's bed can continue");
        self
    }

    /// Force of the gas on all particles of this rank.
    pub(crate) fn gas_force(&self) -> Vector3<f64> {
        let quantum = self.models.force_quantum;
        let counts = self.work.gas.total_force(&self.state.particles, quantum);
        Vector3::from(counts.map(|count| count as f64 * quantum.spacing()))
    }

    /// A particle of this rank.
    pub(crate) fn particle(&self, id: u64) -> ParticleRecord {
        self.0.particle(id).expect("the particle is owned here")
    }

    /// The whole state on all ranks. Collective.
    pub(crate) fn snapshot(&mut self) -> Snapshot {
        self.0.snapshot().expect("the test's forces have a meaning")
    }
}

/// An instrument that passes on its view of a run, with the numbers of the series and the forces of single contacts.
pub(crate) struct Reading<F>(pub(crate) F);

impl<F: FnMut(&View<'_>)> Instrument for Reading<F> {
    fn layout(&self) -> Layout {
        Layout::default()
    }

    fn needs(&self) -> Needs {
        Needs { contact_forces: true, series: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, _: &dyn Communicator) -> Readings {
        (self.0)(view);
        Readings::default()
    }

    fn stored(&self, _: &dyn Communicator) -> Stored {
        Stored::default()
    }

    fn restore(&mut self, _: &Stored, _: &dyn Communicator) -> Option<()> {
        Some(())
    }
}
