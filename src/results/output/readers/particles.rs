//! Reader of `particles.vtkhdf`, one snapshot at a time.

use super::{reading, rising};
use crate::output::OutputError;
use crate::output::vtkhdf::{listed_times, whole_numbers};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The snapshots of a file: their times, and the places of their rows.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSnapshotReader {
    path: PathBuf,
    /// Times of the snapshots, ascending.
    pub times: Vec<f64>,
    rows: Vec<Range<u64>>,
}

/// The particles at one time, by ascending id.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSnapshot {
    /// Global ids.
    pub ids: Vec<u64>,
    /// Centres, inside the box.
    pub positions: Vec<[f64; 3]>,
    /// Velocities of the centres.
    pub velocities: Vec<[f64; 3]>,
    /// Radii.
    pub radii: Vec<f64>,
    /// Masses, if the file has them.
    pub masses: Option<Vec<f64>>,
}

impl ParticleSnapshotReader {
    /// Reads the times.
    ///
    /// # Errors
    /// If the file cannot be read, or is not such a file.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let (times, rows) = reading(path, |file| {
            let mut times = listed_times(file)?;
            let firsts = whole_numbers(file, "Steps/PointOffsets")?;
            let counts = whole_numbers(file, "NumberOfPoints")?;
            times.truncate(firsts.len().min(counts.len()));
            times.truncate(rising(&times));
            let rows = firsts.iter().zip(&counts).map(|(first, count)| *first..first + count);
            let rows: Vec<Range<u64>> = rows.take(times.len()).collect();
            Ok((times, rows))
        })?;
        Ok(Self { path: path.to_owned(), times, rows })
    }

    /// The snapshots within a range of times, both ends included.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let first = self.times.partition_point(|&time| time < from);
        let end = self.times.partition_point(|&time| time <= to).max(first);
        let (times, rows) = (self.times[first..end].to_vec(), self.rows[first..end].to_vec());
        Self { path: self.path.clone(), times, rows }
    }

    /// The number of particles in a snapshot.
    pub fn particles(&self, number: usize) -> u64 {
        self.rows[number].end - self.rows[number].start
    }

    /// Reads the particles of a snapshot.
    ///
    /// # Errors
    /// If its rows cannot be read, or are not those of particles by ascending id.
    pub fn snapshot(&self, number: usize) -> Result<ParticleSnapshot, OutputError> {
        let Range { start, end } = self.rows[number];
        reading(&self.path, |file| {
            let numbers = |name: &str| file.read_rows::<f64>(name, start, end - start);
            let vectors = |name: &str| -> Result<Vec<[f64; 3]>, String> {
                let vector = |numbers: &[f64]| [numbers[0], numbers[1], numbers[2]];
                Ok(numbers(name)?.chunks_exact(3).map(vector).collect())
            };
            let ids: Vec<i64> = file.read_rows("/VTKHDF/PointData/id", start, end - start)?;
            if !ids.is_sorted_by(|a, b| a < b) || ids.first().is_some_and(|&first| first < 0) {
                let time = self.times[number];
                return Err(format!("the ids at time {time} do not ascend: the file is damaged"));
            }
            let shown = file.names("/VTKHDF/PointData")?.iter().any(|name| name == "mass");
            Ok(ParticleSnapshot {
                ids: ids.into_iter().map(|id| id as u64).collect(),
                positions: vectors("/VTKHDF/Points")?,
                velocities: vectors("/VTKHDF/PointData/velocity")?,
                radii: numbers("/VTKHDF/PointData/radius")?,
                masses: shown.then(|| numbers("/VTKHDF/PointData/mass")).transpose()?,
            })
        })
    }
}
