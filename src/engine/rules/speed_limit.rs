//! The largest speed of a particle.

/// A tenth of the smallest diameter per step: a faster particle could pass through others unnoticed.
pub fn speed_limit(smallest_diameter: f64, time_step: f64) -> f64 {
    0.1 * smallest_diameter / time_step
}
