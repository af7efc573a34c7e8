//! Reader of `gas.vtkhdf`, one time after another.

use super::{reading, rising};
use crate::output::OutputError;
use crate::output::vtkhdf::listed_times;
use std::path::{Path, PathBuf};

/// The snapshots of a file: their times, and the cells.
#[derive(Clone, Debug, PartialEq)]
pub struct GasSnapshotReader {
    path: PathBuf,
    /// Times of the snapshots, ascending.
    pub times: Vec<f64>,
    first: u64,
    /// Cells along x, y and z.
    pub cells: [usize; 3],
    /// Size of a cell.
    pub spacing: [f64; 3],
}

impl GasSnapshotReader {
    /// Reads times and grid.
    ///
    /// # Errors
    /// If the file cannot be read, or is not such a file.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        reading(path, |file| {
            let mut times = listed_times(file)?;
            times.truncate(rising(&times));
            let extent: [i64; 6] = file.numbers("/VTKHDF", "WholeExtent")?;
            let cells = [1, 3, 5].map(|end| usize::try_from(extent[end]).unwrap_or(0));
            let spacing: [f64; 3] = file.numbers("/VTKHDF", "Spacing")?;
            let (rows, width) = file.shape("/VTKHDF/CellData/voidage")?;
            if width != cells.iter().product::<usize>() {
                return Err(format!("voidages are {width} at a time, but the cells {cells:?}"));
            }
            times.truncate(rows as usize);
            Ok(Self { path: path.to_owned(), times, first: 0, cells, spacing })
        })
    }

    /// The snapshots within a range of times, both ends included.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let first = self.times.partition_point(|&time| time < from);
        let end = self.times.partition_point(|&time| time <= to).max(first);
        let times = self.times[first..end].to_vec();
        Self { times, first: self.first + first as u64, ..self.clone() }
    }

    /// The voidage in each cell of a snapshot, \[(z * ny + y) * nx + x\].
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn voidage(&self, number: usize) -> Result<Vec<f64>, OutputError> {
        let row = self.first + number as u64;
        reading(&self.path, |file| file.read_rows("/VTKHDF/CellData/voidage", row, 1))
    }
}
