//! Files for schedulers: a Slurm array, and a workflow for row.

use crate::study::folder::{make_folder, write_whole};
use crate::study::session::Session;
use crate::study::setting::Setting;
use crate::study::task::{Task, TaskKind};
use std::path::{Path, PathBuf};

const SLURM: &str = include_str!("templates/study.slurm");
const ROW: &str = include_str!("templates/workflow.toml");
/// Command that row calls for a task, with the task's name inserted at `{directory}`.
const ROW_COMMAND: &str = "{program} study {study} --output {root} --run {directory} --at-a-time 1 \
    --ranks-per-run {ranks} --launcher 'srun -n {ranks}'";
/// File in the folder of a task of row that marks it as done.
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
        .replace("{file}", &in_shell(&path))
        .replace("{tasks}", &session.plan.tasks.len().to_string())
        .replace("{limit}", &study.resources.at_a_time.to_string())
        .replace("{program}", &in_shell(program))
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
    // row changes into the folder of the workflow, so paths must not depend on the folder in which it is called.
    let ranks = study.resources.ranks.to_string();
    let command = ROW_COMMAND
        .replace("{program}", &in_shell(&absolute(program)?))
        .replace("{study}", &in_shell(&absolute(&study.file)?))
        .replace("{root}", &in_shell(&absolute(root)?))
        .replace("{ranks}", &ranks);
    let text = ROW
        .replace("{root}", &in_shell(root))
        .replace("{ranks}", &ranks)
        .replace("{command}", &toml_edit::Value::from(command).to_string());
    for task in &session.plan.tasks {
        let folder = task_folder(root, task);
        make_folder(&folder)?;
        write_whole(&folder.join("value.json"), &values(task))?;
    }
    write_whole(&path, &text)?;
    Ok(path)
}

/// Informs row that a task is done, if row has a folder for it.
///
/// # Errors
/// If this cannot be written.
pub(crate) fn tell_row(root: &Path, task: &Task) -> Result<(), String> {
    let folder = task_folder(root, task);
    if folder.is_dir() { write_whole(&folder.join(DONE), "") } else { Ok(()) }
}

fn task_folder(root: &Path, task: &Task) -> PathBuf {
    root.join("tasks").join(&task.name)
}

/// The values of a task as JSON, which row uses to select and sort.
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
    serde_json::Value::from(text).to_string()
}

/// An absolute path; a bare name is a program that the shell finds, and is unchanged.
fn absolute(path: &Path) -> Result<PathBuf, String> {
    if path.components().count() == 1 && !path.exists() {
        return Ok(path.to_owned());
    }
    std::path::absolute(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// A path as one word of bash, on one line and without braces, so that it is allowed in a comment and where row, or the
/// templates here, replace words in braces.
fn in_shell(path: &Path) -> String {
    let bytes = path.as_os_str().as_encoded_bytes();
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"/._-+=".contains(byte);
    let is_shown = |c: char| !c.is_control() && !"{}".contains(c);
    match std::str::from_utf8(bytes) {
        Ok(text) if !bytes.is_empty() && bytes.iter().all(is_plain) => text.to_owned(),
        Ok(text) if text.chars().all(is_shown) => format!("'{}'", text.replace('\'', "'\\''")),
        _ => in_ansi_c_quotes(bytes),
    }
}

/// Any bytes as one word of bash: `$'...'`.
fn in_ansi_c_quotes(bytes: &[u8]) -> String {
    let mut word = String::from("$'");
    for &byte in bytes {
        match byte {
            b'\\' | b'\'' | b'{' | b'}' | 0x80.. => word += &format!("\\x{byte:02x}"),
            byte if byte.is_ascii_control() => word += &format!("\\x{byte:02x}"),
            byte => word.push(char::from(byte)),
        }
    }
    word + "'"
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::Command;

    /// Names with a special meaning for a shell, for row, or for the templates, or with bytes that are not text.
    const NAMES: [&[u8]; 12] = [
        b"plain/b-c.toml",
        b"it's here",
        b"\"quoted\"",
        b"a}b",
        b"{study}",
        b"$(echo executed)",
        b"`echo executed`",
        b"a\nb",
        b"\x1b\x7f\\",
        "e\u{301}\u{a0}\u{85}".as_bytes(),
        b"not utf-8: \xff",
        b"-n",
    ];

    #[test]
    fn bash_reads_any_path_back_and_a_comment_keeps_it() {
        for name in NAMES {
            let word = in_shell(Path::new(OsStr::from_bytes(name)));
            let script = format!("# a comment with {word}\nprintf %s {word}");
            let output = Command::new("bash").args(["-c", &script]).output().unwrap();
            assert_eq!(output.stdout, name, "{word}");
            assert!(output.stderr.is_empty(), "{word}");
        }
    }

    #[test]
    fn plain_paths_are_not_quoted() {
        assert_eq!(in_shell(Path::new("a/b-c.toml")), "a/b-c.toml");
        assert_eq!(in_shell(Path::new("it's here")), "'it'\\''s here'");
        assert_eq!(json_text("a\"b\n"), "\"a\\\"b\\n\"");
    }
}
