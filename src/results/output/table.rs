//! Descriptions of datasets.

use super::ColumnUnits;
use talcum_engine::fields::Column;

/// Name, shape and meaning of a dataset.
#[derive(Clone, Copy)]
pub(super) struct TableHead<'a> {
    /// Path in the file.
    pub(super) name: &'a str,
    /// Shape of a row; empty for one value.
    pub(super) shape: &'a [usize],
    /// Name of the unit; `1` for pure numbers.
    pub(super) unit: &'a str,
    /// Meaning.
    pub(super) description: &'a str,
}

impl<'a> TableHead<'a> {
    /// The dataset of a column at a path.
    pub(super) fn of_column<V>(name: &'a str, column: &'a Column<V>, units: ColumnUnits) -> Self {
        let (unit, description) = (units.of(column.unit), &column.meaning);
        Self { name, shape: &column.shape, unit, description }
    }
}

/// A dataset, with the scales of its first dimensions; its other dimensions have none.
pub(super) type ScaledTable = (String, Vec<String>);

/// The dataset of a column in a group, and those that contain the times of its rows and the coordinates of its arrays.
pub(super) fn over_time(group: &str, column: &Column) -> ScaledTable {
    let along = column.along.iter().map(|name| format!("/{name}"));
    let scales = std::iter::once(format!("{group}/time")).chain(along).collect();
    (format!("{group}/{}", column.name), scales)
}

/// Number of rows of a dataset.
#[derive(Clone, Copy)]
pub(super) enum Rows {
    /// A fixed number of rows.
    Fixed(u64),
    /// No rows yet; stored in chunks of this number of rows.
    Growing(usize),
    /// Compressed chunks; every chunk must be written at once.
    Compressed {
        /// Number of rows of a chunk.
        piece: usize,
        /// Level of compression, from 1 to 9.
        level: u8,
    },
}
