//! Begins, continues and fills a file of any table.
//!
//! Rows are written first, and then the time to which they belong. The file is closed after each time, so that it can be
//! read during the run; at each checkpoint its rows are secured against a kill.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::table::{Dataset, FileTable, FileType, Fill, Term};
use crate::output::hdf5_file::{SerialFile, SharedFile};
use crate::output::output_file::{Obstacle, continue_or_create, rows_up_to};
use crate::output::{Head, MessageResult, OutputError, metadata_copy, on_root};
use talcum_engine::parallel::Communicator;

const STEPS: &str = "/VTKHDF/Steps";

/// An open file.
#[derive(Clone, Debug)]
pub(crate) struct Writer {
    path: PathBuf,
    table: FileTable,
    extent: Extent,
}

/// The extent of a file.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// Times.
    steps: u64,
    /// Items up to the end of the last time, those between times included.
    items: u64,
    /// Items of the time that has the most.
    most: u64,
    /// The items of a time begin at a multiple of this: compressed pieces are written once, and never moved.
    alignment: u64,
}

/// A time that is added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Added {
    /// Its number, from 0.
    pub(crate) step: u64,
    /// The first of its items.
    pub(crate) first: u64,
    /// How many there are.
    pub(crate) count: u64,
}

impl Extent {
    fn empty(alignment: u64) -> Self {
        Self { steps: 0, items: 0, most: 0, alignment }
    }

    /// The next time, of so many items.
    fn next(&self, count: u64) -> Added {
        Added { step: self.steps, first: self.items.next_multiple_of(self.alignment), count }
    }

    /// The extent with one more time; `None` if there cannot be so many items.
    fn with(self, Added { first, count, .. }: Added) -> Option<Self> {
        let items = first.checked_add(count).filter(|&items| i64::try_from(items).is_ok())?;
        Some(Self { steps: self.steps + 1, items, most: self.most.max(count), ..self })
    }

    /// Rows of a dataset.
    fn rows_of(&self, dataset: &Dataset) -> u64 {
        match &dataset.fill {
            Fill::Rows { per_item, per_time } => per_item * self.items + per_time * self.steps,
            Fill::Times => self.steps,
            Fill::Index(terms) => {
                let width: usize = dataset.shape.iter().product();
                self.steps * (terms.len() / width) as u64
            }
            Fill::Counting => self.most,
            Fill::Never => 0,
        }
    }
}

impl Added {
    fn number(&self, term: Term) -> u64 {
        match term {
            Term::Zero => 0,
            Term::One => 1,
            Term::Step => self.step,
            Term::First(times) => times * self.first,
            Term::Count(times) => times * self.count,
        }
    }
}

impl Writer {
    /// Begins a file, replacing any existing one; or continues a file in its last committed state, after the times up to and
    /// including a given one; later ones are dropped. A file that cannot be read is set aside with a warning, and a new one
    /// is begun. Collective.
    pub(crate) fn open(
        path: &Path,
        table: FileTable,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let found = on_root(path, ranks, || {
            let go_on = |time| {
                let cut = |found| table.cut_after(path, time, found);
                continue_or_create(path, cut, || Ok(Extent::empty(1)))
            };
            let kept = continue_after.map_or(Ok(Extent::empty(1)), go_on)?;
            if kept.steps > 0 {
                metadata_copy::commit(path, &table.paths_of_items())?;
                return Ok(kept);
            }
            let make = |path: &Path| table.make(path, head);
            metadata_copy::create(path, &table.paths_of_items(), make)?;
            Ok(Extent::empty(table.alignment(&SerialFile::open(path)?)?))
        })?;
        // Rank 0 alone has counted: the sum is known to all ranks.
        let Extent { steps, items, most, alignment } = found.unwrap_or(Extent::empty(0));
        let mut counts = [steps, items, most, alignment].map(|count| count as i64);
        ranks.sum_integers(&mut counts);
        let [steps, items, most, alignment] = counts.map(|count| count as u64);
        let extent = Extent { steps, items, most, alignment };
        Ok(Self { path: path.to_owned(), table, extent })
    }

    /// Adds a time of so many items, whose rows all ranks write. Collective.
    pub(crate) fn append(
        &mut self,
        time: f64,
        count: u64,
        ranks: &dyn Communicator,
        write: impl FnOnce(&SharedFile<'_>, Added) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let (added, after) = self.next(count);
        let file = if self.extent.alignment > 1 {
            SharedFile::open_to_write_on_root(&self.path, ranks)?
        } else {
            SharedFile::open_to_write(&self.path, ranks)?
        };
        let growing = self.table.datasets.iter().filter(|dataset| dataset.holds_items());
        growing.into_iter().try_for_each(|it| file.grow(&it.path(), after.rows_of(it)))?;
        write(&file, added)?;
        file.close()?;
        on_root(&self.path, ranks, || {
            let file = SerialFile::open_to_change(&self.path)?;
            self.add_step(&file, time, added)?;
            file.close()
        })?;
        self.extent = after;
        Ok(())
    }

    /// Adds a time of one item, whose row in each dataset rank 0 knows: path below `/VTKHDF`, and numbers. Collective.
    pub(crate) fn append_on_root<'a>(
        &mut self,
        time: f64,
        ranks: &dyn Communicator,
        rows: impl Iterator<Item = (&'a str, Vec<f64>)>,
    ) -> Result<(), OutputError> {
        let (added, after) = self.next(1);
        on_root(&self.path, ranks, || {
            let file = SerialFile::open_to_change(&self.path)?;
            for (name, numbers) in rows {
                file.append(&format!("/VTKHDF/{name}"), &numbers)?;
            }
            self.add_step(&file, time, added)?;
            file.close()
        })?;
        self.extent = after;
        Ok(())
    }

    /// Secures the data written so far. Collective.
    pub(crate) fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &self.table.paths_of_items(), ranks)
    }

    fn next(&self, count: u64) -> (Added, Extent) {
        let added = self.extent.next(count);
        (added, self.extent.with(added).expect("there are fewer items than integers"))
    }

    /// Adds the time to which the last rows belong.
    fn add_step(&self, file: &SerialFile, time: f64, added: Added) -> MessageResult<()> {
        for dataset in &self.table.datasets {
            let path = dataset.path();
            match &dataset.fill {
                Fill::Times => file.append(&path, &[time])?,
                Fill::Index(terms) => {
                    let numbers = terms.iter().map(|&term| added.number(term) as i64);
                    file.append(&path, &numbers.collect::<Vec<_>>())?;
                }
                Fill::Counting if self.extent.most < added.count => {
                    let further = self.extent.most as i64..added.count as i64;
                    file.append(&path, &further.collect::<Vec<_>>())?;
                }
                Fill::Rows { .. } | Fill::Counting | Fill::Never => {}
            }
        }
        file.set_number(STEPS, "NSteps", added.step as i64 + 1)
    }
}

impl FileTable {
    /// Paths of the datasets that the owner of the file fills: they are not copied at checkpoints.
    fn paths_of_items(&self) -> Vec<String> {
        let filled = self.datasets.iter().filter(|dataset| dataset.holds_items());
        filled.map(Dataset::path).collect()
    }

    /// The multiple at which items of a time begin. A file stays compressed or uncompressed, as it was begun.
    fn alignment(&self, file: &SerialFile) -> MessageResult<u64> {
        let paths = self.paths_of_items();
        let compressed = paths.first().map_or(Ok(false), |path| file.is_compressed(path))?;
        Ok(if compressed { self.piece as u64 } else { 1 })
    }

    fn make(&self, path: &Path, head: Head<'_>) -> MessageResult<()> {
        let file = SerialFile::create(path)?;
        let paths: Vec<String> = self.datasets.iter().map(Dataset::path).collect();
        let parents = |path: &'_ str| {
            let ends = path.match_indices('/').map(|(end, _)| path[..end].to_owned());
            ends.filter(|parent| !parent.is_empty()).collect::<Vec<_>>()
        };
        let groups: BTreeSet<String> = paths.iter().flat_map(|path| parents(path)).collect();
        groups.iter().try_for_each(|group| file.make_group(group))?;
        file.set_numbers("/VTKHDF", "Version", &[2_i64, 0])?;
        self.file_type.describe(&file)?;
        file.set_number(STEPS, "NSteps", 0_i64)?;
        file.make_group("/talcum")?;
        for (name, entry) in head.provenance.entries() {
            file.set_text("/talcum", name, &entry)?;
        }
        file.set_text("/talcum", "case", head.case_text)?;
        self.datasets.iter().try_for_each(|dataset| dataset.make(&file, self))?;
        file.close()
    }

    /// Drops the times after a given one; returns the extent that is kept. If nothing is kept, the file is unchanged: a new one
    /// replaces it.
    fn cut_after(&self, path: &Path, time: f64, found_length: u64) -> Result<Extent, Obstacle> {
        metadata_copy::restore(path).map_err(Obstacle::Failed)?;
        let kept = self.extent_to_keep(path, time, found_length).map_err(Obstacle::Unusable)?;
        if kept.steps > 0 {
            self.cut(path, &kept).map_err(Obstacle::Failed)?;
        }
        Ok(kept)
    }

    fn extent_to_keep(&self, path: &Path, time: f64, found_length: u64) -> MessageResult<Extent> {
        let file = SerialFile::open(path)?;
        self.require_known_data(&file)?;
        let steps = rows_up_to(&listed_times(&file)?, time)?;
        let counts = match self.counts {
            Some(name) => whole_numbers(&file, name)?,
            None => vec![1; steps],
        };
        let damaged = "its numbers of items are damaged";
        let mut kept = Extent::empty(self.alignment(&file)?);
        let mut firsts = Vec::new();
        for count in counts.get(..steps).ok_or(damaged)? {
            let added = kept.next(*count);
            kept = kept.with(added).ok_or(damaged)?;
            firsts.push(added.first);
        }
        for dataset in &self.datasets {
            let path = dataset.path();
            metadata_copy::require_rows(&file, &path, kept.rows_of(dataset), found_length)?;
            if let Fill::Index(terms) = &dataset.fill
                && let [Term::First(times)] = terms[..]
            {
                let listed = file.read_rows::<i64>(&path, 0, kept.steps)?;
                if !listed.into_iter().eq(firsts.iter().map(|first| (times * first) as i64)) {
                    return Err(format!("{path} is damaged"));
                }
            }
        }
        file.close()?;
        Ok(kept)
    }

    fn require_known_data(&self, file: &SerialFile) -> MessageResult<()> {
        let shown = file.names(&format!("/VTKHDF/{}", self.data))?;
        let is_known = |name: &&String| {
            let wanted = format!("{}/{name}", self.data);
            self.datasets.iter().any(|dataset| dataset.name == wanted)
        };
        match shown.iter().find(|name| !is_known(name)) {
            Some(other) => Err(format!("it shows {other}, which the case no longer asks for")),
            None => Ok(()),
        }
    }

    fn cut(&self, path: &Path, kept: &Extent) -> MessageResult<()> {
        let file = SerialFile::open_to_change(path)?;
        for dataset in &self.datasets {
            let (path, mut rows) = (dataset.path(), kept.rows_of(dataset));
            if dataset.holds_items() && kept.alignment > 1 {
                // A piece that was cut would be written again, and moved.
                rows = rows.next_multiple_of(kept.alignment).min(file.shape(&path)?.0);
            }
            file.cut(&path, rows)?;
        }
        file.set_number(STEPS, "NSteps", kept.steps as i64)?;
        file.close()
    }
}

impl FileType {
    /// Writes the type of a file into it.
    fn describe(&self, file: &SerialFile) -> MessageResult<()> {
        let Self::ImageData(cells) = self else {
            return file.set_format_name("/VTKHDF", "Type", b"PolyData");
        };
        file.set_format_name("/VTKHDF", "Type", b"ImageData")?;
        let [nx, ny, nz] = cells.counts.map(|count| count as i64);
        file.set_numbers("/VTKHDF", "WholeExtent", &[0, nx, 0, ny, 0, nz])?;
        file.set_numbers("/VTKHDF", "Origin", &cells.origin)?;
        file.set_numbers("/VTKHDF", "Spacing", &cells.spacing)?;
        let upright = [1.0_f64, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        file.set_numbers("/VTKHDF", "Direction", &upright)
    }
}

/// The times that a file lists.
pub(crate) fn listed_times(file: &SerialFile) -> MessageResult<Vec<f64>> {
    let listed: i64 = file.number(STEPS, "NSteps")?;
    let mut times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    times.truncate(listed.max(0) as usize);
    Ok(times)
}

/// The numbers of a dataset below `/VTKHDF` that can only be whole and not negative.
pub(crate) fn whole_numbers(file: &SerialFile, name: &str) -> MessageResult<Vec<u64>> {
    let numbers: Vec<i64> = file.read(&format!("/VTKHDF/{name}"))?;
    let numbers: Result<_, _> = numbers.into_iter().map(u64::try_from).collect();
    numbers.map_err(|_| format!("{name} is damaged"))
}
