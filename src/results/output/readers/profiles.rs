//! Reader of `profiles.h5`.

use super::{reading, rising};
use crate::output::hdf5_file::SerialFile;
use crate::output::{MessageResult, OutputError};
use std::path::Path;

/// Profiles over height and time.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileTable {
    /// Heights of the nodes.
    pub heights: Vec<f64>,
    /// Times of the rows, ascending.
    pub times: Vec<f64>,
    /// Superficial gas velocity at these times.
    pub superficial_velocities: Vec<f64>,
    /// Solids fraction, \[time * nodes + node\].
    pub solids_fractions: Vec<f64>,
    /// Mean vertical velocity of the solids, likewise.
    pub solids_velocities: Vec<f64>,
}

impl ProfileTable {
    /// Reads the file.
    ///
    /// # Errors
    /// If it cannot be read, or is not such a file.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        reading(path, read)
    }

    /// The solids fraction over the height at the time of a row.
    pub fn solids_fraction(&self, row: usize) -> &[f64] {
        let nodes = self.heights.len();
        &self.solids_fractions[row * nodes..(row + 1) * nodes]
    }

    /// The rows within a range of times, both ends included.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let first = self.times.partition_point(|&time| time < from);
        let end = self.times.partition_point(|&time| time <= to).max(first);
        let nodes = self.heights.len();
        let blocks = |all: &[f64]| all[first * nodes..end * nodes].to_vec();
        Self {
            heights: self.heights.clone(),
            times: self.times[first..end].to_vec(),
            superficial_velocities: self.superficial_velocities[first..end].to_vec(),
            solids_fractions: blocks(&self.solids_fractions),
            solids_velocities: blocks(&self.solids_velocities),
        }
    }
}

fn read(file: &SerialFile) -> MessageResult<ProfileTable> {
    let heights: Vec<f64> = file.read("/height")?;
    let nodes = heights.len();
    let times: Vec<f64> = file.read("/time")?;
    let velocities: Vec<f64> = file.read("/superficial_velocity")?;
    let [fractions, solids] = ["/solids_fraction", "/solids_velocity"].map(|name| {
        let (rows, width) = file.shape(name)?;
        if width != nodes || nodes == 0 {
            return Err(format!(
                "{name} has {width} numbers in a row, but there are {nodes} heights"
            ));
        }
        Ok((rows as usize, file.read::<f64>(name)?))
    });
    let ((fraction_rows, mut fractions), (solids_rows, mut solids)) = (fractions?, solids?);
    let rows = [times.len(), velocities.len(), fraction_rows, solids_rows];
    let rows = rows.into_iter().min().unwrap_or(0);
    let rows = rising(&times[..rows]);
    fractions.truncate(rows * nodes);
    solids.truncate(rows * nodes);
    Ok(ProfileTable {
        heights,
        times: times[..rows].to_vec(),
        superficial_velocities: velocities[..rows].to_vec(),
        solids_fractions: fractions,
        solids_velocities: solids,
    })
}
