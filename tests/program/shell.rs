//! Completions and manual pages know every command and option of the program.

use crate::launch::talcum;
use std::fs;

/// The commands that the program's help lists.
fn commands() -> Vec<String> {
    let help = talcum(0, &["--help"]).output;
    let list = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    names.filter(|name| !name.is_empty() && *name != "help").map(str::to_owned).collect()
}

#[test]
fn completions_of_all_shells_offer_all_commands_and_options() {
    let commands = commands();
    assert!(commands.len() > 8, "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ended = talcum(0, &["completions", shell]);
        assert_eq!(ended.code(), Some(0), "{}", ended.errors);
        let words = commands.iter().map(String::as_str).chain(["until", "resume", "at-a-time"]);
        for word in words {
            assert!(ended.output.contains(word), "{shell}: {word}");
        }
        assert!(!ended.output.contains("no-such-option"), "{shell}");
    }
    let ended = talcum(0, &["completions", "tcsh"]);
    assert_eq!(ended.code(), Some(2), "{}", ended.output);
    assert!(ended.errors.contains("possible values: bash, elvish, fish"), "{}", ended.errors);
}

#[test]
fn there_is_a_manual_page_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share/man/man1");
    assert_eq!(talcum(0, &["manual", &pages.display().to_string()]).code(), Some(0));
    let page = |name: &str| fs::read_to_string(pages.join(name)).unwrap();
    let overview = page("talcum.1");
    for command in commands() {
        assert!(page(&format!("talcum-{command}.1")).contains(".SH SYNOPSIS"), "{command}");
        assert!(overview.contains(&format!("talcum\\-{command}(1)")), "{command}: {overview}");
    }
    assert!(page("talcum-run.1").contains("\\-\\-resume"));
    // A folder that cannot be made is an error with its name.
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let ended = talcum(0, &["manual", &file.display().to_string()]);
    assert_eq!(ended.code(), Some(1));
    assert!(ended.error().contains("file: the manual pages cannot be written"), "{}", ended.errors);
}
