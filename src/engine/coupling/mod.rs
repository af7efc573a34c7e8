//! Transfers between particles and grids: deposition, interpolation, filter. This module does not depend on the model
//! of the gas.
//!
//! The coupling is unresolved: grids are coarser than particles, and the gas sees their volume and drag as averages.

mod cells;
mod column_block;
mod column_deposition;
mod corners;
mod drag_share;
mod filter;
mod four_fields;
mod means;

pub(crate) use cells::CellTransfer;
pub(crate) use column_block::{ColumnBlock, interval_fields};
pub use column_deposition::{Bed, ColumnDeposition, NodeSums};
pub(crate) use corners::{Corners, deposit, interpolate};
pub use drag_share::DragShare;
pub(crate) use four_fields::FourFields;
pub(crate) use means::{mean_gradient, mean_of_faces, mend_gradient_at_wall};
