//! The output folder of a run: what is written into it, and when.

use crate::analysis::{BedProfile, Digest, Measures};
use crate::case::Case;
use crate::coupling::Bed;
use crate::gas::volume_averaged::VolumeAveragedModel;
use crate::output::checkpoint::{self, Checkpoint};
use crate::output::{
    ColumnUnits, GasSnapshots, OutputError, ParticleSnapshots, ProfileRow, Profiles, Provenance,
    Series, on_root,
};
use crate::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, Records, WallContactRecord,
};
use crate::particles::ContactHistories;
use crate::state::{Clock, State};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where results go, and where relative paths in the case refer to.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    /// The folder of results.
    pub path: PathBuf,
    /// The folder of the case file.
    pub case_folder: PathBuf,
}

/// The mark of a run that came to its end: holds the digest.
const COMPLETE: &str = "complete";

impl OutputFolder {
    /// Whether an earlier run has left results here.
    pub fn holds_results(&self) -> bool {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return false };
        entries.flatten().any(|entry| is_result(&entry.file_name().to_string_lossy()))
    }

    /// Removes an earlier run's results, and nothing else.
    ///
    /// # Errors
    /// If the folder cannot be read or a file not be removed.
    pub fn clear(&self) -> Result<(), String> {
        if !self.path.exists() {
            return Ok(());
        }
        let entries = std::fs::read_dir(&self.path).map_err(|error| error.to_string())?;
        for entry in entries.flatten() {
            if is_result(&entry.file_name().to_string_lossy()) {
                let path = entry.path();
                std::fs::remove_file(&path)
                    .map_err(|error| format!("{} cannot be removed: {error}", path.display()))?;
            }
        }
        Ok(())
    }
}

fn is_result(name: &str) -> bool {
    let checkpoint = name.starts_with("checkpoint-");
    let growing = ["series.csv", "profiles.h5", "particles.vtkhdf", "gas.vtkhdf"];
    let of_growing = |suffix| name.strip_suffix(suffix).is_some_and(|file| growing.contains(&file));
    let fixed = ["case.toml", COMPLETE];
    checkpoint || fixed.contains(&name) || ["", ".metadata", ".partial"].into_iter().any(of_growing)
}

/// Time between two results of a kind; none if it is not asked for. One is due at each multiple of it, at the
/// nearest step, whatever the steps before were like.
#[derive(Clone, Copy, Debug)]
struct Interval(Option<f64>);

impl Interval {
    fn due(self, clock: &Clock, step: u64) -> bool {
        let Some(interval) = self.0 else { return false };
        // The same numbers whether a step is asked for as this one or as the one before: none is missed.
        let multiples = |step| ((clock.time_of(step) + 0.5 * clock.time_step) / interval).floor();
        step == 0 || step > clock.origin_step && multiples(step) > multiples(step - 1)
    }
}

/// The open files of a run.
pub(super) struct Outputs {
    folder: OutputFolder,
    provenance: Provenance,
    series: Series,
    series_interval: Interval,
    profiles: Option<Profiles>,
    profile_interval: Interval,
    snapshots: Option<ParticleSnapshots>,
    snapshot_interval: Interval,
    gas_snapshots: Option<GasSnapshots>,
    gas_interval: Interval,
    checkpoint_interval: Interval,
    checkpoint_steps: Option<u64>,
    last_checkpoint: Instant,
    every_wall_clock: Option<std::time::Duration>,
    keep: usize,
}

impl Outputs {
    /// Begins the files of a run, or continues them from the state's time on. Collective.
    pub(super) fn open(
        case: &Case,
        folder: &OutputFolder,
        state: &State,
        profile: &BedProfile,
        continues: bool,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        make_folder(&folder.path, &case.text, ranks)?;
        if continues {
            checkpoint::supersede(&folder.path, state.clock.step, ranks)?;
        }
        let units = ColumnUnits::of_system(case.units.name());
        let provenance = Provenance::here_and_now(&case.title, case.units.name(), ranks);
        let (time, text) = (state.clock.time(), &case.text);
        let file = |name: &str| folder.path.join(name);
        let path = file("series.csv");
        let series = match continues {
            true => Series::resume(&path, (time, text), &provenance, units, ranks)?,
            false => Series::create(&path, text, &provenance, units, ranks)?,
        };
        let grid = profile.grid();
        let heights: Vec<f64> = (0..grid.nodes()).map(|node| grid.height_of(node)).collect();
        let path = file("profiles.h5");
        let profiles = match (case.output.profiles, continues) {
            (None, _) => None,
            (_, true) => Some(Profiles::resume(&path, time, (&heights, text), &provenance, ranks)?),
            (_, false) => Some(Profiles::create(&path, &heights, text, &provenance, ranks)?),
        };
        let path = file("particles.vtkhdf");
        let snapshots = match (case.output.particles, continues) {
            (None, _) => None,
            (_, true) => Some(ParticleSnapshots::resume(&path, time, text, &provenance, ranks)?),
            (_, false) => Some(ParticleSnapshots::create(&path, text, &provenance, ranks)?),
        };
        let path = file("gas.vtkhdf");
        let gas_snapshots = match (case.output.gas.and(case.volume_averaged()), continues) {
            (None, _) => None,
            (Some(VolumeAveragedModel { grid, .. }), true) => {
                Some(GasSnapshots::resume(&path, time, (grid, text), &provenance, ranks)?)
            }
            (Some(VolumeAveragedModel { grid, .. }), false) => {
                Some(GasSnapshots::create(&path, grid, text, &provenance, ranks)?)
            }
        };
        Ok(Self {
            folder: folder.clone(),
            provenance,
            series,
            series_interval: Interval(Some(case.output.series)),
            profiles,
            profile_interval: Interval(case.output.profiles),
            snapshots,
            snapshot_interval: Interval(case.output.particles),
            gas_snapshots,
            gas_interval: Interval(case.output.gas),
            checkpoint_interval: Interval(case.checkpoint.every),
            checkpoint_steps: case.checkpoint.every_steps,
            last_checkpoint: Instant::now(),
            every_wall_clock: case.checkpoint.every_wall_clock,
            keep: case.checkpoint.keep,
        })
    }

    /// Whether a row of the series is due after a step.
    pub(super) fn row_due(&self, clock: &Clock, step: u64) -> bool {
        self.series_interval.due(clock, step)
    }

    /// Whether anything but a checkpoint is due now.
    pub(super) fn anything_due(&self, clock: &Clock) -> bool {
        [self.series_interval, self.profile_interval, self.snapshot_interval, self.gas_interval]
            .iter()
            .any(|interval| interval.due(clock, clock.step))
    }

    /// Whether a checkpoint is due now.
    pub(super) fn checkpoint_due(&self, clock: &Clock) -> bool {
        self.checkpoint_interval.due(clock, clock.step)
            || self.checkpoint_steps.is_some_and(|steps| clock.step.is_multiple_of(steps))
    }

    /// Whether a checkpoint is due by the clock on the wall, on this rank.
    pub(super) fn checkpoint_due_by_wall_clock(&self) -> bool {
        self.every_wall_clock.is_some_and(|every| self.last_checkpoint.elapsed() >= every)
    }

    /// Writes what is due now. Collective.
    pub(super) fn write(
        &mut self,
        clock: &Clock,
        measures: &Measures,
        bed: &Bed,
        particles: impl Records<ParticleRecord>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let due = |interval: Interval| interval.due(clock, clock.step);
        if due(self.series_interval) {
            self.series.append(measures, ranks)?;
        }
        if let (Some(profiles), true) = (&self.profiles, due(self.profile_interval)) {
            let row = ProfileRow {
                time: measures.time,
                superficial_velocity: measures.superficial_velocity,
                solids_fraction: &bed.solids_fraction,
                solids_velocity: &bed.solids_velocity,
            };
            profiles.append(&row, ranks)?;
        }
        if let (Some(snapshots), true) = (&mut self.snapshots, due(self.snapshot_interval)) {
            snapshots.append(measures.time, &particles, ranks)?;
        }
        Ok(())
    }

    /// Writes a sample of the gas on cells if that is due at a step. Collective.
    pub(super) fn write_gas(
        &self,
        clock: &Clock,
        sample: impl FnOnce() -> Option<Vec<CellRecord>>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        match &self.gas_snapshots {
            Some(snapshots) if self.gas_interval.due(clock, clock.step) => {
                sample().map_or(Ok(()), |cells| snapshots.append(clock.time(), &cells, ranks))
            }
            _ => Ok(()),
        }
    }

    /// Writes a checkpoint and removes the oldest ones beyond the number kept. The rows of results that it goes
    /// on from are made safe before: a run that is killed goes on from it with all of them. Collective.
    pub(super) fn write_checkpoint(
        &mut self,
        case: &Case,
        state: &State,
        (particles, cells): (impl Records<ParticleRecord>, Vec<CellRecord>),
        ranks: &dyn Communicator,
    ) -> Result<(Digest, PathBuf), OutputError> {
        let ContactHistories { pairs, walls } = state.contacts.histories_once(&state.particles);
        let checkpoint = Checkpoint {
            clock: state.clock,
            departed: state.departed,
            sizes: state.sizes,
            case_text: case.text.clone(),
            case_folder: self.folder.case_folder.display().to_string(),
            particles,
            contacts: pairs.into_iter().map(ContactRecord::from).collect(),
            wall_contacts: walls.into_iter().map(WallContactRecord::from).collect(),
            cells,
            gas_report: state.gas.report(),
        };
        self.series.keep(ranks)?;
        self.profiles.as_ref().map_or(Ok(()), |profiles| profiles.keep(ranks))?;
        self.snapshots.as_ref().map_or(Ok(()), |snapshots| snapshots.keep(ranks))?;
        self.gas_snapshots.as_ref().map_or(Ok(()), |snapshots| snapshots.keep(ranks))?;
        let path = self.folder.path.join(checkpoint::file_name(state.clock.step));
        let digest = checkpoint::write(&path, &checkpoint, &self.provenance, ranks)?;
        checkpoint::prune(&self.folder.path, self.keep, ranks)?;
        self.last_checkpoint = Instant::now();
        Ok((digest, path))
    }

    /// Marks the run as complete: batch scripts need not start it again. Collective.
    pub(super) fn mark_complete(
        &self,
        digest: &Digest,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let path = self.folder.path.join(COMPLETE);
        on_root(&path, ranks, || {
            std::fs::write(&path, format!("digest {digest}\n")).map_err(|error| error.to_string())
        })
        .map(|_| ())
    }
}

/// Makes the folder, with the case in effect; a run that goes on is no longer complete.
fn make_folder(path: &Path, case_text: &str, ranks: &dyn Communicator) -> Result<(), OutputError> {
    let make = || {
        std::fs::create_dir_all(path)?;
        match std::fs::remove_file(path.join(COMPLETE)) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        std::fs::write(path.join("case.toml"), case_text)
    };
    on_root(path, ranks, || make().map_err(|error| error.to_string())).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due_times(clock: &Clock, interval: f64, steps: u64) -> Vec<f64> {
        let steps = clock.step..clock.step + steps;
        let due = |step: &u64| Interval(Some(interval)).due(clock, *step);
        steps.filter(due).map(|step| clock.time_of(step)).collect()
    }

    #[test]
    fn rows_fall_on_multiples_of_their_interval() {
        let clock = Clock::new(2.5e-4);
        let times = due_times(&clock, 0.25, 1_000_000);
        assert_eq!(times.len(), 1000);
        let exact =
            times.iter().zip(0..).all(|(time, k)| (time - 0.25 * f64::from(k)).abs() < 1e-9);
        assert!(exact);
        // Intervals that are no multiples of the step: the nearest step, also half-way and below a step.
        for interval in [1.1e-3, 1.5 * 2.5e-4, 3.7e-4, 2.5e-4, 1.0e-4] {
            let times = due_times(&clock, interval, 10_000);
            let expected = (10_000.0 * 2.5e-4 / interval).min(10_000.0);
            assert!((times.len() as f64 - expected).abs() <= 1.0, "{interval}: {}", times.len());
        }
        assert!(due_times(&clock, 1.0e-4, 100).len() == 100 && !Interval(None).due(&clock, 0));
    }

    #[test]
    fn rows_fall_on_multiples_of_their_interval_after_the_step_has_changed() {
        let (before, after) = (2.5e-4, 1.0e-4);
        let clock = Clock { step: 1003, ..Clock::new(before) }.with_time_step(after);
        let times = due_times(&clock, 0.25, 100_000);
        // From 0.25075 on, for 10 time units: 0.5, 0.75, ...; 0.25 was due before.
        assert_eq!(times.len(), 40);
        let off = |(time, k): (&f64, u32)| (time - 0.25 * f64::from(k)).abs();
        let farthest = times.iter().zip(2..).map(off).fold(0.0, f64::max);
        assert!(farthest <= 0.5 * after + 1.0e-9, "{farthest}");
        // Multiples of 2500 steps would be elsewhere, by up to half of an interval.
        let other = clock.time_of(2500) / 0.25;
        assert!((other - other.round()).abs() > 0.2);
    }
}
