//! Tables of results, and HDF5 files of them: one group for each table, containing one dataset for each column.
//!
//! Nothing in such a file depends on the machine or the time at which it was written.

use super::hdf5_file::SerialFile;
use super::table::{Rows, TableHead};
use super::whole_file::make_whole;
use super::{MessageResult, OutputError};
use std::path::Path;
use talcum_engine::fields::Column;

/// A table with all data needed to understand it by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultTable {
    /// Its name; in an HDF5 file the name of its group.
    pub name: String,
    /// Names and texts of its provenance.
    pub provenance: Vec<(String, String)>,
    /// Its columns, all of the same length.
    pub columns: Vec<TableColumn>,
}

/// A column of a table, with one cell for each row.
pub type TableColumn = Column<Cells, String>;

/// The cells of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Texts.
    Text(Vec<String>),
    /// Whole numbers.
    Whole(Vec<u64>),
    /// Numbers; NaN if there is none.
    Number(Vec<f64>),
}

impl Cells {
    /// Texts as numbers if all of them are numbers.
    pub fn of_values(values: Vec<String>) -> Self {
        let numbers: Result<Vec<f64>, _> = values.iter().map(|value| value.parse()).collect();
        // Seeds may have more digits than a floating-point number can hold.
        let whole: Result<Vec<u64>, _> = values.iter().map(|value| value.parse()).collect();
        match (whole, numbers) {
            (Ok(whole), _) => Self::Whole(whole),
            (_, Ok(numbers)) => Self::Number(numbers),
            _ => Self::Text(values),
        }
    }

    /// Feeds kind, length and every bit of the cells to a hash.
    fn hash_into(&self, hash: &mut blake3::Hasher) {
        let (kind, length) = match self {
            Self::Text(cells) => (0_u64, cells.len()),
            Self::Whole(cells) => (1, cells.len()),
            Self::Number(cells) => (2, cells.len()),
        };
        hash.update(&kind.to_le_bytes()).update(&(length as u64).to_le_bytes());
        match self {
            Self::Text(cells) => cells.iter().for_each(|text| hash_text(hash, text)),
            Self::Whole(cells) => cells.iter().for_each(|number| hash_bits(hash, *number)),
            // All undefined numbers are equal, and a zero has no sign.
            Self::Number(cells) => cells.iter().for_each(|number| {
                let number = if number.is_nan() { f64::NAN } else { number + 0.0 };
                hash_bits(hash, number.to_bits());
            }),
        }
    }
}

impl From<Vec<f64>> for Cells {
    fn from(numbers: Vec<f64>) -> Self {
        Self::Number(numbers)
    }
}

/// The unit of a column as it is hashed and stored: `1` if it has none.
fn unit_of(column: &TableColumn) -> &str {
    if column.unit.is_empty() { "1" } else { &column.unit }
}

impl ResultTable {
    /// A table with these columns.
    pub fn new(name: &str, columns: Vec<TableColumn>) -> Self {
        Self { name: name.to_owned(), provenance: Vec::new(), columns }
    }

    /// Hash of the contents of tables, names, units and cells, without their provenance: BLAKE3, in hexadecimal digits.
    pub fn digest_of(tables: &[Self]) -> String {
        let mut hash = blake3::Hasher::new();
        for table in tables {
            hash_text(&mut hash, &table.name);
            for column in &table.columns {
                hash_text(&mut hash, &column.name);
                hash_text(&mut hash, unit_of(column));
                column.values.hash_into(&mut hash);
            }
        }
        hash.finalize().to_hex().to_string()
    }

    /// Writes tables into an HDF5 file, replacing any existing one; it receives its name only when it is complete. The
    /// root has the provenance; texts with the same name are joined by line breaks.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_all(
        path: &Path,
        provenance: &[(String, String)],
        tables: &[Self],
    ) -> Result<(), OutputError> {
        make_whole(path, |partial| write(partial, provenance, tables))
            .map_err(|message| OutputError { path: path.to_owned(), message })
    }
}

fn hash_bits(hash: &mut blake3::Hasher, bits: u64) {
    hash.update(&bits.to_le_bytes());
}

fn hash_text(hash: &mut blake3::Hasher, text: &str) {
    hash.update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
}

fn write(
    path: &Path,
    provenance: &[(String, String)],
    tables: &[ResultTable],
) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    let mut joined: Vec<(&str, String)> = Vec::new();
    for (name, text) in provenance {
        match joined.iter_mut().find(|(known, _)| known == name) {
            Some((_, all)) => *all = format!("{all}\n{text}"),
            None => joined.push((name, text.clone())),
        }
    }
    for (name, text) in joined {
        file.set_text("/", name, &text)?;
    }
    for table in tables {
        file.make_group(&table.name)?;
        table.columns.iter().try_for_each(|column| write_column(&file, &table.name, column))?;
    }
    file.close()
}

fn write_column(file: &SerialFile, table: &str, column: &TableColumn) -> MessageResult<()> {
    let name = format!("{table}/{}", column.name);
    let (unit, description) = (unit_of(column), &*column.meaning);
    let head = TableHead { name: &name, shape: &[], unit, description };
    match &column.values {
        Cells::Text(texts) => file.make_texts(&head, texts),
        Cells::Whole(numbers) => {
            file.make_table::<u64>(&head, Rows::Fixed(numbers.len() as u64))?;
            file.fill(&name, numbers)
        }
        Cells::Number(numbers) => {
            file.make_table::<f64>(&head, Rows::Fixed(numbers.len() as u64))?;
            file.fill(&name, numbers)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_numbers_only_if_all_are() {
        let cells = |values: [&str; 2]| Cells::of_values(values.map(str::to_owned).to_vec());
        assert_eq!(cells(["1", "2"]), Cells::Whole(vec![1, 2]));
        assert_eq!(cells(["1", "0.5"]), Cells::Number(vec![1.0, 0.5]));
        assert!(matches!(cells(["1", "on"]), Cells::Text(_)));
    }
}
