//! The state of the gas at one time, and the fields of the particles that it needs.

use super::{GAS_HALO, VolumeAveragedModel};
use crate::domain::Subdomain;
use crate::gas::GasReport;
use crate::grid::{Field, LocalCells};
use crate::parallel::{CellRecord, Communicator, send_cells_to_owners};

/// The gas on a rank's cells, and a report on its last step. Part of the state of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedState {
    /// Velocity, pressure, voidage.
    pub fields: GasFields,
    /// Report on the last step, over all ranks.
    pub report: GasReport,
}

impl VolumeAveragedState {
    /// The state from records of cells, each on any one rank. It must be completed before the next step. Collective.
    pub fn from_records(
        model: &VolumeAveragedModel,
        records: &[CellRecord],
        report: GasReport,
        subdomain: Subdomain,
        ranks: &dyn Communicator,
    ) -> Self {
        let part = model.grid.local_cells(subdomain);
        let mut fields = GasFields::at_rest(&part);
        for record in send_cells_to_owners(records, &model.grid, subdomain.decomposition, ranks) {
            fields.restore(record.indices_in(&part), &record);
        }
        Self { fields, report }
    }

    /// Records of the owned cells of a part.
    pub fn records(&self, part: &LocalCells) -> Vec<CellRecord> {
        part.owned().map(|cell| self.fields.record(part, cell)).collect()
    }
}

/// The gas on a rank's part of the grid. [`GasFields::record`] contains all values on which its future depends.
#[derive(Clone, Debug, PartialEq)]
pub struct GasFields {
    /// Velocity u of the gas between the particles: component a is stored at the lower face of each cell along a. The
    /// upper faces of the box are the lower ones of cells in the halo.
    pub velocity: [Field; 3],
    /// Pressure in cells, without the hydrostatic head rho g.x. The halo continues it, so that the difference of two
    /// neighbours over their distance is the gradient on every face, including those of the box.
    pub pressure: Field,
    /// Voidage eps in cells, at the time of the velocity.
    pub voidage: Field,
}

/// The particles as seen by the gas, on cells. Owned cells are given; the gas fills the halos.
#[derive(Clone, Debug, PartialEq)]
pub struct BedOnGrid {
    /// Voidage eps at the end of the step, above 0 and at most 1.
    pub voidage: Field,
    /// Drag coefficient beta per volume: the force of the gas on the particles is beta u - (beta v).
    pub momentum_transfer: Field,
    /// The sum of drag coefficients times the velocities of the particles, per volume: (beta v).
    pub transferred_velocity: [Field; 3],
}

impl GasFields {
    /// Gas at rest without particles; halos are not yet filled.
    pub fn at_rest(part: &LocalCells) -> Self {
        let zero = Field::new(part, GAS_HALO);
        let mut voidage = zero.clone();
        voidage.values_mut().fill(1.0);
        Self { velocity: std::array::from_fn(|_| zero.clone()), pressure: zero, voidage }
    }

    /// Record of an owned cell of a part, for a checkpoint.
    pub fn record(&self, part: &LocalCells, cell: [isize; 3]) -> CellRecord {
        let velocity = |axis: usize, cell| self.velocity[axis].at(cell);
        CellRecord {
            cell: part.number_of(cell),
            lower_velocity: std::array::from_fn(|axis| velocity(axis, cell)),
            upper_velocity: std::array::from_fn(|axis| velocity(axis, next(cell, axis))),
            pressure: self.pressure.at(cell),
            voidage: self.voidage.at(cell),
        }
    }

    /// Sets a cell from its record. Halos must be filled afterwards.
    pub fn restore(&mut self, cell: [isize; 3], record: &CellRecord) {
        for axis in 0..3 {
            *self.velocity[axis].at_mut(cell) = record.lower_velocity[axis];
            *self.velocity[axis].at_mut(next(cell, axis)) = record.upper_velocity[axis];
        }
        *self.pressure.at_mut(cell) = record.pressure;
        *self.voidage.at_mut(cell) = record.voidage;
    }
}

impl BedOnGrid {
    /// A bed without particles: voidage 1 and no drag.
    pub fn empty(part: &LocalCells) -> Self {
        let zero = Field::new(part, GAS_HALO);
        let mut voidage = zero.clone();
        voidage.values_mut().fill(1.0);
        Self {
            voidage,
            momentum_transfer: zero.clone(),
            transferred_velocity: std::array::from_fn(|_| zero.clone()),
        }
    }
}

/// The cell above along an axis.
fn next(mut cell: [isize; 3], axis: usize) -> [isize; 3] {
    cell[axis] += 1;
    cell
}
