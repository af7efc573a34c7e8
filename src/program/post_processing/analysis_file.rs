//! Findings in one HDF5 file.

use super::{Analysis, Findings, Results, Scalar, TimeWindow, Value, full_name};
use std::path::Path;
use talcum_engine::fields::Column;
use talcum_results::output::{Cells, OutputError, ResultTable, commit};

/// Writes `analysis.h5`: the table `/scalars` with all numbers and texts, and the tables of each analysis in a group
/// with its name. The root contains the provenance and the hash of all tables, which is returned.
///
/// # Errors
/// If the file cannot be written.
pub fn write(
    path: &Path,
    results: &Results,
    found: &[(&Analysis, Findings)],
) -> Result<String, OutputError> {
    let mut tables = vec![scalars(found)];
    for (_, findings) in found {
        tables.extend(findings.tables.iter().cloned());
    }
    let digest = ResultTable::digest_of(&tables);
    let TimeWindow { from, to } = results.window;
    let text = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    let mut provenance = vec![
        text("format", "talcum analysis"),
        text("talcum_version", env!("CARGO_PKG_VERSION")),
        text("commit", commit()),
        text("units", results.case().map_or("", |case| case.units.name())),
        text("title", results.case().map_or("", |case| &case.title)),
        text("case", results.case_text()),
        text("run_digest", &results.run_digest().unwrap_or_default()),
        text("from", &from.to_string()),
        text("to", &to.to_string()),
        text("tables_blake3", &digest),
    ];
    let notes = found.iter().flat_map(|(analysis, findings)| {
        findings.notes.iter().map(|note| (format!("{}_note", analysis.name), note.clone()))
    });
    provenance.extend(notes);
    ResultTable::write_all(path, &provenance, &tables)?;
    Ok(digest)
}

/// All numbers and texts by their full names.
fn scalars(found: &[(&Analysis, Findings)]) -> ResultTable {
    let rows: Vec<_> = found
        .iter()
        .flat_map(|(analysis, findings)| findings.scalars.iter().map(|scalar| (*analysis, scalar)))
        .collect();
    let name = |(analysis, scalar): &(&Analysis, &Scalar)| full_name(analysis, &scalar.kind);
    let numbers = |of: fn(&Value) -> Option<f64>| {
        Cells::Number(
            rows.iter().map(|(_, scalar)| of(&scalar.value).unwrap_or(f64::NAN)).collect(),
        )
    };
    let texts = |of: &dyn Fn(&Scalar) -> String| {
        Cells::Text(rows.iter().map(|(_, scalar)| of(scalar)).collect())
    };
    let value = numbers(|value| match value {
        Value::Number { value, .. } => Some(*value),
        Value::Text(_) | Value::Nothing(_) => None,
    });
    let error = numbers(|value| match value {
        Value::Number { error, .. } => *error,
        Value::Text(_) | Value::Nothing(_) => None,
    });
    let text = texts(&|scalar| match scalar.value {
        Value::Text(text) => text.to_owned(),
        Value::Number { .. } | Value::Nothing(_) => String::new(),
    });
    let reason = texts(&|scalar| match &scalar.value {
        Value::Nothing(reason) => reason.reason().to_owned(),
        Value::Number { .. } | Value::Text(_) => String::new(),
    });
    let columns = vec![
        Column::new("name", "of the number or text", Cells::Text(rows.iter().map(name).collect())),
        Column::new("value", "not a number where there is none", value),
        Column::new("error", "standard error, where it can be estimated", error),
        Column::new("text", "of what is a text", text),
        Column::new("unit", "of value and error", texts(&|scalar| scalar.unit.to_owned())),
        Column::new("meaning", "what it is", texts(&|scalar| scalar.kind.meaning.to_owned())),
        Column::new("no_value_because", "why there is none", reason),
    ];
    ResultTable::new("scalars", columns)
}
