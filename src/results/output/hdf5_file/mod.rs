//! HDF5 files: made by one process, filled by all ranks together. This is the only module that calls HDF5.
//!
//! Groups, datasets and attributes are made by rank 0 alone through [`SerialFile`]; rows are then written through
//! [`SharedFile`], where all ranks take part in every transfer, even those without rows.

mod dimension_scales;
mod rows;
mod shared_dataset;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

use bytemuck::Pod;
use hdf5::dataset::{AllocTime, FillTime};
use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{
    Dataset, DatasetBuilderEmpty, Extent, File, FileBuilder, H5Type, Location, SimpleExtents,
};

use self::rows::{open_together, place_of_piece, read_rows, set_rows, write};
pub(super) use self::shared_dataset::SharedDataset;
use super::table::{Rows, TableHead};
use super::{MessageResult, OutputError, agreed, require_file};
use talcum_engine::parallel::{Communicator, FileAccess};

/// Options with which all files are opened.
///
/// There is no lock: many file systems of clusters do not have any, and a script that reads a growing table must not
/// end the run. The library's buffers for numbers are not used either: buffered data are written when their dataset is
/// closed, where a failed write is not reported.
fn options() -> FileBuilder {
    let mut options = File::with_options();
    options.with_fapl(|properties| {
        properties.file_locking(false).sieve_buf_size(0).chunk_cache(0, 0, 0.0)
    });
    options
}

/// Version of the library, and whether it is a parallel one.
pub fn hdf5_version() -> String {
    let (major, minor, patch) = hdf5::library_version();
    let kind = if cfg!(feature = "mpi") { "parallel" } else { "serial" };
    format!("{major}.{minor}.{patch}, {kind}")
}

/// Element types of datasets.
pub(super) trait Element: Pod + H5Type + Default {}
impl Element for f64 {}
impl Element for f32 {}
impl Element for u64 {}
impl Element for i64 {}

/// A file that only this process has open.
pub(super) struct SerialFile(File);

fn described<T>(result: hdf5::Result<T>) -> MessageResult<T> {
    result.map_err(|error| format!("HDF5 says: {}", error.to_string().replace('\n', " ")))
}

/// Whether a write has failed.
static WRITE_FAILED: AtomicBool = AtomicBool::new(false);

/// Whether HDF5 was unable to write something. It then keeps the rest in its memory and crashes when it tries to write
/// this again as MPI is finalised: the program must end without finalising.
pub fn write_failed() -> bool {
    WRITE_FAILED.load(Ordering::Relaxed)
}

fn note_failed_write() {
    WRITE_FAILED.store(true, Ordering::Relaxed);
}

/// Like [`described`], for writing operations.
fn written<T>(result: hdf5::Result<T>) -> MessageResult<T> {
    described(result.inspect_err(|_| note_failed_write()))
}

impl SerialFile {
    /// Makes a new, empty file that replaces any existing one.
    pub(super) fn create(path: &Path) -> MessageResult<Self> {
        written(options().create(path)).map(Self)
    }

    /// Opens a file read-only.
    pub(super) fn open(path: &Path) -> MessageResult<Self> {
        require_file(path).map_err(|error| format!("cannot be opened: {error}"))?;
        described(options().open(path)).map(Self)
    }

    /// Opens a file to change it.
    pub(super) fn open_to_change(path: &Path) -> MessageResult<Self> {
        require_file(path).map_err(|error| format!("cannot be opened: {error}"))?;
        described(options().open_rw(path)).map(Self)
    }

    /// Writes all remaining data to the file and closes it.
    pub(super) fn close(self) -> MessageResult<()> {
        written(self.0.flush().and_then(|()| self.0.close()))
    }

    pub(super) fn make_group(&self, name: &str) -> MessageResult<()> {
        written(self.0.create_group(name)).map(|_| ())
    }

    /// Sets a text attribute of the group `/...`.
    pub(super) fn set_text(&self, group: &str, name: &str, text: &str) -> MessageResult<()> {
        let group = described(self.0.group(group))?;
        written(set_text(&group, name, text))
    }

    /// Sets a text attribute of a fixed length, as the VTKHDF format requires.
    pub(super) fn set_format_name<const N: usize>(
        &self,
        group: &str,
        name: &str,
        text: &[u8; N],
    ) -> MessageResult<()> {
        let text = FixedAscii::<N>::from_ascii(text).map_err(|error| error.to_string())?;
        let set = || {
            let group = self.0.group(group)?;
            group.new_attr::<FixedAscii<N>>().create(name)?.write_scalar(&text)
        };
        written(set())
    }

    /// Sets a number attribute, new or changed.
    pub(super) fn set_number<T: Element>(
        &self,
        group: &str,
        name: &str,
        to: T,
    ) -> MessageResult<()> {
        let set = || {
            let group = self.0.group(group)?;
            let exists = group.attr_names()?.iter().any(|known| known == name);
            let attribute =
                if exists { group.attr(name)? } else { group.new_attr::<T>().create(name)? };
            attribute.write_scalar(&to)
        };
        written(set())
    }

    /// Sets an attribute of several numbers.
    pub(super) fn set_numbers<T: Element>(
        &self,
        group: &str,
        name: &str,
        to: &[T],
    ) -> MessageResult<()> {
        let set = || {
            let group = self.0.group(group)?;
            group.new_attr::<T>().shape([to.len()]).create(name)?.write_raw(to)
        };
        written(set())
    }

    pub(super) fn text(&self, group: &str, name: &str) -> MessageResult<String> {
        let get = || self.0.group(group)?.attr(name)?.read_scalar::<VarLenUnicode>();
        get().map(|text| text.as_str().to_owned()).map_err(|error| missing(group, name, &error))
    }

    /// The unit of a dataset.
    pub(super) fn unit(&self, name: &str) -> MessageResult<String> {
        self.text_at(name, "unit")
    }

    /// Description of a dataset.
    pub(super) fn description(&self, name: &str) -> MessageResult<String> {
        self.text_at(name, "description")
    }

    fn text_at(&self, dataset: &str, name: &str) -> MessageResult<String> {
        let get = || self.0.dataset(dataset)?.attr(name)?.read_scalar::<VarLenUnicode>();
        described(get()).map(|text| text.as_str().to_owned())
    }

    pub(super) fn number<T: Element>(&self, group: &str, name: &str) -> MessageResult<T> {
        let get = || self.0.group(group)?.attr(name)?.read_scalar::<T>();
        get().map_err(|error| missing(group, name, &error))
    }

    /// An attribute of N numbers.
    pub(super) fn numbers<T: Element, const N: usize>(
        &self,
        group: &str,
        name: &str,
    ) -> MessageResult<[T; N]> {
        let get = || self.0.group(group)?.attr(name)?.read_raw::<T>();
        let numbers = get().map_err(|error| missing(group, name, &error))?;
        numbers.try_into().map_err(|_| format!("attribute {name} of {group} is not {N} numbers"))
    }

    /// Makes a new dataset. Room for rows is allocated as soon as there are any: if this were left to the first
    /// transfer, ranks without rows would take no part in it, and transfers of all ranks fail on missing chunks.
    pub(super) fn make_table<T: Element>(&self, head: &TableHead, rows: Rows) -> MessageResult<()> {
        let make = || {
            let builder = self.0.new_dataset::<T>();
            let early = |builder: DatasetBuilderEmpty| {
                builder.alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never)
            };
            let (first, builder) = match rows {
                Rows::Fixed(rows) => (Extent::fixed(rows as usize), early(builder.no_chunk())),
                Rows::Growing(piece) => {
                    (Extent::resizable(0), early(builder.chunk([&[piece], head.shape].concat())))
                }
                Rows::Compressed { piece, level } => {
                    let builder = builder.chunk([&[piece], head.shape].concat());
                    (Extent::resizable(0), builder.shuffle().deflate(level))
                }
            };
            let extents =
                std::iter::once(first).chain(head.shape.iter().map(Extent::from)).collect();
            let builder = builder.obj_track_times(false);
            let dataset = builder.shape(SimpleExtents::from_vec(extents)).create(head.name)?;
            set_text(&dataset, "unit", head.unit)?;
            set_text(&dataset, "description", head.description)
        };
        written(make())
    }

    /// Names of the datasets and groups in a group.
    pub(super) fn names(&self, group: &str) -> MessageResult<Vec<String>> {
        described(self.0.group(group).and_then(|group| group.member_names()))
    }

    /// Whether the chunks of a dataset are compressed.
    pub(super) fn is_compressed(&self, name: &str) -> MessageResult<bool> {
        described(self.0.dataset(name).map(|dataset| !dataset.filters().is_empty()))
    }

    /// Number of rows of a dataset, and of values in each.
    pub(super) fn shape(&self, name: &str) -> MessageResult<(u64, usize)> {
        let shape =
            described(self.0.dataset(name)).map_err(|message| format!("{name}: {message}"))?;
        match &shape.shape()[..] {
            [rows, inner @ ..] => Ok((*rows as u64, inner.iter().product())),
            [] => Err(format!("{name} is not a table")),
        }
    }

    /// All rows of a dataset.
    pub(super) fn read<T: Element>(&self, name: &str) -> MessageResult<Vec<T>> {
        let dataset = described(self.0.dataset(name))?;
        if dataset.size() * size_of::<T>() > self.0.size() as usize {
            return Err(format!("{name} claims to be larger than the file"));
        }
        described(dataset.read_raw())
    }

    /// A given number of rows of a dataset from `first_row` on.
    pub(super) fn read_rows<T: Element>(
        &self,
        name: &str,
        first_row: u64,
        rows: u64,
    ) -> MessageResult<Vec<T>> {
        // The check comes before memory is allocated for them.
        if self.shape(name)?.0 < first_row + rows {
            return Err(format!("{name} has fewer than {} rows", first_row + rows));
        }
        let read = || read_rows(&self.0.dataset(name)?, first_row, rows, false);
        described(read()).map_err(|message| format!("{name}: {message}"))
    }

    /// Makes a new dataset of texts.
    pub(super) fn make_texts(&self, head: &TableHead, texts: &[String]) -> MessageResult<()> {
        let make = || {
            let texts: Result<Vec<VarLenUnicode>, _> =
                texts.iter().map(|text| VarLenUnicode::from_str(text)).collect();
            let texts = texts.map_err(|error| error.to_string())?;
            let builder = self.0.new_dataset::<VarLenUnicode>().obj_track_times(false);
            let dataset = builder.shape([texts.len()]).create(head.name)?;
            dataset.write_raw(&texts)?;
            set_text(&dataset, "unit", head.unit)?;
            set_text(&dataset, "description", head.description)
        };
        described(make())
    }

    /// Writes all rows of a dataset.
    pub(super) fn fill<T: Element>(&self, name: &str, values: &[T]) -> MessageResult<()> {
        written(self.0.dataset(name).and_then(|dataset| write(&dataset, 0, values, false)))
    }

    /// Truncates a dataset to its first rows.
    pub(super) fn cut(&self, name: &str, rows: u64) -> MessageResult<()> {
        if self.shape(name)?.0 < rows {
            return Err(format!("{name} has fewer than {rows} rows"));
        }
        written(self.0.dataset(name).and_then(|dataset| set_rows(&dataset, rows)))
    }

    /// Byte ranges of the first rows of a growing dataset in the file: whole chunks that contain any of these rows.
    pub(super) fn places_of_rows(&self, name: &str, rows: u64) -> MessageResult<Vec<Range<u64>>> {
        let places = || {
            let dataset = self.0.dataset(name)?;
            let piece = dataset.chunk().ok_or("the dataset does not grow")?;
            (0..rows).step_by(piece[0].max(1)).map(|row| place_of_piece(&dataset, row)).collect()
        };
        described(places()).map_err(|message| format!("{name}: {message}"))
    }

    /// Appends rows to a dataset.
    pub(super) fn append<T: Element>(&self, name: &str, values: &[T]) -> MessageResult<()> {
        let (rows, width) = self.shape(name)?;
        let added = (values.len() / width.max(1)) as u64;
        let append = || {
            let dataset = self.0.dataset(name)?;
            set_rows(&dataset, rows + added)?;
            write(&dataset, rows, values, false)?;
            self.0.flush()
        };
        written(append())
    }
}

/// A file whose rows all ranks write or read together. Every method is collective.
pub(super) struct SharedFile<'r> {
    path: PathBuf,
    /// `None` on ranks that leave the writing to rank 0.
    file: Option<File>,
    ranks: &'r dyn Communicator,
    /// Whether all ranks transfer their rows themselves, together.
    together: bool,
}

impl<'r> SharedFile<'r> {
    /// Opens a file whose datasets exist.
    pub(super) fn open_to_write(
        path: &Path,
        ranks: &'r dyn Communicator,
    ) -> Result<Self, OutputError> {
        Self::open(path, ranks, true, access_to(path, ranks))
    }

    /// Opens a file whose rows are written by rank 0 for all ranks.
    pub(super) fn open_to_write_on_root(
        path: &Path,
        ranks: &'r dyn Communicator,
    ) -> Result<Self, OutputError> {
        Self::open(path, ranks, true, FileAccess::Root)
    }

    /// Opens a file to read from it on all ranks.
    pub(super) fn open_to_read(
        path: &Path,
        ranks: &'r dyn Communicator,
    ) -> Result<Self, OutputError> {
        Self::open(path, ranks, false, access_to(path, ranks))
    }

    fn open(
        path: &Path,
        ranks: &'r dyn Communicator,
        write: bool,
        access: FileAccess,
    ) -> Result<Self, OutputError> {
        let mut options = options();
        let mut together = false;
        if let FileAccess::Collective(communicator) = access {
            together = true;
            options.with_fapl(|properties| {
                open_together(properties, communicator);
                properties
            });
        }
        let opened = if !write {
            options.open(path).map(Some)
        } else if together || ranks.is_root() {
            options.open_rw(path).map(Some)
        } else {
            Ok(None)
        };
        let file = agreed(path, described(opened), ranks)?;
        Ok(Self { path: path.to_owned(), file, ranks, together })
    }

    /// Applies a function to a dataset on the ranks that have the file open.
    fn with<T: Default>(
        &self,
        name: &str,
        work: impl FnOnce(&Dataset) -> hdf5::Result<T>,
    ) -> Result<T, OutputError> {
        let result = match &self.file {
            Some(file) => file.dataset(name).and_then(|dataset| work(&dataset)),
            None => Ok(T::default()),
        };
        let result = described(result).map_err(|message| format!("{name}: {message}"));
        agreed(&self.path, result, self.ranks)
    }

    /// Extends a dataset to a number of rows.
    pub(super) fn grow(&self, name: &str, rows: u64) -> Result<(), OutputError> {
        self.with(name, |dataset| set_rows(dataset, rows).inspect_err(|_| note_failed_write()))
    }

    /// Opens a dataset to write to it in several turns.
    pub(super) fn dataset(&self, name: &str) -> Result<SharedDataset<'_>, OutputError> {
        let opened = self.file.as_ref().map(|file| file.dataset(name)).transpose();
        let opened = described(opened).map_err(|message| format!("{name}: {message}"));
        let dataset = self.agreed(opened)?;
        Ok(SharedDataset::new(name, dataset, self.ranks, self.together))
    }

    /// Writes this rank's rows from `first_row` on. The rows of the ranks follow one another in the order of ranks,
    /// without gaps.
    pub(super) fn write_rows<T: Element>(
        &self,
        name: &str,
        first_row: u64,
        values: &[T],
    ) -> Result<(), OutputError> {
        self.agreed(self.dataset(name)?.write_rows(first_row, values))
    }

    /// Makes an error of any rank an error of all.
    pub(super) fn agreed<T>(&self, result: MessageResult<T>) -> Result<T, OutputError> {
        agreed(&self.path, result, self.ranks)
    }

    /// Reads a number of rows from `first_row` on; each rank reads its own.
    pub(super) fn read_rows<T: Element>(
        &self,
        name: &str,
        first_row: u64,
        rows: u64,
    ) -> Result<Vec<T>, OutputError> {
        self.with(name, |dataset| read_rows(dataset, first_row, rows, self.together))
    }

    /// Writes all remaining data to the file and closes it.
    pub(super) fn close(self) -> Result<(), OutputError> {
        let closed = self.file.map_or(Ok(()), |file| file.flush().and_then(|()| file.close()));
        agreed(&self.path, written(closed), self.ranks)
    }
}

/// The way in which ranks share a file. MPI-IO interprets the part of a path before its first colon as a kind of file
/// system, and removes it: such a file is left to rank 0.
fn access_to(path: &Path, ranks: &dyn Communicator) -> FileAccess {
    if path.as_os_str().as_encoded_bytes().contains(&b':') {
        FileAccess::Root
    } else {
        ranks.file_access(path)
    }
}

fn missing(group: &str, name: &str, error: &hdf5::Error) -> String {
    format!("attribute {name} of {group} cannot be read: {error}")
}

fn set_text(location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    let text = VarLenUnicode::from_str(text).map_err(|error| error.to_string())?;
    location.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&text)
}
