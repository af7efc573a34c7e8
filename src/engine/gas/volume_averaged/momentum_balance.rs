//! Comparison of the momentum lost by the gas with that gained by the particles.

use super::BedOnGrid;
use crate::grid::{ColumnOnCells, Field};
use crate::numbers::{ExactSum, Quantum, vectorised};
use crate::parallel::Communicator;

/// Momentum per time transferred in one step from the gas to the particles on this rank, by the sums on either side.
#[derive(Clone, Debug, Default)]
pub(super) struct Exchanged {
    /// Force lost by the gas at its faces.
    pub(super) lost: [ExactSum; 3],
    /// Forces on particles, in quanta of force.
    pub(super) gained: [i64; 3],
}

impl Exchanged {
    /// Largest component of the difference between the force on all particles and the force that the gas loses, at the
    /// last gas step. Collective.
    pub(super) fn error(&self, quantum: Quantum, ranks: &dyn Communicator) -> f64 {
        let Self { lost, gained } = self;
        let mut integers: Vec<i64> = (0..3)
            .flat_map(|axis| {
                let mut sum = ExactSum::default();
                sum.add_count(-gained[axis], quantum);
                [lost[axis].to_integers(), sum.to_integers()].concat()
            })
            .collect();
        ranks.sum_integers(&mut integers);
        let components = integers.chunks(2 * ExactSum::INTEGERS).map(|both| {
            let (lost, gained) = both.split_at(ExactSum::INTEGERS);
            let sum: Vec<i64> = lost.iter().zip(gained).map(|(a, b)| a + b).collect();
            ExactSum::from_integers(&sum).value().abs()
        });
        components.fold(0.0, |largest, error| if error <= largest { largest } else { error })
    }
}

/// Volumes of cells, in the box or in a round column.
#[derive(Clone, Copy)]
pub(super) struct CellVolumes<'a> {
    /// Volume of a whole cell.
    pub(super) whole: f64,
    pub(super) column: Option<&'a ColumnOnCells>,
}

impl CellVolumes<'_> {
    /// Volume of the cell at an index into a field.
    fn at(self, index: usize) -> f64 {
        self.column.map_or(self.whole, |column| self.whole * column.at(index))
    }
}

/// Force along an axis that the gas loses on this rank, sum_c V (beta u - (beta v) - (1 - eps) (grad p - rho_g g)): the
/// sum over faces of the terms in its equations. `in_cells` are its velocity and pressure gradient, `buoyancy` is rho_g
/// g along the axis, `volumes` are those of the cells.
pub(super) fn force_lost(
    bed: &BedOnGrid,
    in_cells: &[Field; 6],
    axis: usize,
    buoyancy: f64,
    volumes: CellVolumes,
) -> ExactSum {
    let mut sum = ExactSum::default();
    let (beta, beta_v) = (&bed.momentum_transfer, &bed.transferred_velocity[axis]);
    let fields = [&in_cells[axis], &in_cells[3 + axis], beta, beta_v, &bed.voidage];
    let mut lost = vec![0.0; bed.voidage.row_length()];
    for row in bed.voidage.rows() {
        lost_per_volume(fields, row, buoyancy, &mut lost);
        for (i, &lost) in lost.iter().enumerate() {
            // The force is zero where there are no particles, and an exact sum costs more than this test.
            if lost != 0.0 {
                sum.add(volumes.at(row + i) * lost);
            }
        }
    }
    sum
}

vectorised!(
    /// Force per volume that the gas loses in a row of cells, from the fields u, the gradient of p, beta, beta v, eps.
    fn lost_per_volume(fields: [&Field; 5], row: usize, buoyancy: f64, lost: &mut [f64]) {
        let length = lost.len();
        set_lost(fields.map(|field| &field.values()[row..][..length]), buoyancy, lost);
    }
);

#[inline(always)]
fn set_lost([u, gradient, beta, beta_v, eps]: [&[f64]; 5], buoyancy: f64, lost: &mut [f64]) {
    for i in 0..lost.len() {
        let by_pressure = (1.0 - eps[i]) * (gradient[i] - buoyancy);
        lost[i] = beta[i] * u[i] - beta_v[i] - by_pressure;
    }
}
