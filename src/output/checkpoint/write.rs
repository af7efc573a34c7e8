//! From ranks to a file that is either whole or not there.

use std::path::Path;

use super::Checkpoint;
use super::schema::{FORMAT, Table, VERSION};
use crate::analysis::Digest;
use crate::output::hdf5_file::{SerialFile, SharedFile};
use crate::output::table::{Rows, TableHead};
use crate::output::{
    ColumnUnits, InWords, OutputError, Provenance, on_root, seal, sync_folder, with_suffix,
};
use crate::parallel::{Communicator, SortedBlock, sort_by_id};

/// Writes all ranks' shares as one checkpoint and returns the digest of the state. The file is written
/// beside its place under the name `<path>.partial`, brought to the disk, and renamed at last: whenever the
/// program is killed, `path` is what it was before or complete. Collective.
///
/// # Errors
/// If the file cannot be written; then `path` is untouched.
pub fn write(
    path: &Path,
    mut checkpoint: Checkpoint,
    provenance: &Provenance,
    ranks: &dyn Communicator,
) -> Result<Digest, OutputError> {
    let digest = checkpoint.digest(ranks);
    let particles = sorted(&mut checkpoint.particles, ranks);
    let contacts = sorted(&mut checkpoint.contacts, ranks);
    let wall_contacts = sorted(&mut checkpoint.wall_contacts, ranks);
    let cells = sorted(&mut checkpoint.cells, ranks);
    let partial = with_suffix(path, ".partial");
    on_root(&partial, ranks, || {
        let file = SerialFile::create(&partial)?;
        write_head(&file, &checkpoint, provenance, digest)?;
        let units = ColumnUnits::of_system(&provenance.units);
        make_datasets(&file, &particles, &units)?;
        make_datasets(&file, &contacts, &units)?;
        make_datasets(&file, &wall_contacts, &units)?;
        make_datasets(&file, &cells, &units)?;
        file.close()
    })?;
    let file = SharedFile::open_to_write(&partial, ranks)?;
    write_rows(&file, &particles)?;
    write_rows(&file, &contacts)?;
    write_rows(&file, &wall_contacts)?;
    write_rows(&file, &cells)?;
    file.close()?;
    seal::seal(&partial, ranks)?;
    on_root(path, ranks, || {
        std::fs::rename(&partial, path).map_err(|error| error.to_string())?;
        sync_folder(path)
    })?;
    Ok(digest)
}

/// Takes the records, and brings those of all ranks into the order of the table's first columns.
fn sorted<R: Table>(records: &mut Vec<R>, ranks: &dyn Communicator) -> SortedBlock<R> {
    let first = R::IDS[0].get;
    let mut block = sort_by_id(std::mem::take(records), first, ranks);
    block.rows.sort_unstable_by_key(|record| {
        (first(record), R::IDS.get(1).map_or(0, |second| (second.get)(record)))
    });
    block
}

fn write_head(
    file: &SerialFile,
    checkpoint: &Checkpoint,
    provenance: &Provenance,
    digest: Digest,
) -> InWords<()> {
    let text = |name: &str, text: &str| file.set_text("/", name, text);
    text("format", FORMAT)?;
    file.set_number("/", "schema_version", VERSION)?;
    for (name, words) in provenance.entries() {
        text(name, &words)?;
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
    file.make_group("/departed")?;
    file.set_number("/departed", "count", checkpoint.departed.count)?;
    file.set_number("/departed", "volume", checkpoint.departed.volume)?;
    file.make_group("/sizes")?;
    let sizes = &checkpoint.sizes;
    file.set_number("/sizes", "smallest_diameter", sizes.smallest_diameter)?;
    file.set_number("/sizes", "largest_diameter", sizes.largest_diameter)?;
    file.set_number("/sizes", "largest_mass", sizes.largest_mass)?;
    file.make_group("/gas")?;
    let report = &checkpoint.flow_report;
    file.set_number("/gas", "iterations", report.iterations)?;
    file.set_number("/gas", "raised_cells", report.raised_cells)?;
    file.set_number("/gas", "courant", report.courant)?;
    file.set_number("/gas", "momentum_error", report.momentum_error)?;
    ["/particles", "/contacts", "/wall_contacts"].iter().try_for_each(|name| file.make_group(name))
}

fn make_datasets<R: Table>(
    file: &SerialFile,
    block: &SortedBlock<R>,
    units: &ColumnUnits,
) -> InWords<()> {
    let rows = Rows::Fixed(block.total);
    for column in R::IDS {
        let (name, description) = (column.name, column.description);
        file.make_table::<u64>(&TableHead { name, width: 1, unit: "1", description }, rows)?;
    }
    for column in R::NUMBERS {
        let (name, width, description) = (column.name, column.width, column.description);
        let unit = (column.unit)(units);
        file.make_table::<f64>(&TableHead { name, width, unit, description }, rows)?;
    }
    Ok(())
}

fn write_rows<R: Table>(file: &SharedFile<'_>, block: &SortedBlock<R>) -> Result<(), OutputError> {
    for column in R::IDS {
        let values: Vec<u64> = block.rows.iter().map(column.get).collect();
        file.write_rows(column.name, block.offset, &values)?;
    }
    for column in R::NUMBERS {
        let mut values = Vec::with_capacity(block.rows.len() * column.width);
        block.rows.iter().for_each(|record| values.extend_from_slice((column.get)(record)));
        file.write_rows(column.name, block.offset, &values)?;
    }
    Ok(())
}
