//! What is in a file: its datasets, and how each is filled.

use crate::output::hdf5_file::SerialFile;
use crate::output::table::{Rows, TableHead};
use crate::output::{ColumnUnits, MessageResult, SnapshotStorage};
use std::borrow::Cow;
use talcum_engine::fields::Column;

/// Rows of indices that are stored as one piece.
const INDEX_PIECE: usize = 256;

/// A kind of file.
#[derive(Clone, Debug)]
pub(crate) struct FileTable {
    /// What VTK calls its data.
    pub(crate) file_type: FileType,
    /// The group of the data that are shown, below `/VTKHDF`.
    pub(crate) data: &'static str,
    /// The dataset of the number of items at each time, below `/VTKHDF`; one item if there is none.
    pub(crate) counts: Option<&'static str>,
    /// Rows of items that are stored as one piece.
    pub(crate) piece: usize,
    /// How numbers of items are held.
    pub(crate) storage: SnapshotStorage,
    /// Its datasets.
    pub(crate) datasets: Vec<Dataset>,
}

/// What VTK calls the data of a file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FileType {
    /// Points, and cells of them.
    PolyData,
    /// Equal cells.
    ImageData(ImageCells),
}

/// The cells of an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageCells {
    pub(crate) origin: [f64; 3],
    pub(crate) spacing: [f64; 3],
    /// Number of cells along x, y and z.
    pub(crate) counts: [usize; 3],
}

/// A dataset that grows.
#[derive(Clone, Debug)]
pub(crate) struct Dataset {
    /// Its path below `/VTKHDF`.
    pub(crate) name: String,
    pub(crate) numbers: Numbers,
    /// Shape of a row; empty for one number.
    pub(crate) shape: Vec<usize>,
    pub(crate) unit: &'static str,
    pub(crate) description: Cow<'static, str>,
    pub(crate) fill: Fill,
}

/// The numbers of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// Integers of 8 bytes.
    Whole,
    /// Of 8 bytes, or of 4 if items are held so.
    Real,
}

/// How a dataset is filled.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fill {
    /// By the owner of the file: so many rows for each item, and for each time in addition.
    Rows {
        /// Rows of an item.
        per_item: u64,
        /// Further rows of a time.
        per_time: u64,
    },
    /// With the times.
    Times,
    /// With these numbers at each time.
    Index(Vec<Term>),
    /// With 0, 1, 2, ... up to the number of items at any time.
    Counting,
    /// Not at all.
    Never,
}

impl Fill {
    /// A row for each item.
    pub(crate) const ITEMS: Self = Self::Rows { per_item: 1, per_time: 0 };
}

/// A number of an index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Term {
    /// 0.
    Zero,
    /// 1.
    One,
    /// The number of the time, from 0.
    Step,
    /// The first item of the time, times this.
    First(u64),
    /// The number of items at the time, times this.
    Count(u64),
}

/// A column of the items of a file, taken from their records; its name is the path below `/VTKHDF`.
pub(crate) type RecordColumn<T> = Column<fn(&T) -> &[f64]>;

/// The numbers of a column in these records, one after another.
pub(crate) fn numbers_in<T>(column: &RecordColumn<T>, records: &[T]) -> Vec<f64> {
    records.iter().flat_map(column.values).copied().collect()
}

impl Dataset {
    /// A column of the items, in a group below `/VTKHDF`.
    pub(crate) fn of_column<V>(
        group: &str,
        column: &Column<V>,
        numbers: Numbers,
        units: ColumnUnits,
    ) -> Self {
        let (name, unit) = (format!("{group}{}", column.name), units.of(column.unit));
        Self::of_items(name, numbers, column.width(), unit, column.meaning.clone())
    }

    /// A row of so many numbers for each item.
    pub(crate) fn of_items(
        name: impl Into<String>,
        numbers: Numbers,
        width: usize,
        unit: &'static str,
        description: impl Into<Cow<'static, str>>,
    ) -> Self {
        let shape = if width == 1 { Vec::new() } else { vec![width] };
        let (name, description) = (name.into(), description.into());
        Self { name, numbers, shape, unit, description, fill: Fill::ITEMS }
    }

    /// Integers of one row for each time, or of several.
    pub(crate) fn index(
        name: impl Into<String>,
        terms: &[Term],
        description: &'static str,
    ) -> Self {
        let fill = Fill::Index(terms.to_vec());
        Self { fill, ..Self::of_items(name, Numbers::Whole, 1, "1", description) }
    }

    /// The times.
    pub(crate) fn times(unit: &'static str, description: &'static str) -> Self {
        let name = "Steps/Values";
        Self { fill: Fill::Times, ..Self::of_items(name, Numbers::Real, 1, unit, description) }
    }

    /// Its path in the file.
    pub(crate) fn path(&self) -> String {
        format!("/VTKHDF/{}", self.name)
    }

    /// Makes it in a file.
    pub(super) fn make(&self, file: &SerialFile, table: &FileTable) -> MessageResult<()> {
        let path = self.path();
        let (unit, description) = (self.unit, &*self.description);
        let head = TableHead { name: &path, shape: &self.shape, unit, description };
        let (storage, rows) = match self.fill {
            Fill::Rows { .. } => (table.storage, table.storage.rows(table.piece)),
            Fill::Counting => (SnapshotStorage::default(), Rows::Growing(table.piece)),
            _ => (SnapshotStorage::default(), Rows::Growing(INDEX_PIECE)),
        };
        match self.numbers {
            Numbers::Whole => file.make_table::<i64>(&head, rows),
            Numbers::Real if storage.single_precision => file.make_table::<f32>(&head, rows),
            Numbers::Real => file.make_table::<f64>(&head, rows),
        }
    }

    /// Whether the owner of the file fills it.
    pub(super) fn holds_items(&self) -> bool {
        matches!(self.fill, Fill::Rows { .. })
    }
}

/// The index of data that are shown: where the items of each time begin in each of them.
pub(crate) fn data_offsets(
    data: &'static str,
    datasets: &[Dataset],
    description: &'static str,
) -> Vec<Dataset> {
    let names = datasets.iter().filter_map(|dataset| dataset.name.strip_prefix(data));
    let index = |name| format!("Steps/{data}Offsets{name}");
    names.map(|name| Dataset::index(index(name), &[Term::First(1)], description)).collect()
}
