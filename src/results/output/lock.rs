//! Locks on files: they are held by a process, and released when it ends in any way.

use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use rustix::process::{Pid, test_kill_process};
use std::fs::File;
use std::io::{Seek, Write};
use std::path::Path;

/// Other processes that may hold the lock at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// None.
    Exclusive,
    /// Others that share it.
    Shared,
}

/// Takes a lock if it is free; `None` if another process holds it.
///
/// A child process that inherits the file keeps the lock for as long as it lives.
///
/// # Errors
/// If the file cannot be made, or the file system has no locks.
pub fn try_lock(path: &Path, sharing: Sharing) -> Result<Option<File>, String> {
    let operation = match sharing {
        Sharing::Exclusive => FlockOperation::NonBlockingLockExclusive,
        Sharing::Shared => FlockOperation::NonBlockingLockShared,
    };
    let file = open(path)?;
    match flock(&file, operation) {
        Ok(()) => Ok(Some(file)),
        Err(Errno::WOULDBLOCK) => Ok(None),
        Err(error) => Err(format!("{} cannot be locked: {error}", path.display())),
    }
}

/// Waits until a lock is free and takes it.
///
/// # Errors
/// If the file cannot be made, or the file system has no locks.
pub fn wait_for_lock(path: &Path) -> Result<File, String> {
    let file = open(path)?;
    loop {
        match flock(&file, FlockOperation::LockExclusive) {
            Ok(()) => return Ok(file),
            Err(Errno::INTR) => {}
            Err(error) => return Err(format!("{} cannot be locked: {error}", path.display())),
        }
    }
}

fn open(path: &Path) -> Result<File, String> {
    let file = File::options().read(true).write(true).create(true).truncate(false).open(path);
    file.map_err(|error| format!("{} cannot be opened: {error}", path.display()))
}

/// Writes the name of the holder into a locked file.
pub fn sign(mut file: &File) {
    let host = host_name();
    let since = super::provenance::date(std::time::SystemTime::now());
    let text = format!("process {} on {host}, since {since}\n", std::process::id());
    // Only a message to others depends on it.
    let _ =
        file.set_len(0).and_then(|()| file.rewind()).and_then(|()| file.write_all(text.as_bytes()));
}

/// The process that signed a locked file.
pub fn holder(path: &Path) -> String {
    match super::read_text(path) {
        Ok(text) if !text.trim().is_empty() => text.trim().to_owned(),
        _ => "another process".to_owned(),
    }
}

/// Whether the process of a signature still exists; `None` if this cannot be determined on this host.
pub fn is_alive(signature: &str) -> Option<bool> {
    let (process, rest) = signature.strip_prefix("process ")?.split_once(" on ")?;
    let process = Pid::from_raw(process.parse().ok()?)?;
    // A process of another user cannot be signalled, but it exists.
    let is_gone = || test_kill_process(process) == Err(Errno::SRCH);
    (rest.split(',').next()? == host_name()).then(|| !is_gone())
}

/// The name of this host; empty if it is not known.
pub fn host_name() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_excludes_others_until_its_file_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let held = try_lock(&path, Sharing::Exclusive).unwrap().unwrap();
        sign(&held);
        assert!(try_lock(&path, Sharing::Shared).unwrap().is_none());
        assert!(holder(&path).contains(&std::process::id().to_string()));
        drop(held);
        let one = try_lock(&path, Sharing::Shared).unwrap();
        assert!(one.is_some() && try_lock(&path, Sharing::Shared).unwrap().is_some());
        assert!(try_lock(&path, Sharing::Exclusive).unwrap().is_none());
    }

    #[test]
    fn a_process_is_looked_for_on_its_own_host_only() {
        let signed =
            |process: u32, host: &str| is_alive(&format!("process {process} on {host}, since x"));
        assert_eq!(signed(std::process::id(), &host_name()), Some(true));
        // A number beyond the largest that a process may have.
        assert_eq!(signed(1 << 30, &host_name()), Some(false));
        assert_eq!(signed(std::process::id(), "elsewhere.invalid"), None);
        assert_eq!(is_alive("another process"), None);
    }
}
