//! A random loose bed without overlap: random sequential addition, layer by layer upwards.

use super::cells::Cells;
use super::{Amount, BedPlan, BedProblem, Sphere, no_room, too_many};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum_engine::domain::Wall;
use talcum_engine::numbers::{random_of, uniform};

/// Thickness of a layer in largest diameters.
const LAYER: f64 = 4.0;
/// Number of tries after which there is no room for a particle.
const TRIES: u32 = 20_000;

/// Spheres at a solids fraction, from the bottom to the height that they need.
pub(super) fn fill(
    plan: &BedPlan<'_>,
    solids_fraction: f64,
    bottom: f64,
) -> Result<Vec<Sphere>, BedProblem> {
    let bounds = &plan.domain.bounds;
    let per_height = solids_fraction * plan.domain.cross_section();
    let diameters = diameters(plan, per_height, bottom)?;
    let largest = diameters.iter().copied().fold(0.0, f64::max);
    let height = diameters.iter().map(|&diameter| volume_of(diameter)).sum::<f64>() / per_height;
    // For one or few particles in a wide box, centres need room above the bottom.
    let height = height.max(largest);
    let (top, reached) = (bounds.lengths().z, bottom + height);
    if reached > top * (1.0 + 1.0e-9) {
        let reason = format!("the bed would reach up to {reached:.6} in a box of {top}");
        return Err(no_room(reason));
    }
    let thickness = height / (height / (LAYER * largest)).round().max(1.0);
    let mut cells = Cells::new(bounds, largest, diameters.len());
    let mut spheres: Vec<Sphere> = Vec::with_capacity(diameters.len());
    let mut filled = 0.0;
    for (id, &diameter) in diameters.iter().enumerate() {
        let layer = (filled / per_height / thickness).floor();
        let lower = bottom + layer * thickness;
        let upper = (lower + thickness).min(reached);
        let free = |sphere: &Sphere| cells.overlap(&spheres, sphere, 0.0).is_none();
        let lowest = if bottom > 0.0 { lower.max(bottom + 0.5 * diameter) } else { lower };
        let Some(sphere) = place(plan, id as u64, diameter, [lowest, upper], free) else {
            let reason = format!(
                "no room for particle {id} between heights of {lower:.6} and {upper:.6} after {TRIES} \
                 tries: lower solids_fraction"
            );
            return Err(no_room(reason));
        };
        cells.push(sphere.position);
        spheres.push(sphere);
        filled += volume_of(diameter);
    }
    Ok(spheres)
}

/// The diameters of all particles: the count that the case wants, or as many as fill the height at so much
/// volume per height.
fn diameters(plan: &BedPlan<'_>, per_height: f64, bottom: f64) -> Result<Vec<f64>, BedProblem> {
    let diameter = |id| plan.diameter_of(id).unwrap_or(plan.particles.reference_diameter);
    let smallest = plan.particles.size_range().map_or(1.0, |sizes| sizes.smallest_diameter);
    let top = plan.domain.bounds.lengths().z;
    let height = match plan.particles.amount {
        Some(Amount::Count(count)) => {
            let room = per_height * (top - bottom).max(0.0) / volume_of(smallest);
            let fits = count as f64 <= room * (1.0 + 1.0e-9);
            let all = || (0..count).map(diameter).collect();
            return fits.then(all).ok_or_else(|| too_many(room.min(1.0e9) as u64));
        }
        Some(Amount::FillHeight(height)) => height.min(top) - bottom,
        None => 0.0,
    };
    let mut room = per_height * height;
    if room / volume_of(smallest) > 1.0e9 {
        let reason = "more than 1e9 particles would fit below fill_height".to_owned();
        return Err(no_room(reason));
    }
    let mut diameters = Vec::new();
    loop {
        let next = diameter(diameters.len() as u64);
        room -= volume_of(next);
        if room < 0.0 {
            break;
        }
        diameters.push(next);
    }
    if diameters.is_empty() {
        return Err(no_room("not one particle fits below fill_height"));
    }
    Ok(diameters)
}

/// A sphere with its centre between two heights that touches no wall and is accepted by `is_free`.
fn place(
    plan: &BedPlan<'_>,
    id: u64,
    diameter: f64,
    [lower, upper]: [f64; 2],
    is_free: impl Fn(&Sphere) -> bool,
) -> Option<Sphere> {
    let bounds = &plan.domain.bounds;
    let sphere = plan.sphere(id, diameter);
    let radius = sphere.radius;
    let mut generator = random_of(plan.particles.seed, id, "position");
    for _ in 0..TRIES {
        let position = Vector3::from_fn(|axis, _| {
            let length = bounds.lengths()[axis];
            let [mut low, mut high] = if axis == 2 { [lower, upper] } else { [0.0, length] };
            if !bounds.is_periodic(axis) {
                low = low.max(radius);
                high = high.min(length - radius);
            }
            low + (high - low) * uniform(&mut generator)
        });
        let position = bounds.position_quantum().round_vector(position);
        let is_inside = (0..3).all(|axis| {
            let room = bounds.lengths()[axis] - radius;
            bounds.is_periodic(axis) || (radius..=room).contains(&position[axis])
        });
        let touches = |wall: &Wall| wall.height_of(&position) < radius;
        let sphere = Sphere { position: position.into(), ..sphere };
        let is_inside = is_inside && plan.domain.may_hold_bed(&position);
        if is_inside && !plan.domain.walls.iter().any(touches) && is_free(&sphere) {
            return Some(sphere);
        }
    }
    None
}

fn volume_of(diameter: f64) -> f64 {
    PI / 6.0 * diameter * diameter * diameter
}
