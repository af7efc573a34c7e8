//! Writing of a checkpoint to a file that is either complete or absent.

use std::panic::resume_unwind;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use super::schema::{
    FORMAT, FieldsInFile, LEDGER, VERSION, custom_fields_in_use, fields_in_use, has, path_of,
};
use super::{Checkpoint, instruments};
use crate::analysis::{Digest, Pair};
use crate::output::hdf5_file::{SerialFile, SharedDataset, SharedFile};
use crate::output::table::{Rows, TableHead};
use crate::output::{
    ColumnUnits, MessageResult, OutputError, Provenance, agreed, checksum, on_root, sync_folder,
    with_suffix,
};
use talcum_engine::fields::{Column, CounterValue, Field, Record};
use talcum_engine::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, Records, SortedRows,
    WallContactRecord, sort_by_id_in_chunks, sort_numbers_by_id,
};
use talcum_engine::state::{Departed, StoredEnergy};

/// Pause between two syncs of a file that is being written; short relative to the time in which a disk writes much.
const PAUSE_OF_SYNCING: Duration = Duration::from_millis(50);

/// Writes the shares of all ranks as one checkpoint and returns the digest of the state. The file is written next to
/// its final place under the name `<path>.partial`, synced to the disk, and then renamed: whenever the program is
/// killed, `path` is either unchanged or complete. Collective.
///
/// # Errors
/// If the file cannot be written; `path` is then unchanged.
pub fn write(
    path: &Path,
    checkpoint: &Checkpoint<impl Records<ParticleRecord>>,
    provenance: &Provenance,
    ranks: &dyn Communicator,
) -> Result<Digest, OutputError> {
    let digest = checkpoint.digest(ranks);
    let mut sums = checkpoint.energy.as_ref().map(|ledger| ledger.sums.clone());
    sums.iter_mut().for_each(|sums| ranks.sum_integers(sums));
    let Checkpoint { particles, contacts, wall_contacts, cells, looked_at, .. } = &checkpoint;
    let pairs = looked_at.as_deref();
    let looked_at = pairs.unwrap_or_default();
    let rows =
        [particles.count(), contacts.len(), wall_contacts.len(), cells.len(), looked_at.len()];
    let rows = rows.map(|count| Rows::Fixed(ranks.total(count) as u64));
    let kept = instruments::row_counts(&checkpoint.instruments, ranks);
    let of_particles = fields_in_use(particles, ranks);
    let custom_in_use = custom_fields_in_use(&checkpoint.custom, ranks);
    let of_contacts = fields_in_use(contacts, ranks);
    let of_wall_contacts = fields_in_use(wall_contacts, ranks);
    let of_cells = fields_in_use(cells, ranks);
    let partial = with_suffix(path, ".partial");
    on_root(&partial, ranks, || {
        let file = SerialFile::create(&partial)?;
        file.set_number("/", "schema_version", VERSION)?;
        write_head(&file, checkpoint, provenance, digest)?;
        write_ledger(&file, checkpoint.energy.as_ref().map(|ledger| &ledger.start), sums)?;
        let units = ColumnUnits::of_system(&provenance.units);
        make_datasets::<ParticleRecord>(&file, rows[0], units, &of_particles)?;
        for &field in &custom_in_use {
            let field = &checkpoint.custom.fields[field];
            make_dataset::<ParticleRecord>(&file, rows[0], units, field)?;
        }
        make_datasets::<ContactRecord>(&file, rows[1], units, &of_contacts)?;
        make_datasets::<WallContactRecord>(&file, rows[2], units, &of_wall_contacts)?;
        make_datasets::<CellRecord>(&file, rows[3], units, &of_cells)?;
        if pairs.is_some() {
            file.make_group(Pair::GROUP)?;
            make_datasets::<Pair>(&file, rows[4], units, &[])?;
        }
        instruments::make(&file, &checkpoint.instruments, &kept)?;
        file.close()
    })?;
    let file = SharedFile::open_to_write(&partial, ranks)?;
    let (written, synced) = while_syncing(&partial, || {
        write_table(&file, particles, &of_particles, ranks)?;
        write_custom_fields(&file, checkpoint, &custom_in_use, ranks)?;
        write_table(&file, contacts, &of_contacts, ranks)?;
        write_table(&file, wall_contacts, &of_wall_contacts, ranks)?;
        write_table(&file, cells, &of_cells, ranks)?;
        if pairs.is_some() {
            write_table(&file, &looked_at, &Vec::new(), ranks)?;
        }
        instruments::write(&file, &checkpoint.instruments, ranks)?;
        file.close()
    });
    written?;
    agreed(&partial, synced, ranks)?;
    checksum::append(&partial, ranks)?;
    on_root(path, ranks, || {
        std::fs::rename(&partial, path).map_err(|error| error.to_string())?;
        sync_folder(path)
    })?;
    Ok(digest)
}

/// Writes while a thread repeatedly syncs to the disk what has been written so far; otherwise the disk would be idle
/// until everything is written. The thread does not communicate with other ranks.
fn while_syncing<T>(path: &Path, write: impl FnOnce() -> T) -> (T, MessageResult<()>) {
    let (writing, wait) = channel::<()>();
    let sync = move || -> std::io::Result<()> {
        let file = std::fs::File::open(path)?;
        while wait.recv_timeout(PAUSE_OF_SYNCING) == Err(RecvTimeoutError::Timeout) {
            file.sync_data()?;
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        // If no thread can be started, the file is synced to the disk only at the end.
        let syncing = std::thread::Builder::new().spawn_scoped(scope, sync);
        let written = write();
        drop(writing);
        let synced = syncing.map_or(Ok(Ok(())), |thread| thread.join());
        let synced = synced.unwrap_or_else(|panic| resume_unwind(panic));
        (written, synced.map_err(|error| error.to_string()))
    })
}

fn write_head(
    file: &SerialFile,
    checkpoint: &Checkpoint<impl Records<ParticleRecord>>,
    provenance: &Provenance,
    digest: Digest,
) -> MessageResult<()> {
    let text = |name: &str, text: &str| file.set_text("/", name, text);
    text("format", FORMAT)?;
    for (name, entry) in provenance.entries() {
        text(name, &entry)?;
    }
    text("case", &checkpoint.case_text)?;
    text("case_blake3", blake3::hash(checkpoint.case_text.as_bytes()).to_hex().as_str())?;
    text("case_folder", &checkpoint.case_folder)?;
    text("digest", &digest.to_string())?;
    file.make_group("/clock")?;
    let clock = &checkpoint.clock;
    file.set_number("/clock", "step", clock.step)?;
    file.set_number("/clock", "origin_step", clock.origin_step)?;
    file.set_number("/clock", "origin_time", clock.origin_time)?;
    file.set_number("/clock", "time_step", clock.time_step)?;
    for counter in Departed::COUNTERS {
        let [group, name] = counter.place;
        if !has(file, "/", &group[1..]) {
            file.make_group(group)?;
        }
        match (counter.get)(&checkpoint.departed) {
            CounterValue::Integer(count) => file.set_number(group, name, count)?,
            CounterValue::Number(number) => file.set_number(group, name, number)?,
        }
    }
    file.make_group("/sizes")?;
    let sizes = &checkpoint.sizes;
    file.set_number("/sizes", "smallest_diameter", sizes.smallest_diameter)?;
    file.set_number("/sizes", "largest_diameter", sizes.largest_diameter)?;
    file.set_number("/sizes", "largest_mass", sizes.largest_mass)?;
    file.make_group("/gas")?;
    let report = &checkpoint.gas_report;
    file.set_number("/gas", "iterations", report.iterations)?;
    file.set_number("/gas", "raised_cells", report.raised_cells)?;
    file.set_number("/gas", "courant", report.courant)?;
    file.set_number("/gas", "momentum_error", report.momentum_error)?;
    ["/particles", "/contacts", "/wall_contacts"].iter().try_for_each(|name| file.make_group(name))
}

/// Writes the energy ledger of all ranks.
fn write_ledger(
    file: &SerialFile,
    start: Option<&StoredEnergy>,
    sums: Option<Vec<i64>>,
) -> MessageResult<()> {
    file.make_group("/energy")?;
    file.set_number("/energy", "kept", u64::from(start.is_some()))?;
    let Some((start, sums)) = start.zip(sums) else { return Ok(()) };
    file.set_number("/energy", "kinetic", start.kinetic)?;
    file.set_number("/energy", "potential", start.potential)?;
    file.set_number("/energy", "elastic", start.elastic)?;
    let description = "integers of the exact sums of work by mechanism, then of the last power";
    let head = TableHead { name: LEDGER, shape: &[], unit: "1", description };
    file.make_table::<i64>(&head, Rows::Fixed(sums.len() as u64))?;
    file.fill(LEDGER, &sums)
}

fn make_datasets<R: Record>(
    file: &SerialFile,
    rows: Rows,
    units: ColumnUnits,
    fields: &[(usize, &'static Field)],
) -> MessageResult<()> {
    for id in R::IDS {
        let (name, description) = (&*path_of::<R>(id.name), id.meaning);
        file.make_table::<u64>(&TableHead { name, shape: &[], unit: "1", description }, rows)?;
    }
    fields.iter().try_for_each(|(_, field)| make_dataset::<R>(file, rows, units, field))
}

fn make_dataset<R: Record>(
    file: &SerialFile,
    rows: Rows,
    units: ColumnUnits,
    field: &Field,
) -> MessageResult<()> {
    let (path, column) = (path_of::<R>(field.name), Column::of_field(field));
    file.make_table::<f64>(&TableHead::of_column(&path, &column, units), rows)
}

/// Writes the records of all ranks in the order of their first ids.
fn write_table<R: Record>(
    file: &SharedFile<'_>,
    records: &impl Records<R>,
    fields: &FieldsInFile,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let ids = R::IDS.iter().map(|id| id.name);
    let names = ids.chain(fields.iter().map(|(_, field)| field.name));
    let datasets =
        names.map(|name| file.dataset(&path_of::<R>(name))).collect::<Result<Vec<_>, _>>()?;
    let id = |record: &R, place: usize| match R::IDS.get(place) {
        Some(_) => record.words()[place],
        None => 0,
    };
    let ids_of = |record: &R| [id(record, 0), id(record, 1)];
    let mut errors = Vec::new();
    // This is also done after an error, because the other ranks take part.
    sort_by_id_in_chunks(records, ids_of, ranks, |rows| {
        errors.extend(write_rows(&datasets, &rows, fields).err())
    });
    file.agreed(errors.into_iter().next().map_or(Ok(()), Err))
}

fn write_rows<R: Record>(
    datasets: &[SharedDataset<'_>],
    rows: &SortedRows<R>,
    fields: &FieldsInFile,
) -> MessageResult<()> {
    let (ids, numbers) = datasets.split_at(R::IDS.len());
    let mut written = Ok(());
    for (place, dataset) in ids.iter().enumerate() {
        let values: Vec<u64> = rows.rows.iter().map(|record| record.words()[place]).collect();
        written = written.and(dataset.write_rows(rows.offset, &values));
    }
    for (&(place, field), dataset) in fields.iter().zip(numbers) {
        let values = match field.width() {
            1 => numbers_of::<R, 1>(place, &rows.rows),
            3 => numbers_of::<R, 3>(place, &rows.rows),
            _ => numbers_of::<R, 6>(place, &rows.rows),
        };
        written = written.and(dataset.write_rows(rows.offset, &values));
    }
    written
}

/// The numbers of a field. The compiler knows the number of values in a row, so that it copies them without a call.
fn numbers_of<R: Record, const WIDTH: usize>(place: usize, records: &[R]) -> Vec<f64> {
    let mut rows = vec![[0.0; WIDTH]; records.len()];
    for (row, record) in rows.iter_mut().zip(records) {
        *row = std::array::from_fn(|number| f64::from_bits(record.words()[place + number]));
    }
    rows.into_flattened()
}

/// Writes custom fields, in the order of the particles' records.
fn write_custom_fields(
    file: &SharedFile<'_>,
    checkpoint: &Checkpoint<impl Records<ParticleRecord>>,
    in_use: &[usize],
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let Checkpoint { particles, custom, .. } = checkpoint;
    for &number in in_use {
        let field = &custom.fields[number];
        let ids = (0..particles.count()).map(|index| particles.at(index).id);
        let SortedRows { rows, offset, .. } =
            sort_numbers_by_id(ids, &custom.column(number), field.width(), ranks);
        let path = path_of::<ParticleRecord>(field.name);
        let written = file.dataset(&path)?.write_rows(offset, &rows);
        file.agreed(written)?;
    }
    Ok(())
}
