//! The keys of the volume-averaged gas.

use super::allowed::Allowed;
use super::column::read_viscosity;
use super::drag::read_drag;
use super::particles::Scales;
use super::section::Section;
use super::tree::Value;
use crate::domain::Bounds;
use crate::gas::ParticleDrag;
use crate::gas::volume_averaged::{
    Boundary, CouplingModel, Inlet, Profile, VolumeAveragedGas, VolumeAveragedModel,
};
use crate::grid::BoxGrid;
use crate::linear_solver::Tolerance;
use crate::numbers::Schedule;
use nalgebra::Vector3;
use serde::Deserialize;
use std::ops::Range;

/// More cells along an axis than this are a mistake.
const MOST_CELLS: usize = 100_000;
/// What stands for keys that are left out.
const LEAST_VOIDAGE: f64 = 0.2;
const TOLERANCE: f64 = 1.0e-6;

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum FaceKind {
    NoSlip,
    FreeSlip,
    Inlet,
    Outlet,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ProfileKind {
    Uniform,
    Parabolic,
}

/// `[gas]` of kind "volume_averaged".
pub(super) fn read_volume_averaged(
    section: Section<'_>,
    (scales, gravity): (Scales, Option<f64>),
    bounds: Option<&Bounds>,
    stages: &[Range<f64>],
) -> Option<VolumeAveragedModel> {
    let grid = read_cells(&section, bounds);
    let viscosity = read_viscosity(&section, scales, gravity);
    let density = section.number("density", Allowed::POSITIVE);
    let drag = read_drag(&section);
    let boundaries = read_boundaries(&section, bounds, stages);
    let substeps = section.optional_count("substeps", 1..100_001);
    if !section.has("substeps") {
        section.fail("substeps", "missing: must be the number of time steps in one of the gas");
    }
    let filter_width = section.number_or("filter_width", Allowed::NOT_NEGATIVE, 0.0);
    let floor = Allowed::between(0.01, 0.9);
    section.note_default("least_voidage", "0.2, below it cells are not let (and counted)");
    let least_voidage = section.number_or("least_voidage", floor, LEAST_VOIDAGE);
    let allowed = Allowed::between(1.0e-14, 0.1);
    let tolerance = section.number_or("tolerance", allowed, TOLERANCE);
    let driving = read_vector(&section, "driving").unwrap_or_default();
    section.finish();
    let (law, factor) = drag?;
    let (grid, density, viscosity) = (grid?, density?, viscosity?);
    let tolerance = Tolerance::relative(tolerance);
    let gas = VolumeAveragedGas { density, viscosity, boundaries: boundaries?, tolerance };
    if let Err(words) = gas.check(&grid) {
        section.fail("kind", words);
        return None;
    }
    let drag = ParticleDrag { law, factor, viscosity, density };
    let coupling = CouplingModel { drag, filter_width, least_voidage };
    Some(VolumeAveragedModel { grid, gas, coupling, substeps: substeps?, driving })
}

fn read_cells(section: &Section<'_>, bounds: Option<&Bounds>) -> Option<BoxGrid> {
    let counts: [usize; 3] = section.value("cells")?;
    if !counts.iter().all(|count| (1..=MOST_CELLS).contains(count)) {
        section.fail("cells", format!("each must be between 1 and {MOST_CELLS}"));
        return None;
    }
    Some(BoxGrid::new(bounds?, counts))
}

fn read_vector(section: &Section<'_>, key: &'static str) -> Option<Vector3<f64>> {
    if !section.has(key) {
        return None;
    }
    let numbers = section.numbers(key, Allowed::FINITE)?;
    if numbers.len() != 3 {
        section.fail(key, "must be a list of 3 numbers");
        return None;
    }
    Some(Vector3::from_column_slice(&numbers))
}

/// What happens at the faces: `x`, `y`, `z`, and the keys that go with inlets and outlets.
fn read_boundaries(
    section: &Section<'_>,
    bounds: Option<&Bounds>,
    stages: &[Range<f64>],
) -> Option<[[Boundary; 2]; 3]> {
    let kinds = ["x", "y", "z"].map(|axis| read_faces(section, axis));
    let velocity = section.schedule("inlet_velocity", Allowed::FINITE, stages);
    let profile = read_profile(section);
    let pressure = section.number_or("outlet_pressure", Allowed::FINITE, 0.0);
    let bounds = bounds?;
    let mut has_inlet = false;
    let mut boundaries = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    for (axis, (name, kinds)) in ["x", "y", "z"].into_iter().zip(kinds).enumerate() {
        match (kinds?, bounds.is_periodic(axis)) {
            (None, true) => {}
            (None, false) => {
                section.fail(name, format!("missing: must be {FACES}"));
                return None;
            }
            (Some(_), true) => {
                section.fail(name, "cannot be given: the box is periodic along this axis");
                return None;
            }
            (Some(kinds), false) => {
                has_inlet |= kinds.contains(&FaceKind::Inlet);
                let boundary = |kind| boundary(kind, (&velocity, &profile), pressure);
                boundaries[axis] = kinds.map(boundary);
            }
        }
    }
    if has_inlet && !section.has("inlet_velocity") {
        section.fail("inlet_velocity", "missing: must be a number or a schedule");
        return None;
    }
    (!has_inlet || velocity.is_some()).then_some(boundaries)
}

const FACES: &str = "\"no_slip\" or \"free_slip\" or { lower = , upper = } of \"no_slip\", \"free_slip\", \"inlet\", \
                     \"outlet\"";

/// The kinds of two faces: `Some(None)` if the key is not given.
fn read_faces(section: &Section<'_>, axis: &'static str) -> Option<Option<[FaceKind; 2]>> {
    let Some(node) = section.get(axis) else { return Some(None) };
    if !matches!(node.value, Value::Table(_)) {
        return section.optional::<FaceKind>(axis).map(|kind| Some([kind; 2]));
    }
    let inner = Section::of(node, section.problems)?;
    let kinds: [Option<FaceKind>; 2] = ["lower", "upper"].map(|side| inner.value(side));
    inner.finish();
    Some(Some([kinds[0]?, kinds[1]?]))
}

fn read_profile(section: &Section<'_>) -> Profile {
    match section.get("inlet_profile").map(|node| &node.value) {
        Some(Value::List(_)) => {
            let numbers = section.numbers("inlet_profile", Allowed::NOT_NEGATIVE);
            Profile::Table(numbers.unwrap_or_default())
        }
        _ => match section.optional("inlet_profile") {
            Some(ProfileKind::Parabolic) => Profile::Parabolic,
            Some(ProfileKind::Uniform) | None => Profile::Uniform,
        },
    }
}

fn boundary(
    kind: FaceKind,
    (velocity, profile): (&Option<Schedule>, &Profile),
    pressure: f64,
) -> Boundary {
    match kind {
        FaceKind::NoSlip => Boundary::NO_SLIP,
        FaceKind::FreeSlip => Boundary::FreeSlip,
        FaceKind::Inlet => Boundary::Inlet(Inlet {
            velocity: velocity.clone().unwrap_or(Schedule::Constant(0.0)),
            profile: profile.clone(),
        }),
        FaceKind::Outlet => Boundary::Outlet { pressure },
    }
}
