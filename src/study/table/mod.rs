//! Tables of results, written as CSV.

mod collect;
pub(crate) mod csv;
mod replicates;
mod searches;

pub(crate) use collect::collect;
pub(crate) use replicates::Replicates;

/// A table with what is needed to understand it alone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table {
    /// Its name, and that of its file.
    pub(crate) name: &'static str,
    /// Names and texts of what it came from.
    pub(crate) provenance: Vec<(String, String)>,
    /// Its columns, all of one length.
    pub(crate) columns: Vec<Column>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    /// Its name.
    pub(crate) name: String,
    /// The unit of its numbers, if they have one.
    pub(crate) unit: Option<String>,
    /// What it means.
    pub(crate) description: String,
    /// One cell for each row.
    pub(crate) cells: Cells,
}

/// The cells of a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cells {
    /// Texts.
    Text(Vec<String>),
    /// Whole numbers.
    Whole(Vec<u64>),
    /// Numbers; not a number where there is none.
    Number(Vec<f64>),
}

impl Cells {
    /// Texts as numbers if all of them are numbers.
    pub(crate) fn of_values(values: Vec<String>) -> Self {
        let numbers: Result<Vec<f64>, _> = values.iter().map(|value| value.parse()).collect();
        // Seeds may have more digits than a floating-point number holds.
        let whole: Result<Vec<u64>, _> = values.iter().map(|value| value.parse()).collect();
        match (whole, numbers) {
            (Ok(whole), _) => Self::Whole(whole),
            (_, Ok(numbers)) => Self::Number(numbers),
            _ => Self::Text(values),
        }
    }
}

impl Column {
    /// A column without a unit.
    pub(crate) fn new(name: &str, description: &str, cells: Cells) -> Self {
        let (name, description) = (name.to_owned(), description.to_owned());
        Self { name, unit: None, description, cells }
    }
}
