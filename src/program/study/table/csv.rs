//! Tables as text: comments with the provenance, a line of names, a line for each row.

use crate::study::folder::write_whole;
use crate::study::setting::shortest;
use std::path::{Path, PathBuf};
use talcum_results::output::{Cells, ResultTable};

/// Writes each table as `NAME.csv` into a folder, replacing any existing ones; returns the files.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write(tables: &[ResultTable], folder: &Path) -> Result<Vec<PathBuf>, String> {
    let write = |table: &ResultTable| {
        let path = folder.join(format!("{}.csv", table.name));
        write_whole(&path, &text(table)).map(|()| path)
    };
    tables.iter().map(write).collect()
}

/// The text of a table. Numbers have as many digits as are needed to read back the same bits.
pub(crate) fn text(table: &ResultTable) -> String {
    let mut text = String::new();
    for (name, value) in &table.provenance {
        text += &format!("# {name}: {}\n", value.replace(['\n', '\r'], " "));
    }
    let heading = table.columns.iter().map(|column| match column.unit.as_str() {
        "" => quoted(&column.name),
        unit => quoted(&format!("{} [{unit}]", column.name)),
    });
    text += &(heading.collect::<Vec<_>>().join(",") + "\n");
    let columns: Vec<Vec<String>> =
        table.columns.iter().map(|column| cells(&column.values)).collect();
    for row in 0..columns.first().map_or(0, Vec::len) {
        let line: Vec<&str> = columns.iter().map(|column| column[row].as_str()).collect();
        text += &(line.join(",") + "\n");
    }
    text
}

fn cells(cells: &Cells) -> Vec<String> {
    // NaN is written as an empty cell, which pandas and numpy read as NaN.
    let number = |value: &f64| if value.is_nan() { String::new() } else { shortest(*value) };
    match cells {
        Cells::Text(texts) => texts.iter().map(|text| quoted(text)).collect(),
        Cells::Whole(numbers) => numbers.iter().map(u64::to_string).collect(),
        Cells::Number(numbers) => numbers.iter().map(number).collect(),
    }
}

/// A text quoted according to RFC 4180, if necessary.
fn quoted(text: &str) -> String {
    let text = text.replace(['\n', '\r'], " ");
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::fields::Column;

    #[test]
    fn a_table_as_text() {
        let height = Column::numbers("height", "d", "", vec![0.1, f64::NAN]);
        let table = ResultTable {
            name: "runs".to_owned(),
            provenance: vec![("title".to_owned(), "two\nlines".to_owned())],
            columns: vec![
                Column::new("run", "", Cells::Text(vec!["a, b".to_owned(), "c".to_owned()])),
                Column::new("seed", "", Cells::of_values(vec!["1".to_owned(), "2".to_owned()])),
                height,
            ],
        };
        let expected = "# title: two lines\nrun,seed,height [d]\n\"a, b\",1,0.1\nc,2,\n";
        assert_eq!(text(&table), expected);
    }
}
