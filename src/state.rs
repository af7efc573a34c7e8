//! The three kinds of data: what a checkpoint holds, what the case chose, and what can be dropped and
//! made anew at any time.

use crate::contact::{ContactForceLaw, ContactModel, VanDerWaals};
pub use crate::coupling::FlowReport;
use crate::coupling::{Flow, FlowModel, FlowSolver, FluidForce};
use crate::domain::{Bounds, Decomposition, EffectiveGravity, Wall, WallPose, WallShape};
use crate::gas::ColumnGas;
use crate::numbers::Quantum;
use crate::parallel::ParticleHalo;
use crate::particles::{Contacts, Neighbours, Particles, Reach, Weight};
use crate::rules::{interaction_range, speed_limit};
use crate::timers::Timers;
use std::time::Duration;

/// Time as a count of steps since the step was last changed: no drift of rounding errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Steps done since the run began.
    pub step: u64,
    /// Time at `origin_step`.
    pub origin_time: f64,
    /// Step from which on `time_step` holds.
    pub origin_step: u64,
    /// Length of a step.
    pub time_step: f64,
}

impl Clock {
    /// A clock at time zero.
    pub fn new(time_step: f64) -> Self {
        Self { step: 0, origin_time: 0.0, origin_step: 0, time_step }
    }

    /// The time now.
    pub fn time(&self) -> f64 {
        self.time_of(self.step)
    }

    /// The time after `step` steps, as long as the step stays as it is.
    pub fn time_of(&self, step: u64) -> f64 {
        self.origin_time + (step - self.origin_step) as f64 * self.time_step
    }

    /// One step on.
    pub fn tick(&mut self) {
        self.step += 1;
    }

    /// The same instant, continued with another step.
    pub fn with_time_step(self, time_step: f64) -> Self {
        if time_step == self.time_step {
            return self;
        }
        Self { step: self.step, origin_time: self.time(), origin_step: self.step, time_step }
    }
}

/// Particles that left through an open face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Departed {
    /// How many.
    pub count: u64,
    /// Their volume, summed in the order of departure and of ids.
    pub volume: f64,
}

/// What a checkpoint holds: with the models, all that the future depends on.
#[derive(Clone, Debug)]
pub struct State {
    /// Owned particles and ghosts.
    pub particles: Particles,
    /// Near pairs, and what the touching ones remember.
    pub contacts: Contacts,
    /// Time.
    pub clock: Clock,
    /// What has left the box.
    pub departed: Departed,
    /// Sizes of the particles that the run began with: limits and lattices follow from them.
    pub sizes: SizeRange,
    /// A gas in three dimensions, on this rank's cells.
    pub flow: Option<Flow>,
    /// Length of the step whose second kick is still due. No checkpoint is written before it is done.
    pub kick_due: Option<f64>,
}

/// The gas as the case chose it.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one for each stage of a case")]
pub enum GasModel {
    /// One-dimensional, without inertia.
    Column(ColumnGas),
    /// In three dimensions.
    VolumeAveraged(FlowModel),
}

/// The smallest and largest particles of a run at its begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeRange {
    /// Smallest diameter.
    pub smallest_diameter: f64,
    /// Largest diameter.
    pub largest_diameter: f64,
    /// Largest mass.
    pub largest_mass: f64,
}

/// Where it happens: the same for the whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// The box.
    pub bounds: Bounds,
    /// Walls: those in faces of the box first, then the case's own.
    pub walls: Vec<Wall>,
}

impl Domain {
    /// Horizontal cross-section that particles have room in: of the box, or of a narrower round column.
    pub fn cross_section(&self) -> f64 {
        let area = |wall: &Wall| match wall.shape {
            WallShape::Plane { .. } => f64::INFINITY,
            WallShape::Cylinder { radius, .. } => std::f64::consts::PI * radius * radius,
        };
        self.walls.iter().map(area).fold(self.bounds.cross_section(), f64::min)
    }
}

/// What acts on the particles: chosen by the case for one stage of the run, and immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    /// Where particles touch.
    pub contact: ContactModel,
    /// Where they touch the walls, by the walls' numbers; walls beyond its end are like particles.
    pub at_walls: Vec<ContactModel>,
    /// Attraction.
    pub cohesion: Option<VanDerWaals>,
    /// Gas.
    pub gas: Option<GasModel>,
    /// Gravity in the frame of the plate.
    pub gravity: EffectiveGravity,
    /// Length of a step.
    pub time_step: f64,
    /// Bounds of what particles may do; beyond them the run ends in words.
    pub limits: Limits,
    /// Lattice that forces are rounded to.
    pub force_quantum: Quantum,
    /// Lattice that torques are rounded to.
    pub torque_quantum: Quantum,
}

impl Models {
    /// The column of gas, if that is the gas.
    pub fn column(&self) -> Option<&ColumnGas> {
        match &self.gas {
            Some(GasModel::Column(gas)) => Some(gas),
            _ => None,
        }
    }

    /// What particles weigh in the frame of the plate.
    pub fn weight_at(&self, time: f64) -> Weight {
        Weight { gravity: self.gravity.at(time), quantum: self.force_quantum }
    }

    /// The gas in three dimensions, if that is the gas.
    pub fn flow(&self) -> Option<&FlowModel> {
        match &self.gas {
            Some(GasModel::VolumeAveraged(model)) => Some(model),
            _ => None,
        }
    }

    /// Separation of surfaces up to which particles of these sizes, or they and walls, act on each other.
    pub fn range(&self, sizes: &SizeRange) -> f64 {
        let interfaces = std::iter::once(&self.contact).chain(&self.at_walls);
        range_of(interfaces, self.cohesion.as_ref(), sizes)
    }

    /// Separation of surfaces up to which contacts of particles of these sizes act.
    pub fn contact_range(&self, sizes: &SizeRange) -> f64 {
        range_of([&self.contact], None, sizes)
    }
}

/// Separation of surfaces up to which bodies act on each other that touch in these ways, particles being of
/// these sizes.
pub fn range_of<'a>(
    interfaces: impl IntoIterator<Item = &'a ContactModel>,
    cohesion: Option<&VanDerWaals>,
    sizes: &SizeRange,
) -> f64 {
    let largest_radius = 0.5 * sizes.largest_diameter;
    let reaches =
        interfaces.into_iter().map(|interface| interface.law.contact_range(largest_radius));
    interaction_range(reaches, cohesion.map(|cohesion| cohesion.range))
}

/// What a run may not exceed: beyond, its numbers would mean nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest component of one contact's force or of one particle's gas force.
    pub force: f64,
    /// Largest speed: a tenth of the smallest diameter in one step.
    pub speed: f64,
}

impl Limits {
    /// Overlap, over the smallest diameter, at which a contact is no longer a contact.
    const LARGEST_OVERLAP: f64 = 0.5;
    /// Contacts (each at the limit) that a particle's force has room for.
    const CONTACTS: f64 = 64.0;

    /// Limits for particles between two diameters, the heavier of this weight, that touch in these ways.
    pub fn new<'a>(
        interfaces: impl IntoIterator<Item = &'a ContactModel>,
        cohesion: Option<&VanDerWaals>,
        diameters: [f64; 2],
        largest_weight: f64,
        time_step: f64,
    ) -> Self {
        let [smallest, largest] = diameters;
        let overlap = Self::LARGEST_OVERLAP * smallest;
        let of_law = |interface: &ContactModel| interface.law.largest_force(overlap, 0.5 * largest);
        let elastic = interfaces.into_iter().map(of_law).fold(0.0, f64::max);
        let attraction = cohesion.map_or(0.0, |law| law.largest_force(0.5 * largest));
        Self {
            force: elastic + attraction + largest_weight,
            speed: speed_limit(smallest, time_step),
        }
    }

    /// The lattice of forces: room for many contacts at the limit.
    pub fn force_quantum(&self) -> Quantum {
        Quantum::spanning(Self::CONTACTS * self.force)
    }

    /// The lattice of torques, of forces at the largest radius.
    pub fn torque_quantum(&self, largest_radius: f64) -> Quantum {
        Quantum::spanning(Self::CONTACTS * self.force * largest_radius)
    }
}

/// What can be dropped and made anew at any time: lists, plans, buffers. None of it changes a result.
#[derive(Debug)]
pub struct Workspace {
    /// When the neighbour list was built, and its cells.
    pub neighbours: Neighbours,
    /// Who is whose ghost.
    pub halo: ParticleHalo,
    /// How the box is cut.
    pub decomposition: Decomposition,
    /// How far lists look.
    pub reach: Reach,
    /// When cut planes move.
    pub balance: Option<Balance>,
    /// Where the walls are at this step.
    pub wall_poses: Vec<WallPose>,
    /// The gas on its grid.
    pub fluid: Option<FluidForce>,
    /// Gas in three dimensions at work on this rank's cells.
    pub flow: Option<FlowSolver>,
    /// Sums of the last force evaluation.
    pub tallies: Tallies,
    /// Time spent.
    pub timers: Timers,
    /// Of that, on particles at the last look at the ranks' loads.
    looked_at: Duration,
    /// What went wrong on this rank, until the ranks next agree.
    pub fault: Option<String>,
    /// What this rank was asked for.
    pub requests: Requests,
}

/// What a rank was asked for between two steps, by a signal or by the clock on the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// Stop, with a checkpoint.
    pub stop: bool,
    /// Write a checkpoint and go on.
    pub checkpoint: bool,
}

/// When cut planes move: ranks look at their loads when lists are rebuilt anyway, not before some steps have passed
/// since the last look, and at the latest after [`Balance::LATEST`] times as many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Least number of steps between looks.
    pub every: u64,
    /// Largest over mean time that ranks spend on their particles above which planes move.
    pub threshold: f64,
    last_look: u64,
}

impl Balance {
    /// Most steps between looks, over the fewest.
    pub const LATEST: u64 = 10;

    /// From the least number of steps between looks, and the largest imbalance that is let be.
    pub fn new(every: u64, threshold: f64) -> Self {
        Self { every, threshold, last_look: 0 }
    }

    /// Whether lists must be rebuilt for a look.
    pub fn is_overdue(&self, step: u64) -> bool {
        step - self.last_look >= Self::LATEST * self.every
    }

    /// Whether to look at this step, at which lists are rebuilt.
    pub fn look(&mut self, step: u64) -> bool {
        let due = step - self.last_look >= self.every;
        if due {
            self.last_look = step;
        }
        due
    }
}

/// External forces on this rank's particles at the last evaluation, as counts of the force lattice: sums
/// over ranks are exact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tallies {
    /// On each wall, by the particles.
    pub on_walls: Vec<[i64; 3]>,
    /// On the particles, by the gas.
    pub by_gas: [i64; 3],
}

impl Workspace {
    /// An empty workspace.
    pub fn new(decomposition: Decomposition, skin: f64, balance: Option<Balance>) -> Self {
        Self {
            neighbours: Neighbours::default(),
            halo: ParticleHalo::default(),
            decomposition,
            reach: Reach { range: 0.0, skin },
            balance,
            wall_poses: Vec::new(),
            fluid: None,
            flow: None,
            tallies: Tallies::default(),
            timers: Timers::default(),
            looked_at: Duration::ZERO,
            fault: None,
            requests: Requests::default(),
        }
    }

    /// Time spent on particles since this was last asked.
    pub fn time_since_last_look(&mut self) -> Duration {
        let now = self.timers.on_particles;
        now - std::mem::replace(&mut self.looked_at, now)
    }

    /// Moves the walls to where they are at the end of a step of this length.
    pub fn move_walls(&mut self, domain: &Domain, time: f64, step: f64) {
        self.wall_poses.clear();
        self.wall_poses.extend(domain.walls.iter().map(|wall| wall.pose(time, step)));
    }

    /// Makes ready for the models of a stage. The neighbour list must be rebuilt before the next step.
    pub fn prepare(&mut self, domain: &Domain, models: &Models, sizes: &SizeRange) {
        self.reach.range = models.range(sizes);
        self.tallies.on_walls = vec![[0; 3]; domain.walls.len()];
        self.tallies.by_gas = [0; 3];
        self.flow = None;
        self.fluid = models.column().map(|gas| {
            let Limits { force, speed } = models.limits;
            let diameters = [sizes.smallest_diameter, sizes.largest_diameter];
            FluidForce::new(gas, &domain.bounds, models.force_quantum, (force, speed), diameters)
        });
    }
}
