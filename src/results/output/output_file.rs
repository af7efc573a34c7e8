//! The interface of all files of results: begin or continue, write an instant, and secure against a kill.

use std::fs::{File, OpenOptions};
use std::path::Path;

use super::{
    ColumnUnits, MessageResult, OutputError, Provenance, SnapshotFormat, is_error_of_system,
    require_file, set_aside,
};
use crate::analysis::{BedProfile, SeriesRow, WallForce};
use talcum_engine::grid::{BoxGrid, ColumnGrid};
use talcum_engine::parallel::{CellSample, Communicator, ParticleRecord, Records};
use talcum_engine::state::EnergyRow;

/// A file of results that grows during a run.
///
/// A new kind is a file with such a type and its [`OutputKind`], and one line in the list of `simulation/outputs.rs`.
pub trait Output {
    /// Adds the data of an instant. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError>;

    /// Secures the data written so far: a run that is killed from now on, and resumed, finds all of them. Collective.
    ///
    /// # Errors
    /// If the file cannot be synced to the disk.
    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError>;
}

/// One instant of a run, as seen by outputs.
pub struct Sample<'a> {
    /// Its numbers.
    pub row: &'a SeriesRow,
    /// The bed over the height.
    pub profile: &'a BedProfile,
    /// This rank's particles, positions wrapped into the box.
    pub particles: &'a dyn Records<ParticleRecord>,
    /// The forces on walls; empty if the case does not request them.
    pub wall_forces: &'a [WallForce],
    /// The energy ledger, if one is kept.
    pub energy: Option<&'a EnergyRow>,
    /// The values of each additional column in snapshots of these particles, particle after particle; empty if no
    /// snapshot is due.
    pub columns: &'a [Vec<f64>],
    /// Samples the volume-averaged gas on this rank's cells; `None` if the stage has no such gas. Collective.
    pub gas_cells: &'a mut dyn FnMut() -> Option<Vec<CellSample>>,
}

/// Head of every file: the case, and the provenance.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// Text of the case in effect.
    pub case_text: &'a str,
    /// Provenance of the file.
    pub provenance: &'a Provenance,
}

impl Head<'_> {
    /// Units of the case, for the columns.
    pub fn units(&self) -> ColumnUnits {
        ColumnUnits::of_system(&self.provenance.units)
    }
}

/// Parameters for opening a file.
pub struct Opening<'a> {
    /// Head of a new file.
    pub head: Head<'a>,
    /// The time up to which an earlier file is continued; `None` if all files begin.
    pub continue_after: Option<f64>,
    /// The grid of profiles.
    pub profile_grid: &'a ColumnGrid,
    /// Contents and format of snapshots.
    pub snapshots: &'a SnapshotFormat,
    /// The cells of a volume-averaged gas, if the case has one.
    pub gas_grid: Option<&'a BoxGrid>,
}

/// The opened output, or `None` if the case has no data for it.
pub type OpenedOutput = Result<Option<Box<dyn Output>>, OutputError>;

/// A kind of output.
pub struct OutputKind {
    /// Name of its file in the folder of results.
    pub file_name: &'static str,
    /// Whether its rows compare the momentum before and after a step.
    pub needs_momentum_before: bool,
    /// Begins or continues the file at a path. Collective.
    pub open: fn(&Path, &Opening<'_>, &dyn Communicator) -> OpenedOutput,
}

/// Reason why an earlier file is not continued.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Obstacle {
    /// It is damaged, or another file than the expected one.
    Unusable(String),
    /// It could not be read or changed at present; the file itself may be intact.
    Failed(String),
}

impl Obstacle {
    /// Obstacle for an error of the system: contents that are not text are damage, all other errors may be temporary.
    pub(super) fn of_io(error: &std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::InvalidData | std::io::ErrorKind::UnexpectedEof => {
                Self::Unusable(error.to_string())
            }
            _ => Self::Failed(error.to_string()),
        }
    }
}

/// Continues a file if there is one, and begins one otherwise. `go_on` is called with the length of the file as it was
/// found. An unusable file is set aside with a warning, and a new one is begun; one that cannot be read or written is
/// left unchanged.
///
/// # Errors
/// If the file cannot be read or changed, or a new one cannot be made.
pub(super) fn continue_or_create<T>(
    path: &Path,
    go_on: impl Fn(u64) -> Result<T, Obstacle>,
    create: impl FnOnce() -> MessageResult<T>,
) -> MessageResult<T> {
    // The length is read before the first attempt, which may make the file longer.
    let Some(found_length) = found_length(path).map_err(|error| error.to_string())? else {
        log::warn!("{} is not there: it begins at the time of the checkpoint", path.display());
        return create();
    };
    let mut opened = go_on(found_length);
    if let Err(Obstacle::Unusable(reason)) = &opened {
        // HDF5 also reports a file as damaged if it could not be read at that moment.
        if is_error_of_system(reason) {
            return Err(reason.clone());
        }
        read_through(path).map_err(|error| error.to_string())?;
        opened = go_on(found_length);
    }
    match opened {
        Ok(opened) => Ok(opened),
        Err(Obstacle::Failed(reason)) => Err(reason),
        Err(Obstacle::Unusable(reason)) => {
            set_aside(path, &reason)?;
            create()
        }
    }
}

/// The length of a file if it is there; an error if it may not be read and written.
fn found_length(path: &Path) -> std::io::Result<Option<u64>> {
    if path.exists() {
        require_file(path)?;
    }
    match OpenOptions::new().read(true).write(true).open(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        opened => Ok(Some(opened?.metadata()?.len())),
    }
}

/// An error if a file cannot be read from its start to its end.
fn read_through(path: &Path) -> std::io::Result<()> {
    std::io::copy(&mut File::open(path)?, &mut std::io::sink()).map(|_| ())
}

/// Number of rows that a run has written up to and including a time, from the ascending times in its file. The rest may be
/// left by an interrupted truncation: a later time, and then others, or none.
///
/// # Errors
/// If a row that is to be kept, or the first behind them, has a damaged time.
pub(super) fn rows_up_to(times: &[f64], time: f64) -> MessageResult<usize> {
    leading_rows(times, time, |before, row_time| before < row_time)
}

/// Number of rows up to a time, if several rows may have the same time.
pub(super) fn shared_rows_up_to(times: &[f64], time: f64) -> MessageResult<usize> {
    leading_rows(times, time, |before, row_time| before <= row_time)
}

fn leading_rows(times: &[f64], time: f64, follows: fn(f64, f64) -> bool) -> MessageResult<usize> {
    let mut last = f64::NEG_INFINITY;
    let rows = times.iter().take_while(|&&row_time| {
        let is_kept = follows(last, row_time) && row_time <= time;
        last = if is_kept { row_time } else { last };
        is_kept
    });
    let rows = rows.count();
    let is_kept = |&row_time: &f64| last < row_time && row_time <= time;
    // A time that is no number is not later either.
    let is_later = |next: f64| next > time;
    match times.get(rows) {
        Some(&next) if !is_later(next) || times[rows..].iter().any(is_kept) => {
            Err(format!("the time of its row {} is damaged: {next}", rows + 1))
        }
        _ => Ok(rows),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::{Cell, RefCell};

    /// Treatment of a file that `failures` attempts find unusable.
    fn after(failures: u32) -> (&'static str, bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("profiles.h5");
        std::fs::write(&path, "rows").unwrap();
        let attempts = Cell::new(0);
        let go_on = |_| {
            attempts.set(attempts.get() + 1);
            let is_damaged = attempts.get() <= failures;
            if is_damaged { Err(Obstacle::Unusable("HDF5 says so".to_owned())) } else { Ok("old") }
        };
        let opened = continue_or_create(&path, go_on, || Ok("new")).unwrap();
        (opened, folder.path().join("profiles.h5.unreadable-1").exists())
    }

    #[test]
    fn a_file_is_set_aside_only_if_it_is_unusable_twice() {
        assert_eq!(after(0), ("old", false));
        assert_eq!(after(1), ("old", false));
        assert_eq!(after(2), ("new", true));
    }

    #[test]
    fn rows_behind_a_damaged_time_are_not_cut_off() {
        for wrong in [0.0, 0.1, f64::NAN, f64::INFINITY, 1.0e9] {
            let error = rows_up_to(&[0.0, 0.1, wrong, 0.3, 0.4], 0.35).unwrap_err();
            assert!(error.contains("the time of its row 3 is damaged"), "{error}");
        }
        assert_eq!(rows_up_to(&[0.0, 0.1, 0.2, 0.3, 0.4], 0.3), Ok(4));
        // Remains of an interrupted truncation, and room that is not filled.
        assert_eq!(rows_up_to(&[0.0, 0.1, 0.4, 0.5, 0.0, 0.0], 0.3), Ok(2));
        assert_eq!(rows_up_to(&[], 0.3), Ok(0));
        // The last row: nothing but its time says that it is one.
        for wrong in [0.0, f64::NAN, -1.0] {
            assert!(rows_up_to(&[0.0, 0.1, wrong], 0.3).is_err());
        }
        assert!(rows_up_to(&[0.0, 0.1, 0.1, 0.2], 0.3).is_err());
        assert_eq!(shared_rows_up_to(&[0.0, 0.1, 0.1, 0.2], 0.3), Ok(4));
    }

    #[test]
    fn a_second_attempt_knows_the_length_before_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("profiles.h5");
        std::fs::write(&path, "half").unwrap();
        let lengths = RefCell::new(Vec::new());
        let go_on = |found| -> Result<(), Obstacle> {
            lengths.borrow_mut().push(found);
            std::fs::write(&path, "as long as it was committed").unwrap();
            Err(Obstacle::Unusable("rows are lost".to_owned()))
        };
        continue_or_create(&path, go_on, || Ok(())).unwrap();
        assert_eq!(*lengths.borrow(), [4, 4]);
    }
}
