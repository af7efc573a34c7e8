//! Layers of a simple cubic lattice, from the bottom upwards.

use super::super::particles::Amount;
use super::{BedError, BedPart, Sphere, diameter_of, no_room, too_many};
use crate::case::Case;
use crate::numbers::{random_of, uniform};
use nalgebra::Vector3;

/// Ratio of sites that may be skipped behind walls to placed particles.
const SKIPPED: f64 = 100.0;
/// Tolerance in units of the spacing: a layer that ends this far beyond a bound counts as ending below it.
const ROUNDING: f64 = 1.0e-9;
/// Largest number of particles: a larger one is a mistake.
const MOST: f64 = 1.0e9;

/// Sites of the lattice: as many along each axis as fit, stretched to fill a width.
struct Sites {
    counts: [f64; 3],
    spacings: [f64; 3],
    bottom: f64,
}

/// Spheres of a part of the bed on lattice sites, and their ids. Each is displaced along each axis by at most `jitter`
/// times half the free gap. This is less than half of the gap, so that no two spheres can touch.
pub(super) fn fill(
    case: &Case,
    spacing: f64,
    jitter: f64,
    bottom: f64,
    part: BedPart,
) -> Result<Vec<(u64, Sphere)>, BedError> {
    let largest = case.size_range().map_or(spacing, |sizes| sizes.largest_diameter);
    let sites = Sites::new(case, spacing, bottom)?;
    let room: f64 = sites.counts.iter().product();
    let wanted = wanted(case, room)?;
    let displacements = sites.spacings.map(|spacing| 0.5 * jitter * (spacing - largest).max(0.0));
    let (mut placed, mut spheres) = (0_u64, Vec::new());
    for number in 0..room.min(wanted * (1.0 + SKIPPED)) as u64 {
        if placed as f64 >= wanted {
            break;
        }
        let site = sites.position_of(number);
        if behind_wall(case, &site, 0.5 * largest, &displacements) {
            continue;
        }
        let id = placed;
        placed += 1;
        if part.holds(id) {
            let diameter = diameter_of(case, id).unwrap_or(largest);
            let position = site + displacement_of(case, id, displacements);
            spheres.push((id, Sphere { position, diameter }));
        }
    }
    match case.particles.amount {
        Some(Amount::Count(asked)) if placed < asked => Err(too_many(case, placed)),
        _ if placed == 0 => Err(no_room(case, "not one particle fits")),
        _ => Ok(spheres),
    }
}

/// Number of particles that the case requests, given the number for which there is room.
fn wanted(case: &Case, room: f64) -> Result<f64, BedError> {
    match case.particles.amount {
        Some(Amount::Count(asked)) if asked as f64 > room => Err(too_many(case, room as u64)),
        Some(Amount::Count(count)) => Ok(count as f64),
        _ if room > MOST => {
            let reason =
                format!("{room} particles fit below fill_height: at most 1e9 are possible");
            Err(no_room(case, reason))
        }
        _ => Ok(room),
    }
}

/// Whether a particle at this site could touch a wall with any of its possible displacements.
fn behind_wall(case: &Case, site: &Vector3<f64>, radius: f64, displacements: &[f64; 3]) -> bool {
    case.domain.walls.iter().any(|wall| {
        let towards = wall.approach_within(displacements);
        wall.height_of(site) < (radius + towards) * (1.0 - ROUNDING)
    })
}

fn displacement_of(case: &Case, id: u64, displacements: [f64; 3]) -> Vector3<f64> {
    if displacements == [0.0; 3] {
        return Vector3::zeros();
    }
    let mut generator = random_of(case.particles.seed, id, "jitter");
    Vector3::from(displacements.map(|largest| largest * (2.0 * uniform(&mut generator) - 1.0)))
}

impl Sites {
    fn new(case: &Case, spacing: f64, bottom: f64) -> Result<Self, BedError> {
        let bounds = &case.domain.bounds;
        let lengths = bounds.lengths();
        let fitting = |length: f64, spacing: f64| (length / spacing * (1.0 + ROUNDING)).floor();
        let mut counts: [f64; 3] = std::array::from_fn(|axis| fitting(lengths[axis], spacing));
        let mut spacings: [f64; 3] = std::array::from_fn(|axis| lengths[axis] / counts[axis]);
        let top = match case.particles.amount {
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
            return Err(no_room(case, reason));
        }
        Ok(Self { counts, spacings, bottom })
    }

    /// Sites are numbered along x, then y, then z.
    fn position_of(&self, number: u64) -> Vector3<f64> {
        let [nx, ny] = [self.counts[0] as u64, self.counts[1] as u64];
        let index = [number % nx, number / nx % ny, number / nx / ny];
        let at = |axis: usize| (index[axis] as f64 + 0.5) * self.spacings[axis];
        Vector3::new(at(0), at(1), self.bottom + at(2))
    }
}
