//! A volume-averaged gas, from its keys.

use super::boxes::AXES;
use super::context::ReadContext;
use super::drag::read_drag;
use super::schedules::read_schedule;
use super::section::Section;
use crate::gas::ParticleDrag;
use crate::gas::volume_averaged::{
    Boundary, CouplingModel, Inlet, Profile, VolumeAveragedGas, VolumeAveragedModel,
};
use crate::grid::BoxGrid;
use crate::linear_solver::Tolerance;
use crate::numbers::Schedule;
use nalgebra::Vector3;

/// `[gas]` of kind "volume_averaged".
pub(super) fn read_volume_averaged(
    section: &Section<'_>,
    viscosity: Option<f64>,
    context: ReadContext<'_>,
) -> Option<VolumeAveragedModel> {
    let boundaries = read_boundaries(section, context);
    let grid = BoxGrid::new(&context.domain?.bounds, section.counts("cells")?);
    let (density, viscosity) = (section.number("density")?, viscosity?);
    let tolerance = Tolerance::relative(section.number("tolerance")?);
    let gas = VolumeAveragedGas { density, viscosity, boundaries: boundaries?, tolerance };
    if let Err(message) = gas.check(&grid) {
        section.fail("kind", message);
        return None;
    }
    let (law, factor) = (read_drag(section)?, section.number("drag_factor")?);
    let longest = context.domain?.bounds.lengths().max();
    let filter_width = section.number("filter_width")?;
    if filter_width > longest {
        section.fail(
            "filter_width",
            format!("must be at most {longest}, the longest edge of the box: the work grows with its square"),
        );
        return None;
    }
    let coupling = CouplingModel {
        drag: ParticleDrag { law, factor, viscosity, density },
        filter_width,
        least_voidage: section.number("least_voidage")?,
    };
    let driving = section.vector("driving").map(Vector3::from).unwrap_or_default();
    Some(VolumeAveragedModel { grid, gas, coupling, substeps: section.count("substeps")?, driving })
}

/// What goes with inlets and outlets.
struct Openings {
    velocity: Option<Schedule>,
    profile: Profile,
    pressure: f64,
}

/// What happens at the faces: `x`, `y`, `z`, and the keys that go with inlets and outlets.
fn read_boundaries(section: &Section<'_>, context: ReadContext<'_>) -> Option<[[Boundary; 2]; 3]> {
    let openings = Openings {
        velocity: read_schedule(section, "inlet_velocity", context.times),
        profile: read_profile(section),
        pressure: section.number("outlet_pressure")?,
    };
    let bounds = &context.domain?.bounds;
    let mut boundaries = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    let mut is_complete = true;
    for (axis, name) in AXES.into_iter().enumerate() {
        if bounds.is_periodic(axis) {
            if section.has(name) {
                section.fail(name, "cannot be given: the box is periodic along this axis");
            }
            continue;
        }
        section.require(name);
        let Some(words) = read_faces(section, name) else {
            is_complete = false;
            continue;
        };
        if words.contains(&"inlet") {
            section.require("inlet_velocity");
            is_complete &= openings.velocity.is_some();
        }
        boundaries[axis] = words.map(|word| boundary(word, &openings));
    }
    is_complete.then_some(boundaries)
}

/// The words of two faces.
fn read_faces<'a>(section: &Section<'a>, name: &str) -> Option<[&'a str; 2]> {
    match section.table(name) {
        Some(sides) => Some([sides.word("lower")?, sides.word("upper")?]),
        None => section.word(name).map(|word| [word; 2]),
    }
}

fn read_profile(section: &Section<'_>) -> Profile {
    match section.numbers("inlet_profile") {
        Some(factors) => Profile::Table(factors),
        None => match section.word("inlet_profile") {
            Some("parabolic") => Profile::Parabolic,
            _ => Profile::Uniform,
        },
    }
}

fn boundary(word: &str, openings: &Openings) -> Boundary {
    match word {
        "free_slip" => Boundary::FreeSlip,
        "inlet" => Boundary::Inlet(Inlet {
            velocity: openings.velocity.clone().unwrap_or(Schedule::Constant(0.0)),
            profile: openings.profile.clone(),
        }),
        "outlet" => Boundary::Outlet { pressure: openings.pressure },
        _ => Boundary::NO_SLIP,
    }
}
