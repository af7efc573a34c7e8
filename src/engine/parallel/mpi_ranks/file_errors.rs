//! Errors of MPI file operations, which end all ranks.
//!
//! Files are written and read by all ranks together, in the collective calls of the HDF5 library. If such a call fails
//! on one rank (a full disk, a bad sector), that rank leaves it at once, and the others wait in it without end. They
//! would never reach a later agreement on the error. The rank that meets the failure therefore reports it and ends all
//! ranks. Checkpoints receive their final names only when they are complete, so the last one is not touched.

#![allow(unsafe_code, reason = "the mpi crate has no handlers of file errors")]

use crate::parallel::flush_standard_streams;
use mpi::ffi::{self, MPI_Errhandler, MPI_File};
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator as _;
use rustix::io::Errno;
use std::ffi::c_int;
use std::io::Write;
use std::mem::MaybeUninit;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

/// Exit code of all ranks; the same as for any other error.
const CODE: i32 = 1;
/// Additional waiting time of each rank relative to the previous one. If all ranks meet the failure, the first one to
/// report it ends the others before they repeat it.
const PAUSE: Duration = Duration::from_millis(100);
/// The longest such pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);

/// Errors that concern files. Other numbers are left from earlier calls.
const OF_FILES: [Errno; 12] = [
    Errno::NOSPC,
    Errno::DQUOT,
    Errno::IO,
    Errno::FBIG,
    Errno::ROFS,
    Errno::MFILE,
    Errno::NFILE,
    Errno::NOMEM,
    Errno::STALE,
    Errno::ACCESS,
    Errno::NODEV,
    Errno::ISDIR,
];
/// Free space below which a warning is printed, in bytes.
const LITTLE: u64 = 100_000_000;

/// The file that was opened last; the error names it.
static FILE: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Sets the file that later errors name.
pub(super) fn set_file(path: &Path) {
    if let Ok(mut file) = FILE.lock() {
        *file = Some(path.to_owned());
    }
    count_handler_once_more();
}

/// Asks once more for the error handler of the null file. Each file takes over this handler when it is opened, and
/// gives it back when it is closed. MPICH 4.0 counts only the latter, so that after a few files the handler would count
/// as freed, and MPI aborts ("Assertion failed ... ref_count"). A request for the handler counts it. If MPI counts
/// correctly, the count is one too large, which does no harm.
fn count_handler_once_more() {
    let mut handler = MaybeUninit::<MPI_Errhandler>::uninit();
    // SAFETY: MPI is initialised, as files are opened by its ranks.
    unsafe { ffi::MPI_File_get_errhandler(ffi::RSMPI_FILE_NULL, handler.as_mut_ptr()) };
}

/// Makes errors of all files that are opened from now on end all ranks. MPI must be initialised.
pub(super) fn end_all_ranks_on_file_errors() {
    let mut handler = MaybeUninit::<MPI_Errhandler>::uninit();
    // SAFETY: MPI calls the function with a file, a pointer to the code, and arguments that depend on the
    // implementation. They are passed after the two that the function has, so that it does not see them.
    unsafe {
        let function = std::mem::transmute::<
            unsafe extern "C" fn(*mut MPI_File, *mut c_int),
            unsafe extern "C" fn(*mut MPI_File, *mut c_int, ...),
        >(end_all_ranks);
        ffi::MPI_File_create_errhandler(Some(function), handler.as_mut_ptr());
        // Every file that is opened later takes over the handler of the null file.
        ffi::MPI_File_set_errhandler(ffi::RSMPI_FILE_NULL, handler.assume_init());
    }
}

/// Ends all ranks; called by MPI at the place where the operation has failed.
unsafe extern "C" fn end_all_ranks(_: *mut MPI_File, code: *mut c_int) {
    // This comes before any other call to the system.
    let cause = cause_of_failure(std::io::Error::last_os_error());
    let world = SimpleCommunicator::world();
    let rank = u32::try_from(world.rank()).unwrap_or(u32::MAX);
    std::thread::sleep(PAUSE.saturating_mul(rank).min(LONGEST_PAUSE));
    // SAFETY: MPI gives a pointer to the code.
    let reason = text_of(unsafe { *code });
    let file = FILE.lock().ok().and_then(|file| file.clone()).unwrap_or_default();
    let room = free_space(&file);
    // Nothing is left to do if standard error is closed.
    let _ = writeln!(
        std::io::stderr(),
        "error: {}: rank {rank}: {reason}{cause}{room}",
        file.display()
    );
    flush_standard_streams();
    world.abort(CODE)
}

/// The system's error of the failed call, if it concerns files: MPI itself keeps only that there was one.
fn cause_of_failure(error: std::io::Error) -> String {
    let kind = Errno::from_io_error(&error).filter(|kind| OF_FILES.contains(kind));
    kind.map_or_else(String::new, |_| format!(": {error}"))
}

/// The free space, if it is little.
fn free_space(path: &Path) -> String {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let Ok(found) = rustix::fs::statvfs(folder.unwrap_or(Path::new("."))) else {
        return String::new();
    };
    let free = found.f_bavail.saturating_mul(found.f_frsize);
    if free < LITTLE {
        format!("; {:.1} MB are free on its file system", 1.0e-6 * free as f64)
    } else {
        String::new()
    }
}

/// MPI's text for an error code.
fn text_of(code: c_int) -> String {
    let mut text = [0_u8; ffi::MPI_MAX_ERROR_STRING as usize];
    let mut length = 0;
    // SAFETY: there is room for the longest text.
    unsafe { ffi::MPI_Error_string(code, text.as_mut_ptr().cast(), &raw mut length) };
    let length = usize::try_from(length).unwrap_or(0).min(text.len());
    String::from_utf8_lossy(&text[..length]).into_owned()
}
