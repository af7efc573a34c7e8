//! A run from its start to its end: stages, results, checkpoints, and the ways to stop.

mod layout;
mod memory;
mod outputs;
mod start;

pub use layout::{LayoutError, lay_out};
pub use outputs::OutputFolder;
pub use start::{Beginning, Start, StartError, begin_from_case, begin_from_checkpoint};

use crate::analysis::{BedProfile, Digest, MomentumProbe, measure};
use crate::case::Case;
use crate::gas::GasModel;
use crate::grid::ColumnGrid;
use crate::output::OutputError;
use crate::parallel::{Communicator, MadeRecords, ParticleRecord, Records};
use crate::state::{Models, State, Workspace};
use crate::time_step::{self, StepError};
use crate::timers::{Stage as TimedStage, StageTime};
use outputs::Outputs;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Why a run ended early, not as it was asked to. The same on all ranks.
#[derive(Debug, Error)]
pub enum RunError {
    /// A step could not be done.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Particles were lost or doubled: a fault of the program.
    #[error("internal error: {found} particles are in the box or have left, of {expected}")]
    ParticleCount {
        /// How many there are.
        found: u64,
        /// How many there were.
        expected: u64,
    },
}

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whether it came to its end; if not, it was asked to stop.
    pub complete: bool,
    /// Time at the end.
    pub time: f64,
    /// Hash of the state.
    pub digest: Digest,
    /// The checkpoint that holds it.
    pub checkpoint: std::path::PathBuf,
    /// Steps done in this run.
    pub steps: u64,
    /// Particles times steps.
    pub particle_steps: f64,
    /// Wall-clock time of the steps, outputs included.
    pub elapsed: Duration,
    /// How that time divides.
    pub stages: Vec<StageTime>,
    /// Particles that have left through open faces since the beginning.
    pub departed: u64,
}

/// How far a run is, for who watches it.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Simulated time.
    pub time: f64,
    /// Simulated time at the end.
    pub end: f64,
    /// Steps done in this run, and still to do.
    pub steps: (u64, u64),
    /// Number of particles.
    pub particles: usize,
    /// Time since the first step.
    pub elapsed: Duration,
}

/// What a run needs beside its beginning.
pub struct Conditions<'a> {
    /// When it ends.
    pub end_time: f64,
    /// Where results go.
    pub folder: OutputFolder,
    /// Set by a signal: stop with a checkpoint.
    pub stop: &'a AtomicBool,
    /// Called on rank 0 now and then.
    pub watch: &'a mut dyn FnMut(&Progress),
}

/// Steps between looks at the clock on the wall and calls of who watches.
const WATCH_EVERY: u64 = 64;

struct Simulation<'a> {
    case: &'a Case,
    state: State,
    work: Workspace,
    models: Models,
    stage: usize,
    stage_began: (Instant, u64),
    profile: BedProfile,
    outputs: Outputs,
    expected_particles: u64,
    ranks: &'a dyn Communicator,
}

/// Runs a case from its beginning to the end time, or until asked to stop. Collective.
///
/// # Errors
/// If a step or a file fails; the results and checkpoints written before stay.
pub fn run(
    case: &Case,
    beginning: Beginning,
    mut conditions: Conditions,
    ranks: &dyn Communicator,
) -> Result<Outcome, RunError> {
    let began = Instant::now();
    let mut simulation = Simulation::new(case, beginning, &conditions, ranks)?;
    let first_step = simulation.state.clock.step;
    let last_step = simulation.step_at(conditions.end_time);
    let mut stopped = false;
    let mut particle_steps = 0.0;
    let count = ranks.total(simulation.state.particles.owned_count());
    while simulation.state.clock.step < last_step && !stopped {
        simulation.look_around(&mut conditions, began, (first_step, last_step), count);
        stopped = simulation.step()?;
        particle_steps += count as f64;
    }
    let elapsed = began.elapsed();
    let complete = simulation.state.clock.step >= last_step;
    let whole_case = conditions.end_time >= case.end_time();
    let (digest, checkpoint) = simulation.finish(complete && whole_case)?;
    Ok(Outcome {
        complete,
        time: simulation.state.clock.time(),
        digest,
        checkpoint,
        steps: simulation.state.clock.step - first_step,
        particle_steps,
        elapsed,
        stages: simulation.work.timers.over_ranks(ranks),
        departed: simulation.state.departed.count,
    })
}

/// The grid of profiles: that of the first gas, or one of 1.5 diameters.
fn profile_grid(case: &Case, largest_diameter: f64) -> ColumnGrid {
    let bounds = &case.domain.bounds;
    let mut gases = case.stages.iter().map(|stage| &stage.gas);
    match gases.find(|gas| **gas != GasModel::None).unwrap_or(&GasModel::None) {
        GasModel::Column(gas) => gas.grid(bounds),
        GasModel::VolumeAveraged(model) => ColumnGrid::new(bounds, model.grid.spacing().z, 1.0),
        GasModel::None => {
            let nodes = (bounds.lengths().z / (1.5 * largest_diameter)).round().max(2.0);
            ColumnGrid::new(bounds, bounds.lengths().z / nodes, 1.0)
        }
    }
}

impl<'a> Simulation<'a> {
    fn new(
        case: &'a Case,
        beginning: Beginning,
        conditions: &Conditions,
        ranks: &'a dyn Communicator,
    ) -> Result<Self, RunError> {
        let Beginning { mut state, mut work, start } = beginning;
        let stage = stage_of(case, &state);
        let models = case.stages[stage].models(&state.sizes);
        state.clock = state.clock.with_time_step(models.time_step);
        work.prepare(&case.domain, &models, &state.sizes);
        let Start { histories, new_bed, continues } = start;
        time_step::begin(&mut state, &case.domain, &models, &mut work, histories, new_bed, ranks)?;
        memory::give_back();
        let [d_min, d_max] = [state.sizes.smallest_diameter, state.sizes.largest_diameter];
        let grid = profile_grid(case, d_max);
        let profile =
            BedProfile::new(grid, models.limits.speed, [d_min, d_max], case.output.bed_threshold);
        let outputs = Outputs::open(case, &conditions.folder, &state, &profile, continues, ranks)?;
        let here = ranks.total(state.particles.owned_count()) as u64;
        let expected_particles = here + state.departed.count;
        let stage_began = (Instant::now(), state.clock.step);
        let mut simulation = Self {
            case,
            state,
            work,
            models,
            stage,
            stage_began,
            profile,
            outputs,
            expected_particles,
            ranks,
        };
        // The row of the first instant belongs to the run that led to it, where there was one.
        if new_bed {
            simulation.write_due(None)?;
        }
        Ok(simulation)
    }

    /// The step at which a time is reached, the present one at the earliest.
    fn step_at(&self, time: f64) -> u64 {
        let clock = &self.state.clock;
        let steps = ((time - clock.origin_time) / clock.time_step).round().max(0.0) as u64;
        (clock.origin_step + steps).max(clock.step)
    }

    /// Signals, the clock on the wall, and who watches.
    fn look_around(
        &mut self,
        conditions: &mut Conditions,
        began: Instant,
        (first, last): (u64, u64),
        particles: usize,
    ) {
        let requests = &mut self.work.requests;
        requests.stop = conditions.stop.load(Ordering::Relaxed);
        requests.checkpoint = false;
        let step = self.state.clock.step;
        if !self.ranks.is_root() || !step.is_multiple_of(WATCH_EVERY) {
            return;
        }
        let elapsed = began.elapsed();
        requests.stop |= self.case.wall_clock.is_some_and(|limit| elapsed >= limit);
        requests.checkpoint = self.outputs.checkpoint_due_by_wall_clock();
        (conditions.watch)(&Progress {
            time: self.state.clock.time(),
            end: self.state.clock.time_of(last),
            steps: (step - first, last - step),
            particles,
            elapsed,
        });
    }

    /// One step, and what is due after it. Returns whether the run was asked to stop.
    fn step(&mut self) -> Result<bool, RunError> {
        self.enter_stage()?;
        let domain = &self.case.domain;
        let next = self.state.clock.step + 1;
        let row_due = self.outputs.row_due(&self.state.clock, next);
        if row_due {
            time_step::complete(&mut self.state, &mut self.work);
        }
        let probe = row_due.then(|| MomentumProbe::take(&self.state.particles, self.ranks));
        let requests =
            time_step::advance(&mut self.state, domain, &self.models, &mut self.work, self.ranks)?;
        let begin = Instant::now();
        self.write_due(probe)?;
        if requests.checkpoint || self.outputs.checkpoint_due(&self.state.clock) {
            self.write_checkpoint()?;
        }
        self.work.timers.add(TimedStage::Output, begin.elapsed());
        Ok(requests.stop)
    }

    /// Changes the models when the next stage begins.
    fn enter_stage(&mut self) -> Result<(), RunError> {
        let stage = stage_of(self.case, &self.state);
        if stage == self.stage {
            return Ok(());
        }
        self.report_stage();
        self.stage = stage;
        self.models = self.case.stages[stage].models(&self.state.sizes);
        log::info!("stage \"{}\" begins", self.case.stages[stage].name);
        self.work.prepare(&self.case.domain, &self.models, &self.state.sizes);
        let domain = &self.case.domain;
        time_step::rebuild(&mut self.state, domain, &self.models, &mut self.work, self.ranks)?;
        Ok(())
    }

    /// The rate of the stage that ends, and the clock for the next.
    fn report_stage(&mut self) {
        let (began, first) = self.stage_began;
        self.stage_began = (Instant::now(), self.state.clock.step);
        let steps = self.state.clock.step - first;
        let particles = (self.expected_particles - self.state.departed.count) as f64;
        let rate = steps as f64 * particles / began.elapsed().as_secs_f64().max(1.0e-9) * 1.0e-6;
        let name = &self.case.stages[self.stage].name;
        log::info!("stage \"{name}\" ends: {steps} steps, {rate:.2} million particle-steps/s");
    }

    /// Rows, profiles and snapshots that are due at this step.
    fn write_due(&mut self, probe: Option<MomentumProbe>) -> Result<(), RunError> {
        if !self.outputs.anything_due(&self.state.clock) {
            return Ok(());
        }
        time_step::complete(&mut self.state, &mut self.work);
        time_step::confirm(&self.state, &mut self.work, self.ranks)?;
        let Self { case, state, work, models, profile, outputs, ranks, .. } = self;
        let measures = measure(state, &case.domain, models, work, profile, probe, *ranks);
        outputs.write(&state.clock, &measures, profile.bed(), records(case, state), *ranks)?;
        let sample = || work.gas.sample(&state.gas, &state.particles, *ranks);
        outputs.write_gas(&state.clock, sample, *ranks)?;
        let found = measures.particles as u64 + state.departed.count;
        if found != self.expected_particles {
            let expected = self.expected_particles;
            return Err(RunError::ParticleCount { found, expected });
        }
        Ok(())
    }

    fn write_checkpoint(&mut self) -> Result<(Digest, std::path::PathBuf), RunError> {
        time_step::complete(&mut self.state, &mut self.work);
        time_step::confirm(&self.state, &mut self.work, self.ranks)?;
        let Self { case, state, work, outputs, ranks, .. } = self;
        let cells = work.gas.records(&state.gas);
        let written =
            outputs.write_checkpoint(case, state, (records(case, state), cells), *ranks)?;
        memory::give_back();
        Ok(written)
    }

    /// The last checkpoint, and the mark of a case that has come to its end.
    fn finish(&mut self, complete: bool) -> Result<(Digest, std::path::PathBuf), RunError> {
        self.report_stage();
        let (digest, path) = self.write_checkpoint()?;
        if complete {
            self.outputs.mark_complete(&digest, self.ranks)?;
        }
        Ok((digest, path))
    }
}

/// The stage of the step that comes next.
fn stage_of(case: &Case, state: &State) -> usize {
    let middle = state.clock.time() + 0.5 * state.clock.time_step;
    let next = case.stages.partition_point(|stage| stage.start <= middle);
    next.saturating_sub(1)
}

/// This rank's particles as records, with wrapped positions.
fn records(case: &Case, state: &State) -> impl Records<ParticleRecord> {
    let (bounds, particles) = (&case.domain.bounds, &state.particles);
    MadeRecords(particles.owned_count(), |index: usize| ParticleRecord {
        position: bounds.wrap(particles.body[index].position).into(),
        ..ParticleRecord::of(particles, index)
    })
}
