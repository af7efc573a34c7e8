//! The section on the gas: its kind, and the keys common to both kinds.

use super::column::read_column;
use super::context::ReadContext;
use super::forces::positive_gravity;
use super::volume_averaged::read_volume_averaged;
use crate::input::Section;
use talcum_engine::gas::GasModel;
use talcum_engine::rules::viscosity_of_stokes_number;

/// `[gas]`.
pub(super) fn read_gas(section: &Section<'_>, context: ReadContext<'_>) -> Option<GasModel> {
    // The viscosity is read even without a known kind, so that its errors are reported.
    let viscosity = read_viscosity(section, context);
    match section.word("kind")? {
        "volume_averaged" => {
            read_volume_averaged(section, viscosity, context).map(GasModel::VolumeAveraged)
        }
        _ => read_column(section, viscosity, context).map(GasModel::Column),
    }
}

/// mu, given directly or through St = rho_s g^1/2 d^3/2 / mu.
fn read_viscosity(section: &Section<'_>, context: ReadContext<'_>) -> Option<f64> {
    let key = section.given(&["viscosity", "stokes_number"])?;
    let number = section.number(key)?;
    if key == "viscosity" {
        return Some(number);
    }
    let gravity = positive_gravity(section, key, "viscosity", context.gravity)?;
    let diameter = context.scales.diameter?;
    Some(viscosity_of_stokes_number(number, context.scales.density?, gravity, diameter))
}
