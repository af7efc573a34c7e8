//! Rules by which the value of a key for two bodies of different species follows from those of each species.

/// A rule of mixing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mixing {
    /// No rule: the two species have the same value, or the pair is given one of its own.
    None,
    /// Geometric mean, sqrt(a b): it applies to strengths of attraction, such as Hamaker constants (Israelachvili 2011,
    /// section 13.9) and works of adhesion (Good and Girifalco 1960), and to coefficients, for which the value of a
    /// pair is 0 if either value is 0.
    Geometric,
    /// 2 a b / (a + b): springs in series, each of half the stiffness of the pair.
    Springs,
    /// A property of a body, not of a pair: the law takes both values, or it acts only at walls.
    OfBody,
}

impl Mixing {
    /// The value of a pair; `None` if there is no rule.
    pub fn mixed(self, one: f64, other: f64) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Geometric => Some((one * other).sqrt()),
            Self::Springs if one + other == 0.0 => Some(0.0),
            Self::Springs => Some(2.0 * one * other / (one + other)),
            Self::OfBody => Some(one),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Mixing;

    #[test]
    fn a_species_mixed_with_itself_is_itself() {
        for rule in [Mixing::Geometric, Mixing::Springs, Mixing::OfBody] {
            assert_eq!(rule.mixed(0.25, 0.25), Some(0.25));
        }
        assert_eq!(Mixing::None.mixed(0.25, 0.25), None);
        assert_eq!(Mixing::Geometric.mixed(4.0, 9.0), Some(6.0));
        assert_eq!(Mixing::Springs.mixed(2.0, 6.0), Some(3.0));
        assert_eq!(Mixing::Springs.mixed(0.0, 0.0), Some(0.0));
    }
}
