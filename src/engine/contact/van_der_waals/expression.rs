//! Expressions for the attraction as a function of the separation.

use super::VanDerWaalsNow;

/// Expression of the force at a separation s between surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CohesionExpression {
    /// A r / (12 s^2) with r = 2 r_i r_j / (r_i + r_j): the limit s << r.
    NearContact,
    /// Hamaker's expression for two spheres at any separation.
    Full,
    /// Near contact of rough spheres: A r / (12 s^2) [a / (a + r) + (s / (s + a))^2]. A hemispherical asperity of
    /// radius a stands between the surfaces; the first term is its attraction, the second that of the spheres behind it
    /// (Rumpf).
    Rough {
        /// Radius a of the asperities.
        asperity_radius: f64,
    },
}

impl CohesionExpression {
    /// Ratio of the force on rough spheres, or on a rough sphere and a wall, to that on smooth ones, at a separation s;
    /// r = 2 r_i r_j / (r_i + r_j), or the radius of the sphere at a wall. It is 1 if they are smooth.
    ///
    /// ```
    /// # use talcum_engine as talcum;
    /// use talcum::contact::CohesionExpression::{NearContact, Rough};
    /// let rough = Rough { asperity_radius: 1.0e-2 };
    /// assert!((rough.roughness_factor(0.5, 1.0e-5) - 1.0 / 51.0).abs() < 2.0e-6); // (s / a)^2 = 1e-6
    /// assert_eq!(NearContact.roughness_factor(0.5, 1.0e-5), 1.0);
    /// ```
    #[inline(always)]
    pub fn roughness_factor(self, radius: f64, separation: f64) -> f64 {
        match self {
            Self::NearContact | Self::Full => 1.0,
            Self::Rough { asperity_radius } => {
                roughness_factor(asperity_radius, radius, separation)
            }
        }
    }
}

#[inline(always)]
fn roughness_factor(asperity: f64, radius: f64, s: f64) -> f64 {
    let behind = s / (s + asperity);
    asperity / (asperity + radius) + behind * behind
}

/// An attraction between two spheres whose surfaces are `separation` apart (negative: overlap).
pub(crate) trait Attraction: Copy {
    /// Separation below which the attraction no longer grows.
    fn cut_off(&self) -> f64;

    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64;
}

/// A r / (12 s^2), r = 2 r_1 r_2 / (r_1 + r_2).
#[derive(Clone, Copy)]
pub(crate) struct NearContact(pub(crate) VanDerWaalsNow);

/// Hamaker's expression.
#[derive(Clone, Copy)]
pub(crate) struct Full(pub(crate) VanDerWaalsNow);

/// A r / (12 s^2) times the factor of asperities.
#[derive(Clone, Copy)]
pub(crate) struct Rough {
    pub(crate) smooth: NearContact,
    pub(crate) asperity_radius: f64,
}

impl Attraction for NearContact {
    #[inline(always)]
    fn cut_off(&self) -> f64 {
        self.0.cut_off
    }

    #[inline(always)]
    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let s = if separation > self.0.cut_off { separation } else { self.0.cut_off };
        let force =
            self.0.hamaker * (radius_1 * radius_2) / (6.0 * (radius_1 + radius_2) * (s * s));
        if separation > self.0.range { 0.0 } else { force }
    }
}

impl Attraction for Full {
    #[inline(always)]
    fn cut_off(&self) -> f64 {
        self.0.cut_off
    }

    #[inline(always)]
    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let s = if separation > self.0.cut_off { separation } else { self.0.cut_off };
        let force = self.0.hamaker * hamaker_full(radius_1, radius_2, s);
        if separation > self.0.range { 0.0 } else { force }
    }
}

impl Attraction for Rough {
    #[inline(always)]
    fn cut_off(&self) -> f64 {
        self.smooth.cut_off()
    }

    #[inline(always)]
    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let cut_off = self.cut_off();
        let s = if separation > cut_off { separation } else { cut_off };
        let radius = 2.0 * (radius_1 * radius_2) / (radius_1 + radius_2);
        self.smooth.between(radius_1, radius_2, separation)
            * roughness_factor(self.asperity_radius, radius, s)
    }
}

/// Force divided by the Hamaker constant (Moon 2006 eq. (4)):
///
/// ```math
/// \frac{2 r_1 r_2 (s + r_1 + r_2)}{3 p^2} \left[ \frac{p}{p + 4 r_1 r_2} - 1 \right]^2, \qquad p = s (s + 2 r_1 + 2 r_2)
/// ```
#[inline(always)]
pub(super) fn hamaker_full(radius_1: f64, radius_2: f64, s: f64) -> f64 {
    let product = radius_1 * radius_2;
    let near = s * (s + 2.0 * (radius_1 + radius_2));
    let far = near + 4.0 * product; // (s + r_1 + r_2)^2 - (r_1 - r_2)^2
    let bracket = 4.0 * product / (far * near);
    2.0 / 3.0 * product * (s + radius_1 + radius_2) * bracket * bracket
}
