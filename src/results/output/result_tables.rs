//! Tables of results, and HDF5 files of them: one group for each table, containing one dataset for each column.
//!
//! Nothing in such a file depends on the machine or the time at which it was written.

use super::hdf5_file::SerialFile;
use super::table::{Rows, TableHead};
use super::whole_file::make_whole;
use super::{MessageResult, OutputError};
use std::path::Path;

/// A table with all data needed to understand it by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultTable {
    /// Its name; in an HDF5 file the name of its group.
    pub name: String,
    /// Names and texts of its provenance.
    pub provenance: Vec<(String, String)>,
    /// Its columns, all of the same length.
    pub columns: Vec<Column>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The unit of its numbers, if they have one.
    pub unit: Option<String>,
    /// Its meaning.
    pub description: String,
    /// One cell for each row.
    pub cells: Cells,
}

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

impl Column {
    /// A column without a unit.
    pub fn new(name: &str, description: &str, cells: Cells) -> Self {
        let (name, description) = (name.to_owned(), description.to_owned());
        Self { name, unit: None, description, cells }
    }

    /// A column of numbers with their unit.
    pub fn numbers(name: &str, unit: &str, description: &str, numbers: Vec<f64>) -> Self {
        let column = Self::new(name, description, Cells::Number(numbers));
        Self { unit: Some(unit.to_owned()), ..column }
    }
}

impl ResultTable {
    /// A table with these columns.
    pub fn new(name: &str, columns: Vec<Column>) -> Self {
        Self { name: name.to_owned(), provenance: Vec::new(), columns }
    }

    /// Hash of the contents of tables, names, units and cells, without their provenance: BLAKE3, in hexadecimal digits.
    pub fn digest_of(tables: &[Self]) -> String {
        let mut hash = blake3::Hasher::new();
        for table in tables {
            hash_text(&mut hash, &table.name);
            for column in &table.columns {
                hash_text(&mut hash, &column.name);
                hash_text(&mut hash, column.unit.as_deref().unwrap_or("1"));
                column.cells.hash_into(&mut hash);
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

fn write_column(file: &SerialFile, table: &str, column: &Column) -> MessageResult<()> {
    let name = format!("{table}/{}", column.name);
    let unit = column.unit.as_deref().unwrap_or("1");
    let head = TableHead { name: &name, width: 1, unit, description: &column.description };
    match &column.cells {
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
