//! A copy of all data of a growing HDF5 file except its many numbers, so that no rows are lost by a kill or damage.
//!
//! HDF5 writes rows to places that it never moves, but while it adds rows it changes, in several writes, the records of
//! their positions (its metadata). A program that is killed between two of these writes leaves an unreadable file. At
//! each checkpoint this metadata is copied next to the file, as `<name>.metadata`. A resumed run puts it back and
//! truncates the file to its length at that time: the file is again the one of the checkpoint. The times of the rows
//! are copied as well, and the index of snapshots. A resumed run counts the rows by these, and one wrong time would
//! cost all later rows. The copy is small: 8 bytes for each of these numbers, and about a hundred for each 4096 rows of
//! the other datasets.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::hdf5_file::SerialFile;
use super::whole_file::make_whole;
use super::{MessageResult, OutputError, on_root, require_file, with_suffix, write_whole};
use talcum_engine::parallel::Communicator;

/// First bytes of a copy.
const MARK: &[u8; 16] = b"\nTalcum copy  1\n";
/// Number of bytes of the hash at the end.
const HASH_LENGTH: usize = 32;

fn path_of_copy(path: &Path) -> PathBuf {
    with_suffix(path, ".metadata")
}

/// Makes a new file with its first copy; it receives its name only when it is complete. Rows of the `bulk` tables are
/// not copied.
pub(super) fn create(
    path: &Path,
    bulk: &[String],
    make: impl FnOnce(&Path) -> MessageResult<()>,
) -> MessageResult<()> {
    // The copy of an older file would otherwise be put into this one.
    match std::fs::remove_file(path_of_copy(path)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error.to_string()),
        _ => {}
    }
    make_whole(path, make)?;
    commit(path, bulk)
}

/// Copies the metadata of a closed file, replacing an earlier copy, and syncs the file to the disk: from now on its
/// rows are safe. Those of the `bulk` tables are not copied.
pub(super) fn commit(path: &Path, bulk: &[String]) -> MessageResult<()> {
    let file = SerialFile::open(path)?;
    let mut rows = Vec::new();
    for name in bulk {
        rows.extend(file.places_of_rows(name, file.shape(name)?.0)?);
    }
    file.close()?;
    let copy = copy_of_all_but(path, rows).map_err(|error| error.to_string());
    let copied = copy.and_then(|copy| write_whole(&path_of_copy(path), &copy));
    copied.map_err(|error| format!("its metadata cannot be copied: {error}"))
}

/// Commits on rank 0. Collective.
pub(super) fn commit_on_root(
    path: &Path,
    bulk: &[String],
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    on_root(path, ranks, || commit(path, bulk)).map(|_| ())
}

/// All of a file except the given ranges, with the places of the parts.
fn copy_of_all_but(path: &Path, rows: Vec<Range<u64>>) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    file.sync_all()?;
    let length = file.metadata()?.len();
    let pieces = gaps(rows, length);
    let mut copy = MARK.to_vec();
    copy.extend_from_slice(&length.to_le_bytes());
    copy.extend_from_slice(&(pieces.len() as u64).to_le_bytes());
    for piece in &pieces {
        copy.extend_from_slice(&piece.start.to_le_bytes());
        copy.extend_from_slice(&piece.end.to_le_bytes());
    }
    for piece in &pieces {
        file.seek(SeekFrom::Start(piece.start))?;
        Read::by_ref(&mut file).take(piece.end - piece.start).read_to_end(&mut copy)?;
    }
    let hash = blake3::hash(&copy);
    copy.extend_from_slice(hash.as_bytes());
    Ok(copy)
}

/// The gaps between ranges, from 0 to `length`.
fn gaps(mut ranges: Vec<Range<u64>>, length: u64) -> Vec<Range<u64>> {
    ranges.sort_unstable_by_key(|range| range.start);
    ranges.push(length..length);
    let mut end = 0;
    let mut gaps = Vec::new();
    for range in ranges {
        if range.start > end {
            gaps.push(end..range.start);
        }
        end = end.max(range.end);
    }
    gaps
}

/// Restores a file to its committed state and length. Rows beyond the length with which the file was found are lost,
/// and become zeros. Without a copy nothing is done, with a warning.
pub(super) fn restore(path: &Path) -> MessageResult<()> {
    let place = path_of_copy(path);
    if !place.exists() {
        let (place, path) = (place.display(), path.display());
        log::warn!("{place} is not there: nothing says whether {path} has lost its last rows");
        return Ok(());
    }
    let copy = require_file(&place).and_then(|()| std::fs::read(&place));
    let copy = copy.map_err(|error| format!("{}: {error}", place.display()))?;
    match Copy::of_bytes(&copy) {
        Some(copy) => copy.put_into(path).map_err(|error| error.to_string())?,
        None => log::warn!("{} is damaged: it is not used", place.display()),
    }
    Ok(())
}

/// A complete copy, split into its parts.
struct Copy<'a> {
    length: u64,
    pieces: Vec<(u64, &'a [u8])>,
}

impl<'a> Copy<'a> {
    fn of_bytes(bytes: &'a [u8]) -> Option<Self> {
        let (covered, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH_LENGTH)?)?;
        if *blake3::hash(covered).as_bytes() != *hash {
            return None;
        }
        let mut rest = covered.strip_prefix(MARK)?;
        let length = number(&mut rest)?;
        let count = number(&mut rest)?;
        let ranges: Vec<[u64; 2]> = (0..count)
            .map(|_| Some([number(&mut rest)?, number(&mut rest)?]))
            .collect::<Option<_>>()?;
        let mut pieces = Vec::with_capacity(ranges.len());
        for [start, end] in ranges {
            let (piece, after) = rest.split_at_checked(end.checked_sub(start)? as usize)?;
            pieces.push((start, piece));
            rest = after;
        }
        Some(Self { length, pieces })
    }

    fn put_into(&self, path: &Path) -> std::io::Result<()> {
        let mut file = OpenOptions::new().write(true).open(path)?;
        file.set_len(self.length)?;
        for (start, piece) in &self.pieces {
            file.seek(SeekFrom::Start(*start))?;
            file.write_all(piece)?;
        }
        file.sync_all()
    }
}

fn number(bytes: &mut &[u8]) -> Option<u64> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(u64::from_le_bytes(*first))
}

/// An error if some of the first rows of a table lie beyond the length with which a file was found.
pub(super) fn require_rows(
    file: &SerialFile,
    name: &str,
    rows: u64,
    found_length: u64,
) -> MessageResult<()> {
    let end = file.places_of_rows(name, rows)?.iter().map(|place| place.end).max().unwrap_or(0);
    if end > found_length {
        return Err(format!("it was cut short: rows of {name} lie beyond its end"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::table::{Rows, TableHead};

    const WIDTHS: [usize; 3] = [1, 3, 40];

    fn tables() -> Vec<String> {
        WIDTHS.iter().map(|width| format!("/rows/{width}")).collect()
    }

    fn make(path: &Path) -> MessageResult<()> {
        let file = SerialFile::create(path)?;
        file.make_group("/rows")?;
        file.set_number("/rows", "count", 0_i64)?;
        for (name, width) in tables().iter().zip(WIDTHS) {
            let shape: &[usize] = if width == 1 { &[] } else { &[width] };
            let head = TableHead { name, shape, unit: "1", description: "rows of a test" };
            file.make_table::<f64>(&head, Rows::Growing(8))?;
        }
        file.close()
    }

    fn row(number: u64, width: usize) -> impl Iterator<Item = f64> {
        (0..width).map(move |column| number as f64 + 0.01 * column as f64)
    }

    fn append(path: &Path, numbers: Range<u64>) {
        let file = SerialFile::open_to_change(path).unwrap();
        for (name, width) in tables().iter().zip(WIDTHS) {
            let rows: Vec<f64> = numbers.clone().flat_map(|number| row(number, width)).collect();
            file.append(name, &rows).unwrap();
        }
        file.set_number("/rows", "count", numbers.end as i64).unwrap();
        file.close().unwrap();
    }

    /// A resumed run that needs the first `rows` rows, which must be as they were written.
    fn resume(path: &Path, rows: u64) -> MessageResult<()> {
        let found = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
        restore(path)?;
        let file = SerialFile::open_to_change(path)?;
        tables().iter().try_for_each(|name| require_rows(&file, name, rows, found))?;
        for (name, width) in tables().iter().zip(WIDTHS) {
            file.cut(name, rows)?;
            let expected: Vec<f64> = (0..rows).flat_map(|number| row(number, width)).collect();
            assert_eq!(file.read::<f64>(name)?, expected);
        }
        file.close()
    }

    /// A mixture of blocks of a file from two times: any part of the data to be written has reached the file. This is a
    /// superset of what a kill can leave.
    fn mixed(before: &[u8], after: &[u8], trial: u64) -> Vec<u8> {
        const BLOCK: usize = 32;
        let mut mixed = after.to_vec();
        let blocks = mixed.chunks_mut(BLOCK).zip(before.chunks(BLOCK)).enumerate();
        for (number, (block, earlier)) in blocks {
            let hash = blake3::hash(&[trial.to_le_bytes(), number.to_le_bytes()].concat());
            // From few blocks of the later time to nearly all of them.
            if u64::from(hash.as_bytes()[0]) * 16 > 256 * (trial % 16) {
                block[..earlier.len()].copy_from_slice(earlier);
            }
        }
        let cut = (after.len() - before.len()) as u64 * (trial % 7) / 6;
        mixed.truncate(before.len() + cut as usize);
        mixed
    }

    #[test]
    fn no_part_of_a_write_takes_away_committed_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.h5");
        create(&path, &tables(), make).unwrap();
        let mut rows = 0;
        for round in 0..6 {
            // The rounds go through the first chunk, some chunks, and several levels of the tree of chunks.
            let more = [1, 30, 700, 3, 2000, 40][round];
            append(&path, rows..rows + more);
            rows += more;
            commit(&path, &tables()).unwrap();
            let before = std::fs::read(&path).unwrap();
            for (step, more) in [1, 9, 300, 5].into_iter().enumerate() {
                append(&path, rows..rows + more);
                let after = std::fs::read(&path).unwrap();
                for trial in 0..10 {
                    let trial = 10 * step as u64 + trial;
                    std::fs::write(&path, mixed(&before, &after, trial)).unwrap();
                    resume(&path, rows).unwrap();
                }
                // The run is killed once more, after it has resumed and committed its starting point.
                commit(&path, &tables()).unwrap();
                let seed = 1000 + step as u64;
                std::fs::write(&path, mixed(&before, &after, seed)).unwrap();
                resume(&path, rows).unwrap();
            }
        }
    }

    #[test]
    fn damage_is_repaired_or_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.h5");
        create(&path, &tables(), make).unwrap();
        append(&path, 0..100);
        commit(&path, &tables()).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let mut damaged = whole.clone();
        damaged[..200].fill(0xff);
        std::fs::write(&path, &damaged).unwrap();
        resume(&path, 100).unwrap();
        // Some rows no longer exist.
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        assert!(resume(&path, 100).unwrap_err().contains("it was cut short"));
        // Nothing helps if the copy is damaged too.
        let copy = path_of_copy(&path);
        let mut bytes = std::fs::read(&copy).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&copy, bytes).unwrap();
        std::fs::write(&path, &damaged).unwrap();
        assert!(resume(&path, 100).is_err());
    }

    #[test]
    fn gaps_are_what_is_left() {
        assert_eq!(gaps(vec![5..7, 0..2, 7..9], 12), [2..5, 9..12]);
        assert_eq!(gaps(vec![1..3, 4..6], 6), [0..1, 3..4]);
    }
}
