//! The force laws at a step.

use crate::contact::ForceLaws;
use crate::particles::InteractionRanges;
use crate::state::{Models, State, Workspace};

/// The present laws of all contacts, with the present attraction; they advance histories by `dt`.
pub(super) fn force_laws<'a>(
    state: &State,
    models: &'a Models,
    work: &Workspace,
    dt: f64,
) -> ForceLaws<'a> {
    ForceLaws {
        contact: &models.physics.contact,
        at_walls: &models.physics.at_walls,
        exchanges: &models.physics.exchanges,
        cohesion: models.physics.cohesion_at(state.clock.time()),
        ranges: InteractionRanges {
            contact: models.contact_range(&state.sizes),
            any: work.list_range.interaction,
            diameter: state.sizes.largest_diameter,
        },
        dt,
        limit: models.limits.force,
        force_quantum: models.force_quantum,
        torque_quantum: models.torque_quantum,
    }
}
