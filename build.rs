//! Tells the program which commit it is built from, so that its results can say so.

use std::process::Command;

/// What cargo puts into a package of a registry, where there is no repository.
const PACKAGED: &str = ".cargo_vcs_info.json";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Ok(text) = std::fs::read_to_string(PACKAGED) {
        println!("cargo::rerun-if-changed={PACKAGED}");
        say_commit(packaged_commit(&text));
        return;
    }
    say_commit(git(&["rev-parse", "HEAD"]));
    // The log of HEAD grows with every commit and every change of branch.
    for name in ["logs/HEAD", "HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", name])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
}

fn say_commit(commit: Option<String>) {
    println!("cargo::rustc-env=TALCUM_COMMIT={}", commit.as_deref().unwrap_or("unknown"));
}

/// The value of "sha1" in cargo's file.
fn packaged_commit(text: &str) -> Option<String> {
    let value = text.split("\"sha1\"").nth(1)?.split('"').nth(1)?;
    let is_hash = value.len() == 40 && value.chars().all(|c| c.is_ascii_hexdigit());
    is_hash.then(|| value.to_owned())
}

/// What git answers; nothing outside a repository or without git.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let answer = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !answer.is_empty()).then_some(answer)
}
