//! The rows of docs/files.md about fields agree with the lists of fields.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use crate::case_schema::require_written;
use crate::launch::in_repository;
use talcum::analysis::Pair;
use talcum::fields::{Record, Unit};
use talcum::parallel::{CellRecord, ContactRecord, ParticleRecord, WallContactRecord};

/// Rows of docs/files.md: datasets of a record, of so many rows.
fn documented<R: Record>(rows: &str) -> String {
    let ids = R::IDS.iter().map(|id| (id.name, format!("({rows})"), "1", id.meaning.to_owned()));
    let fields = R::FIELDS.iter().map(|field| {
        let shape = match field.width() {
            1 => format!("({rows})"),
            width => format!("({rows}, {width})"),
        };
        let only = field.comes_with.map(|what| format!("; only with {what}")).unwrap_or_default();
        (field.name, shape, in_words(field.unit), format!("{}{only}", field.meaning))
    });
    ids.chain(fields)
        .map(|(name, shape, unit, meaning)| {
            format!("| `{}/{name}` | {shape} | {unit} | {meaning} |\n", R::GROUP)
        })
        .collect()
}

fn in_words(unit: Unit) -> &'static str {
    match unit {
        Unit::One | Unit::Angle => "1",
        Unit::Length => "length",
        Unit::Speed => "velocity",
        Unit::AngularSpeed => "angular velocity",
        Unit::Mass => "mass",
        Unit::Force => "force",
        Unit::Torque => "torque",
        Unit::Pressure => "pressure",
        Unit::Volume => "volume",
        Unit::Named(name) => name,
        other => panic!("no field has the unit {other:?}"),
    }
}

#[test]
fn docs_files_has_the_rows_that_the_lists_of_fields_say() {
    const MARKER: &str = "<!-- fields -->\n";
    let committed = std::fs::read_to_string(in_repository("docs/files.md")).unwrap();
    let mut parts: Vec<&str> = committed.split(MARKER).collect();
    assert_eq!(parts.len(), 3, "the rows are between two markers");
    let rows = [
        "| dataset | shape | unit | meaning |\n| --- | --- | --- | --- |\n".to_owned(),
        documented::<ParticleRecord>("n"),
        documented::<ContactRecord>("c"),
        documented::<WallContactRecord>("w"),
        documented::<CellRecord>("g"),
        documented::<Pair>("l"),
    ];
    let rows = rows.concat();
    parts[1] = &rows;
    let command = "TALCUM_WRITE_DOCS=1 cargo test --test program documented_fields";
    require_written("docs/files.md", &parts.join(MARKER), command);
}
