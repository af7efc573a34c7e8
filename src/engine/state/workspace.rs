//! Data that can be dropped and rebuilt at any time.

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

/// Data that can be dropped and rebuilt at any time: lists, plans, buffers. None of it changes a result.
#[derive(Debug)]
pub struct Workspace {
    /// Cells of the neighbour list, and when it was built.
    pub neighbours: NeighbourList,
    /// Ghosts of this rank, and of its particles on other ranks.
    pub halo: ParticleHalo,
    /// Decomposition of the box.
    pub decomposition: Decomposition,
    /// Rule by which the skin of the lists is chosen.
    pub skin: Skin,
    /// Range of the lists.
    pub list_range: ListRange,
    /// Least width of a subdomain: that of the widest ghost layer of any stage, with the narrowest skin.
    pub least_width: f64,
    /// Whether cut planes move, and where to.
    pub balance: LoadBalance,
    /// Positions of the walls at this step.
    pub wall_poses: Vec<WallPose>,
    /// The gas of the present stage.
    pub gas: GasSolver,
    /// Forces of this rank's particles on walls at the last evaluation.
    pub on_walls: WallTallies,
    /// Time spent.
    pub timers: Timers,
    /// The first error on this rank, until the ranks next agree.
    pub fault: Option<String>,
    /// Requests to this rank.
    pub requests: Requests,
}

/// Requests made to a rank between two steps, by a signal or because of the wall-clock time.
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

    /// Does the work of a phase of the step, and adds its duration to the timers.
    pub fn time<T>(&mut self, phase: Phase, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let result = work(self);
        self.timers.add(phase, start.elapsed());
        result
    }

    /// Keeps the first error until the ranks next agree.
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

    /// Moves the walls to their positions at the end of a step of this length.
    pub fn move_walls(&mut self, domain: &Domain, time: f64, step: f64) {
        self.wall_poses.clear();
        self.wall_poses.extend(domain.walls.iter().map(|wall| wall.pose(time, step)));
    }

    /// Prepares for the models of a stage. The neighbour list must be rebuilt before the next step.
    pub fn prepare(&mut self, domain: &Domain, models: &Models, sizes: &SizeRange) {
        self.list_range.interaction = models.range(sizes);
        self.on_walls.reset(domain.walls.len());
        self.gas = GasSolver::None;
    }
}
