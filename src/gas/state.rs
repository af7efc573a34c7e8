//! What a gas is at one time, beside the particles.

use super::GasModel;
use super::step::GasReport;
use super::volume_averaged::VolumeAveragedState;
use crate::domain::Subdomain;
use crate::parallel::{CellRecord, Communicator};

/// The part of a run's state that is the gas's: with the particles, all that its future depends on.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one in a run")]
pub enum GasState {
    /// No gas, or one that follows the particles at every step.
    #[default]
    None,
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
            Self::None => None,
        }
    }

    /// How the last step went; zeros for a gas without cells.
    pub fn report(&self) -> GasReport {
        match self {
            Self::None => GasReport::default(),
            Self::VolumeAveraged(state) => state.report,
        }
    }
}
