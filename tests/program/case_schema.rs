//! The manuals and the editors' schemas of the case file and of the study file are what the tables in src/runs/case/schema and
//! src/program/study say.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use crate::toml_files::{study_files, toml_files};
use boon::{Compiler, Schemas};
use std::path::{Path, PathBuf};
use talcum::input::FileKeys;
use talcum::{case, study};

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
fn the_manuals_are_what_the_tables_say() {
    let manual = case::FILE_KEYS.manual();
    require_written("docs/input.md", &manual, "talcum keys --markdown > docs/input.md");
    let manual = study::FILE_KEYS.manual();
    let command = "talcum keys study --markdown > docs/study-keys.md";
    require_written("docs/study-keys.md", &manual, command);
}

#[test]
fn the_schemas_for_editors_are_what_the_tables_say() {
    let schema = case::FILE_KEYS.json_schema();
    let command = "talcum keys --json-schema > docs/case.schema.json";
    require_written("docs/case.schema.json", &schema, command);
    let schema = study::FILE_KEYS.json_schema();
    let command = "talcum keys study --json-schema > docs/study.schema.json";
    require_written("docs/study.schema.json", &schema, command);
}

/// What the schema of a kind of file says of each text: nothing, or an error.
fn judged_by<'a>(
    keys: &FileKeys,
    texts: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> Vec<(String, Option<String>)> {
    let mut compiler = Compiler::new();
    let schema: serde_json::Value = serde_json::from_str(&keys.json_schema()).unwrap();
    compiler.add_resource("schema.json", schema).unwrap();
    let mut schemas = Schemas::new();
    let schema = compiler.compile("schema.json", &mut schemas).unwrap();
    let mut judged = Vec::new();
    for (name, text) in texts {
        // What is not TOML at all is not for the schema to judge.
        let Ok(file) = toml::from_str::<serde_json::Value>(text) else { continue };
        let error = schemas.validate(&file, schema).err().map(|error| error.to_string());
        judged.push((name.to_owned(), error));
    }
    judged
}

/// What the schema of a kind of file says of some files.
fn judged_files(keys: &FileKeys, files: &[PathBuf]) -> Vec<(String, Option<String>)> {
    let read = |file: &PathBuf| {
        let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
        (name, std::fs::read_to_string(file).unwrap())
    };
    let texts: Vec<(String, String)> = files.iter().map(read).collect();
    judged_by(keys, texts.iter().map(|(name, text)| (name.as_str(), text.as_str())))
}

fn judged(folder: &str) -> Vec<(String, Option<String>)> {
    judged_files(&case::FILE_KEYS, &toml_files(folder))
}

#[track_caller]
fn assert_all_accepted(judged: Vec<(String, Option<String>)>) {
    let refused =
        judged.into_iter().filter_map(|(name, error)| Some(format!("{name}: {}", error?)));
    let refused: Vec<String> = refused.collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn the_schema_accepts_every_right_case_file() {
    let judged = [judged("tests/cases/good"), judged("cases")].concat();
    assert!(judged.len() >= 40);
    assert_all_accepted(judged);
}

#[test]
fn the_schema_of_studies_accepts_every_study_of_the_repository() {
    let mut files = study_files("cases");
    files.push(root().join("tests/program/study/study.toml"));
    assert!(files.len() >= 40);
    assert_all_accepted(judged_files(&study::FILE_KEYS, &files));
}

/// Negative control.
#[test]
fn the_schema_of_studies_refuses_wrong_values_keys_and_partners() {
    const RIGHT: &str = "title = \"t\"\ncase = \"c.toml\"\nmeasures = [\"u_mf\"]\n";
    let judge = |wrong: &str| {
        let text = format!("{RIGHT}{wrong}");
        judged_by(&study::FILE_KEYS, [("", text.as_str())]).remove(0).1
    };
    assert_eq!(judge(""), None);
    for wrong in [
        "seed = 5",
        "seeds = 0",
        "seeds = [1.5]",
        "confidence = 95",
        "[[axis]]\nkey = \"a\"",
        "[[axis]]\nkey = \"a\"\nkeys = [\"b\", \"c\"]\nvalues = [1]",
        "[[axis]]\nkey = \"a\"\nrange = { from = 1, to = 2 }",
        "[measure.x]\ncolumn = \"bed_top\"\nstatistic = \"median\"",
        "[measure.x]\nsource = \"analysis\"\nquantity = \"u_mf\"\nstatistic = \"mean\"",
        "[measure.x]\nsource = \"case\"\ncolumn = \"contacts\"\nstatistic = \"mean\"",
        "[bisection]\nkey = \"a\"\nbracket = [1, 2, 3]",
        "[continuation]\nfrom_stage = \"pour\"",
        "[run]\nranks = 0",
    ] {
        assert!(judge(wrong).is_some(), "{wrong} is accepted");
    }
}

/// Negative control: what a table shows without the rest of the file is refused.
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
    let contact = case::FILE_KEYS.terminal(Some("contact")).unwrap();
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
    assert!(case::FILE_KEYS.terminal(None).unwrap().contains("stokes_number"));
    let error = case::FILE_KEYS.terminal(Some("contcat")).unwrap_err().to_string();
    assert_eq!(error, "there is no section or key \"contcat\": did you mean contact?");
}

#[test]
fn a_key_or_what_belongs_to_a_word_is_printed_alone() {
    let substeps = case::FILE_KEYS.terminal(Some("gas.substeps")).unwrap();
    assert!(substeps.contains("substeps\n") && !substeps.contains("viscosity"), "{substeps}");
    let stress = case::FILE_KEYS.terminal(Some("measure.stress")).unwrap();
    for (key, is_there) in [("layers", true), ("wave_speed", true), ("radius", false)] {
        assert_eq!(stress.contains(&format!("\n  {key}")), is_there, "{key}: {stress}");
    }
    let error = case::FILE_KEYS.terminal(Some("measure.stres")).unwrap_err().to_string();
    assert_eq!(error, "there is no section or key \"measure.stres\": did you mean measure.stress?");
}

#[test]
fn keys_of_the_study_file_are_printed_alike() {
    let keys = |asked| study::FILE_KEYS.terminal(Some(asked)).unwrap();
    let axis = keys("axis");
    for expected in ["[axis]\n", "Needed: this or range.", "Default: its first key.", "  step\n"] {
        assert!(axis.contains(expected), "{expected} is missing in\n{axis}");
    }
    assert!(keys("set").contains("inline tables are values"));
    let bracket = keys("bisection.bracket");
    assert!(bracket.contains("bracket\n") && !bracket.contains("tolerance"), "{bracket}");
    let analysis = keys("measure.analysis");
    assert!(analysis.contains("  quantity") && !analysis.contains("  column"), "{analysis}");
    let error = study::FILE_KEYS.terminal(Some("axes")).unwrap_err().to_string();
    assert_eq!(error, "there is no section or key \"axes\": did you mean axis?");
}
