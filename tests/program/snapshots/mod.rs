//! Snapshots are read by VTK's own reader, bit for bit, for any number of ranks.

mod fields;
mod gas;
mod particles;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use talcum::output::{Head, Provenance};

/// The head of a file of these tests.
pub(crate) fn head(provenance: &Provenance) -> Head<'_> {
    Head { case_text: "title = 1", provenance }
}

/// Time of a snapshot.
pub(crate) fn time(step: usize) -> f64 {
    0.1 * step as f64
}

/// The Python that has VTK: that of `scripts/install`, else the one on the path.
pub(crate) fn python() -> PathBuf {
    let installed = concat!(env!("CARGO_MANIFEST_DIR"), "/.venv/bin/python");
    match std::env::var_os("TALCUM_PYTHON") {
        Some(named) => PathBuf::from(named),
        None if Path::new(installed).exists() => PathBuf::from(installed),
        None => PathBuf::from("python3"),
    }
}

/// Compares a file with the rows that were written, each with its time ahead, by VTK's reader; says so if this machine
/// does not have it. `summary` is what the reader says of the file.
pub(crate) fn check_by_vtk(path: &Path, rows: impl Iterator<Item = Vec<f64>>, summary: &str) {
    let mut expected = String::new();
    for row in rows {
        let message: Vec<String> = row.iter().map(f64::to_string).collect();
        writeln!(expected, "{}", message.join(",")).unwrap();
    }
    let expected_path = path.with_extension("csv");
    std::fs::write(&expected_path, expected).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/snapshots/read_vtkhdf.py");
    let output = Command::new(python()).arg(script).arg(path).arg(expected_path).output();
    let missing = match &output {
        Err(error) => Some(format!("Python cannot be started: {error}")),
        Ok(output) if output.status.code() == Some(77) => {
            Some(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Ok(_) => None,
    };
    if let Some(reason) = missing {
        assert!(std::env::var_os("CI").is_none(), "VTK's reader is needed: {reason}");
        eprintln!("not checked by VTK's reader: {reason}");
        return;
    }
    let output = output.unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.is_empty(), "{message}");
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), summary);
}
