//! A run as shown by its folder of results, which is read repeatedly while the run writes.

mod bed;
mod latest;
mod listing;
mod overview;
mod pace;
mod state;
mod warnings;

pub(super) use self::bed::Bed;
pub(super) use self::listing::Version;
pub(super) use self::overview::{Overview, brief};
pub(super) use self::state::RunState;

use self::latest::Latest;
use self::listing::Listing;
use self::pace::Pace;
use self::state::Marks;
use anyhow::{anyhow, bail};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use talcum_results::output::readers::{ProfileTable, SeriesTable};
use talcum_results::output::{OutputError, require_file};
use talcum_runs::case::Case;
use talcum_runs::input;

/// Time without output after which a run counts as quiet if nothing is known of its pace.
const PATIENCE: Duration = Duration::from_secs(600);
/// The least such time, and the number of rows that may be late if the pace is known.
const LEAST_PATIENCE: Duration = Duration::from_secs(60);
const LATE_ROWS: f64 = 10.0;
/// Tolerance for the age of a file: a run writes its case at every start, and the file of a run that was never resumed
/// is no older than its contents.
const ONE_START: Duration = Duration::from_secs(2);

/// Data of a folder of results, read as far as they are requested.
pub(super) struct WatchedRun {
    folder: PathBuf,
    listing: Listing,
    case: Latest<Case>,
    series: Latest<SeriesTable>,
    profiles: Latest<ProfileTable>,
    bed: Latest<Bed>,
    pace: Pace,
    marks: Marks,
}

impl WatchedRun {
    /// Reads a folder for the first time.
    ///
    /// # Errors
    /// If there is no such folder, or it contains other things than results.
    pub(super) fn open(folder: &Path) -> anyhow::Result<Self> {
        let listing = Listing::of(folder).map_err(|error| {
            anyhow!("{}: {error}; name the folder of results of a run", folder.display())
        })?;
        if !listing.has("case.toml") && !listing.is_unused() {
            bail!(
                "{}: this is no folder of results, it holds no case.toml; name that of a run, or an empty one",
                folder.display()
            );
        }
        let (case, series, profiles, bed, pace, marks) = Default::default();
        let mut run =
            Self { folder: folder.to_owned(), listing, case, series, profiles, bed, pace, marks };
        run.renew();
        Ok(run)
    }

    /// Reads again the marks, the case and the series.
    pub(super) fn renew(&mut self) {
        // A folder that no longer exists is treated like one in which nothing has been written.
        self.listing = Listing::of(&self.folder).unwrap_or_default();
        let (case, series) = (self.file("case.toml"), self.file("series.csv"));
        let folder = &self.folder;
        self.case.renew(case, |path| {
            require_file(path).map_err(|error| format!("{}: {error}", path.display()))?;
            let text = input::read_text(path).map_err(|error| error.to_string())?;
            let case = Case::of_earlier_run(&text, &path.display().to_string(), folder, &[]);
            case.map_err(|errors| errors.to_string())
        });
        let rows = self.rows();
        self.series.renew(series, SeriesTable::read);
        let has_grown = self.rows() > rows && rows > 0;
        self.renew_marks(has_grown);
        self.renew_pace();
    }

    fn renew_marks(&mut self, has_grown: bool) {
        let marks = Marks::read(&self.folder);
        let is_unlocked = marks.holder.is_none();
        // The condition must hold twice without a lock: between two checks a run may write its last row and unlock the
        // folder.
        let grows = is_unlocked
            && (self.marks.grows_without_lock || self.marks.holder.is_none() && has_grown);
        let last_write = self.listing.last_write();
        self.marks = Marks { grows_without_lock: grows, last_write, ..marks };
    }

    fn renew_pace(&mut self) {
        if !self.state().is_active() {
            self.pace.forget();
            return;
        }
        if self.pace.is_empty() {
            let begin = self.begin().zip(self.first_time());
            begin.into_iter().for_each(|(at, time)| self.pace.note(at, time));
        }
        let written = self.series.read().map(|(_, version)| version.modified);
        if let (Some(at), Some(time)) = (written, self.time()) {
            self.pace.note(at, time);
        }
    }

    /// Approximate time at which the first row was written; `None` if the run was resumed since.
    fn begin(&self) -> Option<SystemTime> {
        let metadata = std::fs::metadata(self.folder.join("case.toml")).ok()?;
        let (created, modified) = (metadata.created().ok()?, metadata.modified().ok()?);
        let [earlier, later] = [created.min(modified), created.max(modified)];
        (later.duration_since(earlier).ok()? < ONE_START).then_some(modified)
    }

    /// The rows of series.csv, if there are any.
    pub(super) fn series(&self) -> Option<&SeriesTable> {
        self.series.value()
    }

    /// The version of series.csv that was read.
    pub(super) fn series_version(&self) -> Option<Version> {
        self.series.read().map(|(_, version)| version)
    }

    /// The profiles, read again if they have changed, and the version of their file.
    pub(super) fn profiles(&mut self) -> Option<(&ProfileTable, Version)> {
        let file = self.file("profiles.h5");
        self.profiles.renew(file, ProfileTable::read);
        self.profiles.read()
    }

    /// The particles, read again if they have changed, and the version of their file.
    pub(super) fn bed(&mut self) -> Option<(&Bed, Version)> {
        let file = self.bed_file();
        self.bed.renew(file, |path| {
            let is_checkpoint = path.extension().is_some_and(|ending| ending == "h5");
            let read: fn(&Path) -> Result<Bed, OutputError> =
                if is_checkpoint { Bed::of_checkpoint } else { Bed::of_snapshots };
            read(path)
        });
        self.bed.read()
    }

    fn bed_file(&self) -> Option<(PathBuf, Version)> {
        let checkpoint = || self.listing.newest_checkpoint().and_then(|name| self.file(name));
        self.file("particles.vtkhdf").or_else(checkpoint)
    }

    /// Present versions of series, profiles and bed; `None` if there is no such file.
    pub(super) fn versions(&self) -> [Option<Version>; 3] {
        [
            self.listing.version("series.csv"),
            self.listing.version("profiles.h5"),
            self.bed_file().map(|(_, version)| version),
        ]
    }

    /// Lengths of the box, if the case is known.
    pub(super) fn box_lengths(&self) -> Option<[f64; 3]> {
        self.case.value().map(|case| case.domain.bounds.lengths().into())
    }

    /// The overview of the run.
    pub(super) fn overview(&self) -> Overview {
        let folder = self.folder.display().to_string();
        let unit = |series: &SeriesTable| Some(series.columns[series.position("time")?].1.clone());
        let overview = Overview {
            title: self.title().unwrap_or_else(|| folder.clone()),
            folder,
            state: self.state(),
            time: self.time(),
            end: None,
            time_unit: self.series().and_then(unit).unwrap_or_default(),
            stage: None,
            rate: self.pace.rate(),
            warnings: self.warnings(),
        };
        match self.case.value() {
            Some(case) => overview.with_case(case),
            None => overview,
        }
    }

    fn title(&self) -> Option<String> {
        self.series()?.entry("title").map(str::to_owned)
    }

    fn state(&self) -> RunState {
        self.marks.state(SystemTime::now(), self.patience())
    }

    fn patience(&self) -> Duration {
        let interval = self.case.value().map(|case| case.output.series);
        let (Some(interval), Some(rate)) = (interval, self.pace.rate()) else { return PATIENCE };
        let late = Duration::try_from_secs_f64(LATE_ROWS * interval / rate).unwrap_or(PATIENCE);
        late.max(LEAST_PATIENCE)
    }

    fn warnings(&self) -> Vec<String> {
        let complaints = [
            self.case.complaint().map(|why| format!("this Talcum does not accept the case: {why}")),
            self.series.complaint().map(str::to_owned),
            self.profiles.complaint().map(str::to_owned),
            self.bed.complaint().map(str::to_owned),
        ];
        let set_aside = self.listing.set_aside();
        let set_aside = (!set_aside.is_empty())
            .then(|| format!("damaged files were set aside: {}", set_aside.join(", ")));
        let of_series = self.series().map(warnings::of_series).unwrap_or_default();
        complaints.into_iter().flatten().chain(set_aside).chain(of_series).collect()
    }

    /// A file of the folder, if it exists.
    fn file(&self, name: &str) -> Option<(PathBuf, Version)> {
        Some((self.folder.join(name), self.listing.version(name)?))
    }

    fn rows(&self) -> usize {
        self.series().map_or(0, |series| series.rows.len())
    }

    fn time(&self) -> Option<f64> {
        self.time_of(|series| series.rows.last())
    }

    fn first_time(&self) -> Option<f64> {
        self.time_of(|series| series.rows.first())
    }

    fn time_of(&self, row: impl Fn(&SeriesTable) -> Option<&Vec<f64>>) -> Option<f64> {
        let series = self.series()?;
        row(series)?.get(series.position("time")?).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// Adds a row and checks. A reading of some microseconds requires a pause of some more.
    fn look_after(run: &mut WatchedRun, text: &str) -> Overview {
        std::thread::sleep(Duration::from_millis(20));
        let file = std::fs::File::options().append(true).open(run.folder.join("series.csv"));
        file.unwrap().write_all(text.as_bytes()).unwrap();
        run.renew();
        run.overview()
    }

    fn begun() -> (tempfile::TempDir, WatchedRun) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("case.toml"), "title = 1\n").unwrap();
        std::fs::write(folder.path().join("series.csv"), "# title: A bed\ntime [s]\n0\n").unwrap();
        let run = WatchedRun::open(folder.path()).unwrap();
        (folder, run)
    }

    #[test]
    fn where_there_are_no_locks_growth_shows_that_a_run_is_active() {
        let (_folder, mut run) = begun();
        assert_eq!(run.overview().state, RunState::Stopped);
        assert_eq!(look_after(&mut run, "0.").state, RunState::Stopped);
        let growing = look_after(&mut run, "5\n");
        assert_eq!((growing.state.word(), growing.time), ("running", Some(0.5)));
        assert!(look_after(&mut run, "1\n").rate.is_some_and(|rate| rate > 0.0));
        // The mark of completion ends the run, and with it the pace.
        std::fs::write(run.folder.join("complete"), "digest 12\n").unwrap();
        assert_eq!(look_after(&mut run, "").state.word(), "complete");
        assert_eq!(run.overview().pace_text(), None);
    }

    #[test]
    fn a_case_that_is_not_accepted_is_a_warning_and_the_series_has_the_title() {
        let (folder, run) = begun();
        let overview = run.overview();
        assert_eq!((overview.title.as_str(), overview.end), ("A bed", None));
        assert!(overview.warnings[0].contains("does not accept the case"), "{overview:?}");
        // A folder that disappears is treated like one in which nothing has been written.
        let mut run = run;
        drop(folder);
        run.renew();
        assert_eq!((run.overview().state, run.overview().time), (RunState::Waiting, None));
    }
}
