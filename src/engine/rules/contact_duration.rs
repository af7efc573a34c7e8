//! Quantities for the assessment of the duration of a contact.

/// Number of steps per contact below which collisions are no longer resolved: a dozen steps keep the restitution of a
/// linear spring and dashpot within a few per cent.
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

    /// Two spheres of these masses and radii.
    pub fn of_spheres(masses: [f64; 2], radii: [f64; 2]) -> Self {
        let reduced = |[one, other]: [f64; 2]| one * other / (one + other);
        Self { mass: reduced(masses), radius: reduced(radii) }
    }

    /// A sphere and a wall, which is flat and has infinite mass: m* = m, R* = r.
    pub fn of_sphere_and_wall(mass: f64, radius: f64) -> Self {
        Self { mass, radius }
    }
}
