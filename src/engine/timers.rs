//! Division of the time of a run among the phases of the step.

use crate::parallel::Communicator;
use std::time::{Duration, Instant};
use std::vec::Drain;

/// The phases of a step, in the order of the step, and the rest of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Kick and drift.
    Integrate,
    /// Decision whether the lists are outdated: one small reduction, in which ranks wait for each other.
    Decide,
    /// Migration, new ghosts and new lists.
    Rebuild,
    /// Updating of ghosts, and return of the forces on them, except for the messages.
    CopyGhosts,
    /// Messages of ghosts, in which ranks wait for each other; and all of a refresh between two steps.
    ExchangeGhosts,
    /// Particles to grid, superficial velocity.
    Gas,
    /// Pairs of particles.
    Contacts,
    /// Particles and walls.
    Walls,
    /// Gas force on the particles.
    GasForce,
    /// Samples of instruments, including their files.
    Instruments,
    /// Results and checkpoints.
    Output,
}

impl Phase {
    /// All phases.
    pub const ALL: [Self; 11] = [
        Self::Integrate,
        Self::Decide,
        Self::Rebuild,
        Self::CopyGhosts,
        Self::ExchangeGhosts,
        Self::Gas,
        Self::Contacts,
        Self::Walls,
        Self::GasForce,
        Self::Instruments,
        Self::Output,
    ];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Integrate => "integrate",
            Self::Decide => "decide (wait)",
            Self::Rebuild => "migrate, rebuild lists",
            Self::CopyGhosts => "copy ghosts",
            Self::ExchangeGhosts => "exchange ghosts (wait)",
            Self::Gas => "coarse-grain, gas",
            Self::Contacts => "contact forces",
            Self::Walls => "wall forces",
            Self::GasForce => "gas force",
            Self::Instruments => "instruments",
            Self::Output => "output",
        }
    }
}

/// Time spent in each phase on this rank.
#[derive(Clone, Debug, Default)]
pub struct Timers {
    spent: [Duration; Phase::ALL.len()],
}

/// Durations of the last steps. If there are more than [`RecentDurations::MOST`], the oldest are dropped.
#[derive(Clone, Debug, Default)]
pub struct RecentDurations {
    kept: Vec<Duration>,
    /// Number of durations that have been recorded.
    count: usize,
}

/// One phase over all ranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseTime {
    /// The phase.
    pub phase: Phase,
    /// Mean over ranks, in seconds.
    pub mean: f64,
    /// Largest value of any rank, in seconds.
    pub largest: f64,
}

impl Timers {
    /// Runs a phase and adds its time.
    #[inline]
    pub fn time<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = work();
        self.spent[phase as usize] += begin.elapsed();
        result
    }

    /// Time spent in a phase.
    pub fn spent(&self, phase: Phase) -> Duration {
        self.spent[phase as usize]
    }

    /// Adds time to a phase.
    pub fn add(&mut self, phase: Phase, time: Duration) {
        self.spent[phase as usize] += time;
    }

    /// Mean and largest time of each phase over ranks. Collective.
    pub fn over_ranks(&self, ranks: &dyn Communicator) -> Vec<PhaseTime> {
        let seconds = self.spent.map(|spent| spent.as_secs_f64());
        let mut largest = seconds;
        ranks.maximum(&mut largest);
        let mut nanoseconds = self.spent.map(|spent| spent.as_nanos() as i64);
        ranks.sum_integers(&mut nanoseconds);
        let mean_of = |index: usize| nanoseconds[index] as f64 * 1.0e-9 / ranks.size() as f64;
        let row = |phase: Phase| {
            let index = phase as usize;
            PhaseTime { phase, mean: mean_of(index), largest: largest[index] }
        };
        Phase::ALL.map(row).to_vec()
    }
}

impl RecentDurations {
    /// Largest number of durations that are kept.
    pub const MOST: usize = 4096;

    /// Adds the duration of one step.
    pub fn note(&mut self, took: Duration) {
        if self.kept.len() < Self::MOST {
            self.kept.push(took)
        } else {
            self.kept[self.count % Self::MOST] = took
        }
        self.count += 1;
    }

    /// All durations, the shortest first; they are removed, but the memory is kept.
    pub fn take_sorted(&mut self) -> Drain<'_, Duration> {
        self.count = 0;
        self.kept.sort_unstable();
        self.kept.drain(..)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_durations_are_forgotten() {
        let mut durations = RecentDurations::default();
        let middle = |mut durations: RecentDurations| {
            let sorted = durations.take_sorted();
            sorted.as_slice().get(sorted.len() / 2).copied()
        };
        assert_eq!(middle(durations.clone()), None);
        let note = |durations: &mut RecentDurations, count: usize, milliseconds: u64| {
            (0..count).for_each(|_| durations.note(Duration::from_millis(milliseconds)));
        };
        note(&mut durations, RecentDurations::MOST, 5);
        note(&mut durations, RecentDurations::MOST / 2 - 1, 9);
        assert_eq!(middle(durations.clone()), Some(Duration::from_millis(5)));
        note(&mut durations, 1, 9);
        assert_eq!(middle(durations.clone()), Some(Duration::from_millis(9)));
        note(&mut durations, RecentDurations::MOST / 2, 1);
        assert_eq!(middle(durations.clone()), Some(Duration::from_millis(9)));
        assert_eq!(durations.clone().take_sorted().len(), RecentDurations::MOST);
        assert_eq!(durations.take_sorted().next(), Some(Duration::from_millis(1)));
        assert_eq!(middle(durations), None);
    }
}
