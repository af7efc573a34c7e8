//! A run under way: one step after another, with the output that is due after each.

use super::RunError;
use super::checkpoints::{Checkpoints, WrittenCheckpoint};
use super::folder::{OutputFolder, make_folder, mark_complete};
use super::instruments::{Beginning, Instruments};
use super::outputs::Outputs;
use super::particle_columns::{self, snapshot_format};
use super::stage_rate::StageRate;
use super::start::{InitialState, Origin};
use crate::case::Case;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use talcum_engine::gas::GasModel;
use talcum_engine::grid::ColumnGrid;
use talcum_engine::parallel::{
    AllocatorOfRanks, Communicator, ComputedRecords, ParticleRecord, Records,
};
use talcum_engine::particles::ContactHistories;
use talcum_engine::state::{EnergyRow, Mechanism, Models, SizeRange, State, StoredSums, Workspace};
use talcum_engine::time_step::{self, Staggered, StepError, stored_energy};
use talcum_engine::timers::{Phase, PhaseTime};
use talcum_results::analysis::{BedProfile, MomentumProbe, RunView, series_row, wall_forces};
use talcum_results::instruments::View;
use talcum_results::output::checkpoint::{self, Checkpoint, StoredLedger};
use talcum_results::output::{Head, Opening, OutputError, Provenance, Sample};

/// Number of steps between checks of the wall-clock time, and between reports of the progress.
pub(super) const WATCH_EVERY: u64 = 64;

/// A run between two steps.
pub(super) struct Simulation<'a> {
    case: &'a Case,
    state: Staggered<'a>,
    work: &'a mut Workspace,
    models: Models,
    stage: usize,
    stage_rate: StageRate,
    profile: BedProfile,
    folder: OutputFolder,
    provenance: Provenance,
    outputs: Outputs,
    instruments: Instruments,
    checkpoints: Checkpoints,
    expected_particles: u64,
    ranks: &'a dyn Communicator,
}

impl<'a> Simulation<'a> {
    /// Makes the lists and, for a new bed, computes the forces of the initial state; opens the files of results.
    /// Collective.
    pub(super) fn new(
        case: &'a Case,
        initial: &'a mut InitialState,
        folder: OutputFolder,
        ranks: &'a dyn Communicator,
    ) -> Result<Self, RunError> {
        let (stage, models) = begin(case, initial, ranks)?;
        let InitialState { state, work, instruments: kept, origin, .. } = initial;
        let (is_new, origin) = (*origin == Origin::NewBed, *origin);
        let profile = profile_of(case, &models, &state.sizes);
        let provenance = Provenance::here_and_now(&case.title, case.units.name(), ranks);
        let head = Head { case_text: &case.text, provenance: &provenance };
        let continue_after = (origin == Origin::ContinuedRun).then(|| state.clock.time());
        let gas_grid = case.volume_averaged().map(|model| &model.grid);
        let snapshots = &snapshot_format(case);
        let profile_grid = profile.grid();
        let opening = Opening { head, continue_after, profile_grid, snapshots, gas_grid };
        let outputs = open_outputs(&folder, case, &opening, state.clock.step, ranks)?;
        let beginning = Beginning { folder: &folder.path, head, continue_after, kept };
        let instruments = Instruments::open(case, &beginning, &state.sizes, profile.grid(), ranks)?;
        kept.clear();
        let here = ranks.total(state.particles.owned_count()) as u64;
        let mut simulation = Self {
            case,
            stage,
            stage_rate: StageRate::begin(state.clock.step, &models.physics.gas),
            expected_particles: here + state.departed.count,
            state: Staggered::new(state),
            work,
            models,
            profile,
            folder,
            provenance,
            outputs,
            instruments,
            checkpoints: Checkpoints::new(&case.checkpoint),
            ranks,
        };
        // The row of the first instant belongs to the run that led to it, if there was one.
        if is_new {
            simulation.sample_due()?;
            simulation.write_due(None)?;
        }
        Ok(simulation)
    }

    /// Steps since the start of the case.
    pub(super) fn steps_done(&self) -> u64 {
        self.state.clock().step
    }

    /// Simulated time.
    pub(super) fn time(&self) -> f64 {
        self.state.clock().time()
    }

    /// Simulated time of a step.
    pub(super) fn time_of(&self, step: u64) -> f64 {
        self.state.clock().time_of(step)
    }

    /// The step at which a time is reached; at the earliest the present one.
    pub(super) fn step_at(&self, time: f64) -> u64 {
        let clock = self.state.clock();
        let steps = ((time - clock.origin_time) / clock.time_step).round().max(0.0) as u64;
        clock.origin_step.saturating_add(steps).max(clock.step)
    }

    /// Particles in the box. Collective.
    pub(super) fn particle_count(&self) -> usize {
        self.ranks.total(self.state.owned_count())
    }

    /// Particles that have left since the start of the case.
    pub(super) fn departed_count(&self) -> u64 {
        self.state.departed().count
    }

    /// Division of the time of the run into phases. Collective.
    pub(super) fn times_over_ranks(&self) -> Vec<PhaseTime> {
        self.work.timers.over_ranks(self.ranks)
    }

    /// Records whether this rank is asked to stop or to write a checkpoint, by a signal or by the wall-clock time since
    /// `began`.
    pub(super) fn poll_requests(&mut self, stop: &AtomicBool, began: Instant) {
        let requests = &mut self.work.requests;
        requests.stop = stop.load(Ordering::Relaxed);
        requests.checkpoint = false;
        if self.ranks.is_root() && self.state.clock().step.is_multiple_of(WATCH_EVERY) {
            requests.stop |= self.case.wall_clock.is_some_and(|limit| began.elapsed() >= limit);
            requests.checkpoint = self.checkpoints.due_by_wall_clock();
        }
    }

    /// Advances the run by one step and writes the output that is due after it. Returns whether the run was asked to
    /// stop. Collective.
    pub(super) fn step(&mut self) -> Result<bool, RunError> {
        self.enter_stage()?;
        let domain = &self.case.domain;
        let next = self.state.clock().step + 1;
        let needs_momentum = self.outputs.needs_momentum_before(self.state.clock(), next);
        let probe = needs_momentum.then(|| {
            let state = self.state.synchronised(&mut self.work.timers);
            MomentumProbe::take(&state.particles, self.ranks)
        });
        let requests =
            time_step::advance(&mut self.state, domain, &self.models, self.work, self.ranks)?;
        let instruments_start = Instant::now();
        if self.models.physics.gas.is_due(self.steps_done()) {
            self.stage_rate.note(instruments_start);
        }
        self.sample_due()?;
        self.work.timers.add(Phase::Instruments, instruments_start.elapsed());
        let output_start = Instant::now();
        self.write_due(probe)?;
        if requests.checkpoint || self.checkpoints.due(self.state.clock(), &self.work.gas) {
            self.write_checkpoint()?;
        }
        self.work.timers.add(Phase::Output, output_start.elapsed());
        Ok(requests.stop)
    }

    /// Changes the models when the next stage begins.
    fn enter_stage(&mut self) -> Result<(), RunError> {
        let stage = self.case.stage_number_at(self.state.clock().time());
        if stage == self.stage {
            return Ok(());
        }
        if self.case.checkpoint.stage_ends {
            let written = self.write_checkpoint()?;
            self.keep_stage_end(&written)?;
        }
        self.report_stage();
        self.stage = stage;
        let stored = self.stored_for_ledger();
        self.models = self.case.stages[stage].models(self.state.sizes());
        self.stage_rate = StageRate::begin(self.steps_done(), &self.models.physics.gas);
        log::info!("stage \"{}\" begins", self.case.stages[stage].name);
        self.work.prepare(&self.case.domain, &self.models, self.state.sizes());
        let domain = &self.case.domain;
        let state = self.state.synchronised(&mut self.work.timers);
        time_step::rebuild(state, domain, &self.models, self.work, self.ranks)?;
        if let Some((before, after)) = stored.zip(self.stored_for_ledger()) {
            let state = self.state.synchronised(&mut self.work.timers);
            let ledger = state.energy.iter_mut();
            ledger.for_each(|ledger| ledger.add_change(Mechanism::Models, &before, &after));
        }
        Ok(())
    }

    /// Keeps a checkpoint at the end of the present stage under the name of the stage. Collective.
    fn keep_stage_end(&self, written: &WrittenCheckpoint) -> Result<(), RunError> {
        let name = &self.case.stages[self.stage].name;
        let name = checkpoint::stage_file_name(self.stage + 1, name);
        Ok(checkpoint::keep_as(&written.path, &name, self.ranks)?)
    }

    /// Whether the time of the present stage is over.
    fn stage_is_over(&self) -> bool {
        let clock = self.state.clock();
        clock.step >= self.step_at(self.case.stages[self.stage].end)
    }

    /// Energy stored by this rank's particles under the present models, if an energy ledger is kept.
    fn stored_for_ledger(&mut self) -> Option<StoredSums> {
        let state = self.state.synchronised(&mut self.work.timers);
        let is_kept = state.energy.is_some();
        is_kept.then(|| stored_energy(state, &self.case.domain, &self.models, self.work))
    }

    /// Logs the rate of the stage that ends.
    fn report_stage(&mut self) {
        let particles = (self.expected_particles - self.state.departed().count) as f64;
        let steps_done = self.steps_done();
        let report = self.stage_rate.report(steps_done, particles);
        log::info!("stage \"{}\" ends: {report}", self.case.stages[self.stage].name);
    }

    /// Writes the rows, profiles and snapshots that are due at this step. Collective.
    fn write_due(&mut self, probe: Option<MomentumProbe>) -> Result<(), RunError> {
        if !self.outputs.due(self.state.clock(), self.steps_done()) {
            return Ok(());
        }
        let Self { case, state, work, models, profile, outputs, instruments, ranks, .. } = self;
        let state = confirmed(state, work, *ranks)?;
        let view = RunView { state, domain: &case.domain, models, work };
        let row = series_row(view, profile, probe, *ranks);
        let energy = state.energy.as_ref().map(|ledger| {
            let stored = stored_energy(state, &case.domain, models, work).total(*ranks);
            EnergyRow { stored, balance: ledger.balance(&stored, *ranks) }
        });
        let is_asked_for = case.output.walls.is_some();
        let wall_forces = if is_asked_for { wall_forces(view, *ranks) } else { Vec::new() };
        let columns = if outputs.shows_particles(&state.clock) {
            particle_columns::values(case, view, instruments, *ranks)
        } else {
            Vec::new()
        };
        let mut gas_cells = || work.gas.sample(&state.gas, &state.particles, *ranks);
        let mut sample = Sample {
            row: &row,
            profile,
            particles: &records(case, state),
            wall_forces: &wall_forces,
            energy: energy.as_ref(),
            columns: &columns,
            gas_cells: &mut gas_cells,
        };
        outputs.write(&state.clock, &mut sample, *ranks)?;
        let found = row.particles as u64 + state.departed.count;
        if found != self.expected_particles {
            let expected = self.expected_particles;
            return Err(RunError::ParticleCount { found, expected });
        }
        Ok(())
    }

    /// Takes a sample for each instrument that is due at this step. Collective.
    fn sample_due(&mut self) -> Result<(), RunError> {
        let clock = *self.state.clock();
        if !self.instruments.due(&clock) {
            return Ok(());
        }
        let needs = self.instruments.needs(&clock);
        let Self { case, state, work, models, profile, instruments, ranks, .. } = self;
        let state = state.synchronised(&mut work.timers);
        time_step::confirm(state, work, *ranks)?;
        if needs.contact_forces {
            // Their velocities are those of the half step before; the next step sets them again in any case.
            time_step::refresh_ghosts(state, work, *ranks);
        }
        let gas_cells = if needs.gas_cells {
            work.gas.sample(&state.gas, &state.particles, *ranks)
        } else {
            None
        };
        let run = RunView { state, domain: &case.domain, models, work };
        let series = needs.series.then(|| series_row(run, profile, None, *ranks));
        let view = View::new(run, profile, series.as_ref(), gas_cells.as_deref());
        Ok(instruments.look(&clock, &view, *ranks)?)
    }

    /// Commits the results and then writes a checkpoint, so that a run that is killed resumes from it with all results.
    /// Collective.
    fn write_checkpoint(&mut self) -> Result<WrittenCheckpoint, RunError> {
        let Self { case, state, work, folder, provenance, checkpoints, ranks, .. } = self;
        let state = confirmed(state, work, *ranks)?;
        self.outputs.commit(*ranks)?;
        self.instruments.commit(*ranks)?;
        let instruments = self.instruments.kept(*ranks);
        let ContactHistories { pairs, walls, .. } = state.contacts.histories(&state.particles);
        let checkpoint = Checkpoint {
            clock: state.clock,
            departed: state.departed,
            sizes: state.sizes,
            case_text: case.text.clone(),
            case_folder: folder.case_folder.display().to_string(),
            particles: records(case, state),
            custom: state.particles.custom_fields(),
            contacts: pairs,
            wall_contacts: walls,
            cells: work.gas.records(&state.gas, *ranks),
            gas_report: state.gas.report(),
            looked_at: state.looked_at.clone(),
            energy: state.energy.as_deref().map(StoredLedger::of),
            instruments,
        };
        let written = checkpoints.write(&folder.path, &checkpoint, provenance, *ranks)?;
        drop(checkpoint);
        AllocatorOfRanks::return_freed();
        Ok(written)
    }

    /// Writes the last checkpoint, and the mark of a case that has come to its end. Collective.
    pub(super) fn finish(&mut self, complete: bool) -> Result<WrittenCheckpoint, RunError> {
        self.report_stage();
        let written = self.write_checkpoint()?;
        if self.case.checkpoint.stage_ends && self.stage_is_over() {
            self.keep_stage_end(&written)?;
        }
        if complete {
            mark_complete(&self.folder.path, &written.digest, self.ranks)?;
        }
        Ok(written)
    }
}

/// Opens or drops the energy ledger according to the case; returns whether it is a new one.
fn prepare_ledger(case: &Case, state: &mut State) -> bool {
    let is_kept = case.output.energy.is_some();
    let earlier = state.energy.take().filter(|_| is_kept);
    let is_new = is_kept && earlier.is_none();
    state.energy = if is_new { Some(Box::default()) } else { earlier };
    is_new
}

/// Makes the lists and, for a new bed, computes the forces of the initial state; returns the number of its stage, and
/// the models. Collective.
fn begin(
    case: &Case,
    initial: &mut InitialState,
    ranks: &dyn Communicator,
) -> Result<(usize, Models), StepError> {
    let InitialState { state, work, histories, origin, .. } = initial;
    let stage = case.stage_number_at(state.clock.time());
    let models = case.stages[stage].models(&state.sizes);
    state.clock = state.clock.with_time_step(models.physics.time_step);
    work.prepare(&case.domain, &models, &state.sizes);
    work.on_walls
        .set_classes(case.particles.classes().iter().map(|class| class.diameter).collect());
    let opens_ledger = prepare_ledger(case, state);
    time_step::begin(state, &case.domain, &models, work, std::mem::take(histories), ranks)?;
    if *origin == Origin::NewBed {
        time_step::find_first_forces(state, &case.domain, &models, work, ranks);
    }
    if opens_ledger {
        let start = stored_energy(state, &case.domain, &models, work).total(ranks);
        state.energy.iter_mut().for_each(|ledger| ledger.open_at(start));
    }
    AllocatorOfRanks::return_freed();
    Ok((stage, models))
}

/// Makes the folder of results and opens the files in it, at a step. Collective.
fn open_outputs(
    folder: &OutputFolder,
    case: &Case,
    opening: &Opening<'_>,
    step: u64,
    ranks: &dyn Communicator,
) -> Result<Outputs, OutputError> {
    make_folder(&folder.path, case, ranks)?;
    if opening.continue_after.is_some() {
        checkpoint::supersede(&folder.path, step, ranks)?;
    }
    Outputs::open(&folder.path, &case.output, opening, ranks)
}

/// The state in a form that can be written: velocities at the time of the clock, and meaningful forces. Collective.
fn confirmed<'s>(
    state: &'s mut Staggered,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<&'s State, StepError> {
    let state = state.synchronised(&mut work.timers);
    time_step::confirm(state, work, ranks)?;
    Ok(state)
}

/// This rank's particles as records, with wrapped positions.
fn records(case: &Case, state: &State) -> impl Records<ParticleRecord> {
    let (bounds, particles) = (&case.domain.bounds, &state.particles);
    ComputedRecords(particles.owned_count(), |index: usize| ParticleRecord {
        position: bounds.wrap(particles.body[index].position).into(),
        ..ParticleRecord::of(particles, index)
    })
}

/// The profile of the bed, on the grid of the first gas or on one with a spacing of 1.5 diameters.
fn profile_of(case: &Case, models: &Models, sizes: &SizeRange) -> BedProfile {
    let bounds = &case.domain.bounds;
    let mut gases = case.stages.iter().map(|stage| &stage.physics.gas);
    let grid = match gases.find(|gas| **gas != GasModel::None).unwrap_or(&GasModel::None) {
        GasModel::Column(gas) => gas.grid(bounds),
        GasModel::VolumeAveraged(model) => ColumnGrid::new(bounds, model.grid.spacing().z, 1.0),
        GasModel::None => {
            let nodes = (bounds.lengths().z / (1.5 * sizes.largest_diameter)).round().max(2.0);
            ColumnGrid::new(bounds, bounds.lengths().z / nodes, 1.0)
        }
    };
    let diameters = [sizes.smallest_diameter, sizes.largest_diameter];
    let grid = grid.within(case.domain.cross_section());
    BedProfile::new(grid, models.limits.speed, diameters, case.output.bed_threshold)
}
