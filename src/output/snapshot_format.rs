//! How snapshots hold numbers, and what they show beside what they always show.

use super::ColumnUnits;
use super::table::Rows;
use crate::fields::{Field, Kind};

/// How snapshots hold numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnapshotStorage {
    /// Whether a number takes 4 bytes in place of 8.
    pub single_precision: bool,
    /// How hard numbers are compressed: from 0, not at all, to 9.
    pub compression: u8,
}

impl SnapshotStorage {
    /// Growing rows, in pieces of so many.
    pub(super) fn rows(self, piece: usize) -> Rows {
        match self.compression {
            0 => Rows::Growing(piece),
            level => Rows::Compressed { piece, level },
        }
    }
}

/// What snapshots show of each particle, beside what they always show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointColumn {
    /// Name of its dataset.
    pub name: &'static str,
    /// Numbers for each particle.
    pub width: usize,
    /// Whether they are whole.
    pub is_whole: bool,
    /// Name of their unit.
    pub unit: &'static str,
    /// What they mean.
    pub description: &'static str,
}

impl PointColumn {
    /// The column of a field of the particles.
    pub fn of_field(field: &Field, units: &ColumnUnits) -> Self {
        Self {
            name: field.name,
            width: field.width(),
            is_whole: field.kind == Kind::Integer,
            unit: units.of_unit(field.unit),
            description: field.meaning,
        }
    }
}

/// What is common to all snapshots of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SnapshotFormat {
    /// What they show of each particle, beside what they always show.
    pub columns: Vec<PointColumn>,
    /// How they hold numbers.
    pub storage: SnapshotStorage,
}
