//! Times at which checkpoints are due, and the number that is kept.

use super::interval::Interval;
use crate::case::CheckpointPlan;
use std::path::{Path, PathBuf};
use std::time::Instant;
use talcum_engine::gas::GasSolver;
use talcum_engine::parallel::{Communicator, ParticleRecord, Records};
use talcum_engine::state::Clock;
use talcum_results::analysis::Digest;
use talcum_results::output::checkpoint::{self, Checkpoint};
use talcum_results::output::{OutputError, Provenance};

/// A written checkpoint.
#[derive(Clone, Debug)]
pub(super) struct WrittenCheckpoint {
    pub(super) path: PathBuf,
    /// Digest of the state in it.
    pub(super) digest: Digest,
}

/// The checkpoints of a run.
pub(super) struct Checkpoints {
    plan: CheckpointPlan,
    last: Instant,
    /// Whether the gas is about to fail, and an earlier checkpoint has been written.
    failure_is_near: bool,
}

impl Checkpoints {
    /// Checkpoints as planned by the case; the wall-clock time since the last one counts from now.
    pub(super) fn new(plan: &CheckpointPlan) -> Self {
        Self { plan: plan.clone(), last: Instant::now(), failure_is_near: false }
    }

    /// Whether one is due now: by simulated time or steps, or because the next step of the gas will be too long, which
    /// would leave a meaningless state.
    pub(super) fn due(&mut self, clock: &Clock, gas: &GasSolver) -> bool {
        let was_near = std::mem::replace(&mut self.failure_is_near, gas.next_is_too_long());
        (self.failure_is_near && !was_near)
            || Interval(self.plan.every).due(clock, clock.step)
            || self.plan.every_steps.is_some_and(|steps| clock.step.is_multiple_of(steps))
    }

    /// Whether one is due by wall-clock time, on this rank.
    pub(super) fn due_by_wall_clock(&self) -> bool {
        self.plan.every_wall_clock.is_some_and(|every| self.last.elapsed() >= every)
    }

    /// Writes one into a folder and removes the oldest ones beyond the number kept. Collective.
    pub(super) fn write(
        &mut self,
        folder: &Path,
        checkpoint: &Checkpoint<impl Records<ParticleRecord>>,
        provenance: &Provenance,
        ranks: &dyn Communicator,
    ) -> Result<WrittenCheckpoint, OutputError> {
        let path = folder.join(checkpoint::file_name(checkpoint.clock.step));
        let digest = checkpoint::write(&path, checkpoint, provenance, ranks)?;
        checkpoint::prune(folder, self.plan.keep, ranks)?;
        self.last = Instant::now();
        Ok(WrittenCheckpoint { path, digest })
    }
}
