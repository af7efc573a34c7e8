//! `talcum check`: description of a run in numbers.

mod adhesion;
mod bed;
mod gas;
mod lines;
mod mesh;
mod particle;
mod partners;
mod stage;
mod trial;

use super::Changes;
use super::memory;
use super::progress::readable;
use super::reading::read_case;
use super::report::six_digits;
use super::run::say;
use bed::BedAtRest;
use lines::Lines;
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;
use std::path::Path;
use talcum_engine::contact::Kept;
use talcum_engine::domain::{Bend, Face, Surface, Wall, WallMotion, WallRotation, WallShape};
use talcum_engine::fields::Unit;
use talcum_engine::parallel::Communicator;
use talcum_engine::state::SizeRange;
use talcum_results::output::ColumnUnits;
use talcum_runs::case::Case;
use talcum_runs::simulation::{InitialState, start_from_case};
use trial::{Trials, try_steps};

/// Reads, validates and describes a case. Collective.
pub(super) fn check(
    path: &Path,
    changes: &Changes,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let case = read_case(path, &changes.set, ranks)?;
    memory::require(&case, changes.any_memory, ranks)?;
    let initial = start_from_case(&case, changes.ranks, ranks)?;
    let particles = ranks.total(initial.state.particles.owned_count());
    let sizes = initial.state.sizes;
    let mut message = super::report::head(&case, particles, ranks.size());
    describe_parcels(&mut message, &case);
    describe_box(&mut message, &case, &sizes);
    let bed = BedAtRest::of(&case, &initial.state, ranks);
    bed.describe(&mut Lines(&mut message), &case, &sizes);
    for number in 0..case.stages.len() {
        stage::describe(&mut message, &case, number, &sizes);
        bed.describe_overlaps(&mut Lines(&mut message), &case, &case.stages[number]);
    }
    describe_ranks(&mut message, &initial, ranks);
    let megabytes = 1.0e-6 * memory::needed(&case, Some(particles as f64), ranks);
    let _ = writeln!(message, "memory: about {megabytes:.0} MB in all");
    // This comes before the trial, since it helps if the trial fails.
    say(ranks, message.trim_end())?;
    let trials = try_steps(&case, initial, changes.ranks, ranks)?;
    say(ranks, describe_trials(&case, &trials, ranks).trim_end())
}

fn describe_trials(case: &Case, trials: &Trials, ranks: &dyn Communicator) -> String {
    let mut message = String::new();
    for (stage, error) in &trials.stopped {
        let text = format!("stage \"{stage}\", tried in a dense bed: {error}");
        Lines(&mut message).warn(&text);
    }
    let steps: f64 =
        case.stages.iter().map(|stage| (stage.end - stage.start) / stage.physics.time_step).sum();
    let (total, on_ranks) =
        (readable(trials.seconds), super::report::count_of(ranks.size(), "rank"));
    let pace = if trials.dense { "of each stage in a dense bed" } else { "of the first steps" };
    let _ = writeln!(
        message,
        "estimated run time: about {total} for {steps:.0} steps, at the pace {pace} on {on_ranks} of this machine"
    );
    message
}

/// Describes the bodies of the run if they are parcels.
fn describe_parcels(message: &mut String, case: &Case) {
    let Some(parcels) = &case.coarse_graining else { return };
    let unit = ColumnUnits::of_system(case.units.name()).of(Unit::Length);
    let diameter = case.particle_diameter(case.particles.reference_diameter);
    let kept = match parcels.keeps {
        Kept::Strength => {
            format!("the Bond number of parcels is 1/{} of theirs", parcels.factor)
        }
        Kept::BondNumber => {
            format!("the tensile strength of parcels is {} times theirs", parcels.factor)
        }
    };
    let _ = writeln!(
        message,
        "parcels: {} particles of diameter {diameter:.4e} {unit} in each; {kept}; dimensionless groups of the gas refer to the \
         particles, everything else to the parcels",
        parcels.particles()
    );
}

fn describe_box(message: &mut String, case: &Case, sizes: &SizeRange) {
    let bounds = &case.domain.bounds;
    let d = sizes.largest_diameter;
    let lengths = bounds.lengths();
    let in_diameters = lengths / d;
    let _ = writeln!(
        message,
        "box: {} x {} x {} {} ({:.3} x {:.3} x {:.3} of the largest diameter)",
        six_digits(lengths.x),
        six_digits(lengths.y),
        six_digits(lengths.z),
        ColumnUnits::of_system(case.units.name()).of(Unit::Length),
        in_diameters.x,
        in_diameters.y,
        in_diameters.z
    );
    for axis in 0..3 {
        let face = |kind| match kind {
            Face::Periodic => "periodic",
            Face::Wall => "wall",
            Face::Open => "open: particles leave and are counted",
            Face::Stop => "stop (a particle that leaves ends the run)",
        };
        let [lower, upper] = bounds.faces(axis).map(face);
        let axis = ["x", "y", "z"][axis];
        let _ = writeln!(message, "  {axis}: lower {lower}, upper {upper}");
    }
    for wall in &case.domain.walls {
        let _ = writeln!(
            message,
            "  wall \"{}\" {}",
            wall.name,
            describe_wall(wall, case.domain.bounds.lengths().norm())
        );
    }
}

/// Position and motion of a wall.
fn describe_wall(wall: &Wall, box_size: f64) -> String {
    let mut message = match &wall.shape {
        WallShape::Plane { point: p, normal: n } => format!(
            "through ({}, {}, {}), normal ({:.4}, {:.4}, {:.4})",
            six_digits(p.x),
            six_digits(p.y),
            six_digits(p.z),
            n.x,
            n.y,
            n.z
        ),
        WallShape::Cylinder { centre, radius } => {
            format!("round about ({}, {}), radius {radius}, particles inside", centre.x, centre.y)
        }
        WallShape::Limited(surface) => describe_surface(surface, box_size),
    };
    let WallMotion { velocity: v, amplitude: a, frequency, start, end } = wall.motion;
    if !wall.motion.is_rest() {
        let _ = write!(message, ", velocity ({}, {}, {})", v.x, v.y, v.z);
        let _ = write!(message, ", amplitude ({}, {}, {}) at {frequency}", a.x, a.y, a.z);
        let _ = write!(message, ", from {start} to {end}");
    }
    if let Some(rotation) = &wall.rotation {
        message += &describe_rotation(rotation);
    }
    message
}

/// Axis, speed and times of a rotation.
fn describe_rotation(rotation: &WallRotation) -> String {
    let WallRotation { axis, speed, ramp, amplitude, frequency, start, end } = rotation;
    let [direction, through] = [&axis.direction, &axis.point].map(point);
    let mut message = format!(", turns about {direction} through {through} at {speed}");
    if *ramp > 0.0 {
        let _ = write!(message, " after a ramp of {ramp}");
    }
    if *amplitude != 0.0 {
        let degrees = six_digits(amplitude.to_degrees());
        let _ = write!(message, ", amplitude {degrees} degrees at {frequency}");
    }
    let _ = write!(message, ", from {start} to {end}");
    message
}

/// Kind, place and size of a surface in a box of this size.
fn describe_surface(surface: &Surface, box_size: f64) -> String {
    match surface {
        Surface::Mesh(mesh) => mesh::describe_mesh(mesh, box_size),
        Surface::Rectangle { centre, half_edges: [one, other] } => format!(
            "rectangle about {}, edges {} and {}",
            point(centre),
            point(&(one * 2.0)),
            point(&(other * 2.0))
        ),
        Surface::Revolved { axis, ends: [first, last] } => {
            let place = |end: &Vector2<f64>| point(&(axis.point + axis.direction * end.x));
            if first.x == last.x {
                let (hole, radius, normal) = (first.y, last.y, point(&axis.direction));
                return format!(
                    "disc about {}, normal {normal}, radii {hole} to {radius}",
                    place(first)
                );
            }
            let [from, to] = [first, last].map(place);
            format!("cylinder or cone from {from} to {to}, radii {} and {}", first.y, last.y)
        }
        Surface::Sphere { centre, radius } => {
            format!("sphere about {}, radius {radius}", point(centre))
        }
        Surface::Bend(Bend { centre, start, bend_radius, radius, angle, .. }) => format!(
            "bend about {} from {}, radius {radius}, angle {} degrees",
            point(centre),
            point(&(centre + start * *bend_radius)),
            six_digits(angle.to_degrees())
        ),
    }
}

/// The coordinates of a point.
fn point(point: &Vector3<f64>) -> String {
    format!("({}, {}, {})", six_digits(point.x), six_digits(point.y), six_digits(point.z))
}

fn describe_ranks(message: &mut String, initial: &InitialState, ranks: &dyn Communicator) {
    let here = initial.state.particles.owned_count() as u64;
    let counts = ranks.gather_to_root(&here.to_le_bytes()).unwrap_or_default();
    for (rank, bytes) in counts.iter().enumerate() {
        let corners =
            initial.work.decomposition.subdomain_corners(rank).map(|corner| corner.map(six_digits));
        let [lower, upper] = corners;
        let count = bytes.as_slice().try_into().map_or(0, u64::from_le_bytes);
        let _ = writeln!(
            message,
            "rank {rank}: x {} to {}, y {} to {}, z {} to {}, {count} particles",
            lower.x, upper.x, lower.y, upper.y, lower.z, upper.z
        );
    }
}
