//! What the duration of a contact is judged by.

/// Steps per contact below which collisions are no longer resolved: a dozen steps keep the restitution of a linear
/// spring and dashpot within a few per cent.
pub const LEAST_STEPS_PER_CONTACT: f64 = 12.0;

/// Two bodies in contact as one: reduced mass m* = m_1 m_2 / (m_1 + m_2) and reduced radius
/// R* = r_1 r_2 / (r_1 + r_2), on which the duration of their contact depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedBody {
    /// m*.
    pub mass: f64,
    /// R*.
    pub radius: f64,
}

impl ReducedBody {
    /// Two equal spheres: m* = m / 2, R* = r / 2.
    pub fn of_equal_spheres(mass: f64, radius: f64) -> Self {
        Self { mass: 0.5 * mass, radius: 0.5 * radius }
    }

    /// Two spheres of these masses and of one radius.
    pub fn of_spheres([one, other]: [f64; 2], radius: f64) -> Self {
        Self { mass: one * other / (one + other), radius: 0.5 * radius }
    }

    /// A sphere and a wall, which is flat and has no end of mass: m* = m, R* = r.
    pub fn of_sphere_and_wall(mass: f64, radius: f64) -> Self {
        Self { mass, radius }
    }
}
