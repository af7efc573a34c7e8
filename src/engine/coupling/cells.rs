//! Transfers between the particles and the cells of one rank, with sums over ranks.

use super::corners::{Corners, deposit};
use super::filter::Filter;
use crate::domain::{Bounds, Subdomain};
use crate::grid::{BoxGrid, CellLocator, ColumnOnCells, Field, LocalCells, RoundColumn};
use crate::numbers::{Quantum, vectorised};
use crate::parallel::{Communicator, FieldHalo};
use crate::particles::{Body, Particles, sphere_volume};
use nalgebra::Vector3;
use std::ops::Range;

/// Transfers between the particles and the cells of one rank: hat functions around cell centres, then the filter if
/// there is one. It is not part of the state of a run.
///
/// One set of weights serves both directions, so that interpolation is the adjoint of deposition.
#[derive(Clone, Debug)]
pub(crate) struct CellTransfer {
    bounds: Bounds,
    cell_volume: f64,
    ends: [[bool; 2]; 3],
    locator: CellLocator,
    halo: FieldHalo,
    /// The round column that bounds the gas, if there is one.
    column: Option<ColumnOnCells>,
    filter: Option<Filter>,
    /// Cells around each owned particle at the last deposition of volume.
    corners: Vec<Corners>,
    /// The smallest range that contains all of their places.
    places: Range<usize>,
}

vectorised!(
    /// Finds the cells around each particle and gives them their shares of its volume.
    fn deposit_volume(
        transfer: &CellTransfer,
        bodies: &[Body],
        quantum: Quantum,
        solids_fraction: &mut Field,
        corners: &mut Vec<Corners>,
    ) {
        for body in bodies {
            let around = transfer.corners_at(&body.position, solids_fraction);
            let volume = sphere_volume(body.radius);
            deposit([&mut *solids_fraction], [quantum], &around, [volume]);
            corners.push(around);
        }
    }
);

impl CellTransfer {
    /// Transfers on one rank's part of a grid, in the box or in a round column in it, with a filter of this full width
    /// at half maximum (0 for none). Fields have the shape of `field`.
    pub(crate) fn new(
        (grid, column): (&BoxGrid, Option<&RoundColumn>),
        filter_width: f64,
        subdomain: Subdomain,
        field: &Field,
    ) -> Self {
        let part = grid.local_cells(subdomain);
        let column = column.map(|column| ColumnOnCells::new(column, &part, field));
        Self {
            bounds: subdomain.bounds.clone(),
            cell_volume: grid.cell_volume(),
            ends: std::array::from_fn(|axis| part.at_ends(axis)),
            locator: CellLocator::new(grid, part),
            halo: FieldHalo::new(subdomain),
            filter: Filter::new(grid, filter_width, column.as_ref(), field),
            column,
            corners: Vec::new(),
            places: 0..0,
        }
    }

    /// Largest distance that particles may move, after they were sent to ranks, and still lie within reach of their
    /// rank's halos; length.
    pub(crate) fn reach(grid: &BoxGrid) -> f64 {
        CellLocator::MARGIN * grid.spacing().min()
    }

    /// The cells of this rank.
    pub(crate) fn part(&self) -> &LocalCells {
        self.locator.cells()
    }

    /// Fraction of a wave's amplitude that the filter leaves: see [`Filter::part_of_wave`]; 1 without a filter.
    pub(crate) fn part_of_wave(&self, squares: [f64; 3]) -> f64 {
        self.filter.as_ref().map_or(1.0, |filter| filter.part_of_wave(squares))
    }

    /// The round column that bounds the gas, if there is one.
    pub(crate) fn column(&self) -> Option<&ColumnOnCells> {
        self.column.as_ref()
    }

    /// The cells around each owned particle at the last [`CellTransfer::deposit_volume`].
    pub(crate) fn corners(&self) -> &[Corners] {
        &self.corners
    }

    /// The range of their places in the memory of fields.
    pub(crate) fn places(&self) -> Range<usize> {
        self.places.clone()
    }

    /// The cells around a point, for fields of the shape of `field`.
    #[inline(always)]
    pub(crate) fn corners_at(&self, position: &Vector3<f64>, field: &Field) -> Corners {
        let wrapped = self.bounds.wrap(*position);
        match &self.column {
            None => Corners::of(&self.locator.weights(&wrapped), field),
            Some(cells) => {
                let weights = self.locator.weights(&cells.column.within_reach(&wrapped));
                Corners::of(&weights, field).in_column(cells)
            }
        }
    }

    /// Sets the solids fraction of each owned cell, and finds the cells around each particle. Shares of volume are
    /// rounded to `quantum`. Collective.
    ///
    /// Before: owned particles are current. After: halos of the field are out of date.
    pub(crate) fn deposit_volume(
        &mut self,
        particles: &Particles,
        quantum: Quantum,
        solids_fraction: &mut Field,
        ranks: &dyn Communicator,
    ) {
        solids_fraction.values_mut().fill(0.0);
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let bodies = &particles.body[..particles.owned_count()];
        deposit_volume(self, bodies, quantum, solids_fraction, &mut corners);
        self.corners = corners;
        self.places = Corners::places_of(&self.corners);
        self.sum_per_volume(&mut [solids_fraction], ranks);
    }

    /// Turns amounts that particles gave to cells and halos into amounts per open volume of owned cells, filtered.
    /// Collective.
    ///
    /// After: halos are out of date.
    pub(crate) fn sum_per_volume(&mut self, fields: &mut [&mut Field], ranks: &dyn Communicator) {
        self.halo.add_to_owners(fields, ranks);
        for field in fields.iter_mut() {
            field.values_mut().iter_mut().for_each(|value| *value /= self.cell_volume);
            if let Some(column) = &self.column {
                divide_by_open_fractions(field, column);
            }
        }
        self.filter(fields, ranks);
    }

    /// Adds the values in halos to the cells of their owners. Collective.
    pub(crate) fn add_to_owners(&mut self, fields: &mut [&mut Field], ranks: &dyn Communicator) {
        self.halo.add_to_owners(fields, ranks);
    }

    /// Filters fields before they are interpolated, and fills their halos. Collective.
    pub(crate) fn prepare_interpolation(
        &mut self,
        fields: &mut [&mut Field],
        ranks: &dyn Communicator,
    ) {
        self.filter(fields, ranks);
        self.halo.refresh(fields, ranks);
    }

    /// Fills the halos of fields. Collective.
    pub(crate) fn refresh(&mut self, fields: &mut [&mut Field], ranks: &dyn Communicator) {
        self.halo.refresh(fields, ranks);
    }

    fn filter(&mut self, fields: &mut [&mut Field], ranks: &dyn Communicator) {
        if let Some(filter) = &mut self.filter {
            filter.apply(fields, &self.ends, &mut self.halo, ranks);
        }
    }
}

/// Divides a field by the open fraction of each cell; closed cells were given nothing.
fn divide_by_open_fractions(field: &mut Field, column: &ColumnOnCells) {
    let values = field.values_mut().iter_mut().zip(column.values());
    for (value, &open) in values.filter(|(_, open)| **open > 0.0) {
        *value /= open;
    }
}
