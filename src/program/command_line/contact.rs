//! `talcum contact`: the force of a contact over its overlap, as a table.

use super::reading::read_case;
use super::run::say;
use anyhow::anyhow;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use talcum_engine::contact::{ContactForceLaw, force_loop};
use talcum_engine::fields::Unit;
use talcum_engine::parallel::Communicator;
use talcum_engine::rules::ReducedBody;
use talcum_results::output::ColumnUnits;
use talcum_runs::case::{Case, Stage};

/// Overlap over diameter by default.
const OVERLAP: f64 = 1.0e-3;

#[derive(Debug, Args)]
pub(super) struct ContactOptions {
    /// The case file.
    case: PathBuf,
    /// Set a key of the case to this value; may be repeated.
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Press a particle against this wall, instead of against another particle.
    #[arg(long, value_name = "NAME")]
    wall: Option<String>,
    /// Take particles of this species, or one of each of two species, NAME,NAME (default: the first species of the case).
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    species: Vec<String>,
    /// Take the laws of this stage (default: the first).
    #[arg(long, value_name = "NAME")]
    stage: Option<String>,
    /// Press to this overlap (default: a thousandth of the reference diameter, or twice the length of a neck if that is more).
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    overlap: Option<f64>,
    /// Print so many points on each of the four parts: half loading, unloading, full loading, separation.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    points: u32,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("must be a number above 0".to_owned()),
    }
}

/// Prints the table. Collective.
pub(super) fn contact(options: &ContactOptions, ranks: &dyn Communicator) -> anyhow::Result<()> {
    let case = read_case(&options.case, &options.set, ranks)?;
    let stage = stage_of(&case, options.stage.as_deref())?;
    let wall = options.wall.as_deref().map(|name| wall_of(&case, name)).transpose()?;
    let partners = Partners { species: species_of(&case, options)?, wall };
    say(ranks, table(&case, stage, &partners, options).trim_end())
}

fn stage_of<'a>(case: &'a Case, name: Option<&str>) -> anyhow::Result<&'a Stage> {
    let Some(name) = name else { return Ok(&case.stages[0]) };
    case.stages.iter().find(|stage| stage.name == name).ok_or_else(|| {
        let names: Vec<String> =
            case.stages.iter().map(|stage| format!("{:?}", stage.name)).collect();
        anyhow!("--stage {name}: there is no such stage; there are {}", names.join(", "))
    })
}

fn wall_of(case: &Case, name: &str) -> anyhow::Result<usize> {
    case.domain.walls.iter().position(|wall| wall.name == name).ok_or_else(|| {
        let names: Vec<String> =
            case.domain.walls.iter().map(|wall| format!("{:?}", wall.name)).collect();
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        anyhow!("--wall {name}: there is no such wall; there are {names}")
    })
}

/// Two particles of these species, or one of the first species and the wall with a number.
struct Partners {
    species: [usize; 2],
    wall: Option<usize>,
}

fn species_of(case: &Case, options: &ContactOptions) -> anyhow::Result<[usize; 2]> {
    let number = |name: &String| {
        let species = &case.particles.species;
        species.iter().position(|species| species.name == *name).ok_or_else(|| {
            let names: Vec<&str> = species.iter().map(|species| species.name.as_str()).collect();
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            anyhow!("--species {name}: there is no such species; there are {names}")
        })
    };
    let numbers = options.species.iter().map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [] => Ok([0, 0]),
        [one] => Ok([one, one]),
        [one, other] if options.wall.is_none() => Ok([one, other]),
        _ => Err(anyhow!("--species: name one or two species, at a wall one")),
    }
}

/// Comments, a line of names with units, and a row for each point.
fn table(case: &Case, stage: &Stage, partners: &Partners, options: &ContactOptions) -> String {
    let Partners { species, wall } = *partners;
    let physics = &stage.physics;
    let at_wall = wall.is_some();
    let contact = match wall {
        Some(number) => physics.at_walls[number].of(species[0]),
        None => physics.contact.of(species),
    };
    let diameter = case.particles.reference_diameter;
    let radius = 0.5 * diameter;
    let masses = species.map(|species| case.particles.reference_mass(species));
    let bodies = if at_wall {
        ReducedBody::of_sphere_and_wall(masses[0], radius)
    } else {
        ReducedBody::of_spheres(masses, [radius; 2])
    };
    let cohesion = physics.cohesion.as_ref().map(|cohesion| cohesion.of(species).at(stage.start));
    let attraction = |separation: f64| match &cohesion {
        Some(cohesion) if at_wall => cohesion.to_wall(radius, separation),
        Some(cohesion) => cohesion.between_particles(radius, radius, separation),
        None => 0.0,
    };
    let range = cohesion.map_or(0.0, |cohesion| cohesion.range());
    let default = (OVERLAP * diameter).max(2.0 * contact.law.contact_range(bodies.radius));
    let overlap = options.overlap.unwrap_or(default);
    let points = options.points as usize;
    let points = force_loop(
        &contact.law,
        (bodies.mass, bodies.radius),
        overlap,
        points,
        (&attraction, range),
    );
    let other = options
        .wall
        .as_ref()
        .map_or("two particles".to_owned(), |wall| format!("a particle and wall \"{wall}\""));
    let mut message = format!("# talcum {}\n# title: {}\n", env!("CARGO_PKG_VERSION"), case.title);
    let _ =
        writeln!(message, "# contact: {other} of diameter {diameter}, stage \"{}\"", stage.name);
    let units = ColumnUnits::of_system(case.units.name());
    let [length, force] = [Unit::Length, Unit::Force].map(|unit| units.of(unit));
    let _ = writeln!(message, "overlap [{length}],force [{force}],part [1]");
    for point in points {
        let _ = writeln!(message, "{:?},{:?},{}", point.overlap, point.force, point.part);
    }
    message
}
