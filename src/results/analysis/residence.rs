//! Solids flux through planes and residence times between them, from crossings.

use crate::analysis::no_value::{Estimate, NoValue, require_finite, require_positive};
use crate::analysis::statistics::moments;
use std::collections::BTreeMap;

/// The passage of a particle's centre through a horizontal plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Global id of the particle.
    pub particle: u64,
    /// Number of the plane.
    pub plane: usize,
    /// Time of the crossing.
    pub time: f64,
    /// Whether it is upwards.
    pub upwards: bool,
    /// Mass of the particle.
    pub mass: f64,
}

/// Flux of solids through a plane. Mass over area and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidsFlux {
    /// Upwards.
    pub up: f64,
    /// Downwards; positive.
    pub down: f64,
    /// Upwards less downwards.
    pub net: f64,
    /// Numbers of crossings upwards and downwards.
    pub crossings: [u64; 2],
}

/// Flux through each of `planes` planes of an area within a duration: passing masses over area and time.
///
/// Fails if area or duration is not positive, a mass is not finite, or a crossing names a plane that does not exist.
pub fn solids_flux(
    crossings: &[Crossing],
    planes: usize,
    area: f64,
    duration: f64,
) -> Result<Vec<SolidsFlux>, NoValue> {
    require_positive("the planes' area", area)?;
    require_positive("the duration", duration)?;
    let mut masses = vec![[0.0; 2]; planes];
    let mut counts = vec![[0; 2]; planes];
    for crossing in crossings {
        require_finite("mass", &[crossing.mass])?;
        let side = usize::from(!crossing.upwards);
        let (Some(mass), Some(count)) =
            (masses.get_mut(crossing.plane), counts.get_mut(crossing.plane))
        else {
            let plane = crossing.plane;
            return Err(NoValue::because(format!("a crossing names plane {plane} of {planes}")));
        };
        mass[side] += crossing.mass;
        count[side] += 1;
    }
    let scale = 1.0 / (area * duration);
    Ok(masses
        .iter()
        .zip(counts)
        .map(|([up, down], crossings)| SolidsFlux {
            up: up * scale,
            down: down * scale,
            net: (up - down) * scale,
            crossings,
        })
        .collect())
}

/// A plane and the direction in which it is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gate {
    /// Number of the plane.
    pub plane: usize,
    /// Whether it is passed upwards.
    pub upwards: bool,
}

/// Distribution of residence times between two gates.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidenceTimes {
    /// Mean residence time and its standard error for independent passages.
    pub mean: Estimate,
    /// Standard deviation.
    pub deviation: f64,
    /// Lower ends of the bins, from 0; all have the same width.
    pub times: Vec<f64>,
    /// E(t), normalised such that its integral over all bins is 1. One over time.
    pub density: Vec<f64>,
    /// Number of complete passages.
    pub passages: usize,
    /// Number of particles that left again through the entrance.
    pub returned: usize,
    /// Number of particles still inside at the end. Their times are missing: unless they are few, the mean is too
    /// small.
    pub inside: usize,
}

/// Residence times of particles that come in through `entrance` and leave through `exit` (P. V. Danckwerts, Chem. Eng.
/// Sci. 2 (1953) 1-13, doi:10.1016/0009-2509(53)80001-1).
///
/// A passage begins when a particle passes the entrance and is dropped when it passes the entrance backwards; it ends
/// when the particle passes the exit. Particles that were inside at the start are not counted. Crossings may be in any
/// order; those of one particle at the same time count in the given order.
///
/// Fails for fewer than two passages.
pub fn residence_times(
    crossings: &[Crossing],
    entrance: Gate,
    exit: Gate,
    bins: usize,
) -> Result<ResidenceTimes, NoValue> {
    if bins == 0 || entrance == exit {
        return Err(NoValue::because("there are no bins, or the exit is the entrance"));
    }
    let times: Vec<f64> = crossings.iter().map(|crossing| crossing.time).collect();
    require_finite("crossing times", &times)?;
    let mut ordered: Vec<&Crossing> = crossings.iter().collect();
    ordered.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut entered: BTreeMap<u64, f64> = BTreeMap::new();
    let (mut stays, mut returned) = (Vec::new(), 0);
    for crossing in ordered {
        let gate = Gate { plane: crossing.plane, upwards: crossing.upwards };
        let back = Gate { plane: entrance.plane, upwards: !entrance.upwards };
        if gate == entrance {
            entered.insert(crossing.particle, crossing.time);
        } else if gate == exit {
            stays.extend(entered.remove(&crossing.particle).map(|time| crossing.time - time));
        } else if gate == back && entered.remove(&crossing.particle).is_some() {
            returned += 1;
        }
    }
    distribution(&stays, bins, returned, entered.len())
}

fn distribution(
    stays: &[f64],
    bins: usize,
    returned: usize,
    inside: usize,
) -> Result<ResidenceTimes, NoValue> {
    if stays.len() < 2 {
        return Err(NoValue::because(format!(
            "{} particles passed from entrance to exit; two are needed ({inside} are still inside)",
            stays.len()
        )));
    }
    let found = moments(stays)?;
    let longest = stays.iter().copied().fold(0.0_f64, f64::max);
    let width = if longest > 0.0 { longest / bins as f64 } else { 1.0 };
    let mut density = vec![0.0; bins];
    for stay in stays {
        density[((stay / width) as usize).min(bins - 1)] += 1.0 / (stays.len() as f64 * width);
    }
    let error = found.deviation / (stays.len() as f64).sqrt();
    Ok(ResidenceTimes {
        mean: Estimate { value: found.mean, error },
        deviation: found.deviation,
        times: (0..bins).map(|bin| bin as f64 * width).collect(),
        density,
        passages: stays.len(),
        returned,
        inside,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const ENTRANCE: Gate = Gate { plane: 0, upwards: true };
    const EXIT: Gate = Gate { plane: 1, upwards: true };

    fn crossing(particle: u64, gate: Gate, time: f64) -> Crossing {
        Crossing { particle, plane: gate.plane, time, upwards: gate.upwards, mass: 0.5 }
    }

    #[test]
    fn flux_counts_both_directions() {
        let down = Gate { plane: 0, upwards: false };
        let crossings =
            [crossing(1, ENTRANCE, 0.1), crossing(2, ENTRANCE, 0.2), crossing(1, down, 0.3)];
        let flux = solids_flux(&crossings, 2, 25.0, 2.0).unwrap();
        assert_eq!(flux[0], SolidsFlux { up: 0.02, down: 0.01, net: 0.01, crossings: [2, 1] });
        assert_eq!(flux[1].crossings, [0, 0]);
        assert!(solids_flux(&crossings, 0, 25.0, 2.0).is_err());
        assert!(solids_flux(&crossings, 2, 0.0, 2.0).is_err());
    }

    #[test]
    fn a_stirred_tank_has_exponential_times() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut crossings = Vec::new();
        for particle in 0..20_000 {
            let entry = 0.01 * particle as f64;
            let stay = -3.0 * libm::log(1.0 - random.random::<f64>());
            crossings.push(crossing(particle, EXIT, entry + stay));
            crossings.push(crossing(particle, ENTRANCE, entry));
        }
        let found = residence_times(&crossings, ENTRANCE, EXIT, 60).unwrap();
        assert!((found.mean.value - 3.0).abs() < 4.0 * found.mean.error, "{:?}", found.mean);
        assert!((found.deviation - 3.0).abs() < 0.1);
        let width = found.times[1];
        assert!((found.density.iter().sum::<f64>() * width - 1.0).abs() < 1e-12);
        let expected = (1.0 - libm::exp(-width / 3.0)) / width;
        // 3,000 stays in the first bin: 2 %.
        assert!((found.density[0] / expected - 1.0).abs() < 0.08);
    }

    #[test]
    fn plug_flow_returns_and_particles_inside_are_distinguished() {
        let mut crossings: Vec<Crossing> = (0..50)
            .flat_map(|particle| {
                let entry = particle as f64;
                [crossing(particle, ENTRANCE, entry), crossing(particle, EXIT, entry + 7.0)]
            })
            .collect();
        let down = Gate { plane: 0, upwards: false };
        crossings.push(crossing(100, ENTRANCE, 1.0));
        crossings.push(crossing(100, down, 2.0));
        crossings.push(crossing(101, ENTRANCE, 3.0));
        // The particle is inside from the start, so its time is unknown.
        crossings.push(crossing(102, EXIT, 4.0));
        let found = residence_times(&crossings, ENTRANCE, EXIT, 10).unwrap();
        assert_eq!((found.passages, found.returned, found.inside), (50, 1, 1));
        assert!((found.mean.value - 7.0).abs() < 1e-12 && found.deviation < 1e-12);
        assert!(residence_times(&crossings[..2], ENTRANCE, EXIT, 10).is_err());
    }
}
