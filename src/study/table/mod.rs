//! Tables of results, written as CSV and HDF5.

mod collect;
pub(crate) mod csv;
mod measured;
mod replicates;
mod searches;

pub(crate) use collect::collect;
pub(crate) use replicates::Replicates;
