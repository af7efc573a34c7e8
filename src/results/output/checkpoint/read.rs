//! Reading of a checkpoint from a file, which is accepted only if it is exactly what was written.

use std::ops::Range;
use std::path::Path;

use super::instruments::{self, InstrumentHead};
use super::schema::{
    FIRST_WITH_DIGEST, FORMAT, FieldsInFile, LEDGER, VERSION, fields_in_file, has, own_names,
    path_of,
};
use super::{Checkpoint, StoredLedger};
use crate::analysis::{Digest, Pair};
use crate::output::hdf5_file::{SerialFile, SharedFile};
use crate::output::{MessageResult, OutputError, Provenance, agreed, checksum};
use talcum_engine::fields::{CounterValue, Field, Kind, Record, Unit};
use talcum_engine::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, WallContactRecord,
};
use talcum_engine::particles::CustomFields;
use talcum_engine::state::{Clock, Departed, GasReport, SizeRange, StoredEnergy};

/// Contents of a checkpoint besides its rows.
struct Head {
    /// The checkpoint without rows.
    checkpoint: Checkpoint,
    provenance: Provenance,
    digest: String,
    /// Version of the schema with which it was written.
    version: u64,
    particles: TableInFile,
    contacts: TableInFile,
    wall_contacts: TableInFile,
    /// `None` without a gas that has cells.
    cells: Option<TableInFile>,
    /// `None` if drag does not depend on agglomerates.
    looked_at: Option<TableInFile>,
    instruments: Vec<InstrumentHead>,
}

/// The rows of a record in a file, and the fields that it has.
struct TableInFile {
    rows: u64,
    fields: FieldsInFile,
}

/// Reads a checkpoint, on each rank an even share of its rows; also returns its provenance and the digest of the state.
/// Collective.
///
/// # Errors
/// If the file is missing, empty, truncated, damaged, not a checkpoint, of a newer schema, or if the state in it does
/// not have the digest that it names.
pub fn read(
    path: &Path,
    ranks: &dyn Communicator,
) -> Result<(Checkpoint, Provenance, Digest), OutputError> {
    checksum::check(path, ranks)?;
    read_whole(path, ranks)
}

/// Reads a file whose checksum is known to be right. Collective.
pub(super) fn read_whole(
    path: &Path,
    ranks: &dyn Communicator,
) -> Result<(Checkpoint, Provenance, Digest), OutputError> {
    let head = agreed(path, read_head(path), ranks)?;
    let mut checkpoint = head.checkpoint;
    let file = SharedFile::open_to_read(path, ranks)?;
    // Rank 0 has the sums of all ranks.
    if let Some(ledger) = checkpoint.energy.as_mut().filter(|_| !ranks.is_root()) {
        ledger.sums.clear();
    }
    checkpoint.custom.numbers =
        read_custom(&file, &checkpoint.custom.fields, head.particles.rows, ranks)?;
    checkpoint.particles = read_rows(&file, &head.particles, ranks)?;
    checkpoint.contacts = read_rows(&file, &head.contacts, ranks)?;
    checkpoint.wall_contacts = read_rows(&file, &head.wall_contacts, ranks)?;
    if let Some(cells) = &head.cells {
        checkpoint.cells = read_rows(&file, cells, ranks)?;
    }
    if let Some(pairs) = &head.looked_at {
        checkpoint.looked_at = Some(read_rows(&file, pairs, ranks)?);
    }
    checkpoint.instruments =
        instruments::read(&file, head.instruments, |rows| share_of(rows, ranks))?;
    file.close()?;
    let digest = checkpoint.digest(ranks);
    let same = head.version < FIRST_WITH_DIGEST || digest.to_string() == head.digest;
    let message = || format!("the state's digest is {digest}, but the file says {}", head.digest);
    agreed(path, if same { Ok(()) } else { Err(message()) }, ranks)?;
    Ok((checkpoint, head.provenance, digest))
}

fn read_head(path: &Path) -> MessageResult<Head> {
    let file = SerialFile::open(path)?;
    if file.text("/", "format").as_deref() != Ok(FORMAT) {
        return Err("this is not a checkpoint of Talcum".to_owned());
    }
    let version: u64 = file.number("/", "schema_version")?;
    if version == 0 {
        return Err("its schema is 0, which no Talcum has written".to_owned());
    }
    if version > VERSION {
        return Err(format!(
            "the checkpoint was written by a newer Talcum ({}): its schema is {version}, and this \
             program reads schemas up to {VERSION}",
            file.text("/", "talcum_version").unwrap_or_default()
        ));
    }
    let particles = table_in_file::<ParticleRecord>(&file)?;
    let head = Head {
        checkpoint: read_small(&file, particles.rows)?,
        provenance: read_provenance(&file)?,
        digest: file.text("/", "digest")?,
        version,
        instruments: instruments::read_heads(&file)?,
        particles,
        contacts: table_in_file::<ContactRecord>(&file)?,
        wall_contacts: table_in_file::<WallContactRecord>(&file)?,
        cells: table_if_there::<CellRecord>(&file)?,
        looked_at: table_if_there::<Pair>(&file)?,
    };
    file.close()?;
    Ok(head)
}

/// Reads everything except the rows.
fn read_small(file: &SerialFile, particles: u64) -> MessageResult<Checkpoint> {
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
        departed: read_counters(file),
        sizes: SizeRange {
            smallest_diameter: file.number("/sizes", "smallest_diameter")?,
            largest_diameter: file.number("/sizes", "largest_diameter")?,
            largest_mass: file.number("/sizes", "largest_mass")?,
        },
        case_text,
        case_folder: file.text("/", "case_folder")?,
        particles: Vec::new(),
        custom: CustomFields { fields: custom_fields(file, particles)?, numbers: Vec::new() },
        contacts: Vec::new(),
        wall_contacts: Vec::new(),
        cells: Vec::new(),
        looked_at: None,
        instruments: Vec::new(),
        gas_report: if has(file, "/", "gas") { read_report(file)? } else { GasReport::default() },
        energy: if has(file, "/", "energy") { read_ledger(file)? } else { None },
    })
}

fn read_counters(file: &SerialFile) -> Departed {
    let mut counters = Departed::default();
    for counter in Departed::COUNTERS {
        let [group, name] = counter.place;
        let value = match (counter.get)(&counters) {
            CounterValue::Integer(_) => file.number(group, name).map(CounterValue::Integer),
            CounterValue::Number(_) => file.number(group, name).map(CounterValue::Number),
        };
        // A counter that is newer than the file is zero.
        value.into_iter().for_each(|value| (counter.set)(&mut counters, value));
    }
    counters
}

/// Custom fields in a file, as far as the file describes them; their travel is known only to the run that has
/// registered them.
fn custom_fields(file: &SerialFile, particles: u64) -> MessageResult<Vec<Field>> {
    let field = |name: String| {
        let path = path_of::<ParticleRecord>(&name);
        let kind = match file.shape(&path)? {
            (rows, 1) if rows == particles => Kind::Number,
            (rows, 3) if rows == particles => Kind::Vector,
            (rows, 6) if rows == particles => Kind::SymmetricTensor,
            shape => return Err(format!("{path} has the shape {shape:?}: it is no field")),
        };
        let (unit, meaning) = (file.unit(&path)?, file.description(&path)?);
        // Names of fields live as long as the program; a file has only a few.
        let [name, unit, meaning] = [name, unit, meaning].map(|text| &*text.leak());
        Ok(Field::new(name, kind, Unit::Named(unit), meaning))
    };
    own_names(file)?.into_iter().map(field).collect()
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

/// The rows and fields of a record; all its datasets must have the same number of rows, and the right widths.
fn table_in_file<R: Record>(file: &SerialFile) -> MessageResult<TableInFile> {
    let fields = fields_in_file::<R>(file)?;
    let (rows, _) = file.shape(&path_of::<R>(R::IDS[0].name))?;
    let ids = R::IDS.iter().map(|id| (id.name, 1));
    for (name, width) in ids.chain(fields.iter().map(|(_, field)| (field.name, field.width()))) {
        let name = path_of::<R>(name);
        let shape = file.shape(&name)?;
        if shape != (rows, width) {
            return Err(format!("{name} has the shape {shape:?} instead of {:?}", (rows, width)));
        }
    }
    Ok(TableInFile { rows, fields })
}

/// The table of a record that not every file has.
fn table_if_there<R: Record>(file: &SerialFile) -> MessageResult<Option<TableInFile>> {
    let is_there = has(file, "/", &R::GROUP[1..]) && has(file, R::GROUP, R::IDS[0].name);
    is_there.then(|| table_in_file::<R>(file)).transpose()
}

/// This rank's even share of a number of rows.
fn share_of(total: u64, ranks: &dyn Communicator) -> Range<u64> {
    let begin_of = |rank: usize| (u128::from(total) * rank as u128 / ranks.size() as u128) as u64;
    begin_of(ranks.rank())..begin_of(ranks.rank() + 1)
}

/// This rank's even share of a table's rows.
fn read_rows<R: Record>(
    file: &SharedFile<'_>,
    table: &TableInFile,
    ranks: &dyn Communicator,
) -> Result<Vec<R>, OutputError> {
    let Range { start: first, end } = share_of(table.rows, ranks);
    let count = end - first;
    let mut records = vec![R::zeroed(); count as usize];
    for (place, id) in R::IDS.iter().enumerate() {
        let values: Vec<u64> = file.read_rows(&path_of::<R>(id.name), first, count)?;
        for (record, value) in records.iter_mut().zip(values) {
            record.words_mut()[place] = value;
        }
    }
    for &(place, field) in &table.fields {
        let values: Vec<f64> = file.read_rows(&path_of::<R>(field.name), first, count)?;
        for (record, value) in records.iter_mut().zip(values.chunks_exact(field.width())) {
            record.words_mut()[place..][..field.width()]
                .copy_from_slice(bytemuck::cast_slice(value));
        }
    }
    Ok(records)
}

/// This rank's even share of the rows of custom fields.
fn read_custom(
    file: &SharedFile<'_>,
    fields: &[Field],
    rows: u64,
    ranks: &dyn Communicator,
) -> Result<Vec<f64>, OutputError> {
    let Range { start: first, end } = share_of(rows, ranks);
    let count = (end - first) as usize;
    let mut columns = Vec::new();
    for field in fields {
        let path = path_of::<ParticleRecord>(field.name);
        columns.push(file.read_rows::<f64>(&path, first, count as u64)?);
    }
    let row = |index: usize| {
        let columns = columns.iter().zip(fields);
        columns.flat_map(move |(column, field)| &column[index * field.width()..][..field.width()])
    };
    Ok((0..count).flat_map(row).copied().collect())
}
