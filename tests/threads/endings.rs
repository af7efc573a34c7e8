//! Early ends of runs on threads: by signals, with a checkpoint; by errors, with one message and an exit code.

use super::on_threads;
use crate::launch::{Ended, checkpoints, signal, smoke, start, start_with, talcum};
use std::fs;
use std::path::Path;

/// The error of a run that must fail with code 1, without panics or a digest.
fn failure(ended: &Ended) -> &str {
    assert_eq!(ended.code(), Some(1), "{}\n{}", ended.output, ended.errors);
    assert!(!ended.errors.contains("panicked"), "{}", ended.errors);
    assert!(!ended.output.contains("digest "), "{}", ended.output);
    ended.error()
}

/// Stops an endless run by a signal; a run that continues from there must reach the state of an uninterrupted run.
fn assert_stops_on(name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("rank-equality"), folder.path().display().to_string());
    let endless = ["run", &case, "--threads", "2", "--until", "1e6", "--output", &output];
    let mut running = start(0, &endless);
    let series = folder.path().join("series.csv");
    running.wait_until(|| fs::read_to_string(&series).unwrap_or_default().lines().count() > 20);
    // A second run in the same folder is refused meanwhile.
    let second = on_threads(1, "rank-equality", folder.path(), &["--resume"]);
    assert!(failure(&second).contains("another run is writing here"), "{}", second.errors);
    signal(name, running.process());
    let ended = running.wait();
    assert!(ended.output.contains("stopped at time "), "{}\n{}", ended.output, ended.errors);
    let newest = checkpoints(folder.path()).pop().unwrap().display().to_string();
    assert_eq!(talcum(0, &["info", &newest]).digest(), ended.digest());
    let stopped = ended.output.split_once("stopped at time ").unwrap().1;
    let stopped: f64 = stopped.split(' ').next().unwrap().parse().unwrap();
    let until = (stopped + 0.05).to_string();
    let resumed =
        on_threads(2, "rank-equality", folder.path(), &["--resume", "--until", &until]).digest();
    let whole = tempfile::tempdir().unwrap();
    let expected = on_threads(1, "rank-equality", whole.path(), &["--until", &until]).digest();
    assert_eq!(resumed, expected);
}

#[test]
fn signals_stop_threads_with_a_checkpoint() {
    ["TERM", "INT"].iter().for_each(|name| assert_stops_on(name));
}

#[test]
fn a_wall_clock_limit_stops_threads_with_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let limit = ["--set", "run.wall_clock=1s", "--until", "1e6"];
    let ended = on_threads(2, "walls", folder.path(), &limit);
    ended.digest();
    assert!(ended.output.contains("stopped at time "), "{}", ended.output);
    assert!(!checkpoints(folder.path()).is_empty());
}

#[test]
fn an_error_on_threads_is_one_message() {
    for threads in [1, 2, 3] {
        let folder = tempfile::tempdir().unwrap();
        let unstable = ["--set", "time.step=3.2e-3"];
        let ended = on_threads(threads, "rank-equality", folder.path(), &unstable);
        let message = failure(&ended);
        assert!(message.contains("shorten time.step"), "{message}");
        assert!(checkpoints(folder.path()).is_empty(), "no checkpoint of a meaningless state");
    }
    let folder = tempfile::tempdir().unwrap();
    let ended = on_threads(2, "staged", folder.path(), &["--ranks", "2,2,1"]);
    assert!(failure(&ended).contains("needs 4 ranks, but 2 were started"), "{}", ended.errors);
    for wrong in ["0", "1.5", "two", "100000"] {
        let ended = talcum(0, &["run", &smoke("walls"), "--threads", wrong]);
        assert_eq!(ended.code(), Some(2), "{wrong}: {}", ended.errors);
        assert!(ended.errors.contains("--threads"), "{wrong}: {}", ended.errors);
    }
}

/// A message appears once in the log, whichever rank it comes from.
#[test]
fn a_stage_is_logged_once() {
    let folder = tempfile::tempdir().unwrap();
    let ended = on_threads(4, "staged", folder.path(), &[]);
    ended.digest();
    let begins = ended.errors.lines().filter(|line| line.contains("stage \"gas on\" begins"));
    assert_eq!(begins.count(), 1, "{}", ended.errors);
}

/// Otherwise each process would run the whole case.
#[test]
fn threads_of_several_processes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().display().to_string();
    let case = smoke("walls");
    let run = ["run", &case, "--threads", "2", "--output", &output];
    for [size, rank] in [["PMI_SIZE", "PMI_RANK"], ["SLURM_STEP_NUM_TASKS", "SLURM_PROCID"]] {
        let of = |number: &str| [(size, "4".to_owned()), (rank, number.to_owned())];
        let ended = start_with(&of("0"), 0, &run).wait();
        assert!(failure(&ended).contains("4 processes were started together"), "{ended:?}");
        let ended = start_with(&of("3"), 0, &run).wait();
        assert_eq!((ended.code(), ended.errors.as_str()), (Some(1), ""), "only the first reports");
    }
    if cfg!(feature = "mpi") {
        let ended = talcum(2, &run);
        assert!(failure(&ended).contains("2 processes were started together"), "{ended:?}");
        // One process under mpirun is alone.
        talcum(1, &run).digest();
    }
}

#[test]
fn a_lack_of_memory_is_reported_in_one_message() {
    let program = env!("CARGO_BIN_EXE_talcum");
    let arguments =
        "--threads 2 --any-memory --set particles.count=10000000 --set box.lengths=[2000,2000,12]";
    let script = format!("ulimit -v 1000000; {program} check {} {arguments}", smoke("walls"));
    let ended = crate::launch::start_program(Path::new("/bin/sh"), 0, &["-c", &script]).wait();
    assert!(failure(&ended).contains("error: out of memory: the program has"), "{}", ended.errors);
}

/// The limits are such that ranks find no memory at the same time, in some of the runs.
#[test]
fn ranks_that_are_out_of_memory_together_end_with_the_same_message() {
    let program = env!("CARGO_BIN_EXE_talcum");
    for limit in (250_000..350_000).step_by(10_000) {
        let arguments =
            "--threads 4 --any-memory --set particles.count=400000 --set box.lengths=[400,400,12]";
        let script =
            format!("ulimit -v {limit}; exec {program} check {} {arguments}", smoke("walls"));
        let ended = crate::launch::start_program(Path::new("/bin/sh"), 0, &["-c", &script]).wait();
        assert_eq!(ended.code(), Some(1), "{limit}: {}", ended.errors);
        let messages = ended.errors.matches("error: ").count();
        assert_eq!(messages, 1, "{limit}: {}", ended.errors);
    }
}

/// A process takes some 50 MB, and a thread hardly any.
#[test]
fn threads_are_not_counted_as_processes_in_the_estimate_of_memory() {
    let case = smoke("walls");
    let estimate = |ended: crate::launch::Ended| {
        let said = ended.output.clone() + &ended.errors;
        let line = said.lines().find_map(|line| line.trim().strip_prefix("memory: about "));
        line.unwrap_or_else(|| panic!("{said}")).to_owned()
    };
    let on_threads = |threads| estimate(talcum(0, &["check", case.as_str(), "--threads", threads]));
    assert_eq!(on_threads("1"), on_threads("2"));
    if cfg!(feature = "mpi") {
        assert_ne!(on_threads("2"), estimate(talcum(2, &["check", case.as_str()])));
    }
}
