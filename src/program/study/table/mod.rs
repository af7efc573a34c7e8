//! Tables of results, written as CSV and HDF5.

mod collect;
pub(crate) mod csv;
mod measured;
mod of_points;
mod replicates;
mod searches;

pub(crate) use collect::collect;
pub(crate) use of_points::OfPoints;
