//! The output folder of a run: what is written into it, and when.

use crate::analysis::{BedProfile, Digest, Measures};
use crate::case::Case;
use crate::coupling::Bed;
use crate::output::checkpoint::{self, Checkpoint};
use crate::output::{
    ColumnUnits, OutputError, ParticleSnapshots, ProfileRow, Profiles, Provenance, Series, on_root,
};
use crate::parallel::{Communicator, ContactRecord, ParticleRecord, WallContactRecord};
use crate::state::State;
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
    let growing = ["series.csv", "profiles.h5", "particles.vtkhdf"];
    let of_growing = |suffix| name.strip_suffix(suffix).is_some_and(|file| growing.contains(&file));
    let fixed = ["case.toml", COMPLETE];
    checkpoint || fixed.contains(&name) || ["", ".metadata", ".partial"].into_iter().any(of_growing)
}

/// Steps between two results of a kind; none if it is not asked for.
#[derive(Clone, Copy, Debug)]
struct Interval(Option<u64>);

impl Interval {
    fn of(time: Option<f64>, time_step: f64) -> Self {
        Self(time.map(|time| (time / time_step).round().max(1.0) as u64))
    }

    fn due(self, step: u64) -> bool {
        self.0.is_some_and(|interval| step.is_multiple_of(interval))
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
    checkpoint_interval: Interval,
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
        let series = match continues {
            true => Series::resume(&file("series.csv"), time, &provenance, units, ranks)?,
            false => Series::create(&file("series.csv"), &provenance, units, ranks)?,
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
        let interval = |time| Interval::of(time, state.clock.time_step);
        Ok(Self {
            folder: folder.clone(),
            provenance,
            series,
            series_interval: interval(Some(case.output.series)),
            profiles,
            profile_interval: interval(case.output.profiles),
            snapshots,
            snapshot_interval: interval(case.output.particles),
            checkpoint_interval: match case.checkpoint.every_steps {
                Some(steps) => Interval(Some(steps)),
                None => interval(case.checkpoint.every),
            },
            last_checkpoint: Instant::now(),
            every_wall_clock: case.checkpoint.every_wall_clock,
            keep: case.checkpoint.keep,
        })
    }

    /// Whether a row of the series is due after a step.
    pub(super) fn row_due(&self, step: u64) -> bool {
        self.series_interval.due(step)
    }

    /// Whether anything but a checkpoint is due after a step.
    pub(super) fn anything_due(&self, step: u64) -> bool {
        self.series_interval.due(step)
            || self.profile_interval.due(step)
            || self.snapshot_interval.due(step)
    }

    /// Whether a checkpoint is due after a step.
    pub(super) fn checkpoint_due(&self, step: u64) -> bool {
        self.checkpoint_interval.due(step)
    }

    /// Whether a checkpoint is due by the clock on the wall, on this rank.
    pub(super) fn checkpoint_due_by_wall_clock(&self) -> bool {
        self.every_wall_clock.is_some_and(|every| self.last_checkpoint.elapsed() >= every)
    }

    /// Writes what is due at a step. Collective.
    pub(super) fn write(
        &mut self,
        step: u64,
        measures: &Measures,
        bed: &Bed,
        records: impl FnOnce() -> Vec<ParticleRecord>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        if self.series_interval.due(step) {
            self.series.append(measures, ranks)?;
        }
        if let (Some(profiles), true) = (&self.profiles, self.profile_interval.due(step)) {
            let row = ProfileRow {
                time: measures.time,
                superficial_velocity: measures.superficial_velocity,
                solids_fraction: &bed.solids_fraction,
                solids_velocity: &bed.solids_velocity,
            };
            profiles.append(&row, ranks)?;
        }
        if let (Some(snapshots), true) = (&mut self.snapshots, self.snapshot_interval.due(step)) {
            snapshots.append(measures.time, &records(), ranks)?;
        }
        Ok(())
    }

    /// Writes a checkpoint and removes the oldest ones beyond the number kept. The rows of results that it goes
    /// on from are made safe before: a run that is killed goes on from it with all of them. Collective.
    pub(super) fn write_checkpoint(
        &mut self,
        case: &Case,
        state: &State,
        particles: Vec<ParticleRecord>,
        ranks: &dyn Communicator,
    ) -> Result<(Digest, PathBuf), OutputError> {
        let pairs = state.contacts.records(&state.particles, true);
        let walls = state.contacts.wall_records(&state.particles);
        let checkpoint = Checkpoint {
            clock: state.clock,
            departed: state.departed,
            sizes: state.sizes,
            case_text: case.text.clone(),
            case_folder: self.folder.case_folder.display().to_string(),
            particles,
            contacts: pairs.into_iter().map(ContactRecord::from).collect(),
            wall_contacts: walls.into_iter().map(WallContactRecord::from).collect(),
        };
        self.series.keep(ranks)?;
        self.profiles.as_ref().map_or(Ok(()), |profiles| profiles.keep(ranks))?;
        self.snapshots.as_ref().map_or(Ok(()), |snapshots| snapshots.keep(ranks))?;
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
