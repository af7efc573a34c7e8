//! Files that a run leaves: checkpoints, tables and snapshots. Their schemas are described in `docs/files.md`.
//!
//! A failure on one rank is reported on all ranks, with the same message.

use std::path::{Path, PathBuf};

use talcum_engine::parallel::{Communicator, agree};

pub mod checkpoint;
mod checksum;
mod contact_lines;
mod energy_table;
mod gas_snapshots;
mod hdf5_file;
mod instrument_file;
mod instrument_output;
pub mod lock;
mod metadata_copy;
mod output_file;
mod particle_snapshots;
mod profiles;
mod provenance;
pub mod readers;
mod result_tables;
mod series;
mod snapshot_format;
mod standard_output;
mod table;
mod text_table;
mod units;
mod vtkhdf;
mod wall_force_table;
mod whole_file;

pub use energy_table::EnergyTable;
pub use gas_snapshots::GasSnapshots;
pub use hdf5_file::{hdf5_version, write_failed};
pub use instrument_file::InstrumentResults;
pub use instrument_output::InstrumentOutput;
pub use output_file::{Head, OpenedOutput, Opening, Output, OutputKind, Sample};
pub use particle_snapshots::ParticleSnapshots;
pub use profiles::{ProfileRow, Profiles};
pub use provenance::{Provenance, commit, set_commit};
pub use result_tables::{Cells, ResultTable, TableColumn};
pub use series::Series;
pub use snapshot_format::{PointColumn, SnapshotFormat, SnapshotStorage};
pub use standard_output::{print, unless_closed};
pub use units::ColumnUnits;
pub use wall_force_table::WallForceTable;
pub use whole_file::{name_when_whole, write_whole};

/// A file that could not be written, or has invalid contents.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {message}", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// The fault.
    pub message: String,
}

/// A result whose error is a message that does not name the file yet.
pub(crate) type MessageResult<T> = Result<T, String>;

/// Makes an error on one rank an error on all. Collective.
fn agreed<T>(
    path: &Path,
    result: MessageResult<T>,
    ranks: &dyn Communicator,
) -> Result<T, OutputError> {
    agree(result, ranks).map_err(|error| OutputError { path: path.to_owned(), message: error.0 })
}

/// Does work on rank 0 that ranks do not share; the others wait and are informed of errors. Collective.
pub fn on_root<T>(
    path: &Path,
    ranks: &dyn Communicator,
    work: impl FnOnce() -> MessageResult<T>,
) -> Result<Option<T>, OutputError> {
    let result = if ranks.is_root() { work().map(Some) } else { Ok(None) };
    agreed(path, result, ranks)
}

/// An error unless a path leads to a file: opening a pipe waits for its other end, perhaps without end.
pub fn require_file(path: &Path) -> std::io::Result<()> {
    if std::fs::metadata(path)?.is_file() {
        Ok(())
    } else {
        Err(std::io::Error::other("this is not a file"))
    }
}

/// The text of a file.
pub fn read_text(path: &Path) -> std::io::Result<String> {
    require_file(path).and_then(|()| std::fs::read_to_string(path))
}

/// Whether an error of HDF5 reports a failed system call: the file itself may then be intact.
fn is_error_of_system(message: &str) -> bool {
    message.contains("errno = ")
}

/// A path with something appended to its file name.
fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// Syncs a rename in a file's folder to the disk.
fn sync_folder(path: &Path) -> MessageResult<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let opened = std::fs::File::open(folder.unwrap_or(Path::new(".")));
    opened.and_then(|folder| folder.sync_all()).map_err(|error| error.to_string())
}

/// The first free name for a damaged file: `name.unreadable-1`, and so on.
fn free_name(path: &Path) -> PathBuf {
    let names = (1_u64..).map(|number| with_suffix(path, &format!(".unreadable-{number}")));
    names.into_iter().find(|name| !name.exists()).expect("there are more numbers than files")
}

/// Moves a file that cannot be continued out of the way.
fn set_aside(path: &Path, reason: &str) -> MessageResult<()> {
    let aside = free_name(path);
    std::fs::rename(path, &aside).map_err(|error| format!("cannot be renamed: {error}"))?;
    let [path, aside] = [path.display(), aside.display()];
    log::warn!(
        "{path} cannot be continued ({reason}); it is kept as {aside}, and a new one is started"
    );
    Ok(())
}
