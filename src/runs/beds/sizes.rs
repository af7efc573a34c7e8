//! Diameters of particles, and densities where classes differ in them: a number, a list, or a distribution. Drawn by id,
//! so that they depend on the seed alone.

use rand_chacha::ChaCha8Rng;
use talcum_engine::numbers::{normal, random_of, uniform};

/// Particles of one diameter and density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeClass {
    /// Their diameter.
    pub diameter: f64,
    /// Their part of all particles, by number.
    pub fraction: f64,
    /// Their density, if it is not that of the case.
    pub density: Option<f64>,
    /// Number of their species.
    pub species: usize,
}

/// How diameters are distributed over particles, by number.
#[derive(Clone, Debug, PartialEq)]
pub enum SizeDistribution {
    /// All the same.
    Single(f64),
    /// A few classes, whose number fractions add up to 1.
    Classes(Vec<SizeClass>),
    /// Equally likely between two diameters.
    Uniform {
        /// Lower bound.
        smallest: f64,
        /// Upper bound.
        largest: f64,
    },
    /// Normal, drawn again outside the bounds.
    Normal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation.
        deviation: f64,
        /// Lower bound.
        smallest: f64,
        /// Upper bound.
        largest: f64,
    },
    /// ln d is normal, drawn again outside the bounds.
    LogNormal {
        /// Median before truncation.
        median: f64,
        /// Standard deviation of ln d before truncation.
        deviation: f64,
        /// Lower bound.
        smallest: f64,
        /// Upper bound.
        largest: f64,
    },
}

impl SizeDistribution {
    /// The diameter of a particle.
    pub fn diameter_of(&self, seed: u64, id: u64) -> f64 {
        let mut generator = match self {
            Self::Single(diameter) => return *diameter,
            _ => random_of(seed, id, "diameter"),
        };
        match self {
            Self::Single(diameter) => *diameter,
            Self::Classes(classes) => drawn(classes, &mut generator).diameter,
            Self::Uniform { smallest, largest } => {
                let diameter = smallest + (largest - smallest) * uniform(&mut generator);
                diameter.min(*largest)
            }
            Self::Normal { mean, deviation, smallest, largest } => loop {
                let diameter = mean + deviation * normal(&mut generator);
                if (*smallest..=*largest).contains(&diameter) {
                    return diameter;
                }
            },
            Self::LogNormal { median, deviation, smallest, largest } => loop {
                let diameter = median * libm::exp(deviation * normal(&mut generator));
                if (*smallest..=*largest).contains(&diameter) {
                    return diameter;
                }
            },
        }
    }

    /// The class of a particle; `None` if sizes are not in classes.
    pub fn class_of(&self, seed: u64, id: u64) -> Option<&SizeClass> {
        match self {
            Self::Classes(classes) => Some(drawn(classes, &mut random_of(seed, id, "diameter"))),
            _ => None,
        }
    }

    /// The classes; none if sizes are not in classes.
    pub fn classes(&self) -> &[SizeClass] {
        match self {
            Self::Classes(classes) => classes,
            _ => &[],
        }
    }

    /// The smallest and the largest diameter that can occur.
    pub fn bounds(&self) -> [f64; 2] {
        match self {
            Self::Single(diameter) => [*diameter; 2],
            Self::Classes(classes) => {
                let diameters = classes.iter().map(|class| class.diameter);
                [diameters.clone().fold(f64::INFINITY, f64::min), diameters.fold(0.0, f64::max)]
            }
            Self::Uniform { smallest, largest }
            | Self::Normal { smallest, largest, .. }
            | Self::LogNormal { smallest, largest, .. } => [*smallest, *largest],
        }
    }

    /// Whether classes have densities of their own.
    pub fn has_densities(&self) -> bool {
        self.classes().iter().any(|class| class.density.is_some())
    }

    /// Whether random numbers are drawn.
    pub fn is_random(&self) -> bool {
        !matches!(self, Self::Single(_))
    }

    /// Part of the distribution, before truncation, between its bounds.
    pub fn part_within_bounds(&self) -> f64 {
        let below = |x: f64| 0.5 * (1.0 + libm::erf(x / std::f64::consts::SQRT_2));
        match self {
            Self::Normal { mean, deviation, smallest, largest } => {
                below((largest - mean) / deviation) - below((smallest - mean) / deviation)
            }
            Self::LogNormal { median, deviation, smallest, largest } => {
                below(libm::log(largest / median) / deviation)
                    - below(libm::log(smallest / median) / deviation)
            }
            _ => 1.0,
        }
    }

    /// All diameters multiplied by a factor.
    pub(super) fn enlarged(self, factor: f64) -> Self {
        let class = |class: SizeClass| SizeClass { diameter: factor * class.diameter, ..class };
        match self {
            Self::Single(diameter) => Self::Single(factor * diameter),
            Self::Classes(classes) => Self::Classes(classes.into_iter().map(class).collect()),
            Self::Uniform { smallest, largest } => {
                Self::Uniform { smallest: factor * smallest, largest: factor * largest }
            }
            Self::Normal { mean, deviation, smallest, largest } => Self::Normal {
                mean: factor * mean,
                deviation: factor * deviation,
                smallest: factor * smallest,
                largest: factor * largest,
            },
            Self::LogNormal { median, deviation, smallest, largest } => Self::LogNormal {
                median: factor * median,
                deviation,
                smallest: factor * smallest,
                largest: factor * largest,
            },
        }
    }
}

/// One of some classes, as often as its fraction says.
fn drawn<'c>(classes: &'c [SizeClass], generator: &mut ChaCha8Rng) -> &'c SizeClass {
    let mut rest = uniform(generator);
    let class = classes.iter().find(|class| {
        rest -= class.fraction;
        rest < 0.0
    });
    // Rounding may leave a rest.
    class.unwrap_or(&classes[classes.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_of(sizes: &SizeDistribution) -> f64 {
        let [smallest, largest] = sizes.bounds();
        let count = 4000;
        let diameters = (0..count).map(|id| sizes.diameter_of(3, id)).inspect(|diameter| {
            assert!((smallest..=largest).contains(diameter));
        });
        diameters.sum::<f64>() / count as f64
    }

    #[test]
    fn means_are_those_of_the_distributions() {
        // 4 standard deviations (about 0.1) of the mean of 4000: 0.0063.
        let tolerance = 0.0065;
        let (smallest, largest) = (0.8, 1.2);
        let class =
            |diameter, fraction| SizeClass { diameter, fraction, density: None, species: 0 };
        let classes = SizeDistribution::Classes(vec![class(0.9, 0.75), class(1.1, 0.25)]);
        assert!((mean_of(&classes) - 0.95).abs() < tolerance);
        let uniform = SizeDistribution::Uniform { smallest, largest };
        assert!((mean_of(&uniform) - 1.0).abs() < 1.2 * tolerance);
        let normal = SizeDistribution::Normal { mean: 1.0, deviation: 0.1, smallest, largest };
        assert!((mean_of(&normal) - 1.0).abs() < tolerance);
        let log = SizeDistribution::LogNormal { median: 1.0, deviation: 0.1, smallest, largest };
        assert!((mean_of(&log) - 1.0).abs() < tolerance);
        assert!((log.part_within_bounds() - 0.953).abs() < 0.01);
    }
}
