//! Results that were damaged between two runs: no row is lost without a warning.

use super::{arguments, run_in};
use crate::launch::{series, smoke, talcum};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Lines of Python with the HDF5 file `f` open to change, and numpy as `np`.
fn python(file: &Path, lines: &str) -> String {
    let open = format!("f = h5py.File({:?}, 'r+', locking=False)", file.display().to_string());
    let script = format!("import h5py\nimport numpy as np\n{open}\n{lines}\nf.close()\n");
    let mut command = Command::new(crate::snapshots::python());
    let done = command.args(["-c", &script]).output().unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{errors}");
    String::from_utf8_lossy(&done.stdout).trim().to_owned()
}

fn count_unreadable(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).unwrap().flatten();
    entries.filter(|entry| entry.file_name().to_string_lossy().contains("unreadable")).count()
}

/// What is damaged, and how the rows are counted that are there.
const DAMAGES: [[&str; 3]; 6] = [
    ["profiles.h5", "f['time'][3] = 0.0", "print(list(f['time'][:]))"],
    ["profiles.h5", "f['time'][-1] = np.nan", "print(list(f['time'][:]))"],
    ["profiles.h5", "f['time'][2] = 1e9", "print(list(f['time'][:]))"],
    [
        "particles.vtkhdf",
        "f['VTKHDF/Steps/Values'][2] = 0.0",
        "print(list(f['VTKHDF/Steps/Values'][:]))",
    ],
    [
        "particles.vtkhdf",
        "f['VTKHDF/NumberOfPoints'][2:4] = 0",
        "print(list(f['VTKHDF/NumberOfPoints'][:]))",
    ],
    [
        "particles.vtkhdf",
        "f['VTKHDF/Steps/PointOffsets'][3] = 7",
        "print(list(f['VTKHDF/Steps/PointOffsets'][:]))",
    ],
];

#[test]
fn times_and_counts_that_were_damaged_are_mended_from_the_copy_or_the_file_is_set_aside() {
    let whole = tempfile::tempdir().unwrap();
    let digest = talcum(0, &arguments(&run_in(whole.path(), &[]))).digest();
    for [name, damage, count] in DAMAGES {
        let expected = python(&whole.path().join(name), count);
        for has_copy in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            for entry in fs::read_dir(whole.path()).unwrap().flatten() {
                fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
            }
            let path = folder.path().join(name);
            python(&path, damage);
            if !has_copy {
                fs::remove_file(folder.path().join(format!("{name}.metadata"))).unwrap();
            }
            let resumed = talcum(0, &arguments(&run_in(folder.path(), &["--resume"])));
            assert_eq!(resumed.digest(), digest);
            let is_told = resumed.errors.contains("cannot be continued");
            assert_eq!(is_told, !has_copy, "{damage}, copy: {has_copy}: {}", resumed.errors);
            assert_eq!(count_unreadable(folder.path()), usize::from(is_told), "{damage}");
            if has_copy {
                assert_eq!(python(&path, count), expected, "{damage}");
            }
        }
    }
}

#[test]
fn rows_of_a_file_without_its_copy_are_lost_with_a_warning_if_their_time_seems_later() {
    let folder = tempfile::tempdir().unwrap();
    let digest = talcum(0, &arguments(&run_in(folder.path(), &[]))).digest();
    fs::remove_file(folder.path().join("profiles.h5.metadata")).unwrap();
    python(&folder.path().join("profiles.h5"), "f['time'][-1] = 1e9");
    for is_lost in [true, false] {
        let resumed = talcum(0, &arguments(&run_in(folder.path(), &["--resume"])));
        assert_eq!(resumed.digest(), digest);
        let warning = "profiles.h5.metadata is not there";
        assert_eq!(resumed.errors.contains(warning), is_lost, "{}", resumed.errors);
    }
}

#[test]
fn a_row_of_one_wall_whose_time_seems_later_is_lost_with_a_warning() {
    for (time, is_lost) in [("1e9", true), ("0.1", false)] {
        let folder = tempfile::tempdir().unwrap();
        let more = ["--set", "output.walls=0.01"];
        let digest = talcum(0, &arguments(&run_in(folder.path(), &more))).digest();
        let path = folder.path().join("walls.csv");
        let text = fs::read_to_string(&path).unwrap();
        let (rows, last) = text.trim_end().rsplit_once("\n0.1,").unwrap();
        fs::write(&path, format!("{rows}\n{time},{last}\n")).unwrap();
        let more = [&more[..], &["--resume"]].concat();
        let resumed = talcum(0, &arguments(&run_in(folder.path(), &more)));
        assert_eq!(resumed.digest(), digest);
        let warning = "walls.csv: its rows end at time 0.09, before 0.1";
        assert_eq!(resumed.errors.contains(warning), is_lost, "{}", resumed.errors);
    }
}

#[test]
fn a_row_of_the_series_whose_time_is_damaged_is_left_out_with_a_warning() {
    for wrong in ["NaN", "1e9", "0"] {
        let folder = tempfile::tempdir().unwrap();
        let digest = talcum(0, &arguments(&run_in(folder.path(), &[]))).digest();
        let path = folder.path().join("series.csv");
        let whole = fs::read_to_string(&path).unwrap();
        let row = whole.lines().find(|line| line.starts_with("0.05,")).unwrap();
        fs::write(&path, whole.replace(row, &row.replacen("0.05", wrong, 1))).unwrap();
        let resumed = talcum(0, &arguments(&run_in(folder.path(), &["--resume"])));
        assert_eq!(resumed.digest(), digest);
        assert!(resumed.errors.contains("damaged rows are left out"), "{}", resumed.errors);
        assert_eq!(fs::read_to_string(&path).unwrap(), whole.replace(&format!("{row}\n"), ""));
    }
}

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
                assert!(fs::metadata(&path).unwrap().is_file(), "the case is written again");
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
