//! The table of numbers over time: `series.csv`.

use std::path::Path;

use super::text_table::{TableFormat, TextTable, shortest};
use super::{ColumnUnits, Head, OpenedOutput, Opening, Output, OutputError, OutputKind, Sample};
use crate::analysis::SeriesRow;
use talcum_engine::parallel::Communicator;

/// The open table: comments with the provenance, a header with units, and a row for each time.
#[derive(Debug)]
pub struct Series(TextTable);

impl Series {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "series.csv", needs_momentum_before: true, open: Self::open };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let format = format(opening.head.units());
        Ok(Some(Box::new(Self(TextTable::open(path, opening, &format, ranks)?))))
    }

    /// Begins a table, replacing any existing one. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        Ok(Self(TextTable::create(path, head, &format(head.units()), ranks)?))
    }

    /// Continues a table after the rows up to and including `time`; later ones are dropped, so that the file becomes
    /// that of a run without interruption. A file that is not such a table is set aside. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        Ok(Self(TextTable::resume(path, time, head, &format(head.units()), ranks)?))
    }

    /// Adds a row, which is in the file on return; that of rank 0 is written. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&mut self, row: &SeriesRow, ranks: &dyn Communicator) -> Result<(), OutputError> {
        let values = SeriesRow::COLUMNS.iter().map(|column| shortest((column.values)(row)));
        let line = values.collect::<Vec<_>>().join(",") + "\n";
        self.0.append(&line, ranks)
    }
}

impl Output for Series {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append(sample.row, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.commit(ranks)
    }
}

fn format(units: ColumnUnits) -> TableFormat {
    let columns = SeriesRow::COLUMNS.iter();
    let names = columns.map(|column| format!("{} [{}]", column.name, units.of(column.unit)));
    TableFormat { header: names.collect::<Vec<_>>().join(","), texts: &[] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Provenance;
    use talcum_engine::parallel::{OneRank, run_on_threads};

    fn provenance(units: &str) -> Provenance {
        Provenance::here_and_now("A bed", units, &OneRank)
    }

    fn row(time: f64) -> SeriesRow {
        SeriesRow { time, momentum_error: 1.0e-17 * time, particles: 3000.0, ..Default::default() }
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
    fn a_table_that_is_removed_or_replaced_is_written_again_with_all_its_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let provenance = provenance("si");
        let head = Head { case_text: "", provenance: &provenance };
        let mut series = Series::create(&path, head, &OneRank).unwrap();
        series.append(&row(0.0), &OneRank).unwrap();
        std::fs::remove_file(&path).unwrap();
        series.append(&row(0.1), &OneRank).unwrap();
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, "edited").unwrap();
        series.append(&row(0.2), &OneRank).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<&str> =
            text.lines().rev().take(3).map(|line| line.split(',').next().unwrap()).collect();
        assert_eq!(rows, ["0.2", "0.1", "0"], "{text}");
        let aside = folder.path().join("series.csv.unreadable-1");
        assert_eq!(std::fs::read_to_string(aside).unwrap(), "edited");
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
