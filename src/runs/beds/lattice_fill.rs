//! Layers of a simple cubic lattice, from the bottom upwards.

use super::lattice::{Lattice, Row, displaced, displacement};
use super::{Amount, BedPart, BedPlan, BedProblem, Sphere, no_room, too_many};
use nalgebra::Vector3;
use talcum_engine::numbers::random_of;

/// Ratio of sites that may be skipped behind walls to placed particles.
const SKIPPED: f64 = 100.0;
/// Tolerance in units of the spacing: a layer that ends this far beyond a bound counts as ending below it.
const ROUNDING: f64 = 1.0e-9;
/// Largest number of particles: a larger one is a mistake.
const MOST: f64 = 1.0e9;

/// Sites of the lattice: as many along each axis as fit, stretched to fill a width.
struct Sites {
    lattice: Lattice,
    /// How many there are.
    room: f64,
    spacings: [f64; 3],
}

/// Spheres of a part of the bed on lattice sites, and their ids. Each is displaced along each axis by at most `jitter`
/// times half the free gap. This is less than half of the gap, so that no two spheres can touch.
pub(super) fn fill(
    plan: &BedPlan<'_>,
    spacing: f64,
    jitter: f64,
    bottom: f64,
    part: BedPart,
) -> Result<Vec<(u64, Sphere)>, BedProblem> {
    let largest = plan.particles.size_range().map_or(spacing, |sizes| sizes.largest_diameter);
    let sites = Sites::new(plan, spacing, bottom)?;
    let wanted = wanted(plan, sites.room)?;
    let displacements = sites.spacings.map(|spacing| 0.5 * jitter * (spacing - largest).max(0.0));
    let (mut placed, mut spheres) = (0_u64, Vec::new());
    for number in 0..sites.room.min(wanted * (1.0 + SKIPPED)) as u64 {
        if placed as f64 >= wanted {
            break;
        }
        let site = sites.lattice.site(number);
        if behind_wall(plan, site, 0.5 * largest, &displacements) {
            continue;
        }
        let id = placed;
        placed += 1;
        if part.holds(id) {
            let sphere = plan.sphere(id, plan.diameter_of(id).unwrap_or(largest));
            let mut generator = random_of(plan.particles.seed, id, "jitter");
            let shift = displacement(&mut generator, displacements);
            spheres.push((id, Sphere { position: displaced(site, shift), ..sphere }));
        }
    }
    match plan.particles.amount {
        Some(Amount::Count(asked)) if placed < asked => Err(too_many(placed)),
        _ if placed == 0 => Err(no_room("not one particle fits")),
        _ => Ok(spheres),
    }
}

/// How many particles the case wants, of so many that there is room for.
fn wanted(plan: &BedPlan<'_>, room: f64) -> Result<f64, BedProblem> {
    match plan.particles.amount {
        Some(Amount::Count(asked)) if asked as f64 > room => Err(too_many(room as u64)),
        Some(Amount::Count(count)) => Ok(count as f64),
        _ if room > MOST => {
            let reason =
                format!("{room} particles fit below fill_height: at most 1e9 are possible");
            Err(no_room(reason))
        }
        _ => Ok(room),
    }
}

/// Whether this site is outside the rooms of the bed, or a particle there, wherever it is displaced to, could touch a wall.
fn behind_wall(plan: &BedPlan<'_>, site: [f64; 3], radius: f64, displacements: &[f64; 3]) -> bool {
    let site = Vector3::from(site);
    !plan.domain.may_hold_bed(&site)
        || plan.domain.walls.iter().any(|wall| {
            let towards = wall.approach_within(displacements);
            wall.height_of(&site) < (radius + towards) * (1.0 - ROUNDING)
        })
}

impl Sites {
    fn new(plan: &BedPlan<'_>, spacing: f64, bottom: f64) -> Result<Self, BedProblem> {
        let bounds = &plan.domain.bounds;
        let lengths = bounds.lengths();
        let fitting = |length: f64, spacing: f64| (length / spacing * (1.0 + ROUNDING)).floor();
        let mut counts: [f64; 3] = std::array::from_fn(|axis| fitting(lengths[axis], spacing));
        let mut spacings: [f64; 3] = std::array::from_fn(|axis| lengths[axis] / counts[axis]);
        let top = match plan.particles.amount {
            Some(Amount::FillHeight(height)) => height.min(lengths.z),
            _ => lengths.z,
        };
        if !bounds.is_periodic(2) {
            spacings[2] = spacing;
        }
        counts[2] = counts[2].min(fitting(top - bottom, spacings[2]));
        if counts.iter().any(|&count| count.is_nan() || count < 1.0) {
            let reason = format!(
                "not one particle fits between bottom = {bottom} and a height of {top} with \
                 spacing = {spacing}"
            );
            return Err(no_room(reason));
        }
        let row =
            |axis: usize, origin| Row { origin, offset: 0.5, step: spacings[axis], parts: 1.0 };
        let rows = [row(0, 0.0), row(1, 0.0), row(2, bottom)];
        let lattice = Lattice { counts: [counts[0] as u64, counts[1] as u64], rows };
        Ok(Self { lattice, room: counts.iter().product(), spacings })
    }
}
