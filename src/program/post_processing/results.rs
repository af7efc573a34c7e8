//! The folder of a run, read as far as analyses need it.

use super::Unmeasured;
use super::result_file::ResultFile;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use talcum_engine::gas::GasModel;
use talcum_engine::parallel::OneRank;
use talcum_results::analysis::{Digest, NoValue, Periodicity};
use talcum_results::output::checkpoint::{self, Checkpoint};
use talcum_results::output::readers::{
    GasSnapshotReader, ParticleSnapshotReader, ProfileTable, SeriesTable,
};
use talcum_results::output::{ColumnUnits, OutputError, read_text};
use talcum_runs::case::{Case, Stage};

/// The times that are evaluated; both ends are included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeWindow {
    /// First time.
    pub from: f64,
    /// Last time.
    pub to: f64,
}

impl TimeWindow {
    /// All times.
    pub const WHOLE: Self = Self { from: f64::NEG_INFINITY, to: f64::INFINITY };

    fn holds(&self, time: f64) -> bool {
        (self.from..=self.to).contains(&time)
    }
}

type Read<T> = OnceCell<Result<T, Unmeasured>>;

/// The results of a run. Files are read at the first request of an analysis.
pub struct Results {
    folder: PathBuf,
    /// The times that are evaluated.
    pub window: TimeWindow,
    case_text: String,
    case: Result<Case, NoValue>,
    /// Whether files requested by the case must exist.
    is_whole: bool,
    series: Read<SeriesTable>,
    profiles: Read<ProfileTable>,
    checkpoints: Read<Vec<PathBuf>>,
}

impl Results {
    /// The results in a folder.
    ///
    /// # Errors
    /// If it contains no `case.toml`.
    pub fn open(folder: &Path, window: TimeWindow) -> Result<Self, OutputError> {
        let path = folder.join("case.toml");
        let case_text = read_text(&path).map_err(|error| OutputError {
            path: path.clone(),
            message: format!("cannot be read: {error}; name the folder of results of a run"),
        })?;
        let case = Case::of_earlier_run(&case_text, &path.display().to_string(), folder, &[]);
        let case = case.map_err(|errors| {
            NoValue::because(format!("this Talcum does not accept the run's case:\n{errors}"))
        });
        let (series, profiles, checkpoints) = Default::default();
        let folder = folder.to_owned();
        let is_whole = false;
        Ok(Self { folder, window, case_text, case, is_whole, series, profiles, checkpoints })
    }

    /// These results as those of a run that has come to its end: a missing file that the case requests is then an
    /// error, not merely a lack of data.
    pub fn of_complete_run(self) -> Self {
        Self { is_whole: true, ..self }
    }

    /// The folder of the results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The text of the case.
    pub fn case_text(&self) -> &str {
        &self.case_text
    }

    /// The case.
    pub fn case(&self) -> Result<&Case, Unmeasured> {
        self.case.as_ref().map_err(|reason| reason.clone().into())
    }

    /// The units of the case.
    pub fn units(&self) -> ColumnUnits {
        // A case that is not valid may contain anything here; its numbers then have no known unit.
        let name = |case: &Case| case.units.name();
        ColumnUnits::of_system(self.case.as_ref().map_or("dimensionless", name))
    }

    /// Digest of the last state, if the run came to its end.
    pub fn run_digest(&self) -> Option<String> {
        let text = read_text(&self.folder.join("complete")).ok()?;
        text.lines().find_map(|line| Some(line.strip_prefix("digest ")?.trim().to_owned()))
    }

    /// All rows of `series.csv`.
    pub fn whole_series(&self) -> Result<&SeriesTable, Unmeasured> {
        let read = || {
            let path = self.file(ResultFile::Series)?;
            Ok(SeriesTable::read(&path)?)
        };
        as_ref(self.series.get_or_init(read))
    }

    /// The rows of `series.csv` in the window; at least one.
    pub fn series(&self) -> Result<SeriesTable, Unmeasured> {
        let rows = self.whole_series()?.between(self.window.from, self.window.to);
        self.require_times(rows.rows.len(), ResultFile::Series)?;
        Ok(rows)
    }

    /// A column of the rows in the window.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, Unmeasured> {
        let absent = || NoValue::because(format!("series.csv has no column {name}"));
        Ok(self.series()?.column(name).ok_or_else(absent)?)
    }

    /// All rows of `profiles.h5`.
    pub fn whole_profiles(&self) -> Result<&ProfileTable, Unmeasured> {
        let read = || {
            let path = self.file(ResultFile::Profiles)?;
            Ok(ProfileTable::read(&path)?)
        };
        as_ref(self.profiles.get_or_init(read))
    }

    /// The rows of `profiles.h5` in the window; at least one.
    pub fn profiles(&self) -> Result<ProfileTable, Unmeasured> {
        let rows = self.whole_profiles()?.between(self.window.from, self.window.to);
        self.require_times(rows.times.len(), ResultFile::Profiles)?;
        Ok(rows)
    }

    /// The snapshots of particles in the window; at least one.
    pub fn particle_snapshots(&self) -> Result<ParticleSnapshotReader, Unmeasured> {
        let path = self.file(ResultFile::Particles)?;
        let snapshots = ParticleSnapshotReader::open(&path)?;
        let snapshots = snapshots.between(self.window.from, self.window.to);
        self.require_times(snapshots.times.len(), ResultFile::Particles)?;
        Ok(snapshots)
    }

    /// The snapshots of a volume-averaged gas in the window; at least one.
    pub fn gas_snapshots(&self) -> Result<GasSnapshotReader, Unmeasured> {
        let path = self.file(ResultFile::Gas)?;
        let snapshots = GasSnapshotReader::open(&path)?;
        let snapshots = snapshots.between(self.window.from, self.window.to);
        self.require_times(snapshots.times.len(), ResultFile::Gas)?;
        Ok(snapshots)
    }

    /// The paths of all checkpoints, by ascending time.
    pub fn checkpoints(&self) -> Result<&[PathBuf], Unmeasured> {
        let list = || {
            let paths = checkpoint::files_in(&self.folder)?;
            let none = "there is no checkpoint: [checkpoint] of the case says how many are kept";
            if paths.is_empty() { Err(NoValue::because(none).into()) } else { Ok(paths) }
        };
        as_ref(self.checkpoints.get_or_init(list)).map(Vec::as_slice)
    }

    /// A complete checkpoint; `None` if its time is not in the window, or if an active run has removed it meanwhile.
    pub fn checkpoint(&self, path: &Path) -> Result<Option<Checkpoint>, Unmeasured> {
        if !path.exists() {
            return Ok(None);
        }
        let (checkpoint, _, _): (_, _, Digest) = checkpoint::read(path, &OneRank)?;
        Ok(Some(checkpoint).filter(|found| self.window.holds(found.clock.time())))
    }

    /// The last time of the results, inside the window or not.
    ///
    /// # Errors
    /// If no file gives it.
    pub fn last_time(&self) -> Result<f64, OutputError> {
        let series = self.whole_series();
        match series.map(|series| series.column("time").and_then(|times| times.last().copied())) {
            Ok(Some(time)) => Ok(time),
            Err(Unmeasured::Unreadable(error)) => Err(error),
            Ok(None) | Err(Unmeasured::Nothing(_)) => {
                let message = "there are no rows of results yet".to_owned();
                Err(OutputError { path: self.folder.join("series.csv"), message })
            }
        }
    }

    /// The periodic lengths of the box.
    pub fn periodicity(&self) -> Result<Periodicity, Unmeasured> {
        let bounds = &self.case()?.domain.bounds;
        let length = |axis: usize| bounds.is_periodic(axis).then(|| bounds.lengths()[axis]);
        Ok(Periodicity { lengths: [0, 1, 2].map(length) })
    }

    /// The stages in the window.
    pub fn stages(&self) -> Result<impl Iterator<Item = &Stage>, Unmeasured> {
        let TimeWindow { from, to } = self.window;
        Ok(self.case()?.stages.iter().filter(move |stage| stage.end > from && stage.start < to))
    }

    /// The fraction of a full cell of the profiles' grid over which the lowest node averages.
    pub fn lowest_node_part(&self) -> Result<f64, Unmeasured> {
        let case = self.case()?;
        let mut gases = case.stages.iter().map(|stage| &stage.physics.gas);
        let gas = gases.find(|gas| **gas != GasModel::None).and_then(GasModel::column);
        let grid = gas.map(|gas| gas.grid(&case.domain.bounds));
        Ok(grid.map_or(1.0, |grid| grid.volume_of(0) / grid.cell_volume()))
    }

    /// The path of a file, if it exists.
    fn file(&self, file: ResultFile) -> Result<PathBuf, Unmeasured> {
        let path = self.folder.join(file.name());
        if path.exists() {
            return Ok(path);
        }
        let is_due = |case: &Case| file.require_of(case).is_ok();
        if self.is_whole && self.case.as_ref().is_ok_and(is_due) {
            let message =
                "is not there, though the run is complete and its case asks for it".to_owned();
            return Err(OutputError { path, message }.into());
        }
        Err(file.absent().into())
    }

    fn require_times(&self, count: usize, file: ResultFile) -> Result<(), NoValue> {
        let (name, TimeWindow { from, to }) = (file.name(), self.window);
        match count {
            0 if self.window == TimeWindow::WHOLE => {
                Err(NoValue::because(format!("{name} holds no results yet")))
            }
            0 => Err(NoValue::because(format!(
                "{name} holds nothing between the times {from} and {to}"
            ))),
            _ => Ok(()),
        }
    }
}

fn as_ref<T>(read: &Result<T, Unmeasured>) -> Result<&T, Unmeasured> {
    read.as_ref().map_err(Clone::clone)
}
