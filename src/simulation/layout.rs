//! How the ranks divide the box.

use crate::case::{Case, RankLayout};
use crate::domain::{Decomposition, RankGrid};
use crate::state::SizeRange;
use thiserror::Error;

/// Ranks that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LayoutError {
    /// The case or the command line asks for another number of ranks.
    #[error("the rank grid {grid} needs {} ranks, but {ranks} were started (mpirun -n {})", grid.size(), grid.size())]
    WrongSize {
        /// Ranks along x, y and z.
        grid: RankGrid,
        /// How many there are.
        ranks: usize,
    },
    /// Blocks narrower than the ghosts they need.
    #[error(
        "{ranks} ranks along {axis} cut the box into blocks {width:.4} wide, but ghosts need {needed:.4}: use at most \
         {most} along {axis}, or cut along another axis as well (--ranks, or parallel.ranks)"
    )]
    TooNarrow {
        /// The axis.
        axis: &'static str,
        /// Ranks along it.
        ranks: usize,
        /// Width of their blocks.
        width: f64,
        /// Width that ghosts need.
        needed: f64,
        /// How many ranks would do.
        most: usize,
    },
    /// Blocks narrower than the cells that they need.
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

/// Blocks of equal size on the rank grid of the case, or on `grid` if given.
///
/// # Errors
/// If the grid does not fit the number of ranks, or blocks would be narrower than their ghosts.
pub fn lay_out(
    case: &Case,
    sizes: &SizeRange,
    grid: Option<RankGrid>,
    ranks: usize,
) -> Result<Decomposition, LayoutError> {
    let grid = grid.unwrap_or(match case.parallel.layout {
        RankLayout::Slabs(axis) => RankGrid::slabs(axis, ranks),
        RankLayout::Grid(grid) => grid,
    });
    if grid.size() != ranks {
        return Err(LayoutError::WrongSize { grid, ranks });
    }
    let bounds = &case.domain.bounds;
    let needed = case.ghost_width(sizes);
    for axis in (0..3).filter(|&axis| grid.0[axis] > 1) {
        let (length, ranks) = (bounds.lengths()[axis], grid.0[axis]);
        let width = length / ranks as f64;
        if width < needed {
            let most = ((length / needed) as usize).max(1);
            let axis = ["x", "y", "z"][axis];
            return Err(LayoutError::TooNarrow { axis, ranks, width, needed, most });
        }
    }
    let decomposition = Decomposition::even(grid, bounds);
    aligned(case, decomposition, needed)
}

/// The cut with its planes on cell faces, if a gas in the case asks for that.
///
/// # Errors
/// If there are too few cells.
pub(super) fn aligned(
    case: &Case,
    decomposition: Decomposition,
    width: f64,
) -> Result<Decomposition, LayoutError> {
    let Some(model) = case.volume_averaged() else { return Ok(decomposition) };
    let too_few =
        || LayoutError::TooFewCells { grid: decomposition.grid(), cells: model.grid.counts() };
    model.aligned(&decomposition, width).ok_or_else(too_few)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Subdomains must be as wide as the ghosts of the run, which reach as far as the necks of JKR.
    #[test]
    fn subdomains_narrower_than_the_necks_of_jkr_need_are_refused() {
        let good = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/good");
        let strong = ["contact.surface_energy=2000".to_owned()];
        let case = Case::read(&good.join("jkr-round-column.toml"), &strong).unwrap();
        let sizes = case.size_range().unwrap();
        let neck = case.stages[0].models(&sizes).range(&sizes);
        assert!(neck > 0.2 && case.stages[0].cohesion.is_none(), "necks alone reach far: {neck}");
        let slabs = |count: usize| lay_out(&case, &sizes, Some(RankGrid([1, 1, count])), count);
        // Diameter and skin are 1.08, with the necks 1.3: slabs of 1.18 lie between.
        let error = slabs(34).unwrap_err();
        let LayoutError::TooNarrow { needed, most, .. } = error else { panic!("{error}") };
        assert!((needed - 1.08 - neck).abs() < 1.0e-12, "rounding of a sum: {needed}");
        assert!(slabs(most).is_ok() && slabs(most + 1).is_err());
    }
}
