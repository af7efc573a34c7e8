//! Files for schedulers: a Slurm array, and a workflow for row.

use crate::study::folder::{make_folder, write_whole};
use crate::study::session::Session;
use crate::study::setting::Setting;
use crate::study::task::{Task, TaskKind};
use std::path::{Path, PathBuf};

const SLURM: &str = include_str!("templates/study.slurm");
const ROW: &str = include_str!("templates/workflow.toml");
/// In the folder of a task of row: it is done.
const DONE: &str = "done";

/// Writes a Slurm array job for the study; returns its path.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn write_slurm(session: &Session<'_>, program: &Path) -> Result<PathBuf, String> {
    let root = session.folder.root();
    let path = root.join("study.slurm");
    let study = session.study;
    let text = SLURM
        .replace("{file}", &path.display().to_string())
        .replace("{tasks}", &session.plan.tasks.len().to_string())
        .replace("{limit}", &study.resources.at_a_time.to_string())
        .replace("{program}", &program.display().to_string())
        .replace("{study}", &in_shell(&study.file))
        .replace("{output}", &in_shell(root))
        .replace("{ranks}", &study.resources.ranks.to_string());
    make_folder(root)?;
    write_whole(&path, &text)?;
    Ok(path)
}

/// Writes a workflow for row, and a folder for each task with its values; returns the path.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn write_row(session: &Session<'_>, program: &Path) -> Result<PathBuf, String> {
    let root = session.folder.root();
    let path = root.join("workflow.toml");
    let study = session.study;
    // row changes into the folder of the workflow, so that its paths must not depend on where it is called.
    let text = ROW
        .replace("{program}", &in_toml(program)?)
        .replace("{study}", &in_toml(&study.file)?)
        .replace("{root}", &in_toml(root)?)
        .replace("{output}", &root.display().to_string())
        .replace("{ranks}", &study.resources.ranks.to_string());
    for task in &session.plan.tasks {
        let folder = task_folder(root, task);
        make_folder(&folder)?;
        write_whole(&folder.join("value.json"), &values(task))?;
    }
    write_whole(&path, &text)?;
    Ok(path)
}

/// Tells row that a task is done, if row has a folder for it.
///
/// # Errors
/// If that cannot be written.
pub(crate) fn tell_row(root: &Path, task: &Task) -> Result<(), String> {
    let folder = task_folder(root, task);
    if folder.is_dir() { write_whole(&folder.join(DONE), "") } else { Ok(()) }
}

fn task_folder(root: &Path, task: &Task) -> PathBuf {
    root.join("tasks").join(&task.name)
}

/// The values of a task as JSON, by which row selects and sorts.
fn values(task: &Task) -> String {
    let settings: &[Setting] = match &task.kind {
        TaskKind::Runs(members) => members.first().map_or(&[], |member| &member.settings),
        TaskKind::Search { settings, .. } => settings,
    };
    let entry = |setting: &Setting| {
        let value = match setting.value.number() {
            Some(_) => setting.value.plain(),
            None => json_text(&setting.value.plain()),
        };
        format!("  {}: {value}", json_text(&setting.key))
    };
    let entries: Vec<String> = settings.iter().map(entry).collect();
    format!("{{\n{}\n}}\n", entries.join(",\n"))
}

fn json_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// An absolute path in the shell's quotes, inside a text of TOML.
fn in_toml(path: &Path) -> Result<String, String> {
    // A bare name is a program that the shell finds.
    let is_bare = path.components().count() == 1 && !path.exists();
    let absolute = if is_bare { Ok(path.to_owned()) } else { std::path::absolute(path) };
    let absolute = absolute.map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(in_shell(&absolute).replace('\\', "\\\\").replace('"', "\\\""))
}

/// A path as one word of the shell.
fn in_shell(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=".contains(c);
    match text.chars().all(plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_texts_are_quoted_where_needed() {
        assert_eq!(in_shell(Path::new("a/b-c.toml")), "a/b-c.toml");
        assert_eq!(in_shell(Path::new("it's here")), "'it'\\''s here'");
        assert_eq!(json_text("a\"b\n"), "\"a\\\"b\\u000a\"");
    }
}
