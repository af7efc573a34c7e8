//! Files in the place of results that are none.

use super::{arguments, run_in};
use crate::launch::{series, smoke, talcum};
use std::fs;
use std::process::Command;

#[test]
fn a_pipe_in_the_place_of_a_result_is_an_error_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let case = smoke("walls");
    let output = folder.path().display().to_string();
    talcum(0, &arguments(&run_in(folder.path(), &[]))).digest();
    let resume = ["run", &case, "--until", "0.11", "--resume", "--output", &output];
    let files =
        ["series.csv", "profiles.h5", "particles.vtkhdf", "profiles.h5.metadata", "case.toml"];
    for name in files {
        let path = folder.path().join(name);
        let aside = folder.path().join("aside");
        fs::rename(&path, &aside).unwrap();
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        let commands =
            [&resume[..], &["analyse", &output], &["summary", &output], &["watch", &output]];
        for command in commands {
            let ended = talcum(0, command);
            // That all of them end is what is tested; who reads the file says what it is.
            let is_read = match command[0] {
                "run" => name != "case.toml",
                "analyse" => name != "profiles.h5.metadata",
                "summary" => ["series.csv", "case.toml"].contains(&name),
                _ => ["series.csv", "case.toml"].contains(&name),
            };
            let said = ended.errors.contains("this is not a file")
                || ended.output.contains("this is not a file");
            assert_eq!(said, is_read, "{name}: {command:?}: {ended:?}");
            if command[0] == "run" && name == "case.toml" {
                assert!(fs::metadata(&path).unwrap().is_file(), "the case is written anew");
                assert!(
                    Command::new("mkfifo")
                        .arg(folder.path().join("pipe"))
                        .status()
                        .unwrap()
                        .success()
                );
                fs::rename(folder.path().join("pipe"), &path).unwrap();
            }
        }
        fs::rename(&aside, &path).unwrap();
    }
    assert!(!series(folder.path()).is_empty());
}
