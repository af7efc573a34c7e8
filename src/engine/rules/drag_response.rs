//! Change of a particle's velocity in a gas step.

/// The largest [`drag_response`] of a gas step: at 1 the force of one gas step takes all of a particle's velocity
/// relative to the gas if the bed moves as a whole; at 2 the bed would oscillate with growing amplitude.
pub const LARGEST_DRAG_RESPONSE: f64 = 1.0;

/// b dt / (m eps^2): the fraction of its velocity relative to the gas that drag takes from a particle in one gas step.
///
/// b is the drag per velocity (`drag`), dt the gas step, m the particle's mass, eps the voidage around it.
#[inline]
pub fn drag_response(drag: f64, gas_step: f64, mass: f64, voidage: f64) -> f64 {
    drag * gas_step / (mass * voidage * voidage)
}
