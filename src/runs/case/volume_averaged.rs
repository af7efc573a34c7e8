//! The volume-averaged gas, from its keys.

use super::boxes::AXES;
use super::context::ReadContext;
use super::drag::{read_drag, read_drag_share};
use super::schedules::read_schedule;
use crate::input::Section;
use nalgebra::Vector3;
use talcum_engine::domain::{Wall, WallShape};
use talcum_engine::gas::volume_averaged::{
    Boundary, CouplingModel, Inlet, Jet, Profile, VolumeAveragedGas, VolumeAveragedModel, across,
};
use talcum_engine::gas::{AgglomerateDrag, ParticleDrag};
use talcum_engine::grid::{BoxGrid, RoundColumn};
use talcum_engine::linear_solver::Tolerance;
use talcum_engine::numbers::Schedule;

/// `[gas]` of kind "volume_averaged".
pub(super) fn read_volume_averaged(
    section: &Section<'_>,
    viscosity: Option<f64>,
    context: ReadContext<'_>,
) -> Option<VolumeAveragedModel> {
    let cells = section.counts("cells");
    let grid = cells.zip(context.domain).map(|(cells, domain)| BoxGrid::new(&domain.bounds, cells));
    let column = read_column(section, grid.as_ref(), context);
    let mut boundaries = read_boundaries(section, grid.as_ref(), context);
    let (grid, column) = (grid?, column?);
    if let (Some(column), Some(boundaries)) = (&column, &mut boundaries) {
        boundaries.iter_mut().flatten().for_each(|boundary| fit_profile(boundary, column));
    }
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
        drag: ParticleDrag {
            law,
            factor,
            share: read_drag_share(section)?,
            viscosity,
            density,
            parcel_size: 1.0,
        },
        agglomerates: read_agglomerates(section)?,
        filter_width,
        undisturbed: section.boolean("undisturbed_velocity")?,
        local_voidage: section
            .count("local_voidage")
            .map(|factor| factor as usize)
            .filter(|&it| it > 0),
        least_voidage: section.number("least_voidage")?,
    };
    let driving = section.vector("driving").map(Vector3::from).unwrap_or_default();
    let substeps = section.count("substeps")?;
    Some(VolumeAveragedModel { grid, column, gas, coupling, substeps, driving })
}

/// Reads `agglomerates`, and rejects keys that it excludes; `Some(None)` if it is not given.
fn read_agglomerates(section: &Section<'_>) -> Option<Option<AgglomerateDrag>> {
    if !section.has("agglomerates") {
        return Some(None);
    }
    let table = section.table("agglomerates")?;
    let drag = AgglomerateDrag { every: table.count("every")?, smallest: table.count("smallest")? };
    if section.boolean("undisturbed_velocity") == Some(true) {
        let message = "cannot be true with agglomerates: their members disturb the gas together";
        section.fail("undisturbed_velocity", message);
        return None;
    }
    if section.count("local_voidage").is_some_and(|factor| factor > 0) {
        let message = "cannot be above 0 with agglomerates: their drag is that of balls in the voidage of the gas's own cells";
        section.fail("local_voidage", message);
        return None;
    }
    if section.word("drag_in_mixtures") == Some("sauter_diameter") {
        let message = "cannot be \"sauter_diameter\" with agglomerates: a member has the drag of its own diameter at \
                       the packing of its agglomerate";
        section.fail("drag_in_mixtures", message);
        return None;
    }
    Some(Some(drag))
}

/// The round wall in which the gas flows, if there is one.
fn read_column(
    section: &Section<'_>,
    grid: Option<&BoxGrid>,
    context: ReadContext<'_>,
) -> Option<Option<RoundColumn>> {
    let walls = context.domain?.walls.iter();
    let round: Vec<_> = walls
        .filter_map(|wall| match wall.shape {
            WallShape::Cylinder { centre, radius } => Some((wall, centre, radius)),
            WallShape::Plane { .. } | WallShape::Limited(_) => None,
        })
        .collect();
    let [(wall, centre, radius)] = round[..] else {
        if !round.is_empty() {
            section.fail("kind", "the gas flows in one round column: there are several");
        }
        return round.is_empty().then_some(None);
    };
    if !wall.motion.is_rest() {
        let name = &wall.name;
        section.fail("kind", format!(
            "the gas flows in a round column at rest: {name:?} moves (for a column that vibrates use [vibration])"
        ));
        return None;
    }
    let column = RoundColumn::new(grid?, [centre.x, centre.y], radius);
    column.map(Some).map_err(|message| section.fail("cells", message)).ok()
}

/// Replaces a parabolic profile in a round column by Poiseuille's, 2 (1 - r^2 / R^2).
fn fit_profile(boundary: &mut Boundary, column: &RoundColumn) {
    if let Boundary::Inlet(inlet) = boundary
        && inlet.profile == Profile::Parabolic
    {
        inlet.profile = Profile::Table(column.parabolic_profile());
    }
}

/// Settings of inlets and outlets.
struct Openings {
    velocity: Option<Schedule>,
    profile: Profile,
    jet: Option<JetOpening>,
    pressure: f64,
}

/// A rectangle of an inlet with a velocity of its own.
struct JetOpening {
    velocity: Schedule,
    centre: [f64; 2],
    width: [f64; 2],
}

/// Boundary conditions at the faces: `x`, `y`, `z`, and the keys of inlets and outlets.
fn read_boundaries(
    section: &Section<'_>,
    grid: Option<&BoxGrid>,
    context: ReadContext<'_>,
) -> Option<[[Boundary; 2]; 3]> {
    let openings = Openings {
        velocity: read_schedule(section, "inlet_velocity", context.times),
        profile: read_profile(section),
        jet: section.table("inlet_jet").and_then(|jet| read_jet(&jet, context)),
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
        if axis < 2 && context.domain?.walls.iter().any(Wall::is_round) {
            if section.has(name) {
                section.fail(
                    name,
                    "cannot be given: the gas flows in a round column, to whose wall it sticks",
                );
            }
            boundaries[axis] = [Boundary::NO_SLIP, Boundary::NO_SLIP];
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
        let jet = match (&openings.jet, grid) {
            (Some(jet), Some(grid)) if words.contains(&"inlet") => jet.on(section, grid, axis),
            _ => None,
        };
        boundaries[axis] = words.map(|word| boundary(word, &openings, jet.as_ref()));
    }
    is_complete.then_some(boundaries)
}

/// The words for two faces.
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

/// Reads `inlet_jet`.
fn read_jet(table: &Section<'_>, context: ReadContext<'_>) -> Option<JetOpening> {
    let pair = |name| -> Option<[f64; 2]> { table.numbers(name)?.try_into().ok() };
    let velocity = read_schedule(table, "velocity", context.times)?;
    Some(JetOpening { velocity, centre: pair("centre")?, width: pair("width")? })
}

impl JetOpening {
    /// The jet in a face across an axis; it must lie completely in the face.
    fn on(&self, section: &Section<'_>, grid: &BoxGrid, axis: usize) -> Option<Jet> {
        let axes = across(axis);
        let [first, second] = [0, 1].map(|place| {
            let (axis, half) = (axes[place], 0.5 * self.width[place]);
            let range = [self.centre[place] - half, self.centre[place] + half];
            let edge = grid.counts()[axis] as f64 * grid.spacing()[axis];
            // Widths and box lengths are rounded.
            let slack = 1.0e-9 * edge;
            let is_inside = range[0] >= -slack && range[1] <= edge + slack;
            is_inside.then(|| covered_parts(range, grid.spacing()[axis], grid.counts()[axis]))
        });
        let (Some(first), Some(second)) = (first, second) else {
            section.fail(
                "inlet_jet",
                "must lie within the face of the inlet: centre less and plus half of width",
            );
            return None;
        };
        Some(Jet { velocity: self.velocity.clone(), covered: [first, second] })
    }
}

/// The fraction of each of the cells along an axis that a range covers.
fn covered_parts([begin, end]: [f64; 2], spacing: f64, cells: usize) -> Vec<f64> {
    let part = |cell: usize| {
        let (lower, upper) = (cell as f64 * spacing, (cell + 1) as f64 * spacing);
        ((end.min(upper) - begin.max(lower)) / spacing).clamp(0.0, 1.0)
    };
    (0..cells).map(part).collect()
}

/// The boundary that a word of the table of keys names; a test asks that each names one of its own.
fn boundary(word: &str, openings: &Openings, jet: Option<&Jet>) -> Boundary {
    match word {
        "free_slip" => Boundary::FreeSlip,
        "inlet" => Boundary::Inlet(Inlet {
            velocity: openings.velocity.clone().unwrap_or(Schedule::Constant(0.0)),
            profile: openings.profile.clone(),
            jet: jet.cloned(),
        }),
        "outlet" => Boundary::Outlet { pressure: openings.pressure },
        _ => Boundary::NO_SLIP,
    }
}

#[cfg(test)]
mod tests {
    use super::{Boundary, Openings, boundary, covered_parts};
    use crate::case::Case;
    use crate::case::schema::FACES;
    use talcum_engine::gas::volume_averaged::Profile;

    #[test]
    fn each_word_names_a_boundary_of_its_own() {
        let openings =
            Openings { velocity: None, profile: Profile::Uniform, jet: None, pressure: 0.0 };
        let of = |word| boundary(word, &openings, None);
        let mut found: Vec<Boundary> = FACES.iter().map(|word| of(word.name)).collect();
        assert!(found.contains(&Boundary::NO_SLIP));
        while let Some(last) = found.pop() {
            assert!(!found.contains(&last), "{last:?}");
        }
        // Negative control: a word without an arm of its own is taken for a wall.
        assert_eq!(of("symmetry"), Boundary::NO_SLIP);
    }

    #[test]
    fn cells_that_a_jet_covers_in_part_have_that_part_of_it() {
        // Widths that are exact binary fractions.
        assert_eq!(covered_parts([0.25, 2.5], 1.0, 4), [0.75, 1.0, 0.5, 0.0]);
        assert_eq!(covered_parts([1.25, 1.5], 1.0, 3), [0.0, 0.25, 0.0]);
    }

    /// The flux is the sum over the jet and the rest of the face, for any cells.
    #[test]
    fn the_flux_of_a_jet_does_not_depend_on_the_cells() {
        let text = include_str!("../../../tests/cases/good/jet.toml")
            .replace("\"parabolic\"", "\"uniform\"");
        for cells in ["[2, 2, 16]", "[3, 5, 16]", "[10, 10, 16]"] {
            let text = text.replace("[2, 2, 16]", cells);
            let case = Case::from_text(&text, "jet", std::path::Path::new(""), &[]).unwrap();
            let model = case.volume_averaged().unwrap();
            let (face, inlet) = model.gas.inlets().next().unwrap();
            let inflow = model.largest_inflow(face, inlet);
            // 1.5 x 1 of 5 x 5 at 2, the rest at up to 0.15.
            let expected = (1.5 * 2.0 + 23.5 * 0.15) / 25.0;
            assert!((inflow.mean - expected).abs() < 1.0e-12, "{cells}: {}", inflow.mean); // rounding
        }
        // Negative control: without the jet.
        let without = text.replace("inlet_jet =", "# inlet_jet =");
        let case = Case::from_text(&without, "none", std::path::Path::new(""), &[]).unwrap();
        let model = case.volume_averaged().unwrap();
        let (face, inlet) = model.gas.inlets().next().unwrap();
        assert!((model.largest_inflow(face, inlet).mean - 0.15).abs() < 1.0e-12);
    }
}
