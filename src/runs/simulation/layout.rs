//! Division of the box of a case among the ranks.

use crate::case::{Case, RankLayout};
use crate::setup::{Layout, LayoutError};
use nalgebra::Vector3;
use talcum_engine::balance::{Cuts, RankLoad};
use talcum_engine::domain::{Decomposition, RankGrid};
use talcum_engine::parallel::{Communicator, ParticleRecord};
use talcum_engine::state::SizeRange;

/// The rank grid that the case names; slabs along z if it names none.
pub(super) fn named_grid(case: &Case, ranks: usize) -> RankGrid {
    match case.parallel.layout {
        RankLayout::Slabs(axis) => RankGrid::slabs(axis, ranks),
        RankLayout::Grid(grid) => grid,
        RankLayout::Cheapest => RankGrid::slabs(2, ranks),
    }
}

/// Subdomains on a rank grid. If loads are balanced, they have as nearly equal numbers of particles as planes through
/// the whole box allow. Particles lie on the ranks in any order. Collective.
///
/// # Errors
/// If the grid does not fit the number of ranks, or subdomains would be narrower than their ghosts or cells; the same
/// on all ranks.
pub(super) fn divide(
    case: &Case,
    layout: &Layout<'_>,
    grid: RankGrid,
    particles: &[ParticleRecord],
    ranks: &dyn Communicator,
) -> Result<Decomposition, LayoutError> {
    let even = layout.even(grid, ranks.size())?;
    if case.parallel.balance.is_none() {
        return Ok(even);
    }
    let positions = particles.iter().map(|record| (Vector3::from(record.position), 0));
    let (bounds, least_width) = (layout.bounds, layout.ghost_width);
    let cuts = Cuts { bounds, decomposition: &even, least_width };
    layout.align(RankLoad::UNKNOWN.balanced(cuts, positions, ranks))
}

/// Requirements for the division of the case's box.
pub(super) fn layout_of<'a>(case: &'a Case, sizes: &SizeRange) -> Layout<'a> {
    let (bounds, gas) = (&case.domain.bounds, case.gas_on_cells());
    Layout { bounds, gas, ghost_width: case.ghost_width(sizes) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Subdomains must be as wide as the ghosts of the run, which extend as far as the necks of JKR.
    #[test]
    fn subdomains_narrower_than_the_necks_of_jkr_need_are_refused() {
        let good = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/cases/good");
        let strong = ["contact.surface_energy=2000".to_owned()];
        let case = Case::read(&good.join("jkr-round-column.toml"), &strong).unwrap();
        let sizes = case.size_range().unwrap();
        let neck = case.stages[0].models(&sizes).range(&sizes);
        assert!(
            neck > 0.2 && case.stages[0].physics.cohesion.is_none(),
            "necks alone reach far: {neck}"
        );
        let layout = layout_of(&case, &sizes);
        let slabs = |count: usize| layout.even(RankGrid([1, 1, count]), count);
        // Diameter and skin are 1.08, with the necks 1.3: slabs of 1.18 lie between.
        let error = slabs(34).unwrap_err();
        let LayoutError::TooNarrow { needed, most, .. } = error else { panic!("{error}") };
        assert!((needed - 1.08 - neck).abs() < 1.0e-12, "rounding of a sum: {needed}");
        assert!(slabs(most).is_ok() && slabs(most + 1).is_err());
    }
}
