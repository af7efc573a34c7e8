//! The manual and the editors' schema of the case file are what the tables in src/case/schema say.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use crate::toml_files::toml_files;
use boon::{Compiler, Schemas};
use std::path::Path;
use talcum::case::FILE_KEYS;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A committed file must be what the program writes; with TALCUM_WRITE_DOCS set it is written instead.
pub(crate) fn require_written(file: &str, generated: &str, command: &str) {
    let path = root().join(file);
    if std::env::var_os("TALCUM_WRITE_DOCS").is_some() {
        std::fs::write(&path, generated).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    let line = committed.lines().zip(generated.lines()).position(|(a, b)| a != b);
    assert!(
        committed == generated,
        "{file} is not what `{command}` writes, from line {}: write it again",
        line.map_or(0, |line| line + 1)
    );
}

#[test]
fn the_manual_is_what_the_tables_say() {
    require_written("docs/input.md", &FILE_KEYS.manual(), "talcum keys --markdown > docs/input.md");
}

#[test]
fn the_schema_for_editors_is_what_the_tables_say() {
    let command = "talcum keys --json-schema > docs/case.schema.json";
    require_written("docs/case.schema.json", &FILE_KEYS.json_schema(), command);
}

/// What the schema says of each case file of a folder: nothing, or an error.
fn judged(folder: &str) -> Vec<(String, Option<String>)> {
    let mut compiler = Compiler::new();
    let schema: serde_json::Value = serde_json::from_str(&FILE_KEYS.json_schema()).unwrap();
    compiler.add_resource("case.schema.json", schema).unwrap();
    let mut schemas = Schemas::new();
    let schema = compiler.compile("case.schema.json", &mut schemas).unwrap();
    let mut judged = Vec::new();
    for file in toml_files(folder) {
        let text = std::fs::read_to_string(&file).unwrap();
        // What is not TOML at all is not for the schema to judge.
        let Ok(case) = toml::from_str::<serde_json::Value>(&text) else { continue };
        let error = schemas.validate(&case, schema).err().map(|error| error.to_string());
        let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
        judged.push((name, error));
    }
    judged
}

#[test]
fn the_schema_accepts_every_right_case_file() {
    let judged = [judged("tests/cases/good"), judged("cases")].concat();
    assert!(judged.len() >= 40);
    let refused =
        judged.into_iter().filter_map(|(name, error)| Some(format!("{name}: {}", error?)));
    let refused: Vec<String> = refused.collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

/// Negative control: what a table can tell without the rest of the file is refused.
#[test]
fn the_schema_refuses_wrong_values_keys_and_partners() {
    let judged = judged("tests/cases/bad");
    for wrong in [
        "box-values",         // words
        "box-list",           // lengths of lists, unknown keys
        "contact-values",     // ranges
        "contact-exclusive",  // partners
        "contact-laws",       // keys of another law
        "cohesion-schedule",  // schedules
        "gas-both",           // partners
        "particles-missing",  // required by a word
        "sizes-distribution", // tables in braces
        "stages",             // keys of stages
        "start-run",          // keys of another word
        "top",                // unknown sections
        "checkpoint-and-run", // wall-clock times
        "walls",              // companions
    ] {
        let (_, error) = judged.iter().find(|(name, _)| name == wrong).unwrap();
        assert!(error.is_some(), "{wrong} is accepted");
    }
}

#[test]
fn keys_of_a_section_are_printed_with_range_default_and_meaning() {
    let contact = FILE_KEYS.terminal(Some("contact")).unwrap();
    for expected in [
        "restitution\n",
        "Allowed: above 0 and at most 1.",
        "surface_energy [energy/area] (jkr)\n",
        "Default: \"none\".",
        "Needed: this or poisson_ratio.",
    ] {
        assert!(contact.contains(expected), "{expected} is missing in\n{contact}");
    }
    assert!(!contact.contains("stokes_number"));
    assert!(FILE_KEYS.terminal(None).unwrap().contains("stokes_number"));
    let error = FILE_KEYS.terminal(Some("contcat")).unwrap_err().to_string();
    assert_eq!(error, "there is no section or key \"contcat\": did you mean contact?");
}

#[test]
fn a_key_or_what_belongs_to_a_word_is_printed_alone() {
    let substeps = FILE_KEYS.terminal(Some("gas.substeps")).unwrap();
    assert!(substeps.contains("substeps\n") && !substeps.contains("viscosity"), "{substeps}");
    let stress = FILE_KEYS.terminal(Some("measure.stress")).unwrap();
    for (key, is_there) in [("layers", true), ("wave_speed", true), ("radius", false)] {
        assert_eq!(stress.contains(&format!("\n  {key}")), is_there, "{key}: {stress}");
    }
    let error = FILE_KEYS.terminal(Some("measure.stres")).unwrap_err().to_string();
    assert_eq!(error, "there is no section or key \"measure.stres\": did you mean measure.stress?");
}
