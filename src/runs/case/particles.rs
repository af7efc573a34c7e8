//! How the case file says how many particles there are, of what, and where they begin.

use super::sizes::read_diameter;
use super::species::SpeciesSections;
use super::units::Units;
use crate::beds::{Amount, BedFormat, BedStart, ParticleSetup, SizeDistribution, sphere_mass};
use crate::input::Section;
use nalgebra::Vector3;
use std::path::Path;

/// Scales for the conversion of dimensionless groups, as far as they are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    pub(super) density: Option<f64>,
    pub(super) diameter: Option<f64>,
}

impl Scales {
    /// Mass of a particle of the reference diameter.
    pub(super) fn mass(&self) -> Option<f64> {
        Some(sphere_mass(self.density?, self.diameter?))
    }
}

/// An initial arrangement, and T of the random velocities.
struct StartAndTemperature {
    start: Option<BedStart>,
    granular_temperature: f64,
}

/// Reads `[particles]`, and the scales that other sections need even if this one has errors.
pub(super) fn read_particles(
    section: &Section<'_>,
    units: Option<Units>,
    species: &SpeciesSections<'_>,
    folder: &Path,
) -> (Option<ParticleSetup>, Scales) {
    let sizes = read_diameter(section, species);
    let density = read_density(section, units);
    let reference_diameter = read_reference(section, units, sizes.as_ref());
    let scales = Scales { density, diameter: reference_diameter };
    let Some(inner) = section.table("start") else { return (None, scales) };
    let Some(kind) = inner.word("kind") else { return (None, scales) };
    let of_file = matches!(kind, "file" | "run");
    if !of_file {
        section.require("diameter");
    }
    let diameter = section.node.get("diameter");
    if kind == "file" && diameter.is_some_and(|node| node.get("species").is_some()) {
        section.fail("diameter", "species cannot be given: a column of the file says them");
    } else if kind == "file" && sizes.as_ref().is_some_and(SizeDistribution::has_densities) {
        section.fail(
            "diameter",
            "densities cannot be given: which particle of the file is of which class?",
        );
    }
    if !of_file {
        require_species(section, species, sizes.as_ref());
    }
    let amount = read_amount(section, of_file);
    let largest = sizes.as_ref().map(|sizes| sizes.bounds()[1]);
    let StartAndTemperature { start, granular_temperature } =
        read_start(&inner, kind, largest, folder);
    let is_jittered = matches!(start, Some(BedStart::Lattice { jitter, .. }) if jitter > 0.0);
    let is_random = kind == "random"
        || sizes.as_ref().is_some_and(SizeDistribution::is_random)
        || is_jittered
        || granular_temperature > 0.0;
    if is_random {
        section.require("seed");
    }
    let setup = || {
        Some(ParticleSetup {
            amount,
            sizes,
            reference_diameter: reference_diameter?,
            density: density?,
            seed: section.count("seed").unwrap_or(0),
            start: start?,
            granular_temperature,
            species: species.species.clone(),
        })
    };
    (setup(), scales)
}

/// Requires that the case assigns particles to species if there are several.
fn require_species(
    section: &Section<'_>,
    species: &SpeciesSections<'_>,
    sizes: Option<&SizeDistribution>,
) {
    let diameter = section.node.get("diameter");
    let is_said = diameter.is_some_and(|node| node.get("species").is_some());
    if species.species.len() > 1 && sizes.is_some() && !is_said {
        let message = "must be given in classes with their species: { values = [...], fractions = [...], species = [...] }";
        section.fail("diameter", message);
    }
}

fn read_density(section: &Section<'_>, units: Option<Units>) -> Option<f64> {
    let density = section.number("density")?;
    if units == Some(Units::Dimensionless) && density != 1.0 {
        section.fail("density", "must be 1 in dimensionless units, it is their scale");
        return None;
    }
    Some(density)
}

fn read_reference(
    section: &Section<'_>,
    units: Option<Units>,
    sizes: Option<&SizeDistribution>,
) -> Option<f64> {
    const KEY: &str = "reference_diameter";
    let given = section.number(KEY);
    match (units?, sizes) {
        (Units::Dimensionless, _) if given.is_some_and(|diameter| diameter != 1.0) => {
            section.fail(KEY, "must be 1 in dimensionless units, it is their scale");
            None
        }
        (Units::Dimensionless, Some(SizeDistribution::Single(diameter)))
            if !section.has(KEY) && *diameter != 1.0 =>
        {
            let message = "must be 1 in dimensionless units, or reference_diameter = 1.0 be given";
            section.fail("diameter", message);
            Some(1.0)
        }
        (Units::Dimensionless, _) => Some(1.0),
        (Units::Si, _) if section.has(KEY) => given,
        (Units::Si, Some(SizeDistribution::Single(diameter))) => Some(*diameter),
        (Units::Si, None) if section.has("diameter") => None,
        (Units::Si, _) => {
            section.require(KEY);
            None
        }
    }
}

fn read_amount(section: &Section<'_>, of_file: bool) -> Option<Amount> {
    const KEYS: [&str; 2] = ["count", "fill_height"];
    if of_file {
        for key in KEYS.into_iter().filter(|key| section.has(key)) {
            section.fail(key, "cannot be given: the start's file says how many");
        }
        return None;
    }
    section.require("count");
    match section.given(&KEYS)? {
        "count" => section.count("count").map(Amount::Count),
        key => section.number(key).map(Amount::FillHeight),
    }
}

fn read_start(
    section: &Section<'_>,
    kind: &str,
    largest: Option<f64>,
    folder: &Path,
) -> StartAndTemperature {
    let path = || section.text("path").map(|path| folder.join(path));
    let start = || {
        Some(match kind {
            "lattice" => BedStart::Lattice {
                spacing: read_spacing(section, largest)?,
                jitter: section.number("jitter")?,
                bottom: section.number("bottom")?,
            },
            "random" => BedStart::Random {
                solids_fraction: section.number("solids_fraction")?,
                bottom: section.number("bottom")?,
            },
            "file" => {
                let formats = [("csv", BedFormat::Csv), ("lammps", BedFormat::Lammps)];
                let format = section.choice("format", &formats)?;
                let offset = section.vector("offset").map(Vector3::from).unwrap_or_default();
                BedStart::File { path: path()?, format, offset }
            }
            _ => BedStart::Run { path: path()? },
        })
    };
    let velocity = if kind == "run" { None } else { section.table("velocity") };
    let temperature = velocity.and_then(|velocity| velocity.number("granular_temperature"));
    StartAndTemperature { start: start(), granular_temperature: temperature.unwrap_or(0.0) }
}

fn read_spacing(section: &Section<'_>, largest: Option<f64>) -> Option<f64> {
    let spacing = section.number("spacing")?;
    match largest {
        Some(largest) if spacing < largest => {
            section.fail("spacing", format!("must be at least the largest diameter, {largest}"));
            None
        }
        _ => Some(spacing),
    }
}
