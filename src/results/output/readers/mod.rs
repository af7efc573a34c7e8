//! Readers for the files of a run, complete or still being written.
//!
//! Rows that are not complete yet are left out. Reading changes nothing and needs no ranks.

mod gas;
mod particles;
mod profiles;
mod series;

pub use gas::GasSnapshotReader;
pub use particles::{ParticleSnapshot, ParticleSnapshotReader};
pub use profiles::ProfileTable;
pub use series::SeriesTable;

use super::hdf5_file::SerialFile;
use super::{MessageResult, OutputError, require_file};
use std::io::Read;
use std::path::Path;

/// First bytes of an HDF5 file.
const SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";

/// Opens a growing file and reads from it.
fn reading<T>(
    path: &Path,
    read: impl FnOnce(&SerialFile) -> MessageResult<T>,
) -> Result<T, OutputError> {
    let opened = check_signature(path).and_then(|()| SerialFile::open(path));
    let opened = opened.map_err(|message| {
        format!(
            "{message}. If the run was killed while it wrote, `talcum run --resume` mends the file; if the run is \
             still active, try again"
        )
    });
    opened
        .and_then(|file| read(&file))
        .map_err(|message| OutputError { path: path.to_owned(), message })
}

/// Checks that a file is HDF5 before it is passed to the library.
fn check_signature(path: &Path) -> MessageResult<()> {
    let mut start = [0; SIGNATURE.len()];
    let file = require_file(path)
        .and_then(|()| std::fs::File::open(path))
        .map_err(|error| format!("cannot be opened: {error}"));
    match file?.read_exact(&mut start) {
        Ok(()) if start == *SIGNATURE => Ok(()),
        _ => Err("this is not an HDF5 file, or it was cut short".to_owned()),
    }
}

/// Number of rows whose time is later than that of the previous one: allocated rows of the file that are not filled yet
/// contain zeros.
fn rising(times: &[f64]) -> usize {
    let falls = times.windows(2).position(|pair| pair[1] <= pair[0] || !pair[1].is_finite());
    falls.map_or(times.len(), |place| place + 1)
}
