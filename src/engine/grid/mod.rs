//! Grids, and fields on them. Arithmetic only, without communication.

mod box_grid;
mod cell_weights;
mod column_grid;
mod field;
mod round_column;

#[cfg(test)]
pub(crate) use box_grid::MEMORY_ORDERS;
pub use box_grid::{BoxGrid, LocalCells};
pub(crate) use cell_weights::{CellLocator, CellWeights};
pub use column_grid::{ColumnGrid, NodeWeights};
pub use field::Field;
pub(crate) use round_column::ColumnOnCells;
pub use round_column::RoundColumn;
