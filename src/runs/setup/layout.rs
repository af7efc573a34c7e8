//! Division of the box among the ranks.

use talcum_engine::domain::{Bounds, Decomposition, RankGrid};
use talcum_engine::gas::GasModel;
use thiserror::Error;

/// A division of the box that is not possible.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LayoutError {
    /// The case or the command line requires another number of ranks.
    #[error("the rank grid {grid} needs {} ranks, but {ranks} were started (mpirun -n {}, or --threads {})", grid.size(), grid.size(), grid.size())]
    WrongSize {
        /// Ranks along x, y and z.
        grid: RankGrid,
        /// Number of ranks in the run.
        ranks: usize,
    },
    /// Subdomains narrower than the ghosts that they need.
    #[error(
        "{ranks} ranks along {axis} cut the box into blocks {width:.4} wide, but ghosts need {needed:.4}: use at most \
         {most} along {axis}, or cut along another axis as well (--ranks, or parallel.ranks)"
    )]
    TooNarrow {
        /// The axis.
        axis: &'static str,
        /// Ranks along it.
        ranks: usize,
        /// Width of their subdomains.
        width: f64,
        /// Width that ghosts need.
        needed: f64,
        /// Largest number of ranks that would be possible.
        most: usize,
    },
    /// Subdomains narrower than the cells that they need.
    #[error(
        "the rank grid {grid} needs more cells of the gas than {cells:?}: blocks are at least two cells and as wide as \
         their ghosts"
    )]
    TooFewCells {
        /// Ranks along x, y and z.
        grid: RankGrid,
        /// Cells along x, y and z.
        cells: [usize; 3],
    },
}

/// Requirements for the division of the box.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// The box.
    pub bounds: &'a Bounds,
    /// The gas of the run: with a gas on cells, cut planes lie on cell faces.
    pub gas: &'a GasModel,
    /// Width of the ghost layer with the narrowest skin: the least width of a subdomain; length.
    pub ghost_width: f64,
}

impl Layout<'_> {
    /// Subdomains of equal size on a grid of all `ranks`, except for the shift of cut planes to cell faces.
    ///
    /// # Errors
    /// If the grid does not fit the number of ranks, or subdomains would be narrower than their ghosts.
    pub fn even(&self, grid: RankGrid, ranks: usize) -> Result<Decomposition, LayoutError> {
        if grid.size() != ranks {
            return Err(LayoutError::WrongSize { grid, ranks });
        }
        let needed = self.ghost_width;
        for axis in (0..3).filter(|&axis| grid.0[axis] > 1) {
            let (length, ranks) = (self.bounds.lengths()[axis], grid.0[axis]);
            let width = length / ranks as f64;
            if width < needed {
                let most = ((length / needed) as usize).max(1);
                let axis = ["x", "y", "z"][axis];
                return Err(LayoutError::TooNarrow { axis, ranks, width, needed, most });
            }
        }
        self.align(Decomposition::even(grid, self.bounds))
    }

    /// The decomposition with its cut planes on cell faces, if the gas requires this.
    ///
    /// # Errors
    /// If there are too few cells.
    pub fn align(&self, decomposition: Decomposition) -> Result<Decomposition, LayoutError> {
        let Some(model) = self.gas.volume_averaged() else { return Ok(decomposition) };
        let too_few =
            || LayoutError::TooFewCells { grid: decomposition.grid(), cells: model.grid.counts() };
        model.aligned(&decomposition, self.ghost_width).ok_or_else(too_few)
    }
}
