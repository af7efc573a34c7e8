//! Reader of `series.csv`.

use crate::output::{OutputError, read_text};
use std::path::Path;

/// The rows of `series.csv`, and the provenance of its run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeriesTable {
    /// Names and texts of the lines `# name: text`, without the case.
    pub provenance: Vec<(String, String)>,
    /// Names of the columns with their units.
    pub columns: Vec<(String, String)>,
    /// The rows in the order of time.
    pub rows: Vec<Vec<f64>>,
}

impl SeriesTable {
    /// Reads the file; an unfinished last line is left out.
    ///
    /// # Errors
    /// If it cannot be read, or is not such a table.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let wrong = |message: String| OutputError { path: path.to_owned(), message };
        let text = read_text(path);
        let text = text.map_err(|error| wrong(format!("cannot be read: {error}")))?;
        Self::parse(&text).map_err(wrong)
    }

    /// Parses the text of the file.
    ///
    /// # Errors
    /// If it is not such a table.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut table = Self::default();
        let whole = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        for (index, line) in whole.enumerate() {
            if let Some(comment) = line.strip_prefix('#') {
                let pair = comment.split_once(':').unwrap_or((comment, ""));
                let (name, text) = (pair.0.trim(), pair.1.trim());
                if name != "case" {
                    table.provenance.push((name.to_owned(), text.to_owned()));
                }
            } else if table.columns.is_empty() {
                table.columns = line.split(',').map(name_and_unit).collect();
            } else {
                let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
                let row = row.ok().filter(|row| row.len() == table.columns.len());
                table.rows.push(row.ok_or(format!("line {} is not a row of numbers", index + 1))?);
            }
        }
        match table.position("time") {
            Some(_) => Ok(table),
            None => Err("it has no column time: this is not a series.csv of Talcum".to_owned()),
        }
    }

    /// The text of a line of provenance.
    pub fn entry(&self, name: &str) -> Option<&str> {
        self.provenance.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str())
    }

    /// The index of a column.
    pub fn position(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|(known, _)| known == column)
    }

    /// The numbers of a column.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let at = self.position(name)?;
        Some(self.rows.iter().map(|row| row[at]).collect())
    }

    /// The rows within a range of times, both ends included.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let time = self.position("time").unwrap_or(0);
        let inside = |row: &&Vec<f64>| (from..=to).contains(&row[time]);
        Self { rows: self.rows.iter().filter(inside).cloned().collect(), ..self.clone() }
    }
}

/// Splits `name [unit]`.
fn name_and_unit(heading: &str) -> (String, String) {
    match heading.split_once('[') {
        Some((name, unit)) => {
            (name.trim().to_owned(), unit.trim().trim_end_matches(']').to_owned())
        }
        None => (heading.trim().to_owned(), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_is_not_finished_is_left_out_and_a_wrong_one_named() {
        let text = "# commit: abc\n# case: title = \"x\"\ntime [s],bed_top [m]\n0,10\n1,20\n2,4";
        let table = SeriesTable::parse(text).unwrap();
        assert_eq!(table.entry("commit"), Some("abc"));
        assert_eq!(table.entry("case"), None);
        assert_eq!(table.column("bed_top"), Some(vec![10.0, 20.0]));
        assert_eq!(table.columns[1].1, "m");
        assert_eq!(table.between(0.5, 9.0).rows, [[1.0, 20.0]]);
        assert!(SeriesTable::parse("time [s]\n1,2\n").unwrap_err().contains("line 2"));
        assert!(SeriesTable::parse("time [s]\nx\n").unwrap_err().contains("line 2"));
        assert!(SeriesTable::parse("a,b\n1,2\n").unwrap_err().contains("not a series.csv"));
    }
}
