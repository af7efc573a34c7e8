//! How many particles there are, of what, and where they begin.

use super::allowed::Allowed;
use super::section::Section;
use super::sizes::{SizeDistribution, read_diameter};
use super::units::Units;
use crate::state::SizeRange;
use nalgebra::Vector3;
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// The particles as the case describes them.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSetup {
    /// How many; `None` if a file says it.
    pub amount: Option<Amount>,
    /// Diameters; `None` if a file says them.
    pub sizes: Option<SizeDistribution>,
    /// Diameter that Bond and Stokes number refer to.
    pub reference_diameter: f64,
    /// Solid density.
    pub density: f64,
    /// Seed of all random numbers; 0 if none are drawn.
    pub seed: u64,
    /// Where they begin.
    pub start: Start,
    /// T of the random velocities at the start, the variance of each component.
    pub granular_temperature: f64,
}

/// How many particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// This many.
    Count(u64),
    /// As many as fit below this height.
    FillHeight(f64),
}

/// Where the particles begin.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Layers of a simple cubic lattice.
    Lattice {
        /// Least distance of neighbouring sites.
        spacing: f64,
        /// Random displacement over the largest one without contact.
        jitter: f64,
        /// Height of the lowest layer's underside.
        bottom: f64,
    },
    /// Random, loose, without overlap.
    Random {
        /// Solids fraction.
        solids_fraction: f64,
        /// Height of the bed's underside.
        bottom: f64,
    },
    /// The rows of a file.
    File {
        /// Its path.
        path: PathBuf,
        /// Its format.
        format: BedFormat,
        /// Added to all positions.
        offset: Vector3<f64>,
    },
    /// The end of another run.
    Run {
        /// Path of its checkpoint.
        path: PathBuf,
    },
}

/// Formats of files that hold a bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BedFormat {
    /// A table with a header.
    Csv,
    /// A dump of LAMMPS or LIGGGHTS; its last frame.
    Lammps,
}

impl ParticleSetup {
    /// Mass of a sphere of this diameter, rho_s pi d^3 / 6.
    pub fn mass_of(&self, diameter: f64) -> f64 {
        sphere_mass(self.density, diameter)
    }

    /// The range that sizes can have; `None` if a file says it.
    pub fn size_range(&self) -> Option<SizeRange> {
        if !matches!(self.start, Start::Lattice { .. } | Start::Random { .. }) {
            return None;
        }
        let [smallest_diameter, largest_diameter] = self.sizes.as_ref()?.bounds();
        let largest_mass = self.mass_of(largest_diameter);
        Some(SizeRange { smallest_diameter, largest_diameter, largest_mass })
    }
}

/// rho_s pi d^3 / 6.
pub(super) fn sphere_mass(density: f64, diameter: f64) -> f64 {
    density * PI / 6.0 * diameter * diameter * diameter
}

/// What the conversion of dimensionless groups needs, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    pub(super) density: Option<f64>,
    pub(super) diameter: Option<f64>,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Lattice,
    Random,
    File,
    Run,
}

impl Kind {
    fn is_file(self) -> bool {
        matches!(self, Self::File | Self::Run)
    }
}

/// `[particles]`, and the scales that other sections need even if this one has errors.
pub(super) fn read_particles(
    section: Section<'_>,
    units: Option<Units>,
    folder: &Path,
) -> (Option<ParticleSetup>, Scales) {
    let sizes = read_diameter(&section);
    let density = read_density(&section, units);
    let reference_diameter = read_reference(&section, units, sizes.as_ref());
    let scales = Scales { density, diameter: reference_diameter };
    let start_section = section.section("start");
    let kind = start_section.as_ref().and_then(|start| start.value::<Kind>("kind"));
    if !section.has("diameter") && kind.is_some_and(|kind| !kind.is_file()) {
        section.fail("diameter", "missing: must be a number above 0, or a distribution { ... }");
    }
    let amount = kind.and_then(|kind| read_amount(&section, kind));
    let seed = section.optional_count("seed", 0..u64::MAX);
    let largest = sizes.as_ref().map(|sizes| sizes.bounds()[1]);
    let start =
        start_section.zip(kind).map(|(inner, kind)| read_start(inner, kind, largest, folder));
    // Known keys, even if the kind of start is not known.
    section.get("count");
    section.get("fill_height");
    let is_random = kind == Some(Kind::Random)
        || sizes.as_ref().is_some_and(SizeDistribution::is_random)
        || start.as_ref().is_some_and(draws_random_numbers);
    if is_random && !section.has("seed") {
        section.fail("seed", "missing: must be a whole number, since random numbers are drawn");
    }
    section.finish();
    let setup = start.and_then(|(start, granular_temperature)| {
        Some(ParticleSetup {
            amount,
            sizes,
            reference_diameter: reference_diameter?,
            density: density?,
            seed: seed.unwrap_or(0),
            start: start?,
            granular_temperature,
        })
    });
    (setup, scales)
}

/// Whether a start, with its granular temperature, needs random numbers by what its keys say.
fn draws_random_numbers((start, temperature): &(Option<Start>, f64)) -> bool {
    let is_jittered = matches!(start, Some(Start::Lattice { jitter, .. }) if *jitter > 0.0);
    is_jittered || *temperature > 0.0
}

fn read_density(section: &Section<'_>, units: Option<Units>) -> Option<f64> {
    let density = section.number("density", Allowed::POSITIVE)?;
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
    let given = section.optional_number("reference_diameter", Allowed::POSITIVE);
    let is_given = section.has("reference_diameter");
    match units? {
        Units::Dimensionless if is_given && given.is_some_and(|diameter| diameter != 1.0) => {
            section
                .fail("reference_diameter", "must be 1 in dimensionless units, it is their scale");
            None
        }
        Units::Dimensionless => {
            if let (false, Some(SizeDistribution::Single(diameter))) = (is_given, sizes)
                && *diameter != 1.0
            {
                let words =
                    "must be 1 in dimensionless units, or reference_diameter = 1.0 be given";
                section.fail("diameter", words);
            }
            Some(1.0)
        }
        Units::Si => match sizes {
            _ if is_given => given,
            Some(SizeDistribution::Single(diameter)) => Some(*diameter),
            None if section.has("diameter") => None,
            _ => {
                let words = "missing: must be above 0, since diameters differ or come from a file";
                section.fail("reference_diameter", words);
                None
            }
        },
    }
}

fn read_amount(section: &Section<'_>, kind: Kind) -> Option<Amount> {
    const KEYS: [&str; 2] = ["count", "fill_height"];
    if kind.is_file() {
        for key in KEYS.into_iter().filter(|key| section.has(key)) {
            section.fail(key, "cannot be given: the start's file says how many");
        }
        return None;
    }
    match section.exactly_one(&KEYS)? {
        "count" => section.optional_count("count", 1..1_000_000_001).map(Amount::Count),
        key => section.optional_number(key, Allowed::POSITIVE).map(Amount::FillHeight),
    }
}

fn read_start(
    section: Section<'_>,
    kind: Kind,
    largest: Option<f64>,
    folder: &Path,
) -> (Option<Start>, f64) {
    let bottom = || {
        section.note_default("bottom", "0, the bed begins on the floor of the box");
        section.number_or("bottom", Allowed::NOT_NEGATIVE, 0.0)
    };
    let start = match kind {
        Kind::Lattice => {
            section.note_default("jitter", "0, an exact lattice");
            let jitter = section.number_or("jitter", Allowed::from_to_below(0.0, 1.0), 0.0);
            let bottom = bottom();
            read_spacing(&section, largest).map(|spacing| Start::Lattice {
                spacing,
                jitter,
                bottom,
            })
        }
        Kind::Random => {
            let solids_fraction = section.number("solids_fraction", Allowed::positive_up_to(0.3));
            let bottom = bottom();
            solids_fraction.map(|solids_fraction| Start::Random { solids_fraction, bottom })
        }
        Kind::File => read_file(&section, folder),
        Kind::Run => section.text("path").map(|path| Start::Run { path: folder.join(path) }),
    };
    let temperature = if kind == Kind::Run { 0.0 } else { read_temperature(&section) };
    section.finish();
    (start, temperature)
}

fn read_spacing(section: &Section<'_>, largest: Option<f64>) -> Option<f64> {
    let spacing = section.number("spacing", Allowed::POSITIVE)?;
    match largest {
        Some(largest) if spacing < largest => {
            section.fail("spacing", format!("must be at least the largest diameter, {largest}"));
            None
        }
        _ => Some(spacing),
    }
}

fn read_file(section: &Section<'_>, folder: &Path) -> Option<Start> {
    let path = section.text("path");
    let format = section.value("format");
    let offset = match section.has("offset") {
        true => section.numbers("offset", Allowed::FINITE),
        false => Some(vec![0.0; 3]),
    };
    let offset = offset.filter(|offset| {
        if offset.len() != 3 {
            section.fail("offset", "must be a list of 3 numbers");
        }
        offset.len() == 3
    });
    let offset = Vector3::from_column_slice(&offset?);
    Some(Start::File { path: folder.join(path?), format: format?, offset })
}

fn read_temperature(section: &Section<'_>) -> f64 {
    let Some(velocity) = section.optional_section("velocity") else { return 0.0 };
    let temperature = velocity.number("granular_temperature", Allowed::NOT_NEGATIVE);
    velocity.finish();
    temperature.unwrap_or(0.0)
}
