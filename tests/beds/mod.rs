//! Small beds for tests: the one place that builds domain, models, state and workspace.
#![allow(dead_code, reason = "each test file uses a part")]

use nalgebra::Vector3;
use std::collections::HashSet;
use std::f64::consts::PI;
use talcum::contact::{
    CohesionExpression, ContactLaw, ContactModel, FrictionCap, LinearSpringDashpot, VanDerWaals,
};
use talcum::domain::{
    Bounds, BoxFace, Decomposition, EffectiveGravity, Face, RankGrid, Vibration, Wall,
};
use talcum::gas::volume_averaged::VolumeAveragedModel;
use talcum::gas::{BaseNode, ColumnGas, DragLaw, Drive, GasModel, GasReport, GasState};
use talcum::numbers::{Schedule, random_of, uniform};
use talcum::parallel::{
    CellRecord, Communicator, ContactRecord, OneRank, ParticleRecord, WallContactRecord,
    run_on_threads, send_to_owners, share_with_all,
};
use talcum::particles::{ContactHistories, Contacts, PairHistory, Particles, WallHistory};
use talcum::state::{
    Balance, Clock, Departed, Domain, Limits, Models, SizeRange, State, Workspace,
};
use talcum::time_step::{Staggered, StepError, advance, begin, find_first_forces};

pub(crate) const PERIODIC: [Face; 2] = [Face::Periodic; 2];
pub(crate) const OPEN: [Face; 2] = [Face::Open; 2];
/// A plate below, nothing above.
pub(crate) const PLATE: [Face; 2] = [Face::Wall, Face::Open];

/// All that a test chooses before a run.
#[derive(Clone, Debug)]
pub(crate) struct Bench {
    pub(crate) domain: Domain,
    pub(crate) contact: LinearSpringDashpot,
    /// What holds between particles instead of `contact`.
    pub(crate) interface: Option<ContactModel>,
    /// What holds at the walls, by their numbers; walls beyond are like particles.
    pub(crate) at_walls: Vec<ContactModel>,
    pub(crate) cohesion: Option<VanDerWaals>,
    pub(crate) gas: Option<ColumnGas>,
    /// The volume-averaged gas, in the place of the column gas.
    pub(crate) volume_averaged: Option<VolumeAveragedModel>,
    pub(crate) gravity: EffectiveGravity,
    pub(crate) time_step: f64,
    pub(crate) skin: f64,
    pub(crate) balance: Option<Balance>,
    /// The largest force, where a closed form asks for overlaps beyond those of a real case.
    pub(crate) force_limit: Option<f64>,
    pub(crate) density: f64,
    pub(crate) particles: Vec<ParticleRecord>,
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
        viscosity: 1.0 / 55.0,
        density: 1.3e-3,
        drive: Drive::Velocity(Schedule::Constant(superficial_velocity)),
        lateral_drag: false,
        base_node: BaseNode::FullCell,
    }
}

/// Gravity of magnitude 1 in the frame of a plate of acceleration Gamma and frequency f.
pub(crate) fn shaken(relative_acceleration: f64, frequency: f64) -> EffectiveGravity {
    let vibration = Vibration { relative_acceleration, frequency, start: 0.0 };
    EffectiveGravity { magnitude: 1.0, vibration: Some(vibration) }
}

/// From one centre to another's nearest image.
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

fn face_walls(bounds: &Bounds) -> Vec<Wall> {
    let is_wall = |face: &BoxFace| bounds.face(*face) == Face::Wall;
    BoxFace::ALL.into_iter().filter(is_wall).map(|face| Wall::in_face(bounds, face)).collect()
}

impl Bench {
    /// An empty box with walls in its faces: the paper's powder (k_n 2e5, e 0.9, mu 0.1, density and diameter
    /// 1), without weight, gas and cohesion.
    pub(crate) fn new(lengths: [f64; 3], faces: [[Face; 2]; 3]) -> Self {
        let bounds = Bounds::new(lengths.into(), faces);
        let walls = face_walls(&bounds);
        Self {
            domain: Domain { bounds, walls },
            contact: law(2.0e5, 0.9, 0.1),
            interface: None,
            at_walls: Vec::new(),
            cohesion: None,
            gas: None,
            volume_averaged: None,
            gravity: EffectiveGravity { magnitude: 0.0, vibration: None },
            time_step: 2.5e-4,
            skin: 0.15,
            balance: None,
            force_limit: None,
            density: 1.0,
            particles: Vec::new(),
        }
    }

    /// Adds a particle of the bench's density, without spin; its id is its number.
    pub(crate) fn add(&mut self, position: [f64; 3], velocity: [f64; 3], radius: f64) -> &mut Self {
        let lattice = self.domain.bounds.position_quantum();
        let zero = [0.0; 3];
        self.particles.push(ParticleRecord {
            id: self.particles.len() as u64,
            position: lattice.round_vector(position.into()).into(),
            velocity,
            angular_velocity: zero,
            force: zero,
            torque: zero,
            radius,
            mass: self.density * 4.0 / 3.0 * PI * radius.powi(3),
            gas_force: [0.0; 3],
        });
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
        let radii = || self.particles.iter().map(|particle| particle.radius);
        if self.particles.is_empty() {
            let largest_mass = self.density * PI / 6.0;
            return SizeRange { smallest_diameter: 1.0, largest_diameter: 1.0, largest_mass };
        }
        SizeRange {
            smallest_diameter: 2.0 * radii().fold(f64::INFINITY, f64::min),
            largest_diameter: 2.0 * radii().fold(0.0, f64::max),
            largest_mass: self.particles.iter().map(|particle| particle.mass).fold(0.0, f64::max),
        }
    }

    fn gas_model(&self) -> GasModel {
        match (&self.volume_averaged, &self.gas) {
            (Some(model), _) => GasModel::VolumeAveraged(model.clone()),
            (None, Some(gas)) => GasModel::Column(gas.clone()),
            (None, None) => GasModel::None,
        }
    }

    pub(crate) fn models(&self) -> Models {
        let law = ContactLaw::LinearSpringDashpot(self.contact);
        let contact = self.interface.clone().unwrap_or(ContactModel { law, rolling: None });
        let at_walls = self.at_walls.clone();
        let SizeRange { smallest_diameter, largest_diameter, largest_mass } = self.sizes();
        let diameters = [smallest_diameter, largest_diameter];
        let weight = largest_mass * self.gravity.largest();
        let (cohesion, dt) = (self.cohesion.clone(), self.time_step);
        let mut limits = Limits::new(
            std::iter::once(&contact).chain(&at_walls),
            cohesion.as_ref(),
            diameters,
            weight,
            dt,
        );
        limits.force = self.force_limit.unwrap_or(limits.force);
        Models {
            contact,
            at_walls,
            cohesion,
            gas: self.gas_model(),
            gravity: self.gravity,
            time_step: dt,
            limits,
            force_quantum: limits.force_quantum(),
            torque_quantum: limits.torque_quantum(0.5 * largest_diameter),
        }
    }

    /// Everything at the bench's start, on this rank of a rank grid. Collective.
    pub(crate) fn start<'a>(&self, grid: RankGrid, ranks: &'a dyn Communicator) -> Run<'a> {
        let clock = Clock::new(self.time_step);
        let whole = Snapshot { particles: self.particles.clone(), ..Snapshot::at(clock) };
        self.run_from(&whole, true, grid, ranks)
    }

    /// The run that `end` is a state of, continued on this rank of any rank grid. Collective.
    pub(crate) fn resume<'a>(
        &self,
        end: &Snapshot,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Run<'a> {
        self.run_from(end, false, grid, ranks)
    }

    fn run_from<'a>(
        &self,
        whole: &Snapshot,
        new_bed: bool,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Run<'a> {
        let (here, size) = (ranks.rank(), ranks.size());
        assert_eq!(grid.size(), size, "the rank grid is of all ranks");
        let (domain, models) = (self.domain.clone(), self.models());
        let width = self.sizes().largest_diameter + self.skin;
        let even = Decomposition::even(grid, &self.domain.bounds);
        let decomposition =
            models.gas.align(&even, width).expect("the test's gas has enough cells");
        let share: Vec<ParticleRecord> =
            whole.particles.iter().copied().skip(here).step_by(size).collect();
        let mut particles = Particles::default();
        for record in send_to_owners(share, &decomposition, ranks) {
            record.push_to(&mut particles);
        }
        let owned: HashSet<u64> = particles.id.iter().copied().collect();
        let pairs = whole.pairs.iter().copied().map(PairHistory::from);
        let walls = whole.walls.iter().copied().map(WallHistory::from);
        let histories = ContactHistories {
            pairs: pairs
                .filter(|it| owned.contains(&it.lower) || owned.contains(&it.higher))
                .collect(),
            walls: walls.filter(|it| owned.contains(&it.particle)).collect(),
        };
        let (clock, departed, sizes) = (whole.clock, whole.departed, self.sizes());
        let contacts = Contacts::default();
        let share: Vec<_> = whole.cells.iter().copied().skip(here).step_by(size).collect();
        let report = GasReport::default();
        let subdomain = decomposition.subdomain(&self.domain.bounds, here);
        let gas = GasState::from_records(&models.gas, &share, report, subdomain, ranks);
        let mut state = State { particles, contacts, clock, departed, sizes, gas };
        let mut work = Workspace::new(decomposition, self.skin, self.balance);
        work.prepare(&domain, &models, &state.sizes);
        begin(&mut state, &domain, &models, &mut work, histories, ranks)
            .expect("the test's bed can begin");
        if new_bed {
            find_first_forces(&mut state, &domain, &models, &mut work, ranks);
        }
        Run { state, domain, models, work, ranks }
    }

    /// The run on one rank.
    pub(crate) fn alone(&self) -> Run<'static> {
        self.start(RankGrid([1, 1, 1]), &OneRank)
    }

    /// Does `work` with the run on a grid of thread ranks; what rank 0 made of it.
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

/// A state on one rank, with all that is needed for its next step.
pub(crate) struct Run<'a> {
    pub(crate) state: State,
    pub(crate) domain: Domain,
    pub(crate) models: Models,
    pub(crate) work: Workspace,
    pub(crate) ranks: &'a dyn Communicator,
}

impl Run<'_> {
    pub(crate) fn try_step(&mut self) -> Result<(), StepError> {
        let Self { state, domain, models, work, ranks } = self;
        advance(&mut Staggered::new(state), domain, models, work, *ranks).map(|_| ())
    }

    pub(crate) fn steps(&mut self, count: u64) -> &mut Self {
        for _ in 0..count {
            self.try_step().expect("the test's bed can go on");
        }
        self
    }

    pub(crate) fn time(&self) -> f64 {
        self.state.clock.time()
    }

    /// A particle of this rank.
    pub(crate) fn particle(&self, id: u64) -> ParticleRecord {
        let particles = &self.state.particles;
        let owned = &particles.id[..particles.owned_count()];
        let index =
            owned.iter().position(|&other| other == id).expect("the particle is owned here");
        ParticleRecord::of(particles, index)
    }

    /// The whole state, sorted by ids, positions wrapped. Collective; the same on all ranks.
    pub(crate) fn snapshot(&self) -> Snapshot {
        let State { particles, contacts, clock, departed, .. } = &self.state;
        let here: Vec<ParticleRecord> = (0..particles.owned_count())
            .map(|index| {
                let position = self.domain.bounds.wrap(particles.body[index].position).into();
                ParticleRecord { position, ..ParticleRecord::of(particles, index) }
            })
            .collect();
        let ContactHistories { pairs, walls } = contacts.histories_once(particles);
        let pairs = pairs.into_iter().map(ContactRecord::from);
        let walls = walls.into_iter().map(WallContactRecord::from);
        let mut particles = share_with_all(here, self.ranks);
        let mut pairs = share_with_all(pairs.collect::<Vec<_>>(), self.ranks);
        let mut walls = share_with_all(walls.collect::<Vec<_>>(), self.ranks);
        particles.sort_by_key(|particle| particle.id);
        pairs.sort_by_key(|pair| (pair.lower, pair.higher));
        walls.sort_by_key(|contact| (contact.particle, contact.wall));
        let cells = self.work.gas.records(&self.state.gas);
        let mut cells = share_with_all(cells, self.ranks);
        cells.sort_by_key(|record| record.cell);
        Snapshot { particles, pairs, walls, cells, clock: *clock, departed: *departed }
    }
}

/// A whole state: what a checkpoint holds.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    pub(crate) particles: Vec<ParticleRecord>,
    pub(crate) pairs: Vec<ContactRecord>,
    pub(crate) walls: Vec<WallContactRecord>,
    pub(crate) cells: Vec<CellRecord>,
    pub(crate) clock: Clock,
    pub(crate) departed: Departed,
}

impl Snapshot {
    fn at(clock: Clock) -> Self {
        let (pairs, walls, cells) = (Vec::new(), Vec::new(), Vec::new());
        Self { particles: Vec::new(), pairs, walls, cells, clock, departed: Departed::default() }
    }

    /// Every bit of it; equal only for equal states.
    pub(crate) fn bits(&self) -> Vec<u8> {
        let mut bytes = bytemuck::cast_slice::<_, u8>(&self.particles).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&self.pairs));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.walls));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.cells));
        bytes.extend_from_slice(&self.clock.step.to_le_bytes());
        bytes.extend_from_slice(&self.departed.count.to_le_bytes());
        bytes.extend_from_slice(&self.departed.volume.to_le_bytes());
        bytes
    }
}
