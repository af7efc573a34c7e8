//! Operations of parallel HDF5 that a serial one lacks: files that all ranks open through MPI-IO, and transfers of all
//! ranks together. Without MPI neither is ever requested.

use hdf5::plist::file_access::FileAccessBuilder;
use hdf5_sys::h5i::hid_t;

use talcum_engine::parallel::RawCommunicator;

/// Opens the file on all ranks together, with the same metadata operations on each.
#[cfg(feature = "mpi")]
pub(in super::super) fn open_together(
    properties: &mut FileAccessBuilder,
    communicator: RawCommunicator,
) {
    properties.mpio(communicator, None);
    properties.all_coll_metadata_ops(true).coll_metadata_write(true);
}

#[cfg(not(feature = "mpi"))]
pub(in super::super) fn open_together(_: &mut FileAccessBuilder, communicator: RawCommunicator) {
    match communicator {}
}

/// Makes a transfer one of all ranks together.
#[cfg(feature = "mpi")]
#[allow(unsafe_code, reason = "collective transfers are missing in the safe interface")]
pub(super) fn transfer_together(how: hid_t) -> hdf5::Result<()> {
    use hdf5_sys::h5p::{H5FD_mpio_xfer_t, H5Pset_dxpl_mpio};
    let all = H5FD_mpio_xfer_t::H5FD_MPIO_COLLECTIVE;
    // SAFETY: the caller holds the library's lock and gives an open list of properties of a transfer.
    hdf5::h5check(unsafe { H5Pset_dxpl_mpio(how, all) }).map(|_| ())
}

#[cfg(not(feature = "mpi"))]
pub(super) fn transfer_together(_: hid_t) -> hdf5::Result<()> {
    Err("this program was built without MPI".into())
}
