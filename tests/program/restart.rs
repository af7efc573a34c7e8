//! A run that was stopped continues as if it had not been, on any number of ranks: the same digest, series, profiles
//! and snapshots.

use crate::launch::{checkpoints, series, smoke, talcum};
use std::collections::BTreeMap;
use std::path::Path;

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn newest(folder: &Path) -> String {
    text(&checkpoints(folder).pop().expect("there is a checkpoint"))
}

/// Name, shape and bits of every dataset in a file.
type Datasets = BTreeMap<String, (Vec<usize>, Vec<u64>)>;

fn datasets(path: &Path) -> Datasets {
    let mut found = Datasets::new();
    let mut groups = vec![hdf5::File::open(path).unwrap().as_group().unwrap()];
    while let Some(group) = groups.pop() {
        groups.extend(group.groups().unwrap());
        for dataset in group.datasets().unwrap() {
            let bits = if dataset.dtype().unwrap().is::<f64>() {
                dataset.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
            } else {
                let integers = dataset.read_raw::<i64>().unwrap();
                integers.into_iter().map(i64::cast_unsigned).collect()
            };
            found.insert(dataset.name(), (dataset.shape(), bits));
        }
    }
    found
}

/// Everything in two folders of results that the interruption must not change.
fn assert_same_results(one: &Path, other: &Path) {
    assert_eq!(series(one), series(other));
    for name in ["profiles.h5", "particles.vtkhdf"] {
        let [first, second] = [one, other].map(|folder| datasets(&folder.join(name)));
        assert!(first.len() >= 5, "{first:?}");
        for (dataset, contents) in &first {
            assert!(second.get(dataset) == Some(contents), "{name}: {dataset}");
        }
        assert_eq!(first.len(), second.len());
    }
}

/// Stages, ramps, steps and a vibration, stopped in the middle of the ramp of cohesion.
#[test]
fn a_restart_on_other_ranks_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let case = smoke("staged");
    let whole = place("whole");
    let digest = talcum(0, &["run", &case, "--output", &text(&whole)]).digest();

    let resumed = place("resumed");
    let output = text(&resumed);
    talcum(2, &["run", &case, "--output", &output, "--until", "1.75"]).digest();
    let at_half = newest(&resumed);
    let copy = text(&place("checkpoint.h5"));
    std::fs::copy(&at_half, &copy).unwrap();
    let end = talcum(3, &["run", &case, "--output", &output, "--resume"]);
    assert_eq!(end.digest(), digest);
    let message = format!("resuming from {at_half} at time 1.75, state ");
    assert!(end.output.contains(&message), "{}", end.output);
    assert_same_results(&resumed, &whole);

    // A foreign folder for the results: the rest of the rows, after the same header.
    for (ranks, more) in [(0, &[][..]), (1, &[]), (4, &["--ranks", "2,1,2"])] {
        let folder = place(&format!("restarted on {ranks}"));
        let output = text(&folder);
        let arguments = [&["restart", &copy, "--output", &output], more].concat();
        assert_eq!(talcum(ranks, &arguments).digest(), digest);
        let (rest, rows) = (series(&folder), series(&whole));
        let rest = rest.split_once('\n').unwrap().1;
        assert!(rows.ends_with(rest) && rest.lines().count() == 18, "{rest}");
    }
    // Nothing is left to do, and nothing changes, whatever is asked for: neither the case that was run, nor its end.
    let kept = || ["case.toml", "complete"].map(|name| std::fs::read(resumed.join(name)).unwrap());
    let before = kept();
    for set in [&[][..], &["--set", "contact.friction=0.2"]] {
        let again = talcum(2, &[&["run", &case, "--output", &output, "--resume"], set].concat());
        assert_eq!(again.digest(), digest);
        assert_eq!(again.output.contains("has no effect"), !set.is_empty());
        assert_same_results(&resumed, &whole);
        assert!(kept() == before);
    }
    // The control: to a later time it continues.
    let later = ["run", &case, "--output", &output, "--resume", "--until", "3.6"];
    assert!(talcum(0, &later).digest() != digest);
}

#[test]
fn departures_and_initial_sizes_survive_a_restart() {
    for (name, half) in [("open-top", "1.7"), ("polydisperse", "2.05"), ("periodic-weight", "1.2")]
    {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let (whole, resumed) = (place("whole"), place("resumed"));
        let case = smoke(name);
        let digest = talcum(0, &["run", &case, "--output", &text(&whole)]).digest();
        let output = text(&resumed);
        talcum(0, &["run", &case, "--output", &output, "--until", half]).digest();
        talcum(2, &["restart", &newest(&resumed), "--until", "2.5"]).digest();
        let end = talcum(0, &["run", &case, "--output", &output, "--resume"]);
        assert_eq!(end.digest(), digest, "{name}");
        assert_same_results(&resumed, &whole);
        assert_eq!(end.output.contains("particles have left"), name == "open-top");
    }
}

#[test]
fn a_run_can_start_from_the_end_of_another() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let output = text(&place("settled"));
    talcum(0, &["run", &smoke("staged"), "--output", &output, "--until", "1"]).digest();
    let path = newest(&place("settled"));
    let staged = std::fs::read_to_string(smoke("staged")).unwrap();
    let (before, after) = staged.split_once("[particles]").unwrap();
    let after = &after[after.find("[gravity]").unwrap()..];
    let particles =
        format!("density = 1.0\n[particles.start]\nkind = \"run\"\npath = \"{path}\"\n");
    let case = text(&place("case.toml"));
    std::fs::write(&case, format!("{before}[particles]\n{particles}{after}")).unwrap();
    let run = |name: &str, ranks| {
        talcum(ranks, &["run", &case, "--output", &text(&place(name)), "--until", "0.2"])
    };
    let one = run("one", 0);
    assert_eq!(one.digest(), run("two", 2).digest());
    let first = series(&place("one")).lines().nth(1).unwrap().to_owned();
    let last = series(&place("settled")).lines().last().unwrap().to_owned();
    // Time starts again, the bed does not.
    assert!(first.starts_with("0,") && last.starts_with("1,"));
    assert_eq!(first.split(',').nth(6), last.split(',').nth(6));
}

#[test]
fn keys_can_change_on_restart() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let output = text(&place("start"));
    let case = smoke("rank-equality");
    talcum(0, &["run", &case, "--output", &output, "--until", "0.5"]).digest();
    let start = newest(&place("start"));
    let mut count = 0;
    let mut go_on = |ranks, change: &[&str]| {
        count += 1;
        let output = text(&place(&count.to_string()));
        let arguments = [&["restart", &start, "--output", &output, "--until", "0.8"], change];
        let ended = talcum(ranks, &arguments.concat());
        (ended.digest(), ended.output)
    };
    let (same, message) = go_on(0, &[]);
    assert!(
        message.contains("complete at time 0.8;") && message.contains("000000003200.h5"),
        "{message}"
    );
    let shorter = ["--set", "time.step=1.0e-4"];
    let (other, message) = go_on(0, &shorter);
    // 2000 steps of 2.5e-4, then 3000 of 1e-4.
    assert!(
        message.contains("complete at time 0.8;") && message.contains("000000005000.h5"),
        "{message}"
    );
    assert_ne!(other, same);
    assert_eq!(go_on(2, &shorter).0, other);
    let without_gas = ["--set", "gas.superficial_velocity=0"];
    assert_ne!(go_on(0, &without_gas).0, same);
    let parallel = ["--set", "parallel.skin=0.3", "--set", "parallel.axis=x"];
    assert_eq!(go_on(2, &parallel).0, same);
}

#[test]
fn titles_name_what_was_changed_and_the_state_that_a_run_begins_with() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| text(&folder.path().join(name));
    let title = |name: &str| {
        let series = std::fs::read_to_string(folder.path().join(name).join("series.csv")).unwrap();
        let line =
            series.lines().find_map(|line| line.strip_prefix("# title: ").map(str::to_owned));
        line.unwrap()
    };
    let case = smoke("rank-equality");
    let digest = talcum(0, &["run", &case, "--output", &place("one"), "--until", "0.1"]).digest();
    let plain = title("one");
    let start = newest(&folder.path().join("one"));
    let change = ["--set", "contact.friction=0.5", "--set", "parallel.skin=0.3"];
    let on = ["restart", &start, "--output", &place("two"), "--until", "0.15"];
    talcum(0, &[&on[..], &change[..]].concat()).digest();
    let named = format!("{plain}: contact.friction = 0.5, begins with state {digest}");
    assert_eq!(title("two"), named);
    // It stays with the run: a resumed run knows itself, and checkpoints have it.
    let second = newest(&folder.path().join("two"));
    assert!(talcum(0, &["info", &second]).output.contains(&named));
    talcum(0, &["restart", &second, "--until", "0.2"]).digest();
    assert_eq!(title("two"), named);
    let first = ["run", &case, "--output", &place("three"), "--set", "contact.friction=0.5"];
    talcum(0, &[&first[..], &["--until", "0.1"]].concat()).digest();
    let resumed = talcum(0, &[&first[..], &["--until", "0.2", "--resume"]].concat());
    assert!(!resumed.output.contains("changed since the checkpoint"), "{}", resumed.output);
    assert_eq!(title("three"), format!("{plain}: contact.friction = 0.5"));
}

#[test]
fn later_checkpoints_are_superseded_by_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let case = smoke("rank-equality");
    let often = ["--set", "checkpoint.every=0.1", "--set", "checkpoint.keep=3"];
    let run = |name: &str, more: &[&str]| {
        let output = text(&place(name));
        let arguments = [&["run", &case, "--output", &output], &often[..], more].concat();
        talcum(0, &arguments)
    };
    let digest = run("whole", &["--until", "0.5"]).digest();
    run("branched", &["--until", "0.4"]).digest();
    let files = checkpoints(&place("branched"));
    assert_eq!(files.len(), 3);
    // Another future begins at the oldest, and is interrupted at once.
    let change = ["--set", "contact.friction=0.5", "--until", "0.25"];
    let message = talcum(0, &[&["restart", &text(&files[0])], &change[..]].concat());
    assert!(
        message.errors.contains("kept as checkpoint-000000001600.h5.superseded"),
        "{message:?}"
    );
    let goes_on = run("branched", &["--resume", "--until", "0.5"]);
    assert!(goes_on.output.contains("at time 0.25, state "), "{}", goes_on.output);
    assert!(
        goes_on.output.contains("changed since the checkpoint: contact.friction: "),
        "{}",
        goes_on.output
    );
    assert_ne!(goes_on.digest(), digest);
}

#[test]
fn earlier_results_are_kept_continued_or_replaced_as_asked() {
    let folder = tempfile::tempdir().unwrap();
    let output = text(folder.path());
    let case = smoke("walls");
    let run = |more: &[&str]| {
        talcum(0, &[&["run", &case, "--output", &output, "--until", "0.2"], more].concat())
    };
    std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    let digest = run(&[]).digest();
    let before = std::fs::read(folder.path().join("series.csv")).unwrap();
    let refused = run(&[]);
    assert_eq!(refused.code(), Some(1));
    let message = refused.error();
    assert!(
        ["--resume", "--force", "--output"]
            .iter()
            .all(|displacement| message.contains(displacement)),
        "{message}"
    );
    assert_eq!(std::fs::read(folder.path().join("series.csv")).unwrap(), before);
    let elsewhere = talcum(0, &["restart", &newest(folder.path()), "--output", &output]);
    assert_eq!(elsewhere.code(), Some(0), "continues its own folder: {}", elsewhere.errors);
    assert_eq!(run(&["--force"]).digest(), digest);
    assert_eq!(checkpoints(folder.path()).len(), 1);
    assert_eq!(std::fs::read_to_string(folder.path().join("notes.txt")).unwrap(), "mine");
}

/// Half of a table is cut off, as when a disk loses what was on it.
#[test]
fn rows_that_are_lost_before_the_checkpoint_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let output = text(folder.path());
    let case = smoke("walls");
    let run = |until: &str| {
        let words = ["run", &case, "--output", &output, "--until", until, "--resume"];
        talcum(0, &[&words[..], &["--set", "output.series=0.01"]].concat())
    };
    run("0.2").digest();
    let whole = run("0.3");
    assert!(!whole.errors.contains("rows in between are lost"), "{}", whole.errors);
    let path = folder.path().join("series.csv");
    let rows = std::fs::read_to_string(&path).unwrap();
    let header = rows.find("\ntime").unwrap();
    std::fs::write(&path, &rows[..header + (rows.len() - header) / 2]).unwrap();
    let told = run("0.4");
    let digest = told.digest();
    assert!(told.errors.contains("series.csv: its rows end at time 0.1"), "{}", told.errors);
    assert!(told.errors.contains("rows in between are lost"), "{}", told.errors);
    assert!(!digest.is_empty());
}

/// A short run of a smoke case, and the arguments that restart it in a folder of its own.
fn stopped_at(name: &str, until: &str, folder: &Path) -> String {
    let output = text(&folder.join("start"));
    talcum(0, &["run", &smoke(name), "--output", &output, "--until", until]).digest();
    newest(&folder.join("start"))
}

#[test]
fn a_restart_says_what_has_changed_and_refuses_what_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let staged = stopped_at("staged", "0.01", folder.path());
    let output = text(&folder.path().join("next"));
    let restart = |change: &str| {
        talcum(0, &["restart", &staged, "--output", &output, "--until", "0.02", "--set", change])
    };
    for (change, reason) in [
        ("particles.count=17", "the bed is that of the checkpoint"),
        ("box.lengths=[6.0, 6.0, 30.0]", "the bed is that of the checkpoint"),
    ] {
        let ended = restart(change);
        assert_eq!(ended.code(), Some(1), "{change}: {}", ended.output);
        let message = ended.error();
        let key = change.split('=').next().unwrap();
        assert!(message.contains(key) && message.contains(reason), "{message}");
    }
    // Negative control: what may change is said, and used.
    let allowed = restart("contact.friction=0.77");
    allowed.digest();
    let said = "changed since the checkpoint: contact.friction: ";
    assert!(
        allowed.output.contains(said) && allowed.output.contains("-> 0.77"),
        "{}",
        allowed.output
    );
}

#[test]
fn cells_of_the_gas_cannot_change_on_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let case = crate::launch::in_repository("tests/cases/good/volume-averaged.toml");
    let output = text(&folder.path().join("start"));
    let alone = ["--output", &output, "--until", "0.002", "--ranks", "1,1,1"];
    talcum(0, &[&["run", &text(&case)], &alone[..]].concat()).digest();
    let start = newest(&folder.path().join("start"));
    let next = text(&folder.path().join("next"));
    let options = ["--output", &next, "--until", "0.003", "--ranks", "1,1,1"];
    let other = ["--set", "gas.cells=[2, 2, 8]"];
    let ended = talcum(0, &[&["restart", &start], &options[..], &other[..]].concat());
    assert_eq!(ended.code(), Some(1), "{}", ended.output);
    assert!(ended.error().contains("gas.cells: "), "{}", ended.errors);
    // Negative control.
    talcum(0, &[&["restart", &start], &options[..]].concat()).digest();
}

#[test]
fn a_stage_that_is_over_cannot_change() {
    let folder = tempfile::tempdir().unwrap();
    let case = std::fs::read_to_string(smoke("staged")).unwrap();
    let duration: f64 = case
        .lines()
        .find_map(|line| line.strip_prefix("duration = ")?.trim().parse().ok())
        .expect("the first stage has a duration");
    let start = stopped_at("staged", &(duration + 0.01).to_string(), folder.path());
    let next = text(&folder.path().join("next"));
    let until = (duration + 0.02).to_string();
    let restart = |change: &str| {
        talcum(0, &["restart", &start, "--output", &next, "--until", &until, "--set", change])
    };
    let ended = restart(&format!("stage.1.duration={}", duration - 0.02));
    assert_eq!(ended.code(), Some(1), "{}", ended.output);
    assert!(ended.error().contains("this stage is over"), "{}", ended.errors);
}

#[test]
fn walls_can_be_added_and_removed_between_a_stop_and_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let output = text(&folder.path().join("start"));
    let case = std::fs::read_to_string(smoke("walls")).unwrap();
    talcum(0, &["run", &smoke("walls"), "--output", &output, "--until", "2"]).digest();
    let resume = |name: &str, until: &str, changed: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, changed).unwrap();
        let ended =
            talcum(0, &["run", &text(&path), "--resume", "--output", &output, "--until", until]);
        ended.digest();
        std::fs::remove_file(folder.path().join("start/complete")).ok();
    };
    let (before, rest) = case.split_once("[[wall]]").unwrap();
    let (chute, after) = rest.split_once("[particles]").unwrap();
    let another = "[[wall]]\nname = \"lid\"\npoint = [2.5, 2.5, 11.9]\nnormal = [0.0, 0.0, -1.0]\n";
    resume("more.toml", "2.01", &format!("{before}{another}[[wall]]{chute}[particles]{after}"));
    resume("fewer.toml", "2.02", &format!("{before}[particles]{after}"));
}

#[test]
fn particles_that_part_by_more_than_the_skin_in_a_step_have_parted() {
    let folder = tempfile::tempdir().unwrap();
    let bed = "id,x,y,z,vx,vy,vz\n1,2.5,2.5,24.2,0,0,40\n2,2.5,2.5,25.8,0,0,-40\n";
    std::fs::write(folder.path().join("bed.csv"), bed).unwrap();
    let good = crate::launch::in_repository("tests/cases/good/csv-file.toml");
    let case = std::fs::read_to_string(good).unwrap();
    let case = case.replace("offset = [0.0, 0.0, 1.0]\n", "");
    let case = case.replace("seed = 3", "seed = 3\ndiameter = 1.0");
    let path = folder.path().join("case.toml");
    std::fs::write(&path, case).unwrap();
    let digest = |ranks, skin: &str| {
        let output = text(&folder.path().join(format!("{ranks}-{skin}")));
        let skin = format!("parallel.skin={skin}");
        let options = ["--output", &output, "--until", "0.03", "--set", &skin];
        talcum(ranks, &[&["run", &text(&path)], &options[..]].concat()).digest()
    };
    let expected = digest(0, "0.08");
    for (ranks, skin) in [(0, "0.01"), (0, "0.001"), (2, "0.003")] {
        assert_eq!(digest(ranks, skin), expected, "{skin} on {ranks}");
    }
}

#[test]
fn an_end_beyond_all_steps_is_not_reached_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let start = stopped_at("rank-equality", "0.05", folder.path());
    let output = text(&folder.path().join("next"));
    let options = ["--output", &output, "--until", "1e25", "--set", "time.end=1e28"];
    let step = ["--set", "time.step=2.0e-4", "--set", "run.wall_clock=\"2s\""];
    let ended = talcum(0, &[&["restart", &start], &options[..], &step[..]].concat());
    ended.digest();
    assert!(ended.output.contains("stopped at time "), "{}", ended.output);
}

#[test]
fn the_pressures_of_a_column_gas_go_on_where_they_were() {
    for name in ["plenum", "compressible"] {
        let folder = tempfile::tempdir().unwrap();
        let case = format!("tests/cases/good/{name}.toml");
        let case = &text(&crate::launch::in_repository(&case));
        let [whole, part] = ["whole", "part"].map(|name| text(&folder.path().join(name)));
        // In vibration, from an empty plenum's first pressure on.
        let short =
            ["--until", "0.2", "--set", "output.series=0.05", "--set", "parallel.ranks=[1, 1, 1]"];
        let digest = talcum(0, &[&["run", case, "--output", &whole], &short[..]].concat()).digest();
        let half = ["--until", "0.1", "--set", "output.series=0.05"];
        talcum(2, &[&["run", case, "--output", &part], &half[..]].concat()).digest();
        let resume = ["run", case, "--output", &part, "--resume"];
        assert_eq!(talcum(0, &[&resume[..], &short[..]].concat()).digest(), digest);
        assert_eq!(series(Path::new(&part)), series(Path::new(&whole)));
        // The control: the pressure of the plenum is not the same at all times.
        let rows = series(Path::new(&whole));
        let pressures: Vec<&str> =
            rows.lines().skip(1).map(|row| row.split(',').nth(3).unwrap()).collect();
        assert!(pressures.len() == 5 && pressures[1] != pressures[2], "{rows}");
    }
}
