//! The files of results of a run, and the times at which they are written.

use super::interval::Interval;
use crate::case::OutputPlan;
use std::path::Path;
use talcum_engine::parallel::Communicator;
use talcum_engine::state::Clock;
use talcum_results::output::{
    EnergyTable, GasSnapshots, Opening, Output, OutputError, OutputKind, ParticleSnapshots,
    Profiles, Sample, Series, WallForceTable,
};

/// A kind of output in the list of all.
pub(super) struct Listed {
    pub(super) kind: OutputKind,
    /// Its interval in the case; `None` if it is not requested.
    interval: fn(&OutputPlan) -> Option<f64>,
}

/// All kinds of output: one line each, in the order in which they are written.
pub(super) const LISTED: [Listed; 6] = [
    Listed { kind: Series::KIND, interval: |plan| Some(plan.series) },
    Listed { kind: WallForceTable::KIND, interval: |plan| plan.walls },
    Listed { kind: EnergyTable::KIND, interval: |plan| plan.energy },
    Listed { kind: Profiles::KIND, interval: |plan| plan.profiles },
    Listed { kind: ParticleSnapshots::KIND, interval: |plan| plan.particles },
    Listed { kind: GasSnapshots::KIND, interval: |plan| plan.gas },
];

/// An open file of results.
struct ScheduledOutput {
    file_name: &'static str,
    interval: Interval,
    needs_momentum_before: bool,
    output: Box<dyn Output>,
}

/// The open files of a run.
pub(super) struct Outputs(Vec<ScheduledOutput>);

impl Outputs {
    /// Begins or continues the files that a case requests. Collective.
    pub(super) fn open(
        folder: &Path,
        plan: &OutputPlan,
        opening: &Opening<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let mut outputs = Vec::new();
        for Listed { kind, interval } in &LISTED {
            let interval = Interval(interval(plan));
            if interval.0.is_none() {
                continue;
            }
            let needs_momentum_before = kind.needs_momentum_before;
            let opened = (kind.open)(&folder.join(kind.file_name), opening, ranks)?;
            let file_name = kind.file_name;
            outputs.extend(opened.map(|output| ScheduledOutput {
                file_name,
                interval,
                needs_momentum_before,
                output,
            }));
        }
        Ok(Self(outputs))
    }

    /// Whether something is due after a step.
    pub(super) fn due(&self, clock: &Clock, step: u64) -> bool {
        self.0.iter().any(|file| file.interval.due(clock, step))
    }

    /// Whether a result is due after a step that compares the momentum before and after it.
    pub(super) fn needs_momentum_before(&self, clock: &Clock, step: u64) -> bool {
        self.0.iter().any(|file| file.needs_momentum_before && file.interval.due(clock, step))
    }

    /// Whether snapshots of the particles are due now.
    pub(super) fn shows_particles(&self, clock: &Clock) -> bool {
        let due = |file: &ScheduledOutput| file.interval.due(clock, clock.step);
        self.0.iter().any(|file| file.file_name == ParticleSnapshots::KIND.file_name && due(file))
    }

    /// Writes what is due now. Collective.
    pub(super) fn write(
        &mut self,
        clock: &Clock,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let due = self.0.iter_mut().filter(|file| file.interval.due(clock, clock.step));
        due.into_iter().try_for_each(|file| file.output.write(sample, ranks))
    }

    /// Secures the data written so far: a run that is killed resumes from the next checkpoint with all of them.
    /// Collective.
    pub(super) fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.iter().try_for_each(|file| file.output.commit(ranks))
    }
}
