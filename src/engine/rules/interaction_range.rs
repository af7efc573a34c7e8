//! Largest separation at which bodies act on each other.

/// Separation of surfaces up to which bodies act on each other: the maximum of the ranges of the contact laws (necks of
/// JKR) and of the range of cohesion, which is `None` without cohesion. Lists, ghosts and subdomains are made for it.
pub fn interaction_range(
    reaches_of_laws: impl IntoIterator<Item = f64>,
    range_of_cohesion: Option<f64>,
) -> f64 {
    reaches_of_laws.into_iter().fold(range_of_cohesion.unwrap_or(0.0), f64::max)
}
