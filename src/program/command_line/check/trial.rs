//! Estimate of the duration of a run from its first steps and from steps of a dense bed.

use std::time::{Duration, Instant};
use talcum_engine::domain::{Face, RankGrid};
use talcum_engine::parallel::Communicator;
use talcum_engine::state::{Clock, State};
use talcum_engine::time_step::{self, Staggered, StepError};
use talcum_runs::case::{Amount, BedStart, Case, Stage};
use talcum_runs::simulation::{InitialState, start_from_case};

/// Duration of the trial of the first steps.
const FIRST_STEPS: Duration = Duration::from_millis(200);
/// Duration of the trials of all stages together in a dense bed.
const DENSE_BED: Duration = Duration::from_millis(200);

/// Results of the trials of a case.
pub(super) struct Trials {
    /// Estimated duration of the run in seconds.
    pub(super) seconds: f64,
    /// Whether a dense bed was tried: a poured bed costs more than the loose one at its start.
    pub(super) dense: bool,
    /// Stages whose first steps in a dense bed end with an error.
    pub(super) stopped: Vec<(String, StepError)>,
}

/// Tries the first steps of a case, and steps of each stage in a dense bed if the case pours one. Collective.
///
/// # Errors
/// If the first steps fail, as those of the run would.
pub(super) fn try_steps(
    case: &Case,
    mut initial: InitialState,
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> anyhow::Result<Trials> {
    let dense_bed = dense_bed(case, &initial, ranks);
    let first = pace(case, &case.stages[0], &mut initial, FIRST_STEPS, ranks)?;
    drop(initial);
    let mut trials = Trials { seconds: 0.0, dense: dense_bed.is_some(), stopped: Vec::new() };
    let share = DENSE_BED / case.stages.len().max(1) as u32;
    for stage in &case.stages {
        let steps = (stage.end - stage.start) / stage.physics.time_step;
        let mut per_step = first;
        if let Some(mut initial) =
            dense_bed.as_ref().and_then(|bed| start_from_case(bed, grid, ranks).ok())
        {
            initial.state.clock =
                Clock { origin_time: stage.start, ..Clock::new(stage.physics.time_step) };
            match pace(case, stage, &mut initial, share, ranks) {
                Ok(seconds) => per_step = seconds,
                Err(error) => trials.stopped.push((stage.name.clone(), error)),
            }
        }
        trials.seconds += steps * per_step;
    }
    Ok(trials)
}

/// The case with its particles in a simple cubic packing on the floor, in which each has nearly as many neighbours as
/// in a poured bed; `None` if the case does not pour a bed. Collective.
fn dense_bed(case: &Case, initial: &InitialState, ranks: &dyn Communicator) -> Option<Case> {
    let is_poured =
        matches!(case.particles.start, BedStart::Lattice { .. } | BedStart::Random { .. })
            && case.stages[0].physics.gravity.magnitude > 0.0
            && case.domain.bounds.faces(2)[0] != Face::Periodic;
    let count = ranks.total(initial.state.particles.owned_count()) as u64;
    is_poured.then(|| {
        let mut bed = case.clone();
        let spacing = initial.state.sizes.largest_diameter;
        bed.particles.start = BedStart::Lattice { spacing, jitter: 0.0, bottom: 0.0 };
        bed.particles.amount = Some(Amount::Count(count));
        bed.particles.granular_temperature = 0.0;
        bed
    })
}

/// Seconds per step of a stage. Collective.
fn pace(
    case: &Case,
    stage: &Stage,
    initial: &mut InitialState,
    how_long: Duration,
    ranks: &dyn Communicator,
) -> Result<f64, StepError> {
    let InitialState { state, work, histories, .. } = initial;
    let State { sizes, .. } = *state;
    let models = stage.models(&sizes);
    work.prepare(&case.domain, &models, &sizes);
    let histories = std::mem::take(histories);
    time_step::begin(state, &case.domain, &models, work, histories, ranks)?;
    time_step::find_first_forces(state, &case.domain, &models, work, ranks);
    let mut state = Staggered::new(state);
    let start = Instant::now();
    let mut steps = 0;
    // The timing of rank 0 decides for all: a collective check every few steps.
    while !ranks.any(ranks.is_root() && start.elapsed() > how_long) {
        for _ in 0..10 {
            time_step::advance(&mut state, &case.domain, &models, work, ranks)?;
        }
        steps += 10;
    }
    Ok(start.elapsed().as_secs_f64() / f64::from(steps.max(1)))
}
