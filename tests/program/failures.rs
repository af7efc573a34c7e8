//! Failures end all ranks, with one message and an exit code, and never by a hang.

use crate::analyse::made::{CASE, Made};
use crate::launch::{
    Ended, checkpoints, in_repository, signal, smoke, start, start_program, talcum, wait_for_end_of,
};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Arguments that run a smoke case into a folder.
fn run(ranks: usize, name: &str, output: &Path, more: &[&str]) -> Ended {
    let (case, output) = (smoke(name), output.display().to_string());
    talcum(ranks, &[&["run", &case, "--output", &output], more].concat())
}

/// The error of a run that must fail with code 1.
fn failure(ended: &Ended) -> &str {
    assert_eq!(ended.code(), Some(1), "{}\n{}", ended.output, ended.errors);
    assert!(!ended.errors.contains("panicked"), "{}", ended.errors);
    assert!(!ended.output.contains("digest "), "{}", ended.output);
    ended.error()
}

#[test]
fn an_unreadable_case_stops_with_an_error_message() {
    for ranks in [0, 2] {
        let ended = talcum(ranks, &["run", "/nowhere/case.toml"]);
        let message = failure(&ended);
        assert!(message.contains("/nowhere/case.toml: cannot be read: No such file"), "{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    fs::write(&path, b"# a case\ntitle = \"\xff\"\n").unwrap();
    let ended = talcum(2, &["check", &path.display().to_string()]);
    assert!(failure(&ended).contains("case.toml:2: is not a text in UTF-8"), "{}", ended.errors);
}

#[test]
fn all_errors_of_a_case_are_reported_in_one_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    let text = fs::read_to_string(smoke("walls")).unwrap();
    let wrong =
        text.replace("restitution = 0.6", "restitution = 6").replace("friction =", "frction =");
    fs::write(&path, wrong).unwrap();
    let path = path.display().to_string();
    for (ranks, command) in [(0, "check"), (2, "run")] {
        let ended = talcum(ranks, &[command, &path, "--set", "time.end=-1"]);
        let message = failure(&ended);
        for expected in [
            "contact.restitution = 6: must be above 0 and at most 1",
            "contact.frction = 0.5: unknown key: did you mean friction?",
            "--set time.end=-1: time.end = -1: must be above 0",
        ] {
            assert!(message.contains(expected), "{expected}: {message}");
        }
    }
}

#[test]
fn a_limit_of_the_size_of_files_is_an_error_and_ends_no_command_without_a_message() {
    let made = Made::of(CASE);
    let folder = tempfile::tempdir().unwrap();
    let (here, results) = (folder.path().display(), made.path().display());
    let (case, study) = (smoke("walls"), in_repository("tests/program/study/study.toml"));
    let study = format!("study {} --output {here}/study", study.display());
    let run = format!("run {case} --output {here}/run --until 0.01");
    for command in [
        format!("analyse {results}"),
        format!("{study} --write-slurm"),
        format!("{run} --threads 2"),
    ] {
        let script = format!("ulimit -f 0; exec {} {command}", env!("CARGO_BIN_EXE_talcum"));
        let ended = Command::new("sh").args(["-c", &script]).output().unwrap();
        let message = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(1), "{command}: {message}");
        assert!(message.contains("File too large"), "{command}: {message}");
    }
}

#[test]
fn a_case_that_needs_more_memory_than_there_is_is_refused_at_once() {
    let huge =
        ["--set", "box.lengths=[4000.0, 4000.0, 4000.0]", "--set", "particles.count=1000000000"];
    for command in ["check", "run"] {
        let ended = talcum(0, &[&[command, &smoke("walls")], &huge[..]].concat());
        let message = failure(&ended);
        // 600 bytes for each of 1e9 particles.
        assert!(
            message.contains("needs about 600") && message.contains("--any-memory"),
            "{message}"
        );
    }
}

/// The bed needs 2 GB, and a process may have one.
#[test]
fn a_machine_without_memory_is_said_so_in_one_message() {
    let arguments = "--any-memory --set particles.count=10000000 --set box.lengths=[2000,2000,12]";
    for launcher in ["", "mpirun -n 2"] {
        let program = env!("CARGO_BIN_EXE_talcum");
        let script =
            format!("ulimit -v 1000000; {launcher} {program} check {} {arguments}", smoke("walls"));
        let ended = start_program(Path::new("/bin/sh"), 0, &["-c", &script]).wait();
        let messages = ended.errors.matches("error: rank").count();
        assert_eq!(ended.code(), Some(1), "{}", ended.errors);
        assert!((1..=2).contains(&messages), "{}", ended.errors);
        assert!(ended.errors.contains("is out of memory: it has"), "{}", ended.errors);
        assert!(!ended.errors.contains("panicked"), "{}", ended.errors);
    }
}

#[test]
fn a_rank_grid_that_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let ended = run(4, "staged", folder.path(), &["--ranks", "4,1,1"]);
    assert!(failure(&ended).contains("4 ranks along x cut the box into blocks"), "{ended:?}");
    assert!(failure(&ended).contains("use at most 3 along x"), "{ended:?}");
    let ended = run(4, "staged", folder.path(), &["--set", "parallel.axis=x"]);
    assert!(failure(&ended).contains("use at most 3 along x"), "{ended:?}");
    let ended = run(2, "staged", folder.path(), &["--ranks", "2,2,1"]);
    let message = failure(&ended);
    assert!(message.contains("the rank grid 2,2,1 needs 4 ranks, but 2 were started"), "{message}");
    let ended = run(0, "staged", folder.path(), &["--set", "parallel.ranks=[1,1,2]"]);
    let message = failure(&ended);
    assert!(
        message.contains("--set parallel.ranks=[1,1,2]: parallel.ranks = [1, 1, 2]: "),
        "{message}"
    );
    assert!(message.contains("(mpirun -n 2, or --threads 2)"), "{message}");
    // Nothing was begun.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn an_unstable_run_advises_a_shorter_time_step() {
    for ranks in [0, 2] {
        let folder = tempfile::tempdir().unwrap();
        let ended = run(ranks, "rank-equality", folder.path(), &["--set", "time.step=3.2e-3"]);
        let message = failure(&ended);
        assert!(message.contains("step ") && message.contains("shorten time.step"), "{message}");
        assert!(checkpoints(folder.path()).is_empty(), "no checkpoint of a state without meaning");
        assert!(message.contains("there is no checkpoint from before"), "{message}");
    }
}

/// The inlet becomes faster until a gas step of 20 of the particles' is too long, at the third.
#[test]
fn a_gas_step_that_is_too_long_leaves_the_state_of_the_gas_step_before() {
    let faster = ["--set", "gas.inlet_velocity={from=0.02, to=2000.0}"];
    for ranks in [0, 2] {
        let folder = tempfile::tempdir().unwrap();
        let go_on =
            |more: &[&str]| run(ranks, "fluidised", folder.path(), &[&faster, more].concat());
        let message = failure(&go_on(&[])).to_owned();
        let step = number_after(&message, "step ") as u64;
        assert!(message.contains("the gas's step of 5.000e-6 is too long"), "{message}");
        let newest = checkpoints(folder.path()).pop().unwrap();
        assert!(message.contains("the newest checkpoint is"), "{message}");
        assert!(message.contains(&newest.display().to_string()), "{message}");
        assert_eq!(
            newest.file_name().unwrap(),
            format!("checkpoint-{:012}.h5", step - 20).as_str()
        );
        // The same step fails again, a shorter one succeeds.
        assert_eq!(failure(&go_on(&["--resume"])).lines().next(), message.lines().next());
        let shorter = ["--resume", "--set", "time.step=1.25e-7", "--until", "1.1e-5"];
        go_on(&shorter).digest();
    }
}

#[test]
fn drag_beyond_all_limits_is_refused_before_it_is_summed() {
    // A grid so fine that a particle fills its nodes many times over: sums of the drag leave the range of integers.
    let folder = tempfile::tempdir().unwrap();
    let ended = run(2, "periodic-weight", folder.path(), &["--set", "gas.spacing=0.0090748"]);
    assert!(failure(&ended).contains("no superficial velocity"), "{}", ended.errors);
}

#[test]
fn a_particle_at_a_stop_face_ends_the_run_with_an_error() {
    for ranks in [0, 2] {
        let folder = tempfile::tempdir().unwrap();
        let low = ["--set", "box.lengths=[5.1,5.1,17.0]", "--set", "gas.superficial_velocity=0.9"];
        let ended = run(ranks, "rank-equality", folder.path(), &low);
        let message = failure(&ended);
        assert!(message.contains("passed the face \"z upper\" of the box"), "{message}");
        assert!(message.contains("the case ends the run there"), "{message}");
    }
}

#[test]
fn an_unwritable_output_folder_stops_all_ranks() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for ranks in [0, 2] {
        let ended = run(ranks, "walls", &file.join("results"), &[]);
        let message = failure(&ended);
        assert!(
            message.contains("file/results") && message.contains("Not a directory"),
            "{message}"
        );
    }
    // A file that stops being writable in the middle of the run: a folder in its place.
    let output = folder.path().join("results");
    fs::create_dir_all(output.join("profiles.h5")).unwrap();
    let ended = run(2, "walls", &output, &["--force"]);
    assert!(failure(&ended).contains("profiles.h5"), "{ended:?}");
}

#[test]
fn an_unwritable_checkpoint_stops_all_ranks() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("checkpoint-000000000400.h5.partial")).unwrap();
    let in_between = ["--resume", "--set", "checkpoint.every_steps=200"];
    let ended = run(3, "walls", folder.path(), &in_between);
    assert!(failure(&ended).contains("checkpoint-000000000400.h5.partial"), "{ended:?}");
    assert_eq!(checkpoints(folder.path()).len(), 1, "the one before is kept");
}

#[test]
fn files_that_are_not_checkpoints_are_refused() {
    let text = smoke("walls");
    for ranks in [0, 2] {
        for command in ["restart", "info"] {
            let ended = talcum(ranks, &[command, &text]);
            assert!(failure(&ended).contains("this is not an HDF5 file"), "{ended:?}");
            let ended = talcum(ranks, &[command, "/nowhere.h5"]);
            assert!(
                failure(&ended).contains("/nowhere.h5: cannot be opened: No such"),
                "{ended:?}"
            );
        }
    }
}

#[test]
fn an_invalid_command_line_has_exit_code_2() {
    let case = smoke("walls");
    for (ranks, arguments) in [
        (0, &["run", &case, "--outptu", "x"][..]),
        (2, &["run", &case, "--outptu", "x"]),
        (0, &["run", &case, "--force", "--resume"]),
        (0, &["run", &case, "--ranks", "2,0,1"]),
        (0, &["run", &case, "--until", "soon"]),
        (0, &["fly", &case]),
        (2, &["run"]),
    ] {
        let ended = talcum(ranks, arguments);
        assert_eq!(ended.code(), Some(2), "{arguments:?}: {ended:?}");
        ended.error();
    }
    for (ranks, argument, expected) in [(0, "--help", "Usage"), (2, "--version", "talcum 0")] {
        let ended = talcum(ranks, &[argument]);
        assert_eq!(
            (ended.code(), ended.output.matches(expected).count()),
            (Some(0), 1),
            "{ended:?}"
        );
    }
}

#[test]
fn an_impossible_end_time_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for until in ["nan", "inf", "--until=-1"] {
        let arguments = if until.starts_with('-') { vec![until] } else { vec!["--until", until] };
        let ended = run(0, "walls", folder.path(), &arguments);
        assert!(failure(&ended).contains("must be at least 0"), "{ended:?}");
    }
    run(0, "walls", folder.path(), &["--until", "0.1"]).digest();
    let ended = run(2, "walls", folder.path(), &["--resume", "--until", "0.05"]);
    assert!(failure(&ended).contains("must be at least 0.1, the time of the state"), "{ended:?}");
}

#[test]
fn killing_one_rank_ends_all() {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("rank-equality"), folder.path().display().to_string());
    let mut running = start(3, &["run", &case, "--output", &output, "--until", "1e6"]);
    let series = folder.path().join("series.csv");
    running.wait_until(|| fs::read_to_string(&series).unwrap_or_default().lines().count() > 10);
    let processes = running.rank_processes();
    assert_eq!(processes.len(), 3);
    signal("KILL", processes[1]);
    let ended = running.wait();
    assert_ne!(ended.code(), Some(0));
    wait_for_end_of(&processes);
}

#[test]
fn check_describes_the_run_and_writes_nothing() {
    for (ranks, name) in [(0, "staged"), (2, "polydisperse")] {
        let ended = talcum(ranks, &["check", &smoke(name)]);
        assert_eq!(ended.code(), Some(0), "{ended:?}");
        let ranks = if ranks == 0 { "1 rank".to_owned() } else { format!("{ranks} ranks") };
        for expected in ["time steps", "U_mf", "memory", "estimated run time", "rank 0: x"] {
            assert!(ended.output.contains(expected), "{expected}: {}", ended.output);
        }
        assert!(ended.output.contains(&format!("on {ranks}\n")), "{}", ended.output);
    }
}

/// The number after a text, up to the next that is no part of one.
fn number_after(text: &str, before: &str) -> f64 {
    let rest = text.split_once(before).unwrap_or_else(|| panic!("{before}: {text}")).1.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
    rest[..end].parse().unwrap()
}

/// The gas is so viscous that the run refuses its step; a number that is three quarters of the one that the run
/// enforces would pass: 2 C + V / 2 = 1.1 here, and 0.83 there.
#[test]
fn check_prints_the_viscous_number_that_the_run_enforces() {
    let folder = tempfile::tempdir().unwrap();
    // The weaker drag keeps the particles' response, which is judged first, within its own limit.
    let viscous = ["--set", "gas.viscosity=4.77e-4", "--set", "gas.drag_factor=0.005"];
    let ended = run(0, "fluidised", folder.path(), &viscous);
    let enforced = number_after(failure(&ended), "(Courant number) + ");
    let ended = talcum(0, &[&["check", &smoke("fluidised")][..], &viscous].concat());
    assert_eq!(ended.code(), Some(1), "the trial stops as the run does: {ended:?}");
    let line = ended.output.lines().find(|line| line.contains("viscous number")).unwrap();
    let uniform = number_after(line, "viscous number");
    let largest = number_after(line, "up to ");
    // The run's bed is not uniform, but nowhere empty beside dense; 0.001 for the digits of the message.
    assert!(uniform - 0.001 < enforced && enforced < largest, "{enforced}: {line}");
    assert!(uniform > 2.0, "{line}");
    assert!(ended.output.contains("the gas step is too long"), "{}", ended.output);
    // Negative control: the case as it is passes.
    let ended = talcum(0, &["check", &smoke("fluidised")]);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    assert!(!ended.output.contains("the gas step is too long"), "{}", ended.output);
}

#[test]
fn rounding_errors_of_a_uniform_flow_need_not_converge() {
    // The right-hand side of its pressure equation is rounding alone. The control: held to the tolerance relative to that, this
    // run ends at step 8 with "the pressure equation did not converge".
    let case = in_repository("tests/cases/good/uniform-suspension.toml");
    let folder = tempfile::tempdir().unwrap();
    let [case, output] = [&*case, folder.path()].map(|path| path.display().to_string());
    let ended = talcum(0, &["run", &case, "--output", &output]);
    assert_eq!(ended.code(), Some(0), "{}", ended.errors);
}
