//! Runs that were made elsewhere, of which only a table `runs.csv` is left.
//!
//! A run of the study that stands in such a table is not made again: its digest and its quantities are taken from there.
//! The identity says that it is the same run, the head of the table that the same things were measured on it.

use crate::study::quantity::{Measured, NamedQuantity, Value};
use csv::{Reader, ReaderBuilder, StringRecord};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Runs that are known from tables.
#[derive(Debug, Default)]
pub(crate) struct KnownRuns {
    by_identity: HashMap<String, KnownRun>,
}

/// Data in a table on a complete run.
#[derive(Debug)]
pub(crate) struct KnownRun {
    /// The digest of its last state.
    pub(crate) digest: String,
    measured: HashMap<String, Measured>,
    provenance: Vec<(String, String)>,
}

impl KnownRun {
    /// A quantity of it.
    ///
    /// # Errors
    /// If the table has no measure of that name.
    pub(crate) fn measure(&self, name: &str) -> Result<Measured, String> {
        self.measured.get(name).cloned().ok_or_else(|| format!("there is no quantity {name}"))
    }

    /// A line of provenance of the runs of its table, for example `commit`.
    pub(crate) fn provenance(&self, name: &str) -> Vec<String> {
        let entry = self.provenance.iter().find(|(known, _)| known == name);
        entry.map(|(_, text)| text.split(", ").map(str::to_owned).collect()).unwrap_or_default()
    }
}

impl KnownRuns {
    /// The runs in some tables that have these quantities.
    ///
    /// # Errors
    /// If a table cannot be read, is not one of runs, or has other quantities.
    pub(crate) fn read(
        tables: &[impl AsRef<Path>],
        quantities: &[NamedQuantity],
    ) -> Result<Self, String> {
        let mut known = Self::default();
        for path in tables {
            let path = path.as_ref();
            let text = std::fs::read_to_string(path)
                .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
            let added = known.add(&text, quantities);
            added.map_err(|message| format!("{}: {message}", path.display()))?;
        }
        Ok(known)
    }

    /// The run with this identity.
    pub(crate) fn run(&self, identity: &str) -> Option<&KnownRun> {
        self.by_identity.get(identity)
    }

    fn add(&mut self, text: &str, quantities: &[NamedQuantity]) -> Result<(), String> {
        let provenance = provenance_of(text);
        check_quantities(&provenance, quantities)?;
        let mut reader = ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let columns = Columns::find(&mut reader, quantities)?;
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            if let Some((identity, run)) = columns.run(&record, &provenance)? {
                self.by_identity.insert(identity, run);
            }
        }
        Ok(())
    }
}

/// The lines `# name: text` at the head of a table.
fn provenance_of(text: &str) -> Vec<(String, String)> {
    let head = text.lines().map_while(|line| line.strip_prefix('#'));
    let pairs = head.filter_map(|line| line.split_once(':'));
    pairs.map(|(name, text)| (name.trim().to_owned(), text.trim().to_owned())).collect()
}

/// Refuses a table that lacks one of the quantities.
fn check_quantities(
    provenance: &[(String, String)],
    quantities: &[NamedQuantity],
) -> Result<(), String> {
    let measured = provenance.iter().filter(|(name, _)| name == "measure");
    let given: BTreeSet<&str> = measured.map(|(_, text)| text.as_str()).collect();
    for quantity in quantities {
        let wanted = format!("{}: {}", quantity.name, quantity.quantity.describe());
        if !given.contains(wanted.as_str()) {
            let message = "this is no quantity of the table";
            return Err(format!("quantity {wanted}: {message}"));
        }
    }
    Ok(())
}

/// Positions of the columns in a row.
struct Columns<'a> {
    state: usize,
    digest: usize,
    identity: usize,
    quantities: Vec<QuantityCells<'a>>,
}

/// The cells of a quantity.
struct QuantityCells<'a> {
    quantity: &'a NamedQuantity,
    column: usize,
    unit: String,
}

impl<'a> Columns<'a> {
    fn find(reader: &mut Reader<&[u8]>, quantities: &'a [NamedQuantity]) -> Result<Self, String> {
        let headings = reader.headers().map_err(|error| error.to_string())?;
        let parts = |heading: &str| match heading.strip_suffix(']').and_then(|h| h.split_once(" ["))
        {
            Some((name, unit)) => (name.to_owned(), unit.to_owned()),
            None => (heading.to_owned(), String::new()),
        };
        let headings: Vec<(String, String)> = headings.iter().map(parts).collect();
        let place = |name: &str| {
            let column = headings.iter().position(|(heading, _)| heading == name);
            column.ok_or(format!("there is no column {name}: this is no runs.csv of a study"))
        };
        let cells = |quantity: &'a NamedQuantity| {
            let column = place(&quantity.name)?;
            Ok(QuantityCells { quantity, column, unit: headings[column].1.clone() })
        };
        Ok(Self {
            state: place("state")?,
            digest: place("digest")?,
            identity: place("identity_blake3")?,
            quantities: quantities.iter().map(cells).collect::<Result<_, String>>()?,
        })
    }

    /// The identity of a run and the data on it; `None` if it was not complete, or could not be measured.
    fn run(
        &self,
        record: &StringRecord,
        provenance: &[(String, String)],
    ) -> Result<Option<(String, KnownRun)>, String> {
        if &record[self.state] != "complete" {
            return Ok(None);
        }
        let mut measured = HashMap::new();
        for cells in &self.quantities {
            let value = cells.value(&record[cells.column]).map_err(|message| {
                let line = record.position().map_or(0, csv::Position::line);
                format!("line {line}: {}: {message}", cells.quantity.name)
            })?;
            let Some(value) = value else { return Ok(None) };
            measured
                .insert(cells.quantity.name.clone(), Measured { value, unit: cells.unit.clone() });
        }
        let (digest, provenance) = (record[self.digest].to_owned(), provenance.to_vec());
        let run = KnownRun { digest, measured, provenance };
        Ok(Some((record[self.identity].to_owned(), run)))
    }
}

impl QuantityCells<'_> {
    /// What a cell says; `None` if it could not be measured.
    fn value(&self, cell: &str) -> Result<Option<Value>, String> {
        let quantity = &self.quantity.quantity;
        if cell.is_empty() {
            let nothing = || Value::Nothing("the run has no value".to_owned());
            return Ok(quantity.may_be_nothing().then(nothing));
        }
        if quantity.texts().is_some() {
            return Ok(Some(Value::Text(cell.to_owned())));
        }
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| format!("{cell} is not a finite number"))?;
        Ok(Some(Value::Number(number)))
    }
}
