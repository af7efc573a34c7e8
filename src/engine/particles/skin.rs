//! The skin of the neighbour lists: wide enough for lists to last, narrow enough for them to hold few pairs.

/// The rule for the skin. It changes how often lists are made, but no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Skin {
    /// Always this separation; length.
    Fixed(f64),
    /// The cheapest skin for the particles' speeds, chosen again for each list.
    FromSpeeds {
        /// Diameter of the largest particles.
        diameter: f64,
    },
}

/// The narrowest and the widest skin that is chosen from speeds, in diameters. A list of the widest skin holds about
/// five times as many pairs as one without a skin.
const NARROWEST: f64 = 0.08;
const WIDEST: f64 = 0.8;

/// Square of the cheapest skin over the displacement in a step, in diameters. Measured on one rank: a skin of 0.1 to
/// 0.25 is cheapest if particles move 1e-4 to 3e-4 d in a step (vibrated and fluidised beds of Moon et al.), one of 0.6
/// and more if they move 5e-3 to 1e-2 d (a bubbling and a spouted bed of glass beads).
const WIDTH_RATIO: f64 = 120.0;

impl Skin {
    /// The narrowest possible skin, for which subdomains must have room; length.
    pub fn narrowest(self) -> f64 {
        match self {
            Self::Fixed(skin) => skin,
            Self::FromSpeeds { diameter } => NARROWEST * diameter,
        }
    }

    /// The cheapest skin if the largest displacement of a particle in a step is `displacement`, and if there is room
    /// for a skin of at most `room`; lengths.
    ///
    /// With s the displacement in a step, a list of skin m lasts for m / 2s steps. The cost 2 s a / m of making lists
    /// and the cost b m of the additional pairs have the least sum for `m^2 = 2 s a / b`.
    pub fn cheapest(self, displacement: f64, room: f64) -> f64 {
        match self {
            Self::Fixed(skin) => skin,
            Self::FromSpeeds { diameter } => {
                let cheapest = (WIDTH_RATIO * diameter * displacement).sqrt();
                cheapest.min(WIDEST * diameter).min(room).max(self.narrowest())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faster_particles_have_a_wider_skin_where_there_is_room() {
        let skin = Skin::FromSpeeds { diameter: 2.0 };
        let room = f64::INFINITY;
        assert_eq!(skin.cheapest(0.0, room), 0.16, "particles at rest: the narrowest");
        let ratio = skin.cheapest(4.0e-3, room) / skin.cheapest(1.0e-3, room);
        assert!((ratio - 2.0).abs() < 1.0e-12, "{ratio}");
        assert_eq!(skin.cheapest(0.1, room), 1.6, "fast particles: the widest");
        assert_eq!(skin.cheapest(0.1, 0.5), 0.5, "no wider than there is room for");
        assert_eq!(skin.cheapest(0.1, -1.0), 0.16, "room for the narrowest has been made sure of");
    }

    #[test]
    fn a_skin_that_is_given_stays() {
        assert_eq!(Skin::Fixed(0.3).cheapest(0.1, 0.01), 0.3);
    }
}
