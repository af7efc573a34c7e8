//! What can be dropped and rebuilt at any time.

use super::{Domain, Models, SizeRange, State};
use crate::balance::{Balance, Cuts, LoadBalance};
use crate::contact::WallTallies;
use crate::domain::{Bounds, Decomposition, WallPose};
use crate::gas::GasSolver;
use crate::parallel::{Communicator, ParticleHalo};
use crate::particles::{ListRange, NeighbourList, Skin};
use crate::timers::{Phase, Timers};
use std::fmt::Display;
use std::time::Instant;

/// What can be dropped and rebuilt at any time: lists, plans, buffers. None of it changes a result.
#[derive(Debug)]
pub struct Workspace {
    /// When the neighbour list was built, and its cells.
    pub neighbours: NeighbourList,
    /// Who is whose ghost.
    pub halo: ParticleHalo,
    /// How the box is cut.
    pub decomposition: Decomposition,
    /// How the skin of the lists is chosen.
    pub skin: Skin,
    /// How far lists look.
    pub list_range: ListRange,
    /// Width that no block may be below: of the widest ghosts of any stage, with the narrowest skin.
    pub least_width: f64,
    /// Whether cut planes move, and where to.
    pub balance: LoadBalance,
    /// Where the walls are at this step.
    pub wall_poses: Vec<WallPose>,
    /// The gas of the present stage.
    pub gas: GasSolver,
    /// Forces on walls at the last evaluation, by this rank's particles.
    pub on_walls: WallTallies,
    /// Time spent.
    pub timers: Timers,
    /// What went wrong on this rank, until the ranks next agree.
    pub fault: Option<String>,
    /// What this rank was asked for.
    pub requests: Requests,
}

/// What a rank was asked for between two steps, by a signal or by wall-clock time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// Stop, with a checkpoint.
    pub stop: bool,
    /// Write a checkpoint and continue.
    pub checkpoint: bool,
}

impl Workspace {
    /// An empty workspace.
    pub fn new(
        decomposition: Decomposition,
        skin: Skin,
        least_width: f64,
        balance: Option<Balance>,
    ) -> Self {
        let several_ranks = decomposition.grid().size() > 1;
        Self {
            neighbours: NeighbourList::default(),
            halo: ParticleHalo::default(),
            balance: LoadBalance::new(balance.filter(|_| several_ranks)),
            decomposition,
            skin,
            list_range: ListRange { interaction: 0.0, skin: skin.narrowest() },
            least_width,
            wall_poses: Vec::new(),
            gas: GasSolver::None,
            on_walls: WallTallies::default(),
            timers: Timers::default(),
            fault: None,
            requests: Requests::default(),
        }
    }

    /// Does the work of a phase of the step, and adds its time.
    pub fn time<T>(&mut self, phase: Phase, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let result = work(self);
        self.timers.add(phase, start.elapsed());
        result
    }

    /// Keeps what went wrong, if it is the first, until the ranks next agree.
    pub fn note_fault<T, E: Display>(&mut self, result: Result<T, E>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(error) => {
                self.fault.get_or_insert_with(|| error.to_string());
                None
            }
        }
    }

    /// Checks the ranks' loads if it is time for that, given whether lists are rebuilt anyway. Collective.
    pub fn check_loads(
        &mut self,
        rebuilt_anyway: bool,
        state: &State,
        bounds: &Bounds,
        ranks: &dyn Communicator,
    ) {
        let State { particles, contacts, clock, .. } = state;
        let (decomposition, least_width) = (&self.decomposition, self.least_width);
        let cuts = Cuts { bounds, decomposition, least_width };
        self.balance.check((clock.step, rebuilt_anyway), particles, contacts, cuts, ranks);
    }

    /// Moves the walls to where they are at the end of a step of this length.
    pub fn move_walls(&mut self, domain: &Domain, time: f64, step: f64) {
        self.wall_poses.clear();
        self.wall_poses.extend(domain.walls.iter().map(|wall| wall.pose(time, step)));
    }

    /// Makes ready for the models of a stage. The neighbour list must be rebuilt before the next step.
    pub fn prepare(&mut self, domain: &Domain, models: &Models, sizes: &SizeRange) {
        self.list_range.interaction = models.range(sizes);
        self.on_walls.reset(domain.walls.len());
        self.gas = GasSolver::None;
    }
}
