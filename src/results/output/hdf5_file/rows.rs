//! Rows of datasets: operations that the safe interface of the library does not offer. This is the only file that calls
//! the library itself.

mod collective;

use std::ops::Range;
use std::ptr;

use hdf5::{Dataset, h5check};
use hdf5_sys::h5::{HADDR_UNDEF, hsize_t};
use hdf5_sys::h5d::{H5Dget_chunk_info_by_coord, H5Dget_space, H5Dread, H5Dset_extent, H5Dwrite};
use hdf5_sys::h5i::hid_t;
use hdf5_sys::h5p::{H5P_CLS_DATASET_XFER, H5Pclose, H5Pcreate};
use hdf5_sys::h5s::{
    H5S_seloper_t, H5Sclose, H5Screate_simple, H5Sselect_hyperslab, H5Sselect_none,
};

pub(super) use self::collective::open_together;
use super::Element;

/// Number of values in a row.
pub(super) fn width(dataset: &Dataset) -> usize {
    dataset.shape().iter().skip(1).product::<usize>().max(1)
}

/// Sets the number of rows of a dataset.
#[allow(unsafe_code, reason = "the safe interface takes the whole shape in a type of fixed rank")]
pub(super) fn set_rows(dataset: &Dataset, rows: u64) -> hdf5::Result<()> {
    let mut shape: Vec<hsize_t> = dataset.shape().iter().map(|&n| n as hsize_t).collect();
    shape[0] = rows;
    // SAFETY: the identifier is that of an open dataset, and `shape` has as many items as its rank.
    hdf5::sync::sync(|| h5check(unsafe { H5Dset_extent(dataset.id(), shape.as_ptr()) })).map(|_| ())
}

/// Writes rows from `first_row` on.
pub(super) fn write<T: Element>(
    dataset: &Dataset,
    first_row: u64,
    values: &[T],
    together: bool,
) -> hdf5::Result<()> {
    let rows = (values.len() / width(dataset)) as u64;
    transfer::<T>(dataset, [first_row, rows], Buffer::Write(values.as_ptr().cast()), together)
}

/// Reads rows from `first_row` on. `together`: as in [`transfer`].
pub(super) fn read_rows<T: Element>(
    dataset: &Dataset,
    first_row: u64,
    rows: u64,
    together: bool,
) -> hdf5::Result<Vec<T>> {
    let mut values = vec![T::default(); rows as usize * width(dataset)];
    let buffer = Buffer::Read(values.as_mut_ptr().cast());
    transfer::<T>(dataset, [first_row, rows], buffer, together)?;
    Ok(values)
}

/// The bytes of the file in which the chunk with a row is stored.
#[allow(unsafe_code, reason = "the safe interface counts through all pieces for each")]
pub(super) fn place_of_piece(dataset: &Dataset, row: u64) -> hdf5::Result<Range<u64>> {
    let mut first = vec![0; dataset.ndim()];
    first[0] = row;
    let (mut address, mut size) = (0, 0);
    let mut skipped_filters = 0;
    // SAFETY: the identifier is that of an open dataset, `first` has as many items as its rank, and the
    // three results are of the types that the library names.
    hdf5::sync::sync(|| {
        h5check(unsafe {
            H5Dget_chunk_info_by_coord(
                dataset.id(),
                first.as_ptr(),
                &raw mut skipped_filters,
                &raw mut address,
                &raw mut size,
            )
        })
    })?;
    if address == HADDR_UNDEF {
        return Err("a piece has no place in the file".into());
    }
    Ok(address..address + size)
}

/// Buffer for numbers in memory.
#[derive(Clone, Copy)]
enum Buffer {
    Write(*const std::ffi::c_void),
    Read(*mut std::ffi::c_void),
}

/// Transfers `rows` rows from `first_row` on between memory and file. With `together` all ranks take part, even those
/// without rows, since the others would otherwise wait without end; the safe interface cannot do this.
#[allow(unsafe_code, reason = "collective transfers are missing in the safe interface")]
fn transfer<T: Element>(
    dataset: &Dataset,
    [first_row, rows]: [u64; 2],
    buffer: Buffer,
    together: bool,
) -> hdf5::Result<()> {
    let mut count: Vec<hsize_t> = dataset.shape().iter().map(|&n| n as hsize_t).collect();
    if count.is_empty() || first_row + rows > count[0] {
        return Err("rows beyond the end of a dataset".into());
    }
    if count[0] == 0 {
        // An empty dataset has no place in the file; this is known to all ranks.
        return Ok(());
    }
    count[0] = rows;
    let mut start = vec![0; count.len()];
    start[0] = first_row;
    let datatype = hdf5::Datatype::from_type::<T>()?;
    // SAFETY: all identifiers come from successful calls; `start` and `count` have the dataset's rank;
    // the buffer holds rows times width elements of type T, as the callers made it.
    hdf5::sync::sync(|| unsafe {
        let file_space = Identifier(h5check(H5Dget_space(dataset.id()))?, H5Sclose);
        let memory_space =
            h5check(H5Screate_simple(count.len() as i32, count.as_ptr(), ptr::null()));
        let memory_space = Identifier(memory_space?, H5Sclose);
        let how = Identifier(h5check(H5Pcreate(*H5P_CLS_DATASET_XFER))?, H5Pclose);
        if together {
            collective::transfer_together(how.0)?;
        }
        let (memory, file) = (memory_space.0, file_space.0);
        if rows == 0 {
            h5check(H5Sselect_none(file))?;
            h5check(H5Sselect_none(memory))?;
        } else {
            let (select, start) = (H5S_seloper_t::H5S_SELECT_SET, start.as_ptr());
            let (none, count) = (ptr::null(), count.as_ptr());
            h5check(H5Sselect_hyperslab(file, select, start, none, count, none))?;
        }
        let (dataset, kind) = (dataset.id(), datatype.id());
        h5check(match buffer {
            Buffer::Write(from) => H5Dwrite(dataset, kind, memory, file, how.0, from),
            Buffer::Read(to) => H5Dread(dataset, kind, memory, file, how.0, to),
        })
    })
    .map(|_| ())
}

/// An identifier of the library that is closed when it is dropped.
pub(super) struct Identifier(
    pub(super) hid_t,
    pub(super) unsafe extern "C" fn(hid_t) -> hdf5_sys::h5::herr_t,
);

impl Drop for Identifier {
    #[allow(unsafe_code, reason = "the library's own way to free what it made")]
    fn drop(&mut self) {
        // SAFETY: the identifier is open, and this function closes identifiers of its kind.
        unsafe { (self.1)(self.0) };
    }
}
