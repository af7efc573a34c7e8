//! Where a rank is, for building levels.

use super::coarsening::LevelGrid;
use crate::domain::{Bounds, Decomposition, RankGrid};
use crate::grid::LocalCells;
use crate::parallel::FieldHalo;

/// A rank in its cut of the box.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub(super) decomposition: &'a Decomposition,
    pub(super) bounds: &'a Bounds,
    pub(super) rank: usize,
}

impl Place<'_> {
    /// Neighbours on a level; none but itself if it is held whole.
    pub(super) fn halo(self, whole: bool) -> FieldHalo {
        if whole {
            let uncut = Decomposition::even(RankGrid([1; 3]), self.bounds);
            FieldHalo::new(&uncut, self.bounds, 0)
        } else {
            FieldHalo::new(self.decomposition, self.bounds, self.rank)
        }
    }

    /// The cells of a level that the rank has.
    pub(super) fn part(self, grid: &LevelGrid, whole: bool) -> LocalCells {
        let block = if whole { [0; 3] } else { self.decomposition.grid().block_of(self.rank) };
        grid.part(block)
    }
}
