//! What a gas is at one time, beside the particles.

use bytemuck::Zeroable;

use super::GasModel;
use super::step::GasReport;
use super::volume_averaged::VolumeAveragedState;
use crate::domain::Subdomain;
use crate::parallel::{CellRecord, Communicator};

/// In checkpoints a plenum is the cell of this number.
const PLENUM: u64 = u64::MAX;

/// What a checkpoint keeps of a plenum.
pub(super) fn plenum_record(pressure: f64) -> CellRecord {
    CellRecord { cell: PLENUM, pressure, ..CellRecord::zeroed() }
}

/// The part of a run's state that is the gas's: with the particles, all that its future depends on.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one in a run")]
pub enum GasState {
    /// No gas, or one that follows the particles at every step.
    #[default]
    None,
    /// The pressure of the plenum that a column gas comes from.
    Plenum(f64),
    /// The volume-averaged gas on this rank's cells.
    VolumeAveraged(VolumeAveragedState),
}

impl GasState {
    /// From the cells of a checkpoint, each on any one rank; none if no rank has any. Collective.
    pub fn from_records(
        model: &GasModel,
        records: &[CellRecord],
        report: GasReport,
        subdomain: Subdomain,
        ranks: &dyn Communicator,
    ) -> Self {
        let plenum = records.iter().find(|record| record.cell == PLENUM);
        if ranks.any(plenum.is_some()) {
            // One rank has it.
            let mut bits = [plenum.map_or(0, |record| record.pressure.to_bits() as i64)];
            ranks.sum_integers(&mut bits);
            return Self::Plenum(f64::from_bits(bits[0] as u64));
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

    /// The state of the volume-averaged gas, if it is that.
    pub fn volume_averaged(&self) -> Option<&VolumeAveragedState> {
        match self {
            Self::VolumeAveraged(state) => Some(state),
            Self::None | Self::Plenum(_) => None,
        }
    }

    /// The pressure of a plenum, if there is one.
    pub fn plenum(&self) -> Option<f64> {
        match self {
            Self::Plenum(pressure) => Some(*pressure),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }

    /// How the last step went; zeros for a gas without cells.
    pub fn report(&self) -> GasReport {
        match self {
            Self::None | Self::Plenum(_) => GasReport::default(),
            Self::VolumeAveraged(state) => state.report,
        }
    }
}
