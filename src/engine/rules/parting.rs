//! The work of separating two bodies held together by adhesion, and the contribution of a softened spring to it.
//!
//! References:
//! * Y. Gu, A. Ozel, S. Sundaresan, "A modified cohesion model for CFD-DEM simulations of fluidization", Powder Technol.
//!   296 (2016) 17-28, <https://doi.org/10.1016/j.powtec.2015.09.037>: softened particles with the work of cohesion of stiff
//!   ones. The equations here are derived, not taken from there.
//! * S. Chen, W. Liu, S. Li, "A fast adhesive discrete element method for random packings of fine particles", Chem. Eng.
//!   Sci. 193 (2019) 336-345, <https://arxiv.org/abs/1805.03025>: surface energy and a reduced Young's modulus.

/// The largest [`WorkOfParting::spring_part`], and the largest [`WorkOfParting::excess_over`], that are accepted
/// without a warning.
pub const LARGEST_SPRING_PART: f64 = 0.1;

/// The work of separating two bodies slowly, from the overlap at which their adhesion balances the spring; energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorkOfParting {
    /// Work of the attraction beyond contact, which does not depend on the stiffness.
    pub surface: f64,
    /// Work while the bodies overlap, or while a neck joins them, which decreases with their stiffness. F0^2 / (2 k)
    /// for an attraction F0 and a linear spring k.
    pub spring: f64,
}

impl WorkOfParting {
    /// Sum of both parts.
    pub fn total(&self) -> f64 {
        self.surface + self.spring
    }

    /// Ratio of the spring's part to the surface's: F0 / (4 k delta) for a linear spring and an attraction that is
    /// constant up to the separation delta and falls with the square of the separation beyond. Infinite if the bodies
    /// attract each other only in contact.
    ///
    /// ```
    /// # use talcum_engine as talcum;
    /// use talcum::rules::WorkOfParting;
    /// // Moon et al. 2006 at Bo 4: F0 = 4 m g, delta = 8e-6, k_n = 2e5; density, diameter and gravity are 1.
    /// let (force, delta, stiffness) = (4.0 * std::f64::consts::PI / 6.0, 8.0e-6, 2.0e5);
    /// let (surface, spring) = (2.0 * force * delta, force * force / (2.0 * stiffness));
    /// let part = WorkOfParting { surface, spring }.spring_part();
    /// assert!((part - force / (4.0 * stiffness * delta)).abs() < 1.0e-12); // rounding
    /// assert_eq!(format!("{part:.2}"), "0.33");
    /// ```
    pub fn spring_part(&self) -> f64 {
        self.spring / self.surface
    }

    /// Ratio of the total to that of other bodies, less 1.
    pub fn excess_over(&self, real: &Self) -> f64 {
        self.total() / real.total() - 1.0
    }
}

/// The factor by which adhesive forces must be multiplied, for particles whose stiffness is `reduction` times smaller
/// than that of the real ones, to keep the spring's part of the work of separation.
///
/// ```text
/// Lambda^(-1 / (n + 1)),   F = K delta^n,   Lambda = K_real / K
/// ```
///
/// since an attraction F0, less the spring's force, does the work n / (n + 1) F0^((n + 1) / n) K^(-1 / n) from the
/// overlap at which the two balance to zero overlap. n = 1 is a linear spring: Lambda^(-1/2). n = 3/2 is Hertz's:
/// Lambda^(-2/5); since the pull-off force of JKR is proportional to the surface energy, this energy scales as E^(2/5).
/// If the range of the attraction grows by the inverse factor, the surface's part is kept too, and all lengths, forces
/// and times of a contact scale: impacts of the softened particles are similar to those of the real ones, at the same
/// velocities.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::rules::adhesion_factor;
/// assert!((adhesion_factor(100.0, 1.0) - 0.1).abs() < 1.0e-15); // rounding
/// assert!((adhesion_factor(1.0e5, 1.5) - 0.01).abs() < 1.0e-15);
/// ```
pub fn adhesion_factor(reduction: f64, overlap_exponent: f64) -> f64 {
    libm::pow(reduction, -1.0 / (overlap_exponent + 1.0))
}
