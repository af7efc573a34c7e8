//! A run from its start to its end: stages, results, checkpoints, and its end.

mod cheapest_grid;
mod checkpoints;
mod folder;
mod instruments;
mod interval;
mod layout;
mod outputs;
mod particle_columns;
mod running;
mod stage_rate;
mod start;

pub use folder::{FolderLock, OutputFolder};
pub use start::{InitialState, Origin, StartError, start_from_case, start_from_checkpoint};

use crate::case::Case;
use running::{Simulation, WATCH_EVERY};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use talcum_engine::parallel::Communicator;
use talcum_engine::time_step::StepError;
use talcum_engine::timers::PhaseTime;
use talcum_results::analysis::Digest;
use talcum_results::output::OutputError;
use thiserror::Error;

/// Reason why a run ended prematurely, other than by request; it is equal on all ranks.
#[derive(Debug, Error)]
pub enum RunError {
    /// A step could not be done.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Particles were lost or doubled: an error of the program.
    #[error("internal error: {found} particles are in the box or have left, of {expected}")]
    ParticleCount {
        /// Number of particles found.
        found: u64,
        /// Number of particles expected.
        expected: u64,
    },
}

/// Outcome of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whether the run came to its end; if not, it was asked to stop.
    pub complete: bool,
    /// Time at the end.
    pub time: f64,
    /// Hash of the state.
    pub digest: Digest,
    /// The checkpoint that contains the state.
    pub checkpoint: std::path::PathBuf,
    /// Steps done in this run.
    pub steps: u64,
    /// Particles times steps.
    pub particle_steps: f64,
    /// Wall-clock time of the steps, outputs included.
    pub elapsed: Duration,
    /// Division of this time into phases.
    pub phases: Vec<PhaseTime>,
    /// Particles that have left through open faces since the start of the case.
    pub departed: u64,
}

/// Progress of a run, for display.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Simulated time.
    pub time: f64,
    /// Simulated time at the end.
    pub end: f64,
    /// Number of steps done in this run, and of those still to do.
    pub steps: (u64, u64),
    /// Number of particles.
    pub particles: usize,
    /// Time since the first step.
    pub elapsed: Duration,
}

/// Options of a run besides its case and its initial state.
pub struct RunOptions<'a> {
    /// Time at which it ends.
    pub end_time: f64,
    /// Folder of results.
    pub folder: OutputFolder,
    /// Set by a signal: stop with a checkpoint.
    pub stop: &'a AtomicBool,
    /// Called on rank 0 from time to time.
    pub watch: &'a mut dyn FnMut(&Progress),
}

/// Runs a case from an initial state to the end time, or until asked to stop. Collective.
///
/// # Errors
/// If a step or a file fails; the results and checkpoints written before are kept.
pub fn run(
    case: &Case,
    mut initial: InitialState,
    options: RunOptions,
    ranks: &dyn Communicator,
) -> Result<Outcome, RunError> {
    let RunOptions { end_time, folder, stop, watch } = options;
    let began = Instant::now();
    let mut simulation = Simulation::new(case, &mut initial, folder, ranks)?;
    let (first, last) = (simulation.steps_done(), simulation.step_at(end_time));
    let particles = simulation.particle_count();
    let mut particle_steps = 0.0;
    let mut stopped = false;
    while simulation.steps_done() < last && !stopped {
        if simulation.steps_done().is_multiple_of(WATCH_EVERY) && ranks.is_root() {
            let steps = (simulation.steps_done() - first, last - simulation.steps_done());
            let (time, end) = (simulation.time(), simulation.time_of(last));
            watch(&Progress { time, end, steps, particles, elapsed: began.elapsed() });
        }
        simulation.poll_requests(stop, began);
        stopped = simulation.step()?;
        particle_steps += particles as f64;
    }
    let elapsed = began.elapsed();
    let complete = simulation.steps_done() >= last;
    let written = simulation.finish(complete)?;
    Ok(Outcome {
        complete,
        time: simulation.time(),
        digest: written.digest,
        checkpoint: written.path,
        steps: simulation.steps_done() - first,
        particle_steps,
        elapsed,
        phases: simulation.times_over_ranks(),
        departed: simulation.departed_count(),
    })
}
