//! The transfer between a level and the next coarser one: axis by axis, the last axis first, followed by the gathering
//! of the coarser level on every rank if it is the first replicated one.

use super::cell_pairs::CellPairs;
use super::interpolation::Interpolation;
use super::level_grid::{LevelGrid, replicated_halo};
use super::operator::{Coefficients, Equation};
use super::prolongation::{correct, prolong, restrict};
use super::replication::Replication;
use crate::domain::Subdomain;
use crate::grid::Field;
use crate::parallel::{Communicator, FieldHalo, OneRank};

/// The transfer to the next coarser level, and the equation of that level.
#[derive(Clone, Debug)]
pub(super) struct LevelTransfer {
    along_axes: Vec<AxisTransfer>,
    /// Set if the coarser level is the first replicated one.
    gathered: Option<GatheredLevel>,
    solution: Field<f32>,
}

/// The transfer along one axis.
#[derive(Clone, Debug)]
struct AxisTransfer {
    interpolation: Interpolation,
    coefficients: Coefficients<f32>,
    /// The restricted residual, then the correction.
    values: Field<f32>,
}

/// The equation of the first replicated level.
#[derive(Clone, Debug)]
struct GatheredLevel {
    replication: Replication,
    halo: FieldHalo,
    coefficients: Coefficients<f32>,
    right_hand_side: Field<f32>,
}

impl LevelTransfer {
    /// The transfer from a level, and the grid of the next one.
    pub(super) fn new(grid: &LevelGrid, subdomain: Subdomain) -> (Self, LevelGrid) {
        let mut along_axes = Vec::new();
        let mut fine = grid.clone();
        for axis in grid.axes_to_coarsen().into_iter().rev() {
            let coarse = fine.coarsened(axis);
            let pairs = CellPairs {
                axis,
                fine: fine.local_cells(subdomain),
                coarse: coarse.local_cells(subdomain),
                periodic: grid.periodic()[axis],
            };
            along_axes.push(AxisTransfer {
                coefficients: Coefficients::new(&pairs.coarse),
                values: Field::new(&pairs.coarse, 2),
                interpolation: Interpolation::new(pairs),
            });
            fine = coarse;
        }
        let cells = fine.local_cells(subdomain);
        let gathers = !grid.is_replicated() && fine.is_replicated();
        let next = if gathers { fine.replicated() } else { fine };
        let next_cells = next.local_cells(subdomain);
        let gathered = gathers.then(|| GatheredLevel {
            replication: Replication::new(cells, grid.periodic()),
            halo: replicated_halo(subdomain),
            coefficients: Coefficients::new(&next_cells),
            right_hand_side: Field::new(&next_cells, 1),
        });
        (Self { along_axes, gathered, solution: Field::new(&next_cells, 1) }, next)
    }

    /// Sets the weights of the interpolation and the coefficients of the coarser level, and returns these. This call is
    /// collective.
    pub(super) fn coarsen<'a>(
        &'a mut self,
        finest: &'a Coefficients<f32>,
        halo: &mut FieldHalo,
        ranks: &dyn Communicator,
    ) -> &'a Coefficients<f32> {
        let mut fine = finest;
        let last = self.along_axes.len() - 1;
        for (number, along_axis) in self.along_axes.iter_mut().enumerate() {
            let AxisTransfer { interpolation, coefficients, .. } = along_axis;
            interpolation.set_half_resistance(fine);
            halo.refresh(&mut [&mut interpolation.half_resistance], ranks);
            interpolation.set_weights(fine);
            halo.refresh(&mut [&mut interpolation.weight], ranks);
            interpolation.coarsen(fine, coefficients);
            if number < last || self.gathered.is_none() {
                halo.refresh(&mut coefficients.fields(), ranks);
            }
            fine = coefficients;
        }
        let Some(gathered) = &mut self.gathered else { return fine };
        let GatheredLevel { replication, halo, coefficients, .. } = gathered;
        replication.gather_coefficients(fine, coefficients, ranks);
        halo.refresh(&mut coefficients.fields(), &OneRank);
        coefficients
    }

    /// Restricts the residual to the right-hand side of the coarser level. Before: the halo of the residual is current.
    pub(super) fn restrict(&mut self, residual: &Field<f32>, ranks: &dyn Communicator) {
        let mut fine = residual;
        for along_axis in &mut self.along_axes {
            restrict(&along_axis.interpolation, fine, &mut along_axis.values);
            fine = &along_axis.values;
        }
        if let Some(gathered) = &mut self.gathered {
            gathered.replication.gather([fine], [&mut gathered.right_hand_side], ranks);
        }
    }

    /// The equation of the coarser level.
    pub(super) fn equation(&mut self) -> Equation<'_, f32> {
        let last = self.along_axes.last().expect("a level is coarsened along some axis");
        let (coefficients, right_hand_side) = match &self.gathered {
            Some(gathered) => (&gathered.coefficients, &gathered.right_hand_side),
            None => (&last.coefficients, &last.values),
        };
        Equation { coefficients, right_hand_side, solution: &mut self.solution }
    }

    /// Adds the prolonged solution of the coarser level to the solution of the finer one. Before: the halo of the
    /// coarser solution is current.
    pub(super) fn correct(&mut self, solution: &mut Field<f32>) {
        let last = self.along_axes.len() - 1;
        let mut coarse = &self.solution;
        let (finer, coarsest) = self.along_axes.split_at_mut(last);
        let AxisTransfer { interpolation, values, .. } = &mut coarsest[0];
        if let Some(gathered) = &self.gathered {
            gathered.replication.take_local(coarse, values);
            coarse = values;
        }
        let mut interpolation = &*interpolation;
        for along_axis in finer.iter_mut().rev() {
            prolong(interpolation, coarse, &mut along_axis.values);
            (coarse, interpolation) = (&along_axis.values, &along_axis.interpolation);
        }
        correct(interpolation, coarse, solution);
    }
}
