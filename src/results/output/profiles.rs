//! Profiles over height and time for space-time plots: `profiles.h5`, written by rank 0. The file is closed after each
//! row, so that it can be read during the run; at each checkpoint its rows are secured against a kill.

use std::path::{Path, PathBuf};

use super::hdf5_file::SerialFile;
use super::output_file::{Obstacle, continue_or_create, rows_up_to};
use super::table::{Rows, TableHead, over_time};
use super::{
    Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind, Sample,
    metadata_copy, on_root,
};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;

/// Number of rows that are stored in one chunk.
const PIECE: usize = 64;

/// The columns that grow with time, for a grid of so many nodes.
fn columns(nodes: usize) -> [Column; 4] {
    let over_height =
        |name, unit, meaning| Column::array(name, &[nodes], unit, meaning).along(&["height"]);
    [
        Column::scalar("time", Unit::Time, "time"),
        Column::scalar("superficial_velocity", Unit::Speed, "superficial gas velocity"),
        over_height("solids_fraction", Unit::One, "solids volume fraction"),
        over_height("solids_velocity", Unit::Speed, "mean solids velocity, up"),
    ]
}

/// The paths of their datasets.
fn growing() -> [String; 4] {
    columns(0).map(|column| format!("/{}", column.name))
}

/// Profiles at one time.
#[derive(Clone, Copy, Debug)]
pub struct ProfileRow<'a> {
    /// Time.
    pub time: f64,
    /// Superficial gas velocity.
    pub superficial_velocity: f64,
    /// Solids volume fraction at the nodes.
    pub solids_fraction: &'a [f64],
    /// Mean vertical velocity of the solids at the nodes.
    pub solids_velocity: &'a [f64],
}

/// The file of profiles.
#[derive(Clone, Debug)]
pub struct Profiles {
    path: PathBuf,
    nodes: usize,
}

impl Profiles {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "profiles.h5", needs_momentum_before: false, open: Self::open };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let grid = opening.profile_grid;
        let heights: Vec<f64> = (0..grid.nodes()).map(|node| grid.height_of(node)).collect();
        let profiles = match opening.continue_after {
            Some(time) => Self::resume(path, time, &heights, opening.head, ranks)?,
            None => Self::create(path, &heights, opening.head, ranks)?,
        };
        Ok(Some(Box::new(profiles)))
    }

    /// Begins a file for profiles at the given heights, replacing any existing one. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        heights: &[f64],
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || create(path, heights, head))?;
        Ok(Self { path: path.to_owned(), nodes: heights.len() })
    }

    /// Continues a file in its last committed state, after the rows up to and including `time`; later ones are dropped.
    /// A file that cannot be read, or has other heights, is set aside. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        heights: &[f64],
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || {
            let kept =
                continue_or_create(path, |found| cut_after(path, time, heights, found), || Ok(0))?;
            if kept > 0 {
                metadata_copy::commit(path, &bulk())
            } else {
                create(path, heights, head)
            }
        })?;
        Ok(Self { path: path.to_owned(), nodes: heights.len() })
    }

    /// Adds a row; that of rank 0 is written. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&self, row: &ProfileRow, ranks: &dyn Communicator) -> Result<(), OutputError> {
        on_root(&self.path, ranks, || {
            if [row.solids_fraction.len(), row.solids_velocity.len()] != [self.nodes; 2] {
                return Err(format!("a profile needs a value at each of {} nodes", self.nodes));
            }
            let file = SerialFile::open_to_change(&self.path)?;
            file.append("/superficial_velocity", &[row.superficial_velocity])?;
            file.append("/solids_fraction", row.solids_fraction)?;
            file.append("/solids_velocity", row.solids_velocity)?;
            // The time comes last: a row without a time does not count.
            file.append("/time", &[row.time])?;
            file.close()
        })?;
        Ok(())
    }
}

impl Output for Profiles {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let bed = sample.profile.bed();
        let row = ProfileRow {
            time: sample.row.time,
            superficial_velocity: sample.row.superficial_velocity,
            solids_fraction: &bed.solids_fraction,
            solids_velocity: &bed.solids_velocity,
        };
        self.append(&row, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &bulk(), ranks)
    }
}

/// The tables that are not copied at checkpoints: all except the times.
fn bulk() -> Vec<String> {
    growing()[1..].to_vec()
}

fn create(path: &Path, heights: &[f64], head: Head<'_>) -> MessageResult<()> {
    metadata_copy::create(path, &bulk(), |path| make(path, heights, head))
}

fn make(path: &Path, heights: &[f64], head: Head<'_>) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/", name, &entry)?;
    }
    file.set_text("/", "case", head.case_text)?;
    let units = head.units();
    let height = Column::scalar("height", Unit::Length, "heights of the grid's nodes");
    let rows = Rows::Fixed(heights.len() as u64);
    file.make_table::<f64>(&TableHead::of_column("/height", &height, units), rows)?;
    file.fill("/height", heights)?;
    let columns = columns(heights.len());
    for (path, column) in growing().iter().zip(&columns) {
        let head = TableHead::of_column(path, column, units);
        file.make_table::<f64>(&head, Rows::Growing(PIECE))?;
    }
    file.set_scales(&columns[1..].iter().map(|column| over_time("", column)).collect::<Vec<_>>())?;
    file.close()
}

/// Drops the rows after a time; returns how many are left. If none are left, the file is unchanged: a new one replaces
/// it.
fn cut_after(path: &Path, time: f64, heights: &[f64], found_length: u64) -> Result<u64, Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let rows = rows_to_keep(path, time, heights, found_length).map_err(Obstacle::Unusable)?;
    if rows > 0 {
        cut(path, rows).map_err(Obstacle::Failed)?;
    }
    Ok(rows)
}

fn rows_to_keep(path: &Path, time: f64, heights: &[f64], found_length: u64) -> MessageResult<u64> {
    let file = SerialFile::open(path)?;
    let same_bits = |a: &f64, b: &f64| a.to_bits() == b.to_bits();
    let stored: Vec<f64> = file.read("/height")?;
    if stored.len() != heights.len() || !stored.iter().zip(heights).all(|(a, b)| same_bits(a, b)) {
        return Err("its heights are others".to_owned());
    }
    let times: Vec<f64> = file.read("/time")?;
    let rows = rows_up_to(&times, time)? as u64;
    let require = |name: &String| metadata_copy::require_rows(&file, name, rows, found_length);
    growing().iter().try_for_each(require)?;
    file.close()?;
    Ok(rows)
}

fn cut(path: &Path, rows: u64) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    growing().iter().try_for_each(|name| file.cut(name, rows))?;
    file.close()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Provenance;
    use talcum_engine::parallel::{OneRank, run_on_threads};

    fn head(provenance: &Provenance) -> Head<'_> {
        Head { case_text: "title = 1", provenance }
    }

    fn append(profiles: &Profiles, step: u32, ranks: &dyn Communicator) {
        let x = f64::from(step);
        let (fraction, velocity) = ([x, 2.0 * x, 3.0 * x], [-x, 0.0, x]);
        let row = ProfileRow {
            time: 0.1 * x,
            superficial_velocity: 0.01,
            solids_fraction: &fraction,
            solids_velocity: &velocity,
        };
        profiles.append(&row, ranks).unwrap();
    }

    fn contents(path: &Path) -> Vec<Vec<f64>> {
        let file = SerialFile::open(path).unwrap();
        growing().iter().map(|name| file.read(name).unwrap()).collect()
    }

    #[test]
    fn a_resume_that_was_itself_killed_leaves_no_false_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("profiles.h5");
        let heights = [0.5, 1.5, 2.5];
        let provenance = Provenance::here_and_now("A bed", "si", &OneRank);
        let profiles = Profiles::create(&path, &heights, head(&provenance), &OneRank).unwrap();
        (0..200).for_each(|step| append(&profiles, step, &OneRank));
        profiles.commit(&OneRank).unwrap();
        // Truncated within a chunk, and over several, without the commit that would have followed.
        for kept in [190_u32, 100, 41] {
            let time = 0.1 * f64::from(kept - 1);
            cut_after(&path, time, &heights, u64::MAX).unwrap();
            assert!(metadata_copy::restore(&path).is_ok());
            Profiles::resume(&path, time, &heights, head(&provenance), &OneRank).unwrap();
            let times = contents(&path).swap_remove(0);
            let expected: Vec<f64> = (0..kept).map(|step| 0.1 * f64::from(step)).collect();
            assert_eq!(times, expected);
        }
        assert!(!folder.path().join("profiles.h5.unreadable-1").exists());
    }

    #[test]
    fn a_resumed_file_is_that_of_an_uninterrupted_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("profiles.h5");
        let heights = [0.5, 1.5, 2.5];
        run_on_threads(2, |ranks| {
            let provenance = Provenance::here_and_now("A bed", "si", ranks);
            let profiles = Profiles::create(&path, &heights, head(&provenance), ranks);
            let profiles = profiles.unwrap();
            (0..100).for_each(|step| append(&profiles, step, ranks));
            profiles.commit(ranks).unwrap();
        });
        let whole = contents(&path);
        assert_eq!(whole[2].len(), 300);
        run_on_threads(2, |ranks| {
            let provenance = Provenance::here_and_now("A bed", "si", ranks);
            let (time, head) = (0.1 * 70.0, head(&provenance));
            let profiles = Profiles::resume(&path, time, &heights, head, ranks).unwrap();
            let rows = if ranks.is_root() { contents(&path)[0].len() } else { 71 };
            assert_eq!(rows, 71);
            (71..100).for_each(|step| append(&profiles, step, ranks));
            profiles.commit(ranks).unwrap();
        });
        assert_eq!(contents(&path), whole);
        let other = [0.5, 1.5];
        run_on_threads(1, |ranks| {
            let provenance = Provenance::here_and_now("A bed", "si", ranks);
            Profiles::resume(&path, 7.0, &other, head(&provenance), ranks).unwrap();
        });
        assert_eq!(contents(&folder.path().join("profiles.h5.unreadable-1")), whole);
        assert_eq!(contents(&path)[0].len(), 0);
    }
}
