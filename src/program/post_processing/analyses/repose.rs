//! Angle of repose of a heap, from snapshots of the particles.

use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured};
use talcum_engine::domain::Face;
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::repose::{Grain, Plate, Surface};
use talcum_results::output::ResultTable;
use talcum_results::output::readers::ParticleSnapshot;
use talcum_runs::case::Case;

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "repose",
    title: "Angle of repose of a heap along x, at the last snapshot that counts",
    scalars: || vec![ANGLE, CREST],
    of_case: |case| {
        require_ends(case)?;
        ResultFile::Particles.require_of(case)
    },
    find,
};

const ANGLE: Kind = Kind::number(
    "angle",
    Unit::Degrees,
    "slope of the surface between eight and two tenths of the crest's height, mean of the sides",
);
const CREST: Kind = Kind::number("crest", Unit::Length, "height of the highest column");

/// Side of the squares whose highest spheres form the surface, in largest diameters.
const SIDE: f64 = 2.0;

/// A heap has ends: the box must not be periodic along x.
fn require_ends(case: &Case) -> Result<(), NoValue> {
    if case.domain.bounds.is_periodic(0) {
        Err(NoValue::because("the box repeats along x: a heap there has no ends"))
    } else {
        Ok(())
    }
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let case = results.case()?;
    require_ends(case)?;
    let snapshots = results.particle_snapshots()?;
    let last = snapshots.snapshot(snapshots.times.len() - 1)?;
    let bounds = &case.domain.bounds;
    let plate = Plate { length: bounds.lengths().x, breadth: bounds.lengths().y };
    let surface = Surface::of(&grains(&last), plate, SIDE * largest_diameter(&last)?)?;
    let is_open = |face: Face| face != Face::Wall;
    let open = bounds.faces(0).map(is_open);

    let mut found = Findings::new(results.units());
    found.add(&ANGLE, surface.angle(open));
    found.add(&CREST, surface.crest());
    let length = results.units().of(Unit::Length);
    let places = (0..surface.heights.len()).map(|column| surface.place(column)).collect();
    found.tables.push(ResultTable::new(
        "repose/surface",
        vec![
            Column::numbers("x", length, "middle of a column", places),
            Column::numbers("height", length, "of the heap there", surface.heights.clone()),
        ],
    ));
    Ok(found)
}

fn grains(snapshot: &ParticleSnapshot) -> Vec<Grain> {
    let places = snapshot.positions.iter().zip(&snapshot.radii);
    places
        .map(|(&[along, across, height], &radius)| Grain { along, across, height, radius })
        .collect()
}

fn largest_diameter(snapshot: &ParticleSnapshot) -> Result<f64, NoValue> {
    let largest = snapshot.radii.iter().copied().fold(0.0, f64::max);
    if largest > 0.0 { Ok(2.0 * largest) } else { Err(NoValue::because("no particles are left")) }
}
