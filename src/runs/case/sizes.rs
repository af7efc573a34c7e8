//! How the case file says the sizes of particles.

use super::species::SpeciesSections;
use crate::beds::{SizeClass, SizeDistribution};
use crate::input::Section;

/// Smallest fraction of a distribution that must lie between its bounds: the rest is drawn again.
const LEAST_PART: f64 = 0.05;

/// Reads the key `diameter`; `None` if it is missing or wrong.
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

/// Whether a sufficient fraction of a distribution lies between its bounds; an error is reported if not.
fn holds_enough(section: &Section<'_>, distribution: &SizeDistribution) -> bool {
    let part = distribution.part_within_bounds();
    if part >= LEAST_PART {
        return true;
    }
    let message = "smallest and largest must contain at least";
    section.fail("diameter", format!("{message} {LEAST_PART} of the distribution, not {part:.2e}"));
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
    /// Its density, if it has its own.
    density: Option<f64>,
}

/// The species of each class; `None` if the file does not give them.
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
