//! A run that ends early for any reason resumes from a checkpoint and gives the same bits: signals, wall-clock limits,
//! a kill at any instant, a damaged file.

use crate::launch::{
    Ended, Running, checkpoints, series, signal, smoke, start, talcum, wait_for_end_of,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// Starts a run that does not end by itself, and waits until it is under way.
fn endless(ranks: usize, case: &str, output: &Path, more: &[&str]) -> Running {
    let folder = text(output);
    let without_end = ["run", case, "--output", &folder, "--until", "1e6"];
    let mut running = start(ranks, &[&without_end, more].concat());
    let rows = || fs::read_to_string(output.join("series.csv")).unwrap_or_default().lines().count();
    let before = rows();
    running.wait_until(|| rows() > 10 && rows() != before);
    running
}

/// The time at which a run stopped, as it says.
fn stop_time(ended: &Ended) -> f64 {
    assert_eq!(ended.code(), Some(0), "{}\n{}", ended.output, ended.errors);
    let message = ended.output.split_once("stopped at time ").expect("says when it stopped").1;
    message.split(' ').next().unwrap().parse().unwrap()
}

/// Resumes the run in a folder for a while; it must come to the state of a run without interruption.
fn assert_resumes(case: &str, output: &Path, stopped: f64, ranks: usize) -> Ended {
    let until = (stopped + 0.1).to_string();
    let resumed =
        talcum(ranks, &["run", case, "--resume", "--output", &text(output), "--until", &until]);
    let message = format!(" at time {stopped}, state ");
    assert!(resumed.output.contains(&message), "{message}: {}", resumed.output);
    let whole = tempfile::tempdir().unwrap();
    let expected = talcum(0, &["run", case, "--output", &text(whole.path()), "--until", &until]);
    assert_eq!(resumed.digest(), expected.digest());
    assert_eq!(series(output), series(whole.path()));
    resumed
}

fn assert_stops_on(name: &str, ranks: usize) {
    let folder = tempfile::tempdir().unwrap();
    let case = smoke("rank-equality");
    let running = endless(ranks, &case, folder.path(), &[]);
    let processes = running.rank_processes();
    assert_eq!(processes.len(), ranks.max(1));
    processes.iter().for_each(|&process| signal(name, process));
    let ended = running.wait();
    let stopped = stop_time(&ended);
    let how = format!("resume with: talcum run {case} --resume --output {}", text(folder.path()));
    assert!(ended.output.contains(&how), "{}", ended.output);
    let checkpoint = checkpoints(folder.path()).pop().unwrap();
    assert!(ended.output.contains(&text(&checkpoint)), "{}", ended.output);
    assert_eq!(talcum(0, &["info", &text(&checkpoint)]).digest(), ended.digest());
    assert!(!folder.path().join("complete").exists());
    assert_resumes(&case, folder.path(), stopped, 2 - ranks);
}

#[test]
fn a_run_is_marked_as_complete_until_it_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("rank-equality"), text(folder.path()));
    let mark = || fs::read_to_string(folder.path().join("complete"));
    let run = ["run", &case, "--output", &output, "--resume", "--until"];
    for until in ["0.05", "0.1"] {
        let digest = talcum(0, &[&run[..], &[until]].concat()).digest();
        assert_eq!(mark().unwrap(), format!("digest {digest}\n"));
    }
    // The control: stopped before its end it is not complete.
    let running = endless(0, &case, folder.path(), &["--resume"]);
    signal("TERM", running.rank_processes()[0]);
    stop_time(&running.wait());
    assert!(mark().is_err());
}

#[test]
fn signals_stop_one_process_with_a_checkpoint() {
    ["TERM", "INT", "USR1"].iter().for_each(|name| assert_stops_on(name, 0));
}

#[test]
fn signals_stop_two_ranks_with_a_checkpoint() {
    ["TERM", "INT", "USR1"].iter().for_each(|name| assert_stops_on(name, 2));
}

/// Slurm's warning may reach `mpirun`, which passes it on, or one rank only.
#[test]
fn a_signal_to_mpirun_or_to_one_rank_stops_all() {
    for to_mpirun in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let case = smoke("walls");
        let running = endless(2, &case, folder.path(), &[]);
        let one = running.rank_processes()[1];
        signal("USR1", if to_mpirun { running.process() } else { one });
        let stopped = stop_time(&running.wait());
        assert_resumes(&case, folder.path(), stopped, 0);
    }
}

#[test]
fn the_resume_command_of_a_stopped_run_repeats_its_overrides() {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("walls"), text(folder.path()));
    let limit = ["--set", "run.wall_clock=1s", "--set", "contact.friction=0.4", "--until", "1e6"];
    let ended = talcum(2, &[&["run", &case, "--output", &output], &limit[..]].concat());
    stop_time(&ended);
    let changes = "--set 'run.wall_clock=1s' --set 'contact.friction=0.4' --until 1000000";
    assert!(ended.output.contains(changes), "{}", ended.output);
    let checkpoint = text(&checkpoints(folder.path()).pop().unwrap());
    // The limit is in the checkpoint's case.
    let again = talcum(0, &["restart", &checkpoint, "--until", "1e6"]);
    stop_time(&again);
    let newest = text(&checkpoints(folder.path()).pop().unwrap());
    let message = format!("resume with: talcum restart {newest} --until 1000000");
    assert!(newest > checkpoint && again.output.contains(&message), "{}", again.output);
}

#[test]
fn wall_clock_time_stops_a_run_with_a_checkpoint() {
    for ranks in [0, 2] {
        let folder = tempfile::tempdir().unwrap();
        let case = smoke("rank-equality");
        let output = text(folder.path());
        let limit = ["--until", "1e6", "--set", "run.wall_clock=1s"];
        let ended = talcum(ranks, &[&["run", &case, "--output", &output], &limit[..]].concat());
        let stopped = stop_time(&ended);
        let resumed = assert_resumes(&case, folder.path(), stopped, 0);
        assert!(
            resumed.output.contains("changed since the checkpoint: run.wall_clock: "),
            "{}",
            resumed.output
        );
    }
}

/// Pauses that hit every part of a step and of the writing of a checkpoint: a linear congruential generator
/// (Numerical Recipes), the same in every test.
struct Pauses(u32);

impl Pauses {
    fn next(&mut self, longest: Duration) -> Duration {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        longest.mul_f64(f64::from(self.0) / f64::from(u32::MAX))
    }
}

/// All datasets of an HDF5 file, by their paths.
fn tables(path: &Path) -> BTreeMap<String, Vec<f64>> {
    fn collect(group: &hdf5::Group, found: &mut BTreeMap<String, Vec<f64>>) {
        for dataset in group.datasets().unwrap() {
            found.insert(dataset.name(), dataset.read_raw().unwrap());
        }
        group.groups().unwrap().iter().for_each(|inner| collect(inner, found));
    }
    let mut found = BTreeMap::new();
    collect(&hdf5::File::open(path).unwrap(), &mut found);
    found
}

/// The results of one folder are those of the other, row by row.
fn assert_same_results(folder: &Path, other: &Path) {
    assert_eq!(series(folder), series(other));
    for name in ["profiles.h5", "particles.vtkhdf"] {
        let found = tables(&folder.join(name));
        assert!(found.values().any(|rows| rows.len() > 10), "{name}");
        assert!(found == tables(&other.join(name)), "{name} has other rows");
    }
}

/// Kills a run again and again while it writes results at each step and a checkpoint every few steps.
fn kill_again_and_again(ranks: usize, kills: usize) {
    const EVERY_FEW_STEPS: [&str; 8] = [
        "--set",
        "checkpoint.every_steps=5",
        "--set",
        "output.series=0.01",
        "--set",
        "output.profiles=2.5e-4",
        "--set",
        "output.particles=2.5e-4",
    ];
    let folder = tempfile::tempdir().unwrap();
    let case = smoke("walls");
    let output = text(folder.path());
    let mut pauses = Pauses(7);
    let mut last = 0.0;
    for _ in 0..kills {
        let arguments = ["run", &case, "--resume", "--output", &output, "--until", "1e6"];
        let mut running = start(ranks, &[&arguments[..], &EVERY_FEW_STEPS].concat());
        let before = checkpoints(folder.path()).pop();
        running.wait_until(|| checkpoints(folder.path()).pop() > before);
        std::thread::sleep(pauses.next(Duration::from_millis(40)));
        let processes = running.rank_processes();
        signal("KILL", processes[pauses.0 as usize % processes.len()]);
        let killed = running.wait();
        assert_ne!(killed.code(), Some(0));
        wait_for_end_of(&processes);
        assert!(!killed.errors.contains("passed over"), "{}", killed.errors);
        assert!(!killed.errors.contains("cannot be continued"), "{}", killed.errors);
        let newest = text(&checkpoints(folder.path()).pop().unwrap());
        let info = talcum(0, &["info", &newest]);
        info.digest();
        let time = info.output.split_once("  time").unwrap().1.trim_start();
        let time: f64 = time.split(' ').next().unwrap().parse().unwrap();
        assert!(time > last, "every start comes further: {time}, {last}");
        last = time;
    }
    let until = (last + 0.05).to_string();
    let end = |output: &str| {
        let arguments = ["run", &case, "--resume", "--output", output, "--until", &until];
        talcum(0, &[&arguments[..], &EVERY_FEW_STEPS].concat()).digest()
    };
    let digest = end(&output);
    let whole = tempfile::tempdir().unwrap();
    assert_eq!(end(&text(whole.path())), digest);
    assert_same_results(folder.path(), whole.path());
    for entry in fs::read_dir(folder.path()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(!name.ends_with(".partial") && !name.contains(".unreadable"), "{name}");
    }
}

#[test]
fn a_kill_at_any_instant_leaves_a_checkpoint_that_restarts() {
    kill_again_and_again(0, 25);
}

#[test]
fn a_kill_of_one_rank_ends_all_and_leaves_a_checkpoint_that_restarts() {
    kill_again_and_again(2, 6);
}

/// What a kill in the middle of a write leaves of a file, made by hand: its head, which says where its rows
/// are, is damaged.
#[test]
fn damaged_results_keep_all_rows_before_the_checkpoint() {
    const RESULTS: [&str; 2] = ["profiles.h5", "particles.vtkhdf"];
    let [folder, whole] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let case = smoke("walls");
    let run = |output: &Path, until: &str| {
        let often = ["--set", "output.profiles=0.01", "--set", "output.particles=0.05"];
        let plan = ["run", &case, "--resume", "--output", &text(output), "--until", until];
        talcum(0, &[&plan[..], &often].concat())
    };
    let digest = run(whole.path(), "0.4").digest();
    run(folder.path(), "0.2").digest();
    for name in RESULTS {
        let path = folder.path().join(name);
        let mut bytes = fs::read(&path).unwrap();
        bytes[..600].fill(0x55);
        fs::write(&path, bytes).unwrap();
    }
    let resumed = run(folder.path(), "0.4");
    assert_eq!(resumed.digest(), digest);
    assert_same_results(folder.path(), whole.path());
    // Without the copies such files are lost to the run, which says so.
    for name in RESULTS {
        let path = folder.path().join(name);
        fs::remove_file(folder.path().join(format!("{name}.metadata"))).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        bytes[..600].fill(0x55);
        fs::write(&path, bytes).unwrap();
    }
    let resumed = run(folder.path(), "0.45");
    assert_eq!(resumed.code(), Some(0));
    assert_eq!(resumed.errors.matches("cannot be continued").count(), 2, "{}", resumed.errors);
}

#[test]
fn a_damaged_checkpoint_is_skipped_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("rank-equality"), text(folder.path()));
    let often = ["--set", "checkpoint.every=0.1", "--set", "checkpoint.keep=3"];
    let run = |output: &str, more: &[&str]| {
        talcum(0, &[&["run", &case, "--output", output], &often[..], more].concat())
    };
    let digest = run(&text(whole.path()), &["--until", "0.5"]).digest();
    run(&output, &["--until", "0.3"]).digest();
    let files = checkpoints(folder.path());
    let bytes = fs::read(&files[2]).unwrap();
    fs::write(&files[2], &bytes[..bytes.len() * 2 / 3]).unwrap();
    let mut bytes = fs::read(&files[1]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&files[1], bytes).unwrap();
    let resumed = run(&output, &["--resume", "--until", "0.5"]);
    assert_eq!(resumed.digest(), digest);
    let message = format!("passed over: {}: the file", text(&files[2]));
    assert!(resumed.errors.contains(&message), "{}", resumed.errors);
    let message = format!("passed over: {}: the file is damaged", text(&files[1]));
    assert!(resumed.errors.contains(&message), "{}", resumed.errors);
    assert!(resumed.output.contains(&text(&files[0])), "{}", resumed.output);
    assert_eq!(series(folder.path()), series(whole.path()));

    // None is good: nothing begins by itself.
    checkpoints(folder.path()).iter().for_each(|path| fs::write(path, "").unwrap());
    let refused = run(&output, &["--resume", "--until", "0.5"]);
    assert_eq!(refused.code(), Some(1));
    assert!(refused.error().contains("no checkpoint can be used"), "{}", refused.errors);
    assert_eq!(run(&output, &["--force", "--until", "0.5"]).digest(), digest);
}

#[test]
fn resuming_keeps_the_good_checkpoint_beside_a_damaged_one() {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("walls"), text(folder.path()));
    let keep = |count: &str| ["--set".to_owned(), format!("checkpoint.keep={count}")];
    let run = |keep: [String; 2], until: &str| {
        let keep: Vec<&str> = keep.iter().map(String::as_str).collect();
        let plan = ["run", &case, "--resume", "--output", &output, "--until", until];
        talcum(0, &[&plan, &["--set", "checkpoint.every=0.1"][..], &keep].concat())
    };
    run(keep("2"), "0.3").digest();
    fs::write(checkpoints(folder.path()).pop().unwrap(), "damaged").unwrap();
    // Ends before the time of the damaged one, which must not be taken for the newest.
    let digest = run(keep("1"), "0.25").digest();
    let left = checkpoints(folder.path());
    assert_eq!(left.len(), 1);
    assert_eq!(talcum(0, &["info", &text(&left[0])]).digest(), digest);
}
