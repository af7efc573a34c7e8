//! Load balancing: measures how long ranks work, decides whether their loads are uneven, and chooses cut planes that give
//! every rank about the same work. None of it changes a result.

mod checks;
mod cut_planes;
mod step_times;

pub use checks::Balance;
pub use cut_planes::{Cuts, RankLoad, RankWork};
pub use step_times::{LoadTimes, StepTimes};

use crate::domain::Decomposition;
use crate::parallel::Communicator;
use crate::particles::{Contacts, Particles};
use crate::timers::Timers;

/// The loads of a run's ranks, and the cut planes that follow from them.
#[derive(Debug, Default)]
pub struct LoadBalance {
    /// When ranks check their loads; `None` if planes never move.
    checks: Option<Balance>,
    /// Times of the steps since the last check.
    step_times: StepTimes,
    /// How the box is to be cut when particles next go to their owners, if the loads were uneven at the last check.
    planned: Option<Decomposition>,
}

impl LoadBalance {
    /// Balances loads at these checks; planes never move without them.
    pub fn new(checks: Option<Balance>) -> Self {
        Self { checks, ..Self::default() }
    }

    /// Begins to count steps, at the first step of a run.
    pub fn begin(&mut self, step: u64) {
        if let Some(checks) = &mut self.checks {
            checks.begin(step);
        }
    }

    /// Notes how long the previous step took, if planes may move.
    pub fn note_step(&mut self, timers: &Timers) {
        if self.checks.is_some() {
            self.step_times.note(timers);
        }
    }

    /// Whether to check although lists are not rebuilt.
    pub fn is_overdue(&self, step: u64) -> bool {
        self.checks.is_some_and(|checks| checks.is_overdue(step))
    }

    /// Whether planes are to move, for which lists must be rebuilt.
    pub fn has_plan(&self) -> bool {
        self.planned.is_some()
    }

    /// Takes the planned decomposition, into which particles move now.
    pub fn take_plan(&mut self) -> Option<Decomposition> {
        self.planned.take()
    }

    /// Checks the ranks' loads at a step if it is time for that, and plans other cut planes if they are uneven, given whether lists
    /// are rebuilt anyway. Collective.
    pub fn check(
        &mut self,
        (step, rebuilt_anyway): (u64, bool),
        particles: &Particles,
        contacts: &Contacts,
        cuts: Cuts<'_>,
        ranks: &dyn Communicator,
    ) {
        let Some(checks) = &mut self.checks else { return };
        if !checks.look(step) {
            return;
        }
        let LoadTimes { on_particles, on_pairs } = self.step_times.take_mean();
        let pairs = contacts.active_counts(particles);
        let pair_count = pairs.iter().map(|&count| count as usize).sum();
        let on_particles = RankWork { count: particles.owned_count(), time: on_particles };
        let on_pairs = RankWork { count: pair_count, time: on_pairs };
        let load = RankLoad::measured(on_particles, on_pairs, ranks);
        if ranks.is_root() {
            log::debug!("step {step}: largest over mean load {:.3}", load.imbalance);
        }
        if checks.are_uneven(load.imbalance, rebuilt_anyway) {
            let positions = particles.body.iter().map(|body| cuts.bounds.wrap(body.position));
            let owned = positions.zip(pairs.iter().copied()); // ghosts are left out
            self.planned = Some(load.balanced(cuts, owned, ranks));
        }
    }
}
