//! The Bond number: ratio of the largest attraction of a particle to its weight.

/// The body to which a particle adheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPartner {
    /// A particle of the same size.
    Particle,
    /// A flat wall.
    Wall,
}

/// F = Bo m g: the attraction of a Bond number.
pub fn attraction_of_bond_number(bond_number: f64, mass: f64, gravity: f64) -> f64 {
    bond_number * mass * gravity
}

/// Hamaker constant A of Bond number 1: A(Bo) = Bo times this, Bo(A) = A over this.
///
/// The Bond number is the ratio of the largest attraction to the weight, Bo = F_max / (m g). With
/// F_max = A r / (12 delta^2) for two particles of radius r = d / 2 and A r / (6 delta^2) for a particle and a wall,
/// A = 12 delta^2 Bo m g / r and A = 6 delta^2 Bo m g / r (Moon et al. 2006, eq. (4)). delta (`cut_off`) is the
/// separation below which the attraction no longer grows, d is `diameter`, m g is `weight`.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::rules::{ContactPartner, hamaker_constant_per_bond_number};
/// // Dimensionless units: d = 1, m g = pi / 6, delta = 1e-4.
/// let weight = std::f64::consts::PI / 6.0;
/// let unit = hamaker_constant_per_bond_number(ContactPartner::Particle, 1.0e-4, 1.0, weight);
/// let force = 5.0 * unit * 0.5 / (12.0 * 1.0e-8); // A r / (12 delta^2) at Bo = 5
/// assert!((force / weight - 5.0).abs() < 1.0e-12); // rounding
/// ```
pub fn hamaker_constant_per_bond_number(
    partner: ContactPartner,
    cut_off: f64,
    diameter: f64,
    weight: f64,
) -> f64 {
    let factor = match partner {
        ContactPartner::Particle => 12.0,
        ContactPartner::Wall => 6.0,
    };
    factor * cut_off * cut_off * (weight / (0.5 * diameter))
}
