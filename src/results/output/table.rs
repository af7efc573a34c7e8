//! Description of a dataset, independent of HDF5.

/// Name, shape and meaning of a dataset.
#[derive(Clone, Copy)]
pub(super) struct TableHead<'a> {
    /// Path in the file.
    pub(super) name: &'a str,
    /// Number of values in a row; 1 for a plain column.
    pub(super) width: usize,
    /// Name of the unit; `1` for pure numbers.
    pub(super) unit: &'a str,
    /// Meaning.
    pub(super) description: &'a str,
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
