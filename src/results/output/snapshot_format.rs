//! Number format of snapshots, and their columns in addition to the standard ones.

use super::table::Rows;
use talcum_engine::fields::{Column, Kind};

/// Number format of snapshots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnapshotStorage {
    /// Whether a number takes 4 bytes instead of 8.
    pub single_precision: bool,
    /// Level of compression: from 0, none, to 9.
    pub compression: u8,
}

impl SnapshotStorage {
    /// Growing rows, in chunks of a given number.
    pub(super) fn rows(self, piece: usize) -> Rows {
        match self.compression {
            0 => Rows::Growing(piece),
            level => Rows::Compressed { piece, level },
        }
    }
}

/// An additional column for each particle in snapshots, with the kind of its numbers.
pub type PointColumn = Column<Kind>;

/// Settings common to all snapshots of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SnapshotFormat {
    /// The additional columns for each particle.
    pub columns: Vec<PointColumn>,
    /// Number format.
    pub storage: SnapshotStorage,
}
