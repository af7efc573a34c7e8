//! Dimension scales, as defined by H5DS of the HDF5 library: they show readers such as xarray and h5py which dataset
//! holds the times or heights of a table's rows and columns.
//!
//! Specification: HDF5 Dimension Scale Specification and Design Notes, The HDF Group (2005).

use super::rows::Identifier;
use super::{SerialFile, described, written};
use crate::output::MessageResult;
use crate::output::table::ScaledTable;
use hdf5::types::{FixedAscii, VarLenArray};
use hdf5::{Dataset, H5Type, ObjectReference1};
use hdf5_sys::h5a::{H5Aclose, H5Acreate2, H5Awrite};
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::{H5S_class_t, H5Sclose, H5Screate};
use hdf5_sys::h5t::{H5T_str_t, H5Tset_strpad};

/// Value of the attribute that makes a dataset a scale.
const CLASS: &[u8; 16] = b"DIMENSION_SCALE\0";

/// A dataset and its dimension to which a scale belongs.
#[derive(Clone, Copy, H5Type)]
#[repr(C)]
struct Use {
    dataset: ObjectReference1,
    dimension: u32,
}

impl SerialFile {
    /// Makes datasets of a new file scales of the dimensions of tables.
    pub(in crate::output) fn set_scales(&self, tables: &[ScaledTable]) -> MessageResult<()> {
        let mut scales: Vec<&String> = tables.iter().flat_map(|(_, scales)| scales).collect();
        scales.sort_unstable();
        scales.dedup();
        scales.into_iter().try_for_each(|scale| self.make_scale(scale, tables))?;
        tables.iter().try_for_each(|(table, scales)| self.list_scales(table, scales))
    }

    fn reference(&self, name: &str) -> MessageResult<ObjectReference1> {
        described(self.0.reference(name))
    }

    fn make_scale(&self, scale: &str, tables: &[ScaledTable]) -> MessageResult<()> {
        let mut uses = Vec::new();
        for (table, scales) in tables {
            for dimension in (0..scales.len()).filter(|&dimension| scales[dimension] == scale) {
                uses.push(Use { dataset: self.reference(table)?, dimension: dimension as u32 });
            }
        }
        let make = || {
            let dataset = self.0.dataset(scale)?;
            set_class(&dataset)?;
            let list = dataset.new_attr::<Use>().shape(uses.len()).create("REFERENCE_LIST")?;
            list.write_raw(&uses)
        };
        written(make())
    }

    fn list_scales(&self, table: &str, scales: &[String]) -> MessageResult<()> {
        let dimensions = described(self.0.dataset(table))?.ndim();
        let of_dimension = |dimension: usize| -> MessageResult<VarLenArray<ObjectReference1>> {
            let scale = scales.get(dimension).map(|scale| self.reference(scale)).transpose()?;
            Ok(VarLenArray::from_slice(scale.as_slice()))
        };
        let references = (0..dimensions).map(of_dimension).collect::<MessageResult<Vec<_>>>()?;
        let list = || {
            let dataset = self.0.dataset(table)?;
            let attribute =
                dataset.new_attr::<VarLenArray<ObjectReference1>>().shape(references.len());
            attribute.create("DIMENSION_LIST")?.write_raw(&references)
        };
        written(list())
    }
}

/// Sets the attribute CLASS, a text that ends in a zero: the high-level functions pad texts in another way, which H5DS
/// rejects.
#[allow(unsafe_code, reason = "the library's attributes of another kind of text")]
fn set_class(dataset: &Dataset) -> hdf5::Result<()> {
    let text = hdf5::Datatype::from_type::<FixedAscii<16>>()?;
    let check = hdf5::h5check::<i32>;
    // SAFETY: all identifiers come from successful calls; CLASS has the 16 bytes of the datatype.
    hdf5::sync::sync(|| unsafe {
        check(H5Tset_strpad(text.id(), H5T_str_t::H5T_STR_NULLTERM))?;
        let space = Identifier(hdf5::h5check(H5Screate(H5S_class_t::H5S_SCALAR))?, H5Sclose);
        let (at, name) = (dataset.id(), c"CLASS".as_ptr());
        let made = H5Acreate2(at, name, text.id(), space.0, H5P_DEFAULT, H5P_DEFAULT);
        let attribute = Identifier(hdf5::h5check(made)?, H5Aclose);
        check(H5Awrite(attribute.0, text.id(), CLASS.as_ptr().cast()))
    })
    .map(|_| ())
}
