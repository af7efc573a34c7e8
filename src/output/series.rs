//! The table of numbers over time: `series.csv`, written by rank 0.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::output_file::{Obstacle, continue_or_create};
use super::{
    ColumnUnits, Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind,
    Sample, free_name, on_root, sync_folder, with_suffix,
};
use crate::analysis::Measures;
use crate::parallel::Communicator;

/// The open table: comments with what was run, a header with units, and a row for each time.
#[derive(Debug)]
pub struct Series {
    path: PathBuf,
    /// On rank 0.
    file: Option<File>,
}

impl Series {
    /// In the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "series.csv", needs_momentum_before: true, open: Self::open };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let series = match opening.continue_after {
            Some(time) => Self::resume(path, time, opening.head, ranks)?,
            None => Self::create(path, opening.head, ranks)?,
        };
        Ok(Some(Box::new(series)))
    }

    /// Begins a table, in the place of one that is there. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let file = on_root(path, ranks, || create(path, head))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Continues a table after the rows up to and including `time`; later ones are dropped, so that the
    /// file becomes that of a run without interruption. A file that is not such a table is set aside. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let file = on_root(path, ranks, || {
            let go_on = || rows_up_to(path, time, &head.units()).map(Some);
            let rows = continue_or_create(path, go_on, || Ok(None))?;
            rows.map_or_else(|| create(path, head), |text| replace(path, &text))
        })?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Adds a row, which is in the file on return. Rank 0's row counts. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&mut self, row: &Measures, ranks: &dyn Communicator) -> Result<(), OutputError> {
        let values = Measures::COLUMNS.iter().map(|column| shortest((column.value)(row)));
        let line = values.collect::<Vec<_>>().join(",") + "\n";
        on_root(&self.path, ranks, || {
            let file = self.file.as_mut().ok_or("the file is not open")?;
            file.write_all(line.as_bytes()).map_err(|error| error.to_string())
        })?;
        Ok(())
    }
}

impl Output for Series {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append(sample.measures, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        on_root(&self.path, ranks, || {
            let file = self.file.as_ref().ok_or("the file is not open")?;
            file.sync_all().map_err(|error| error.to_string())
        })
        .map(|_| ())
    }
}

/// The line of names and units.
fn header(units: &ColumnUnits) -> String {
    let columns = Measures::COLUMNS.iter();
    let names = columns.map(|column| format!("{} [{}]", column.name, units.of(column.quantity)));
    names.collect::<Vec<_>>().join(",")
}

/// The shortest text from which the same bits are read.
fn shortest(value: f64) -> String {
    let plain = value == 0.0 || (1.0e-4..1.0e15).contains(&value.abs());
    if plain { format!("{value}") } else { format!("{value:e}") }
}

fn create(path: &Path, head: Head<'_>) -> MessageResult<File> {
    let mut text = String::new();
    for (name, entry) in head.provenance.entries() {
        text += &format!("# {name}: {}\n", entry.replace(['\n', '\r'], " "));
    }
    for line in head.case_text.lines() {
        text += format!("# case: {line}").trim_end();
        text += "\n";
    }
    text += &header(&head.units());
    text += "\n";
    replace(path, &text)
}

/// Replaces a file at one stroke and opens it to append.
fn replace(path: &Path, text: &str) -> MessageResult<File> {
    let replace = || {
        let partial = with_suffix(path, ".partial");
        let mut file = File::create(&partial)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        std::fs::rename(&partial, path)
    };
    replace().map_err(|error: std::io::Error| error.to_string())?;
    sync_folder(path)?;
    OpenOptions::new().append(true).open(path).map_err(|error| error.to_string())
}

/// The text of a table up to and including a time. Damaged rows are left out with a warning, and a copy of the file as it
/// was is kept; a last row that a kill has cut short is not damage.
fn rows_up_to(path: &Path, time: f64, units: &ColumnUnits) -> Result<String, Obstacle> {
    let text = std::fs::read_to_string(path).map_err(|error| Obstacle::of_io(&error))?;
    let mut kept = String::new();
    let mut damaged = Vec::new();
    let mut columns = None;
    for (number, line) in (1..).zip(text.split_inclusive('\n')) {
        if line.starts_with('#') {
            kept += line;
        } else if columns.is_none() {
            if line.trim_end() != header(units) {
                return Err(Obstacle::Unusable("it has other columns".to_owned()));
            }
            columns = Some(line.split(',').count());
            kept += line;
        } else if !line.ends_with('\n') {
            break;
        } else if Some(line.split(',').count()) != columns || !is_row(line) {
            damaged.push(number.to_string());
        } else if line.split(',').next().and_then(|first| first.parse().ok()) <= Some(time) {
            kept += line;
        }
    }
    if columns.is_none() {
        return Err(Obstacle::Unusable("it has no header".to_owned()));
    }
    if !damaged.is_empty() {
        keep_copy(path, &damaged.join(", ")).map_err(Obstacle::Failed)?;
    }
    Ok(kept)
}

/// Whether all columns are numbers.
fn is_row(line: &str) -> bool {
    line.trim_end().split(',').all(|number| number.parse::<f64>().is_ok())
}

/// Keeps a copy of a table whose damaged rows are left out.
fn keep_copy(path: &Path, lines: &str) -> MessageResult<()> {
    let copy = free_name(path);
    std::fs::copy(path, &copy).map_err(|error| format!("cannot be copied: {error}"))?;
    let [path, copy] = [path.display(), copy.display()];
    log::warn!(
        "{path}: rows that are damaged are left out (line {lines}); as it was it is kept as {copy}"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Provenance;
    use crate::parallel::{OneRank, run_on_threads};

    fn provenance(units: &str) -> Provenance {
        Provenance::here_and_now("A bed", units, &OneRank)
    }

    fn row(time: f64) -> Measures {
        Measures { time, momentum_error: 1.0e-17 * time, particles: 3000.0, ..Default::default() }
    }

    #[test]
    fn a_resumed_table_is_that_of_an_uninterrupted_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let provenance = provenance("dimensionless");
        let head = Head { case_text: "title = \"A\"\n\na = 1", provenance: &provenance };
        run_on_threads(2, |ranks| {
            let mut series = Series::create(&path, head, ranks).unwrap();
            (0..9).for_each(|k| series.append(&row(0.1 * f64::from(k)), ranks).unwrap());
        });
        let whole = std::fs::read_to_string(&path).unwrap();
        assert!(whole.contains("# title: A bed\n"));
        assert!(
            whole.contains("\n# case: title = \"A\"\n# case:\n# case: a = 1\ntime [sqrt(d/g)],")
        );
        assert!(whole.contains("\ntime [sqrt(d/g)],superficial_velocity [sqrt(g d)],"));
        // A kill in the middle of a row after the checkpoint.
        std::fs::write(&path, &whole[..whole.len() - 30]).unwrap();
        run_on_threads(2, |ranks| {
            let mut series = Series::resume(&path, 0.1 * 5.0, head, ranks).unwrap();
            (6..9).for_each(|k| series.append(&row(0.1 * f64::from(k)), ranks).unwrap());
        });
        assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
    }

    #[test]
    fn a_foreign_table_is_set_aside() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        std::fs::write(&path, "a,b\n1,2\n").unwrap();
        let provenance = provenance("si");
        let head = Head { case_text: "", provenance: &provenance };
        Series::resume(&path, 1.0, head, &OneRank).unwrap();
        let aside = folder.path().join("series.csv.unreadable-1");
        assert_eq!(std::fs::read_to_string(aside).unwrap(), "a,b\n1,2\n");
        assert!(std::fs::read_to_string(&path).unwrap().contains("\ntime [s],"));
    }

    #[test]
    fn numbers_are_read_back_as_they_were() {
        for value in [0.0, 0.1, -3000.0, 1.0e-17, 1.234_567_890_123_456_7e300, f64::MIN_POSITIVE] {
            assert_eq!(shortest(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(shortest(3000.0), "3000");
    }

    #[test]
    fn a_table_that_cannot_be_written_is_an_error_on_all_ranks() {
        let path = Path::new("/nonexistent-folder/series.csv");
        let provenance = provenance("si");
        let head = Head { case_text: "", provenance: &provenance };
        run_on_threads(3, |ranks| {
            let error = Series::create(path, head, ranks).unwrap_err();
            assert!(error.to_string().contains("nonexistent-folder/series.csv: No such file"));
        });
    }
}
