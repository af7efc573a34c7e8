//! The state of a gas at one time.

use super::step::GasReport;
use super::volume_averaged::VolumeAveragedState;
use super::{ColumnState, GasModel};
use crate::domain::Subdomain;
use crate::parallel::{CellRecord, Communicator};

/// The gas's part of the state of a run: together with the particles, it determines the future of the gas.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one in a run")]
pub enum GasState {
    /// No gas, or one that follows the particles at every step.
    #[default]
    None,
    /// A column gas that is compressible or comes from a plenum.
    Column(ColumnState),
    /// The volume-averaged gas on this rank's cells.
    VolumeAveraged(VolumeAveragedState),
}

impl GasState {
    /// The state from the cells of a checkpoint, each on any one rank; no gas if no rank has any. Collective.
    pub fn from_records(
        model: &GasModel,
        records: &[CellRecord],
        report: GasReport,
        subdomain: Subdomain,
        ranks: &dyn Communicator,
    ) -> Self {
        let column = ColumnState::from_records(records, ranks);
        if !column.is_empty() {
            return Self::Column(column);
        }
        match model {
            GasModel::VolumeAveraged(model) if ranks.any(!records.is_empty()) => {
                Self::VolumeAveraged(VolumeAveragedState::from_records(
                    model, records, report, subdomain, ranks,
                ))
            }
            GasModel::None | GasModel::Column(_) | GasModel::VolumeAveraged(_) => Self::None,
        }
    }

    /// Checks that the cells of a checkpoint are in the grid of the gas.
    ///
    /// # Errors
    /// Names the first cell that is not; may differ between ranks.
    pub fn require_cells(model: &GasModel, records: &[CellRecord]) -> Result<(), String> {
        let GasModel::VolumeAveraged(model) = model else { return Ok(()) };
        let cells: u64 = model.grid.counts().iter().map(|&count| count as u64).product();
        let is_outside = |record: &&CellRecord| record.cell >= cells && !ColumnState::has(record);
        match records.iter().find(is_outside) {
            Some(CellRecord { cell, .. }) => Err(format!(
                "the checkpoint has cell {cell} of the gas, and the grid {cells} cells"
            )),
            None => Ok(()),
        }
    }

    /// The state of the volume-averaged gas, if the gas is of this kind.
    pub fn volume_averaged(&self) -> Option<&VolumeAveragedState> {
        match self {
            Self::VolumeAveraged(state) => Some(state),
            Self::None | Self::Column(_) => None,
        }
    }

    /// The state of the column gas, if that has one.
    pub fn column(&self) -> Option<&ColumnState> {
        match self {
            Self::Column(state) => Some(state),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }

    /// The pressure of a plenum, if there is one.
    pub fn plenum(&self) -> Option<f64> {
        self.column()?.plenum
    }

    /// Report on the last step; zeros for a gas without cells.
    pub fn report(&self) -> GasReport {
        match self {
            Self::None | Self::Column(_) => GasReport::default(),
            Self::VolumeAveraged(state) => state.report,
        }
    }
}
