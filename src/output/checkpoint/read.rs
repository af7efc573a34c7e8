//! From a file to ranks, and only if it is what was written.

use std::ops::Range;
use std::path::Path;

use super::measures::{self, MeasureHead};
use super::schema::{FORMAT, LEDGER, Table, VERSION, columns_of};
use super::{Checkpoint, StoredLedger};
use crate::analysis::{Digest, Pair};
use crate::output::hdf5_file::{SerialFile, SharedFile};
use crate::output::{MessageResult, OutputError, Provenance, agreed, checksum};
use crate::parallel::Communicator;
use crate::state::{Clock, Departed, GasReport, SizeRange, StoredEnergy};

/// What stands in a checkpoint beside its rows.
struct Head {
    /// Without rows.
    checkpoint: Checkpoint,
    provenance: Provenance,
    digest: String,
    /// Version of the schema that it was written by.
    version: u64,
    /// Of particles, contacts, wall contacts, cells of the gas, and pairs that were looked at.
    rows: [u64; 5],
    measures: Vec<MeasureHead>,
}

/// Reads a checkpoint, on each rank an even share of its rows; returns also who wrote it, and the
/// digest of the state. Collective.
///
/// # Errors
/// If the file is missing, empty, cut short, damaged, not a checkpoint, of a newer schema, or
/// if the state in it is not the one whose digest it names.
pub fn read(
    path: &Path,
    ranks: &dyn Communicator,
) -> Result<(Checkpoint, Provenance, Digest), OutputError> {
    checksum::check(path, ranks)?;
    read_whole(path, ranks)
}

/// The same for a file whose checksum is right. Collective.
pub(super) fn read_whole(
    path: &Path,
    ranks: &dyn Communicator,
) -> Result<(Checkpoint, Provenance, Digest), OutputError> {
    let Head { mut checkpoint, provenance, digest: stored, version, rows, measures } =
        agreed(path, read_head(path), ranks)?;
    let file = SharedFile::open_to_read(path, ranks)?;
    // Rank 0 has the sums of all ranks.
    if let Some(ledger) = checkpoint.energy.as_mut().filter(|_| !ranks.is_root()) {
        ledger.sums.clear();
    }
    checkpoint.particles = read_rows(&file, version, rows[0], ranks)?;
    checkpoint.contacts = read_rows(&file, version, rows[1], ranks)?;
    checkpoint.wall_contacts = read_rows(&file, version, rows[2], ranks)?;
    if rows[3] > 0 {
        checkpoint.cells = read_rows(&file, version, rows[3], ranks)?;
    }
    if version >= VERSION {
        checkpoint.looked_at = Some(read_rows(&file, version, rows[4], ranks)?);
    }
    checkpoint.measures = measures::read(&file, measures, |rows| share_of(rows, ranks))?;
    file.close()?;
    let digest = checkpoint.digest(ranks);
    let same = version < 3 || digest.to_string() == stored;
    let message = || format!("the state's digest is {digest}, but the file says {stored}");
    agreed(path, if same { Ok(()) } else { Err(message()) }, ranks)?;
    Ok((checkpoint, provenance, digest))
}

fn read_head(path: &Path) -> MessageResult<Head> {
    let file = SerialFile::open(path)?;
    if file.text("/", "format").as_deref() != Ok(FORMAT) {
        return Err("this is not a checkpoint of Talcum".to_owned());
    }
    let version: u64 = file.number("/", "schema_version")?;
    if version > VERSION {
        return Err(format!(
            "the checkpoint was written by a newer Talcum ({}): its schema is {version}, and this \
             program reads schemas up to {VERSION}",
            file.text("/", "talcum_version").unwrap_or_default()
        ));
    }
    let head = Head {
        checkpoint: read_small(&file, version)?,
        provenance: read_provenance(&file)?,
        digest: file.text("/", "digest")?,
        version,
        measures: measures::read_heads(&file)?,
        rows: [
            rows_of::<crate::parallel::ParticleRecord>(&file, version)?,
            rows_of::<crate::parallel::ContactRecord>(&file, version)?,
            rows_of::<crate::parallel::WallContactRecord>(&file, version)?,
            if version < 2 { 0 } else { rows_of::<crate::parallel::CellRecord>(&file, version)? },
            if version < VERSION { 0 } else { rows_of::<Pair>(&file, version)? },
        ],
    };
    file.close()?;
    Ok(head)
}

/// Everything but the rows.
fn read_small(file: &SerialFile, version: u64) -> MessageResult<Checkpoint> {
    let case_text = file.text("/", "case")?;
    if file.text("/", "case_blake3")? != blake3::hash(case_text.as_bytes()).to_hex().as_str() {
        return Err("the text of the case is damaged".to_owned());
    }
    let clock = Clock {
        step: file.number("/clock", "step")?,
        origin_time: file.number("/clock", "origin_time")?,
        origin_step: file.number("/clock", "origin_step")?,
        time_step: file.number("/clock", "time_step")?,
    };
    if clock.origin_step > clock.step {
        return Err("the clock's origin lies after its step".to_owned());
    }
    Ok(Checkpoint {
        clock,
        departed: Departed {
            count: file.number("/departed", "count")?,
            volume: file.number("/departed", "volume")?,
        },
        sizes: SizeRange {
            smallest_diameter: file.number("/sizes", "smallest_diameter")?,
            largest_diameter: file.number("/sizes", "largest_diameter")?,
            largest_mass: file.number("/sizes", "largest_mass")?,
        },
        case_text,
        case_folder: file.text("/", "case_folder")?,
        particles: Vec::new(),
        contacts: Vec::new(),
        wall_contacts: Vec::new(),
        cells: Vec::new(),
        looked_at: None,
        measures: Vec::new(),
        gas_report: if version < 2 { GasReport::default() } else { read_report(file)? },
        energy: if version < 4 { None } else { read_ledger(file)? },
    })
}

fn read_report(file: &SerialFile) -> MessageResult<GasReport> {
    Ok(GasReport {
        iterations: file.number("/gas", "iterations")?,
        raised_cells: file.number("/gas", "raised_cells")?,
        courant: file.number("/gas", "courant")?,
        momentum_error: file.number("/gas", "momentum_error")?,
    })
}

fn read_ledger(file: &SerialFile) -> MessageResult<Option<StoredLedger>> {
    let kept: u64 = file.number("/energy", "kept")?;
    if kept == 0 {
        return Ok(None);
    }
    let start = StoredEnergy {
        kinetic: file.number("/energy", "kinetic")?,
        potential: file.number("/energy", "potential")?,
        elastic: file.number("/energy", "elastic")?,
    };
    Ok(Some(StoredLedger { sums: file.read(LEDGER)?, start }))
}

fn read_provenance(file: &SerialFile) -> MessageResult<Provenance> {
    let text = |name: &str| file.text("/", name);
    let ranks = text("ranks")?;
    Ok(Provenance {
        version: text("talcum_version")?,
        commit: text("commit")?,
        ranks: ranks.parse().map_err(|_| format!("ranks = {ranks} is not a number"))?,
        ranks_are: text("ranks_are").ok(),
        machine: text("machine")?,
        date: text("date")?,
        title: text("title")?,
        units: text("units")?,
    })
}

/// The number of rows of a table; all its columns of this version must have it, and their widths.
fn rows_of<R: Table>(file: &SerialFile, version: u64) -> MessageResult<u64> {
    let (rows, _) = file.shape(R::IDS[0].name)?;
    let ids = R::IDS.iter().map(|column| (column.name, 1));
    let numbers = columns_of::<R>(version).map(|column| (column.name, column.width));
    for (name, width) in ids.chain(numbers) {
        let shape = file.shape(name)?;
        if shape != (rows, width) {
            return Err(format!("{name} has the shape {shape:?} instead of {:?}", (rows, width)));
        }
    }
    Ok(rows)
}

/// This rank's even share of so many rows.
fn share_of(total: u64, ranks: &dyn Communicator) -> Range<u64> {
    let begin_of = |rank: usize| (u128::from(total) * rank as u128 / ranks.size() as u128) as u64;
    begin_of(ranks.rank())..begin_of(ranks.rank() + 1)
}

/// This rank's even share of a table's rows.
fn read_rows<R: Table>(
    file: &SharedFile<'_>,
    version: u64,
    total: u64,
    ranks: &dyn Communicator,
) -> Result<Vec<R>, OutputError> {
    let Range { start: first, end } = share_of(total, ranks);
    let count = end - first;
    let mut records = vec![R::zeroed(); count as usize];
    for column in R::IDS {
        let values: Vec<u64> = file.read_rows(column.name, first, count)?;
        for (record, value) in records.iter_mut().zip(values) {
            *(column.get_mut)(record) = value;
        }
    }
    for column in columns_of::<R>(version) {
        let values: Vec<f64> = file.read_rows(column.name, first, count)?;
        for (record, value) in records.iter_mut().zip(values.chunks_exact(column.width)) {
            (column.get_mut)(record).copy_from_slice(value);
        }
    }
    Ok(records)
}
