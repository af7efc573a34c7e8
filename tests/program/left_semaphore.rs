//! A semaphore that a killed run with Open MPI's OMPIO left locked does not make later runs hang.

use crate::launch::{smoke, start_with};
use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Many times what the run takes by itself.
const PATIENCE: Duration = Duration::from_secs(120);
/// By when a run that does not open its file hangs: the whole run takes a second or two on idle cores.
const HANGS: Duration = Duration::from_secs(20);

/// The semaphore by which OMPIO guards a file of a name, locked; it is removed in the end.
struct Locked(PathBuf);

impl Locked {
    /// In the C library of GNU a semaphore is a file of 32 bytes, which begins with its value.
    fn of(file: &str) -> Self {
        let path = PathBuf::from(format!("/dev/shm/sem.OMPIO_{file}"));
        fs::write(&path, [0_u8; 32]).unwrap();
        Self(path)
    }
}

impl Drop for Locked {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Whether a run on two ranks, whose first checkpoint has the file that is guarded, comes to its end within a time.
fn ends(environment: &[(&str, &str)], within: Duration) -> bool {
    // No other test writes a file of this name.
    let _locked = Locked::of("checkpoint-000000000123.h5.partial");
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("walls"), folder.path().display().to_string());
    let until = ["--set", "time.step=1.0e-4", "--until", "0.0123"];
    let arguments = [&["run", &case, "--output", &output][..], &until].concat();
    let environment: Vec<_> =
        environment.iter().map(|&(name, value)| (name, value.to_owned())).collect();
    let mut run = start_with(&environment, 2, &arguments);
    let begin = Instant::now();
    while !run.has_ended() {
        if begin.elapsed() > within {
            return false;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(run.wait().code(), Some(0));
    assert!(folder.path().join("checkpoint-000000000123.h5").exists());
    true
}

#[test]
fn a_semaphore_left_by_a_killed_run_stops_no_run() {
    assert!(ends(&[], PATIENCE));
    // OMPIO too, which is all that Open MPI 6 has.
    assert!(ends(&[("OMPI_MCA_io", "ompio")], PATIENCE));
    let version = std::process::Command::new("mpirun").arg("--version").output().unwrap();
    if String::from_utf8_lossy(&version.stdout).contains("Open MPI") {
        // Control: by Open MPI's own choice (an exclusion of nothing) the run hangs.
        assert!(!ends(&[("OMPI_MCA_io", "ompio"), ("OMPI_MCA_sharedfp", "^none")], HANGS));
    }
}
