//! The text of a case: the identity of its run, and the case of a continued run.

use crate::study::definition::Continuation;
use crate::study::setting::shortest;
use std::collections::BTreeMap;
use talcum_runs::case::{for_each_value, use_first_names};
use toml::{Table, Value};
use toml_edit::{DocumentMut, InlineTable, Item};

/// A case with the settings of one run, without comments and layout.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EffectiveCase(Table);

/// Removes the checksums of meshes, which a run adds to its case.
fn remove_checksums(case: &mut Table) {
    let walls = case.get_mut("wall").and_then(Value::as_array_mut).into_iter().flatten();
    let meshes = walls.filter_map(|wall| wall.get_mut("mesh").and_then(Value::as_table_mut));
    meshes.for_each(|mesh| drop(mesh.remove("checksum")));
}

/// Sections and keys that do not change the results.
const WITHOUT_EFFECT: [&str; 4] = ["title", "parallel", "run", "checkpoint"];

impl EffectiveCase {
    /// Reads the text of a case with all its settings.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        text.parse().map(Self).map_err(|error| format!("not valid TOML: {error}"))
    }

    /// BLAKE3 hash of all settings that determine the results. `start` identifies the state with which the run starts,
    /// if this is the end of another run of the study.
    pub(crate) fn identity(&self, start: Option<&str>) -> String {
        let mut table = self.0.clone();
        use_first_names(&mut table);
        for key in WITHOUT_EFFECT {
            table.remove(key);
        }
        remove_checksums(&mut table);
        if let Some(start) = start {
            table.insert("begins with".to_owned(), Value::String(start.to_owned()));
            if let Some(Value::Table(particles)) = table.get_mut("particles") {
                particles.remove("start");
            }
        }
        blake3::hash(table.to_string().as_bytes()).to_hex().to_string()
    }

    /// The case as TOML, without comments.
    #[cfg(test)]
    pub(crate) fn text(&self) -> String {
        self.0.to_string()
    }

    /// All keys that determine the results, by their paths, with their values as texts.
    pub(crate) fn flat(&self) -> BTreeMap<String, String> {
        let mut all = BTreeMap::new();
        let mut table = self.0.clone();
        WITHOUT_EFFECT.iter().for_each(|&key| drop(table.remove(key)));
        for_each_value(&table, &mut |key, value| {
            let text = match value {
                Value::String(text) => text.clone(),
                Value::Float(number) => shortest(*number),
                other => other.to_string(),
            };
            all.insert(key.to_owned(), text);
        });
        all
    }

    /// Time at which the run ends, if the case gives it.
    pub(crate) fn end_time(&self) -> Option<f64> {
        let Some(Value::Array(stages)) = self.0.get("stage") else {
            return number(self.0.get("time")?.get("end")?);
        };
        let durations: Option<Vec<f64>> =
            stages.iter().map(|stage| number(stage.get("duration")?)).collect();
        Some(durations?.iter().sum())
    }

    /// The earliest possible time of the last row of `series.csv` of a run that has come to its end. Rows are due at
    /// multiples of their interval, and are written at the nearest step.
    pub(crate) fn last_row(&self) -> Option<f64> {
        /// Rounding error of sums of steps; far below any interval.
        const ROUNDING: f64 = 1.0e-9;
        let end = self.end_time()?;
        let interval = number(self.0.get("output")?.get("series")?)?;
        let step = number(self.0.get("time")?.get("step")?)?;
        let rows = (end / interval * (1.0 + ROUNDING)).floor();
        Some(rows * interval - 0.5 * step - ROUNDING * end)
    }

    /// The title.
    pub(crate) fn title(&self) -> Option<&str> {
        self.0.get("title")?.as_str()
    }

    /// The kind of the start of the particles, for example `lattice`.
    pub(crate) fn start_kind(&self) -> Option<&str> {
        self.0.get("particles")?.get("start")?.get("kind")?.as_str()
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|whole| whole as f64))
}

/// Keys of the case that a continued run must not have: its particles come from the previous run.
const OF_A_NEW_BED: [&str; 2] = ["count", "fill_height"];

/// Whether a setting is not valid for a continued run.
pub(crate) fn belongs_to_a_new_bed(key: &str) -> bool {
    let below = |outer: &str| {
        key.strip_prefix("particles.")
            .and_then(|inner| inner.strip_prefix(outer))
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    below("start") || OF_A_NEW_BED.into_iter().any(below)
}

/// The case of continued runs: the bed is the end of another run, whose path is set for each run, and the stages before
/// the named one are left out.
///
/// # Errors
/// If the text is not TOML, or lacks the keys to be changed.
pub(crate) fn continued(text: &str, continuation: &Continuation) -> Result<String, String> {
    let mut document: DocumentMut =
        text.parse().map_err(|error| format!("not valid TOML: {error}"))?;
    let particles = document.get_mut("particles").and_then(Item::as_table_like_mut);
    let particles = particles.ok_or("it has no section [particles]")?;
    for key in OF_A_NEW_BED {
        particles.remove(key);
    }
    let mut start = InlineTable::new();
    start.insert("kind", "run".into());
    start.insert("path", "set for each run".into());
    particles.insert("start", Item::Value(start.into()));
    if let Some(first) = &continuation.from_stage {
        let stages = document.get_mut("stage").and_then(Item::as_array_of_tables_mut);
        let stages = stages.ok_or("it has no stages")?;
        let named = |stage: &toml_edit::Table| {
            stage.get("name").and_then(Item::as_str) == Some(first.as_str())
        };
        let position = stages.iter().position(named);
        let position = position.ok_or(format!("it has no stage named {first:?}"))?;
        (0..position).for_each(|_| drop(stages.remove(0)));
    }
    Ok(document.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_runs::case::Case;

    const TEXT: &str = "title = \"x\"\n[particles]\ncount = 5\nseed = 1 # one\n[particles.start]\nkind = \"lattice\"\n[gas]\nviscosity = 1.0\n[[stage]]\nname = \"pour\"\nduration = 2\n[[stage]]\nname = \"go on\"\nduration = 3.5\n";

    fn case(text: &str, settings: &[&str]) -> EffectiveCase {
        let overrides: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
        let text = Case::text_with(text, "bed.toml", &overrides).unwrap();
        EffectiveCase::parse(&text).unwrap()
    }

    fn identity(text: &str, settings: &[&str]) -> String {
        case(text, settings).identity(None)
    }

    #[test]
    fn the_checksum_of_a_mesh_which_a_run_adds_changes_no_identity() {
        let wall =
            |keys: &str| identity(&format!("{TEXT}\n[[wall]]\nname = \"m\"\nmesh = {keys}\n"), &[]);
        let plain = wall("{ file = \"m.stl\" }");
        assert_eq!(wall("{ file = \"m.stl\", checksum = \"0a\" }"), plain);
        assert_ne!(wall("{ file = \"n.stl\" }"), plain);
    }

    #[test]
    fn the_identity_knows_physics_but_not_layout() {
        let plain = identity(TEXT, &[]);
        let text = TEXT.replace("# one", "# the seed").replace("\"x\"", "\"y\"");
        assert_eq!(plain, identity(&format!("{text}\n[checkpoint]\nevery = 1.0\n"), &[]));
        assert_eq!(plain, identity(TEXT, &["particles.seed=1"]));
        assert_ne!(plain, identity(TEXT, &["particles.seed=2"]));
        let by_name = identity(TEXT, &["stage.pour.duration=3"]);
        assert_eq!(by_name, identity(TEXT, &["stage.1.duration=3"]));
        assert_ne!(by_name, plain);
        let stokes = case(TEXT, &["gas.stokes_number=55"]);
        assert!(!stokes.text().contains("viscosity"));
    }

    #[test]
    fn a_case_knows_its_end_and_its_start() {
        let case = case(TEXT, &["stage.2.duration=4"]);
        assert_eq!(case.end_time(), Some(6.0));
        assert_eq!(case.start_kind(), Some("lattice"));
    }

    #[test]
    fn a_continued_run_takes_its_bed_from_another() {
        let mut continuation =
            Continuation { axis: 0, from_stage: Some("go on".to_owned()), settings: Vec::new() };
        let text = continued(TEXT, &continuation).unwrap();
        let case = EffectiveCase::parse(&text).unwrap();
        assert_eq!((case.start_kind(), case.end_time()), (Some("run"), Some(3.5)));
        assert!(!text.contains("count") && text.contains("seed = 1 # one"), "{text}");
        continuation.from_stage = Some("nowhere".to_owned());
        assert!(continued(TEXT, &continuation).unwrap_err().contains("nowhere"));
        assert!(belongs_to_a_new_bed("particles.start.jitter"));
        assert!(belongs_to_a_new_bed("particles.count"));
        assert!(!belongs_to_a_new_bed("particles.seed"));
    }
}
