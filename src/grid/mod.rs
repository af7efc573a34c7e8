//! Grids that fields live on. Arithmetic only; knows no ranks.

mod column_grid;

pub use column_grid::{ColumnGrid, Weights};
