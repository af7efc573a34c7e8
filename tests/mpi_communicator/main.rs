//! Ranks as MPI processes: this program starts itself again under `mpirun -n 1` to `-n 4`.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../beds/mod.rs"]
mod beds;
#[path = "../parallel/dense_beds.rs"]
mod dense_beds;
mod exchange;
mod machines;
mod sparse_exchange;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use bytemuck::Zeroable;
use talcum::output::checkpoint::{self, Checkpoint};
use talcum::output::{Head, Output, ParticleSnapshots, Provenance, SnapshotFormat};
use talcum::parallel::{
    Communicator, ContactRecord, FileAccess, Message, MpiRanks, OneRank, ParticleRecord,
};
use talcum::parallel::{agree, sort_by_id};
use talcum::particles::CustomFields;
use talcum::state::{Clock, Departed, GasReport, SizeRange};

/// Environment variable with the role of a rank: what it does.
const ROLE: &str = "TALCUM_TEST_ROLE";
/// Environment variable with the folder for files.
const FOLDER: &str = "TALCUM_TEST_FOLDER";
/// Time limit for one start, which is about 100 times what it needs.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    if let Ok(role) = std::env::var(ROLE) {
        let folder = PathBuf::from(std::env::var_os(FOLDER).expect("the parent names a folder"));
        act(&role, &folder);
        return ExitCode::SUCCESS;
    }
    if std::env::args().any(|argument| argument == "--list") {
        return ExitCode::SUCCESS;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut failed = 0;
    let mut passed = 0;
    let mut report = |name: String, problem: Option<String>| match problem {
        None => {
            println!("test {name} ... ok");
            passed += 1;
        }
        Some(message) => {
            println!("test {name} ... FAILED\n{message}");
            failed += 1;
        }
    };
    for n in 1..=4 {
        for role in [
            "methods",
            "methods_in_pieces",
            "messages",
            "messages_in_pieces",
            "machines",
            "write",
            "read",
            "open",
        ] {
            // The files of n ranks are read by n ranks, and later by more.
            report(format!("{role} on {n} ranks"), expect(role, n, folder.path(), 0));
        }
        report(format!("panic on one of {n} ranks"), expect("panic", n, folder.path(), 101));
        let name = format!("panic on one of {n} ranks while the others receive messages");
        report(name, expect("panic_before_exchange", n, folder.path(), 101));
        report(format!("abort on one of {n} ranks"), expect("abort", n, folder.path(), 7));
    }
    report("panic in another thread".to_owned(), expect("thread_panic", 2, folder.path(), 101));
    println!("\n{passed} passed, {failed} failed");
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Starts `n` ranks in a role, and returns a message if they do not end with the expected exit code.
fn expect(role: &str, n: usize, folder: &Path, code: i32) -> Option<String> {
    let log = folder.join("log");
    let output = File::create(&log).unwrap();
    let mut command = Command::new("mpirun");
    command.args(["-n", &n.to_string()]).arg(std::env::current_exe().unwrap());
    command.env(ROLE, role).env(FOLDER, folder).stdin(Stdio::null());
    command.env("TMPDIR", folder);
    command.stdout(output.try_clone().unwrap()).stderr(output);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Some(format!("mpirun cannot be started: {error}")),
    };
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > PATIENCE {
            // mpirun ends its ranks when it is terminated.
            let _ = Command::new("sh").args(["-c", &format!("kill {}", child.id())]).status();
            let _ = child.wait();
            return Some(format!("it did not end within {PATIENCE:?}"));
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let message = std::fs::read_to_string(&log).unwrap_or_default();
    let expected_message = code != 101 || message.contains("on purpose");
    (status.code() != Some(code) || !expected_message).then(|| format!("{status}\n{message}"))
}

/// Runs one rank in its role.
fn act(role: &str, folder: &Path) {
    let ranks = MpiRanks::start().expect("MPI is not yet initialised");
    assert!(MpiRanks::start().is_err());
    let last = ranks.rank() == ranks.size() - 1;
    match role {
        "methods" => methods(&ranks),
        // 100,000 is a multiple of this length: the last piece of such messages is empty.
        "methods_in_pieces" => methods(&ranks.with_longest_message(1000)),
        "messages" => messages(&ranks),
        "messages_in_pieces" => messages(&ranks.with_longest_message(1000)),
        "machines" => machines::beds_have_the_bits_of_one_rank(&ranks),
        "write" => write(&ranks, folder),
        "read" => read(&ranks, folder),
        "open" => open(&ranks, folder),
        "panic" => {
            assert!(!last, "on purpose");
            // This hangs unless the panic ends this rank.
            ranks.any(false);
        }
        "panic_before_exchange" => {
            assert!(!last, "on purpose");
            ranks.sparse_exchange(&[Message { rank: ranks.size() - 1, bytes: vec![1] }]);
        }
        "thread_panic" => {
            if last {
                let thread = std::thread::spawn(|| panic!("on purpose"));
                let _ = thread.join();
            }
            ranks.any(false);
            std::thread::sleep(PATIENCE);
        }
        "abort" => {
            if last {
                ranks.abort(7);
            }
            ranks.any(false);
        }
        _ => panic!("no such role"),
    }
}

fn methods(ranks: &MpiRanks) {
    let (me, n) = (ranks.rank(), ranks.size());
    let message = |from: usize, direction: &str| {
        format!("{from} {direction}").repeat(1 + 30_000 * (from % 2))
    };
    // Twice, so that buffers are used again; periodic, then open.
    for periodic in [true, false, true] {
        let below = if me > 0 { Some(me - 1) } else { periodic.then_some(n - 1) };
        let above = if me + 1 < n { Some(me + 1) } else { periodic.then_some(0) };
        let (down, up) = (message(me, "down"), message(me, "up"));
        let mut incoming = [b"old".to_vec(), b"old".to_vec()];
        ranks.exchange([below, above], [down.as_bytes(), up.as_bytes()], &mut incoming);
        let expected = |from: Option<usize>, direction| {
            from.map_or(String::new(), |from| message(from, direction))
        };
        assert_eq!(incoming[0], expected(below, "up").into_bytes());
        assert_eq!(incoming[1], expected(above, "down").into_bytes());
    }
    numbers(ranks);
    let gathered = ranks.gather_to_root(&vec![7; 100_000 * me]);
    let expected: Vec<Vec<u8>> = (0..n).map(|from| vec![7; 100_000 * from]).collect();
    assert_eq!(gathered, ranks.is_root().then_some(expected));
    for length in [0, 5, 1_000_000] {
        let mut bytes = if ranks.is_root() { vec![3; length] } else { vec![4; 9] };
        ranks.broadcast_from_root(&mut bytes);
        assert_eq!(bytes, vec![3; length]);
    }
    let result = if me == n - 1 { Err(format!("rank {me} failed")) } else { Ok(()) };
    assert_eq!(agree(result, ranks).unwrap_err().0, format!("rank {} failed", n - 1));
    assert_eq!(agree::<_, String>(Ok(me), ranks), Ok(me));
    assert_eq!(ranks.total(me), n * (n - 1) / 2);
    assert!(matches!(ranks.file_access(Path::new("a.h5")), FileAccess::Collective(_)));
    let ids = vec![3 * n - me, me];
    let sorted = sort_by_id(&ids, |&id| [id as u64, 0], ranks);
    assert!(sorted.rows.is_sorted() && sorted.total == 2 * n as u64);
}

fn messages(ranks: &MpiRanks) {
    sparse_exchange::messages_arrive_in_their_exchange(ranks);
    sparse_exchange::all_ranks_get_the_records_of_all(ranks);
    exchange::messages_arrive_while_ranks_reduce_numbers(ranks);
}

fn numbers(ranks: &MpiRanks) {
    let (me, n) = (ranks.rank(), ranks.size());
    for count in [1, 300, 2] {
        let mut exact = vec![0.25 * (me + 1) as f64; count];
        ranks.sum_exact(&mut exact);
        assert_eq!(exact, vec![0.125 * (n * (n + 1)) as f64; count]);
        let mut integers = vec![i64::MAX - me as i64; count];
        ranks.sum_integers(&mut integers);
        let expected = i64::MAX.wrapping_mul(n as i64).wrapping_sub((n * (n - 1) / 2) as i64);
        assert_eq!(integers, vec![expected; count]);
        let mut largest = vec![me as f64; count];
        ranks.maximum(&mut largest);
        assert_eq!(largest, vec![(n - 1) as f64; count]);
    }
    for round in 0..100 {
        let exact = ranks.start_sum_exact(vec![0.25 * (me + round) as f64; 1 + round]);
        let total = ranks.total(me) + ranks.total(round);
        if round % 7 == 3 {
            continue; // drop waits as well: the next sum is none of this one's numbers
        }
        let exact = exact.finish();
        let all = n * (n - 1) / 2 + n * round;
        assert_eq!((exact, total), (vec![0.25 * all as f64; 1 + round], all));
    }
    let mut zero = [-0.0];
    ranks.sum_exact(&mut zero);
    assert!(zero[0].is_sign_positive());
    let mut undefined = [if me == 0 { f64::NAN } else { 1.0 }];
    ranks.maximum(&mut undefined);
    assert_eq!(undefined, [f64::INFINITY]);
}

/// This rank's share of a state. If there are more than two ranks, the last has no particles; with a small state other
/// ranks have no rows in the file either.
fn share(count: u64, ranks: &dyn Communicator) -> Checkpoint {
    let holders = if ranks.size() > 2 { ranks.size() as u64 - 1 } else { ranks.size() as u64 };
    let mine = |id: &u64| id % holders == ranks.rank() as u64;
    let particle = |id: u64| {
        let x = id as f64 / 7.0;
        ParticleRecord { id, position: [x, 2.0 * x, -x], mass: 1.0, ..Zeroable::zeroed() }
    };
    let contact = |lower| ContactRecord { lower, higher: lower + 1, ..Zeroable::zeroed() };
    Checkpoint {
        clock: Clock { step: 12, ..Clock::new(0.1) },
        departed: Departed::default(),
        sizes: SizeRange { smallest_diameter: 1.0, largest_diameter: 1.0, largest_mass: 1.0 },
        case_text: "title = \"A bed\"".to_owned(),
        case_folder: String::new(),
        particles: (0..count).filter(mine).map(particle).collect(),
        custom: CustomFields::default(),
        contacts: (0..count / 2).filter(mine).map(contact).collect(),
        wall_contacts: Vec::new(),
        cells: Vec::new(),
        gas_report: GasReport::default(),
        looked_at: None,
        energy: None,
        instruments: Vec::new(),
    }
}

const COUNTS: [u64; 4] = [0, 1, 3, 20_000];

fn checkpoint_path(folder: &Path, writers: usize, count: u64) -> PathBuf {
    folder.join(format!("{count}-of-{writers}.h5"))
}

fn write(ranks: &MpiRanks, folder: &Path) {
    let provenance = Provenance::here_and_now("A bed", "si", ranks);
    for count in COUNTS {
        let path = checkpoint_path(folder, ranks.size(), count);
        let digest = checkpoint::write(&path, &share(count, ranks), &provenance, ranks).unwrap();
        assert_eq!(digest, share(count, &OneRank).digest(&OneRank));
    }
    let nowhere = folder.join("nowhere").join("checkpoint.h5");
    let refused = checkpoint::write(&nowhere, &share(3, ranks), &provenance, ranks);
    assert!(refused.unwrap_err().message.contains("HDF5 says"));
    let path = folder.join(format!("particles-{}.vtkhdf", ranks.size()));
    let head = Head { case_text: "", provenance: &provenance };
    let format = SnapshotFormat::default();
    let mut snapshots = ParticleSnapshots::open(&path, &format, head, None, ranks).unwrap();
    for (step, count) in COUNTS.into_iter().enumerate() {
        snapshots.append(step as f64, &share(count, ranks).particles, &[], ranks).unwrap();
    }
    snapshots.commit(ranks).unwrap();
    let mut snapshots = ParticleSnapshots::open(&path, &format, head, Some(1.0), ranks).unwrap();
    snapshots.append(2.0, &share(3, ranks).particles, &[], ranks).unwrap();
}

fn read(ranks: &MpiRanks, folder: &Path) {
    for writers in 1..=ranks.size() {
        for count in COUNTS {
            let path = checkpoint_path(folder, writers, count);
            let (checkpoint, provenance, digest) = checkpoint::read(&path, ranks).unwrap();
            assert_eq!(provenance.ranks, writers as u64);
            assert_eq!(digest, share(count, &OneRank).digest(&OneRank));
            assert!(checkpoint.particles.len() <= count as usize / ranks.size() + 1);
            assert_eq!(ranks.total(checkpoint.particles.len()), count as usize);
        }
        let file = hdf5::File::open(folder.join(format!("particles-{writers}.vtkhdf"))).unwrap();
        let ids = file.dataset("VTKHDF/PointData/id").unwrap().read_raw::<i64>().unwrap();
        assert_eq!(ids, [0, 0, 1, 2]);
        let points = file.dataset("VTKHDF/Points").unwrap().read_raw::<f64>().unwrap();
        assert_eq!(points[9..], [2.0 / 7.0, 2.0 * (2.0 / 7.0), -2.0 / 7.0]);
    }
}

/// While all ranks have a file open, MPI keeps nothing else with the name of that file: no other file beside it or
/// among the temporary files, and no semaphore, for which the run after a killed one would wait.
fn open(ranks: &MpiRanks, folder: &Path) {
    let name = format!("open-by-{}.h5", ranks.size());
    let mut options = hdf5::File::with_options();
    if let FileAccess::Collective(communicator) = ranks.file_access(&folder.join(&name)) {
        options.with_fapl(|properties| properties.mpio(communicator, None));
    }
    let file = options.create(folder.join(&name)).unwrap();
    ranks.any(false);
    let with_that_name =
        names_below(folder).into_iter().filter(|path| path.contains(&name)).count();
    assert_eq!(with_that_name, 1, "{:?}", names_below(folder));
    ranks.any(false);
    file.close().unwrap();
}

/// The paths of all files in a folder and in those inside it.
fn names_below(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    let names = |path: PathBuf| {
        if path.is_dir() { names_below(&path) } else { vec![path.display().to_string()] }
    };
    paths.flat_map(names).collect()
}
