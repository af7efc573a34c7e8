//! Diameters of particles, and densities where classes differ in them: a number, a list, or a distribution. Drawn by id,
//! so that they depend on the seed alone.

use super::species::SpeciesSections;
use crate::input::Section;
use crate::numbers::{normal, random_of, uniform};
use rand_chacha::ChaCha8Rng;

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
    /// Part of a distribution that must lie between its bounds: the rest is drawn again.
    const LEAST_PART: f64 = 0.05;

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
    fn part_within_bounds(&self) -> f64 {
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
}

/// The key `diameter`, if it is given and right.
pub(super) fn read_diameter(
    section: &Section<'_>,
    species: &SpeciesSections<'_>,
) -> Option<SizeDistribution> {
    let Some(table) = section.table("diameter") else {
        return section.number("diameter").map(SizeDistribution::Single);
    };
    match table.given(&["values", "distribution"])? {
        "values" => read_classes(&table, species),
        _ => read_distribution(&table).filter(|distribution| holds_enough(section, distribution)),
    }
}

fn read_distribution(section: &Section<'_>) -> Option<SizeDistribution> {
    let shape = section.word("distribution")?;
    let (smallest, largest) = (section.number("smallest")?, section.number("largest")?);
    if smallest > largest {
        section.fail("largest", "must be at least smallest");
        return None;
    }
    let deviation = || section.number("deviation");
    Some(match shape {
        "normal" => SizeDistribution::Normal {
            mean: section.number("mean")?,
            deviation: deviation()?,
            smallest,
            largest,
        },
        "log_normal" => SizeDistribution::LogNormal {
            median: section.number("median")?,
            deviation: deviation()?,
            smallest,
            largest,
        },
        _ => SizeDistribution::Uniform { smallest, largest },
    })
}

/// Whether enough of a distribution lies between its bounds; if not, that is reported.
fn holds_enough(section: &Section<'_>, distribution: &SizeDistribution) -> bool {
    let part = distribution.part_within_bounds();
    let least = SizeDistribution::LEAST_PART;
    if part >= least {
        return true;
    }
    let message = "smallest and largest must contain at least";
    section.fail("diameter", format!("{message} {least} of the distribution, not {part:.2e}"));
    false
}

fn read_classes(section: &Section<'_>, species: &SpeciesSections<'_>) -> Option<SizeDistribution> {
    let (values, fractions) = (section.numbers("values")?, section.numbers("fractions")?);
    let densities = section.numbers("densities");
    let species = read_species(section, species)?;
    let lengths = [
        ("fractions", Some(fractions.len())),
        ("densities", densities.as_ref().map(Vec::len)),
        ("species", section.has("species").then_some(species.len())),
    ];
    for (key, length) in lengths {
        if length.is_some_and(|length| length != values.len()) {
            section.fail(key, format!("must be as many as values, {}", values.len()));
            return None;
        }
    }
    let sum: f64 = fractions.iter().sum();
    if (sum - 1.0).abs() > 1.0e-6 {
        section.fail("fractions", format!("must add up to 1, not {sum}"));
    }
    let class = |(number, (&diameter, fraction))| {
        let SpeciesOfClass { species, density } = species.get(number).copied().unwrap_or_default();
        let own = densities.as_ref().map(|densities| densities[number]);
        SizeClass { diameter, fraction, density: own.or(density), species }
    };
    let classes = values.iter().zip(fractions).enumerate().map(class);
    Some(SizeDistribution::Classes(classes.collect()))
}

/// The species of a class of sizes.
#[derive(Clone, Copy, Default)]
struct SpeciesOfClass {
    /// Its number.
    species: usize,
    /// Its density, if it has one of its own.
    density: Option<f64>,
}

/// The species of each class; none if the file does not say them.
fn read_species(section: &Section<'_>, all: &SpeciesSections<'_>) -> Option<Vec<SpeciesOfClass>> {
    const KEY: &str = "species";
    if !section.has(KEY) {
        return Some(Vec::new());
    }
    let mut read = Vec::new();
    for name in section.texts(KEY)? {
        let Some(species) = all.number_of(&name) else {
            section.fail(KEY, all.unknown(&name));
            return None;
        };
        let density = all.species[species].density;
        if density.is_some() && section.has("densities") {
            let message = format!("cannot be given: species {name:?} has a density of its own");
            section.fail("densities", message);
        }
        read.push(SpeciesOfClass { species, density });
    }
    Some(read)
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
