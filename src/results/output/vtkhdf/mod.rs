//! Files for ParaView: temporal data of VTKHDF 2.0.
//!
//! A kind of file is a [`FileTable`], plain data that says which datasets it has and how each is filled; one [`Writer`] begins,
//! continues and fills them all.

mod image_data;
mod poly_data;
mod table;
mod writer;

pub(super) use image_data::image_table;
pub(super) use poly_data::{Drawn, PolyData};
pub(super) use table::{
    Dataset, FileTable, FileType, Fill, ImageCells, Numbers, RecordColumn, Term, numbers_in,
};
pub(super) use writer::{Added, Writer, listed_times, whole_numbers};
