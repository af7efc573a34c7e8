//! `talcum new`: cases to begin with, which pass `talcum check` and never overwrite a file.

use crate::launch::talcum;

#[test]
fn cases_are_listed_and_each_is_written_and_valid() {
    let folder = tempfile::tempdir().unwrap();
    let listed = talcum(0, &["new"]);
    assert_eq!(listed.code(), Some(0), "{listed:?}");
    let names: Vec<&str> =
        listed.output.lines().filter_map(|line| line.split(' ').next()).collect();
    assert_eq!(names.len(), 12, "{}", listed.output);
    for name in names {
        let file = folder.path().join(name).with_extension("toml").display().to_string();
        let written = talcum(0, &["new", name, "--output", &file]);
        assert_eq!(written.code(), Some(0), "{written:?}");
        assert!(written.output.contains(&format!("talcum run {file}")), "{}", written.output);
        let checked = talcum(0, &["check", &file]);
        assert_eq!(checked.code(), Some(0), "{checked:?}");
    }
}

#[test]
fn nothing_is_written_over_and_what_does_not_exist_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml").display().to_string();
    std::fs::write(&file, "mine").unwrap();
    let ended = talcum(0, &["new", "spout", "--output", &file]);
    assert_eq!(ended.code(), Some(1));
    assert!(ended.error().contains("cannot be written") && ended.error().contains("mine.toml"));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    let ended = talcum(0, &["new", "spuot"]);
    assert_eq!(ended.code(), Some(1));
    assert!(ended.error().contains("there is no such case") && ended.error().contains("spout"));
}
