//! What a dataset is, apart from HDF5.

/// Name, shape and meaning of a dataset.
#[derive(Clone, Copy)]
pub(super) struct TableHead<'a> {
    /// Path in the file.
    pub(super) name: &'a str,
    /// Numbers in a row; 1 for a plain column.
    pub(super) width: usize,
    /// Name of the unit; `1` for pure numbers.
    pub(super) unit: &'a str,
    /// Meaning.
    pub(super) description: &'a str,
}

/// How many rows a dataset has.
#[derive(Clone, Copy)]
pub(super) enum Rows {
    /// So many, from the start.
    Fixed(u64),
    /// None yet; stored in pieces of so many rows.
    Growing(usize),
    /// Compressed pieces; every piece may be written at one time only.
    Compressed {
        /// Rows of a piece.
        piece: usize,
        /// How hard, from 1 to 9.
        level: u8,
    },
}
