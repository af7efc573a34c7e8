//! How fast a particle may move.

/// A tenth of the smallest diameter in one step: a faster particle could pass through others unseen.
pub fn speed_limit(smallest_diameter: f64, time_step: f64) -> f64 {
    0.1 * smallest_diameter / time_step
}
