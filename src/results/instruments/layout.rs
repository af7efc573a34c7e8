//! Contents of the files of an instrument: plain data, which the instrument declares once.

use talcum_engine::fields::Column;

/// The files of an instrument.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Arrays that do not change, such as the heights of a profile.
    pub fixed: Vec<Column<Vec<f64>>>,
    /// Tables that grow with time. The first is called `results`: it has a row for each result.
    pub tables: Vec<Table>,
    /// Fields on cells for ParaView, if there are any.
    pub image: Option<Image>,
    /// Whether there are lines from particle to particle for ParaView.
    pub lines: bool,
}

impl Layout {
    /// The columns of `results` with one number in a row: those for tables over many runs.
    pub fn scalars(&self) -> impl Iterator<Item = &Column> {
        let results = self.tables.first().map(|table| table.columns.as_slice());
        results.unwrap_or_default().iter().filter(|column| column.shape.is_empty())
    }
}

/// A table that grows with time: a group of datasets with equally many rows. The first one, `time`, is in every table
/// and is not declared.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the group.
    pub name: &'static str,
    /// Its columns.
    pub columns: Vec<Column>,
}

/// Fields on equal cells of a box.
#[derive(Clone, Debug)]
pub struct Image {
    /// The lowest corner.
    pub origin: [f64; 3],
    /// Edge lengths of a cell.
    pub spacing: [f64; 3],
    /// Number of cells along x, y and z.
    pub counts: [usize; 3],
    /// The fields; each has one component, three, or nine (a tensor by rows).
    pub fields: Vec<Column>,
}

/// Rows of a table at one time, on rank 0; nothing on the others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Number of the table in the layout.
    pub table: usize,
    /// Number of rows.
    pub count: usize,
    /// The values of each column, one row after another.
    pub values: Vec<Vec<f64>>,
}

impl Rows {
    /// One row, column by column.
    pub fn one(table: usize, values: Vec<Vec<f64>>) -> Self {
        Self { table, count: 1, values }
    }

    /// Rows of numbers.
    pub fn of<const N: usize>(table: usize, rows: &[[f64; N]]) -> Self {
        let column = |k: usize| rows.iter().map(|row| row[k]).collect();
        Self { table, count: rows.len(), values: (0..N).map(column).collect() }
    }
}
