//! The gas that a case chooses for a stage.

use super::volume_averaged::VolumeAveragedModel;
use super::{AgglomerateDrag, ColumnGas};
use crate::coupling::CellTransfer;
use crate::domain::Decomposition;
use crate::parallel::CollectiveError;

/// The gas of a stage.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one for each stage of a case")]
pub enum GasModel {
    /// No gas.
    #[default]
    None,
    /// The column gas: one-dimensional, without inertia.
    Column(ColumnGas),
    /// The volume-averaged gas, in three dimensions.
    VolumeAveraged(VolumeAveragedModel),
}

impl From<ColumnGas> for GasModel {
    fn from(gas: ColumnGas) -> Self {
        Self::Column(gas)
    }
}

impl From<VolumeAveragedModel> for GasModel {
    fn from(gas: VolumeAveragedModel) -> Self {
        Self::VolumeAveraged(gas)
    }
}

impl GasModel {
    /// The column gas, if the gas is of this kind.
    pub fn column(&self) -> Option<&ColumnGas> {
        match self {
            Self::Column(gas) => Some(gas),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }

    /// The volume-averaged gas, if the gas is of this kind.
    pub fn volume_averaged(&self) -> Option<&VolumeAveragedModel> {
        match self {
            Self::VolumeAveraged(model) => Some(model),
            Self::None | Self::Column(_) => None,
        }
    }

    /// This gas around parcels of l^3 particles each; l is `size`.
    #[must_use]
    pub fn around_parcels(mut self, size: f64) -> Self {
        match &mut self {
            Self::None => {}
            Self::Column(gas) => gas.parcel_size = size,
            Self::VolumeAveraged(model) => model.coupling.drag.parcel_size = size,
        }
        self
    }

    /// Dependence of the drag on the agglomerates of the particles, if there is any.
    pub fn agglomerates(&self) -> Option<AgglomerateDrag> {
        self.volume_averaged()?.coupling.agglomerates
    }

    /// Number of steps of the particles in one step of the gas.
    pub fn substeps(&self) -> u64 {
        match self {
            Self::None | Self::Column(_) => 1,
            Self::VolumeAveraged(model) => model.substeps,
        }
    }

    /// Whether the gas makes a step at this step of the particles.
    pub fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.substeps())
    }

    /// Largest distance that particles may move before they are sorted to their ranks again; length.
    pub fn reach(&self) -> f64 {
        match self {
            Self::None | Self::Column(_) => f64::INFINITY,
            Self::VolumeAveraged(model) => CellTransfer::reach(&model.finest_cells()),
        }
    }

    /// The decomposition with its cut planes moved to cell faces, if the gas has cells; subdomains are at least
    /// `width` wide.
    ///
    /// # Errors
    /// If there are too few cells for the ranks.
    pub fn align(
        &self,
        decomposition: &Decomposition,
        width: f64,
    ) -> Result<Decomposition, CollectiveError> {
        match self {
            Self::None | Self::Column(_) => Ok(decomposition.clone()),
            Self::VolumeAveraged(model) => model.aligned(decomposition, width).ok_or_else(|| {
                let (cells, ranks) = (model.grid.counts(), decomposition.grid());
                CollectiveError(format!(
                    "the gas's cells, {cells:?}, are too few for {ranks} ranks"
                ))
            }),
        }
    }
}
