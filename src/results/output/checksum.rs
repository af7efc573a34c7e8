//! A checksum trailer: a hash over the bytes of a file, at its end. The HDF5 library must not read bytes that were not
//! written by Talcum, since it may crash on damaged files.
//!
//! HDF5 ignores bytes after its data, so a file with a trailer is still an HDF5 file. The bytes are hashed in blocks,
//! by all ranks together.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use xxhash_rust::xxh3::xxh3_128;

use super::{OutputError, agreed, on_root};
use talcum_engine::parallel::Communicator;

/// Kind of checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// BLAKE3, 256 bits: older files.
    First,
    /// XXH3, 128 bits in the canonical order of bytes: detects damage as reliably, at the speed of memory.
    Second,
}

impl Kind {
    /// First bytes of the trailer.
    fn mark(self) -> &'static [u8; 16] {
        match self {
            Self::First => b"\nTalcum seal  1\n",
            Self::Second => b"\nTalcum seal  2\n",
        }
    }

    const fn hash_length(self) -> usize {
        match self {
            Self::First => 32,
            Self::Second => 16,
        }
    }

    fn hash(self, bytes: &[u8]) -> Vec<u8> {
        match self {
            Self::First => blake3::hash(bytes).as_bytes().to_vec(),
            Self::Second => xxh3_128(bytes).to_be_bytes().to_vec(),
        }
    }
}

/// Contents of a trailer: the length of the covered bytes, and their hash.
struct Trailer {
    kind: Kind,
    length: u64,
    hash: Vec<u8>,
}

/// Length of the trailer before the hash: the mark, and the length of the covered bytes.
const HEAD_LENGTH: usize = 16 + 8;
/// Length of the longest trailer.
const LONGEST: u64 = (HEAD_LENGTH + Kind::First.hash_length()) as u64;
/// Number of bytes that are hashed as one block.
const BLOCK: u64 = 1 << 22;
/// First bytes of an HDF5 file.
const HDF5_SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";

impl Trailer {
    fn to_bytes(&self) -> Vec<u8> {
        [&self.kind.mark()[..], &self.length.to_le_bytes(), &self.hash].concat()
    }

    /// The trailer at the end of a file, given its last bytes and its length.
    fn at_end(bytes: &[u8], file_length: u64) -> Option<Self> {
        [Kind::First, Kind::Second].into_iter().find_map(|kind| {
            let from = bytes.len().checked_sub(HEAD_LENGTH + kind.hash_length())?;
            let hash = bytes[from + HEAD_LENGTH..].to_vec();
            let length = file_length - (bytes.len() - from) as u64;
            let trailer = Self { kind, length, hash };
            (trailer.to_bytes() == bytes[from..]).then_some(trailer)
        })
    }
}

/// Appends the trailer to a closed file and syncs it to the disk. Collective.
pub(super) fn append(path: &Path, ranks: &dyn Communicator) -> Result<(), OutputError> {
    append_kind(Kind::Second, path, ranks)
}

fn append_kind(kind: Kind, path: &Path, ranks: &dyn Communicator) -> Result<(), OutputError> {
    let length = std::fs::metadata(path).map(|data| data.len()).map_err(|error| error.to_string());
    let length = agreed(path, length, ranks)?;
    let hash = hash_of(kind, path, length, ranks)?;
    on_root(path, ranks, || {
        let write = || {
            let mut file = OpenOptions::new().append(true).open(path)?;
            file.write_all(&Trailer { kind, length, hash }.to_bytes())
        };
        write().map_err(|error: std::io::Error| error.to_string())
    })?;
    // Each rank wrote through its own machine.
    let synced = File::open(path).and_then(|file| file.sync_all());
    agreed(path, synced.map_err(|error| error.to_string()), ranks)
}

/// Reason why a file is rejected; it is equal on all ranks.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It cannot be read at present; the file itself may be intact.
    Unreadable(OutputError),
    /// It is damaged, or not such a file.
    Damaged(OutputError),
}

impl From<Refusal> for OutputError {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Unreadable(error) | Refusal::Damaged(error) => error,
        }
    }
}

/// Rejects a file whose bytes do not agree with its trailer. Collective.
pub(super) fn check(path: &Path, ranks: &dyn Communicator) -> Result<(), Refusal> {
    let trailer = read_trailer(path);
    let is_unreadable = ranks.any(matches!(trailer, Err(Flaw::Unreadable(_))));
    let trailer = agreed(path, trailer.map_err(Flaw::message), ranks);
    let refuse = if is_unreadable { Refusal::Unreadable } else { Refusal::Damaged };
    let Trailer { kind, length, hash } = trailer.map_err(refuse)?;
    let same = hash_of(kind, path, length, ranks).map_err(Refusal::Unreadable)? == hash;
    let message = "the file is damaged: its bytes are not those that were written";
    agreed(path, if same { Ok(()) } else { Err(message.to_owned()) }, ranks)
        .map_err(Refusal::Damaged)
}

/// A fault of a file found by one rank.
enum Flaw {
    Unreadable(String),
    Damaged(String),
}

impl Flaw {
    fn message(self) -> String {
        match self {
            Self::Unreadable(message) | Self::Damaged(message) => message,
        }
    }
}

impl From<String> for Flaw {
    fn from(message: String) -> Self {
        Self::Damaged(message)
    }
}

fn read_trailer(path: &Path) -> Result<Trailer, Flaw> {
    let unopened = |error: std::io::Error| Flaw::Unreadable(format!("cannot be opened: {error}"));
    let unreadable = |error: std::io::Error| Flaw::Unreadable(format!("cannot be read: {error}"));
    // This is done before it is opened: opening a pipe waits for its other end.
    let metadata = std::fs::metadata(path).map_err(unopened)?;
    if !metadata.is_file() {
        return Err("this is not a file".to_owned().into());
    }
    let mut file = File::open(path).map_err(unopened)?;
    let length = metadata.len();
    if length == 0 {
        return Err("the file is empty".to_owned().into());
    }
    let mut start = Vec::new();
    Read::by_ref(&mut file).take(64).read_to_end(&mut start).map_err(unreadable)?;
    if !start.starts_with(HDF5_SIGNATURE) {
        return Err("this is not an HDF5 file".to_owned().into());
    }
    let mut end = Vec::new();
    file.seek(SeekFrom::Start(length.saturating_sub(LONGEST))).map_err(unreadable)?;
    file.read_to_end(&mut end).map_err(unreadable)?;
    if let Some(trailer) = Trailer::at_end(&end, length) {
        return Ok(trailer);
    }
    match promised_length(&start) {
        Some(promised) if promised > length => {
            Err(format!("the file was cut short: it has {length} of {promised} bytes").into())
        }
        _ => Err(
            "the file does not end in Talcum's checksum: it was cut short or damaged, or is an HDF5 \
                  file of another program, not a checkpoint"
                .to_owned()
                .into(),
        ),
    }
}

/// The number of bytes given in the head of an HDF5 file ("end of file address" of its superblock, HDF5 File Format
/// Specification 3.0 section II.A, with addresses of eight bytes).
fn promised_length(start: &[u8]) -> Option<u64> {
    let at = match start.get(8)? {
        0 => 40,
        1 => 44,
        _ => 28,
    };
    Some(u64::from_le_bytes(start.get(at..at + 8)?.try_into().ok()?))
}

/// Hash of the first `length` bytes: the hash of the hashes of their blocks. Collective.
fn hash_of(
    kind: Kind,
    path: &Path,
    length: u64,
    ranks: &dyn Communicator,
) -> Result<Vec<u8>, OutputError> {
    let own = own_hashes(kind, path, length, ranks);
    let own = agreed(path, own.map_err(|error| error.to_string()), ranks)?;
    let mut bytes = Vec::new();
    if let Some(gathered) = ranks.gather_to_root(&own) {
        let mut of_ranks: Vec<_> =
            gathered.iter().map(|own| own.chunks_exact(kind.hash_length())).collect();
        let blocks = length.div_ceil(BLOCK) as usize;
        let size = of_ranks.len();
        let in_turn = (0..blocks).filter_map(|block| of_ranks[block % size].next());
        bytes = kind.hash(&in_turn.collect::<Vec<_>>().concat());
    }
    ranks.broadcast_from_root(&mut bytes);
    Ok(bytes)
}

/// Hashes of this rank's blocks: those whose numbers differ from its own by multiples of the number of ranks.
fn own_hashes(
    kind: Kind,
    path: &Path,
    length: u64,
    ranks: &dyn Communicator,
) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let mut hashes = Vec::new();
    let mut block = vec![0; BLOCK.min(length) as usize];
    for number in (ranks.rank() as u64..length.div_ceil(BLOCK)).step_by(ranks.size()) {
        let start = number * BLOCK;
        let bytes = &mut block[..BLOCK.min(length - start) as usize];
        file.seek(SeekFrom::Start(start))?;
        file.read_exact(bytes)?;
        hashes.extend(kind.hash(bytes));
    }
    Ok(hashes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::parallel::{OneRank, run_on_threads};

    #[test]
    fn a_checksum_of_several_blocks_is_the_same_on_any_number_of_ranks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        let mut bytes = HDF5_SIGNATURE.to_vec();
        bytes.extend((0..2 * BLOCK + 1000).map(|k| (k % 251) as u8));
        std::fs::write(&path, &bytes).unwrap();
        for kind in [Kind::First, Kind::Second] {
            std::fs::write(&path, &bytes).unwrap();
            append_kind(kind, &path, &OneRank).unwrap();
            for n in 1..=4 {
                run_on_threads(n, |ranks| check(&path, ranks).unwrap());
            }
            let mut damaged = std::fs::read(&path).unwrap();
            damaged[BLOCK as usize + 5] ^= 1;
            std::fs::write(&path, &damaged).unwrap();
            run_on_threads(3, |ranks| {
                let Err(Refusal::Damaged(error)) = check(&path, ranks) else { panic!("taken") };
                assert!(error.message.contains("damaged"));
            });
        }
    }
}
