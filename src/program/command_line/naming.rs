//! Title of a run: it gives the differences from its case file, and the state with which the run begins.

use talcum_results::analysis::Digest;
use talcum_runs::case::{Case, changes};
use talcum_runs::input::InputErrors;

/// Sections and keys that do not change the results, and are not named.
const WITHOUT_EFFECT: [&str; 4] = ["title", "parallel", "run", "checkpoint"];

/// Adds to the title the settings of the command line and the state with which the run begins; also in the text of the
/// case, which is part of results and checkpoints. A title that was set explicitly is unchanged.
pub(super) fn name_differences(
    case: &mut Case,
    set: &[String],
    begins_with: Option<&Digest>,
) -> Result<(), InputErrors> {
    let has_effect = |change: &&String| {
        let section = change.split(['.', '=']).next().unwrap_or("").trim();
        !WITHOUT_EFFECT.contains(&section)
    };
    let changes = set.iter().filter(has_effect).map(|change| match change.split_once('=') {
        Some((key, value)) => format!("{} = {}", key.trim(), value.trim()),
        None => change.clone(),
    });
    let start = begins_with.map(|digest| format!("begins with state {digest}"));
    let parts: Vec<String> = changes.chain(start).collect();
    let ending = format!(": {}", parts.join(", "));
    if parts.is_empty() || sets_title(set) || case.title.ends_with(&ending) {
        return Ok(());
    }
    let title = format!("{}{ending}", case.title);
    case.text = with_title(&case.text, &title)?;
    case.title = title;
    Ok(())
}

/// Takes over title and text from an earlier part of the same run, if only the title differs; returns whether this is
/// so.
pub(super) fn adopt_title(case: &mut Case, set: &[String], earlier: &str) -> bool {
    let differences = changes(earlier, &case.text);
    if sets_title(set) || !differences.iter().all(|change| change.key == "title") {
        return false;
    }
    let table: Option<toml::Table> = earlier.parse().ok();
    let title = table.and_then(|table| Some(table.get("title")?.as_str()?.to_owned()));
    case.title = title.unwrap_or_else(|| case.title.clone());
    earlier.clone_into(&mut case.text);
    true
}

fn sets_title(set: &[String]) -> bool {
    set.iter().any(|change| change.split('=').next().is_some_and(|key| key.trim() == "title"))
}

fn with_title(text: &str, title: &str) -> Result<String, InputErrors> {
    let title = toml::Value::String(title.to_owned());
    Case::text_with(text, "the case", &[format!("title={title}")])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn case(set: &[&str]) -> (Case, Vec<String>) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/program/study/bed.toml");
        let set: Vec<String> = set.iter().map(|change| (*change).to_owned()).collect();
        (Case::read(&path, &set).unwrap(), set)
    }

    #[test]
    fn the_title_names_what_changes_results_and_no_more() {
        let (plain, _) = case(&[]);
        let (mut changed, set) = case(&["contact.friction=0.3", "parallel.skin=0.2"]);
        name_differences(&mut changed, &set, None).unwrap();
        assert_eq!(changed.title, format!("{}: contact.friction = 0.3", plain.title));
        // The text agrees with the title, and reading it gives the same case.
        let again = Case::from_text(&changed.text, "again", Path::new(""), &[]).unwrap();
        assert_eq!(again.title, changed.title);
        // When it is called again, as by a restart with the same change, it adds nothing.
        let before = changed.clone();
        name_differences(&mut changed, &set, None).unwrap();
        assert_eq!(changed, before);
        for set in [&["parallel.skin=0.2"][..], &["title=\"own\"", "contact.friction=0.3"]] {
            let (mut unchanged, set) = case(set);
            let before = unchanged.title.clone();
            name_differences(&mut unchanged, &set, None).unwrap();
            assert_eq!(unchanged.title, before);
        }
    }

    #[test]
    fn a_resumed_run_keeps_its_title_and_a_changed_case_is_told() {
        let (mut begun, set) = case(&["contact.friction=0.3"]);
        name_differences(&mut begun, &set, None).unwrap();
        let (mut resumed, _) = case(&["contact.friction=0.3"]);
        assert!(adopt_title(&mut resumed, &set, &begun.text));
        assert_eq!((&resumed.title, &resumed.text), (&begun.title, &begun.text));
        let (mut other, set) = case(&["contact.friction=0.2"]);
        assert!(!adopt_title(&mut other, &set, &begun.text));
    }
}
