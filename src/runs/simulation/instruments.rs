//! The instruments of a run: their times, files, and data in checkpoints.

use super::interval::Interval;
use crate::case::Case;
use std::path::Path;
use talcum_engine::grid::ColumnGrid;
use talcum_engine::parallel::Communicator;
use talcum_engine::state::{Clock, SizeRange};
use talcum_results::instruments::{
    Instrument, InstrumentPlan, InstrumentState, Needs, Setting, View,
};
use talcum_results::output::{Head, InstrumentOutput, OutputError};

/// An instrument with its files.
struct Scheduled {
    plan: InstrumentPlan,
    instrument: Box<dyn Instrument>,
    output: InstrumentOutput,
}

impl Scheduled {
    fn is_due(&self, clock: &Clock, step: u64) -> bool {
        let has_begun = clock.time_of(step) > self.plan.start - 0.5 * clock.time_step;
        has_begun && Interval(Some(self.plan.every)).due(clock, step)
    }
}

/// Data with which instruments start.
pub(super) struct Beginning<'a> {
    /// The folder of results.
    pub(super) folder: &'a Path,
    /// The head of new files.
    pub(super) head: Head<'a>,
    /// The time up to which earlier files are continued.
    pub(super) continue_after: Option<f64>,
    /// Data that instruments stored in the checkpoint from which the run continues.
    pub(super) kept: &'a [InstrumentState],
}

/// All instruments of a run.
pub(super) struct Instruments(Vec<Scheduled>);

impl Instruments {
    /// Begins the instruments of a case, or continues them. Collective.
    pub(super) fn open(
        case: &Case,
        beginning: &Beginning<'_>,
        sizes: &SizeRange,
        column: &ColumnGrid,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let (bounds, gas_grid) = (&case.domain.bounds, case.volume_averaged().map(|it| &it.grid));
        let open = |plan: &InstrumentPlan| {
            let InstrumentPlan { every, start, .. } = *plan;
            let setting = Setting { bounds, sizes, column, gas_grid, every, start };
            let instrument = begin(plan, beginning.kept, &setting, ranks);
            let Beginning { folder, head, continue_after, .. } = *beginning;
            let layout = instrument.layout();
            let output =
                InstrumentOutput::open(folder, plan, &layout, head, continue_after, ranks)?;
            Ok(Scheduled { plan: plan.clone(), instrument, output })
        };
        case.instruments.iter().map(open).collect::<Result<_, _>>().map(Self)
    }

    /// Whether an instrument takes a sample after this step.
    pub(super) fn due(&self, clock: &Clock) -> bool {
        self.0.iter().any(|scheduled| scheduled.is_due(clock, clock.step))
    }

    /// The data needed by the instruments that take a sample now.
    pub(super) fn needs(&self, clock: &Clock) -> Needs {
        let due = self.0.iter().filter(|scheduled| scheduled.is_due(clock, clock.step));
        due.fold(Needs::default(), |needs, scheduled| needs.or(scheduled.instrument.needs()))
    }

    /// Takes a sample for each instrument that is due. Collective.
    pub(super) fn look(
        &mut self,
        clock: &Clock,
        view: &View<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        for scheduled in &mut self.0 {
            if scheduled.is_due(clock, clock.step) {
                let readings = scheduled.instrument.look(view, ranks);
                scheduled.output.write(clock.time(), readings, ranks)?;
            }
        }
        Ok(())
    }

    /// The agglomerates of particles by their ids, from the instrument with a name. Collective.
    pub(super) fn agglomerates(
        &self,
        name: &str,
        ids: &[u64],
        ranks: &dyn Communicator,
    ) -> Option<Vec<Option<u64>>> {
        let scheduled = self.0.iter().find(|scheduled| scheduled.plan.name == name)?;
        scheduled.instrument.agglomerates(ids, ranks)
    }

    /// Secures the data written so far. Collective.
    pub(super) fn commit(&mut self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.iter_mut().try_for_each(|scheduled| scheduled.output.commit(ranks))
    }

    /// The data that all of them store. Collective.
    pub(super) fn kept(&self, ranks: &dyn Communicator) -> Vec<InstrumentState> {
        let kept = |Scheduled { plan, instrument, .. }: &Scheduled| InstrumentState {
            name: plan.name.clone(),
            settings: plan.settings(),
            stored: instrument.stored(ranks),
        };
        self.0.iter().map(kept).collect()
    }
}

/// An instrument that continues from its stored data, if there are such data with the same settings.
fn begin(
    plan: &InstrumentPlan,
    kept: &[InstrumentState],
    setting: &Setting<'_>,
    ranks: &dyn Communicator,
) -> Box<dyn Instrument> {
    let mut instrument = plan.kind.begin(setting);
    let Some(state) = kept.iter().find(|state| state.name == plan.name) else { return instrument };
    let is_same = state.settings == plan.settings();
    if is_same && instrument.restore(&state.stored, ranks).is_some() {
        return instrument;
    }
    if ranks.is_root() {
        let name = &plan.name;
        log::warn!("instrument {name} had other settings in the checkpoint: it starts again");
    }
    plan.kind.begin(setting)
}
