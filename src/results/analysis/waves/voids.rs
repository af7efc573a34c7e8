//! Tracking of voids over time: a second estimate of the speed of the waves.

use super::field::{Rows, running_mean};
use super::motion::Bed;
use crate::analysis::LineFit;
use crate::analysis::no_value::{Estimate, NoValue};
use crate::analysis::numerics::interpolation::peak_near;
use crate::analysis::statistics::moments;

/// Smallest number of tracks from which a speed is computed.
const FEWEST: usize = 4;
/// Smallest depth of a void relative to its surroundings on both sides, as a fraction of the waves' amplitude.
const LEAST_DEPTH: f64 = 0.5;

/// Speed and distance of voids, minima of phi over height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedVoids {
    /// Mean speed of the tracks. Length over time.
    pub speed: Estimate,
    /// Standard deviation of the tracks' speeds. Length over time.
    pub speed_deviation: f64,
    /// Mean distance between neighbouring voids, and its standard error with tracks as independent values. Length.
    pub spacing: Estimate,
    /// Number of tracks.
    pub tracks: usize,
}

/// Results of the first estimate, in nodes and intervals, for the search for voids.
#[derive(Clone, Debug)]
pub(super) struct Expected {
    /// Places and times with waves, \[height\]\[time\].
    pub(super) places: Vec<Vec<bool>>,
    pub(super) slowness: f64,
    pub(super) period: f64,
    pub(super) amplitude: f64,
}

struct Track {
    times: Vec<f64>,
    places: Vec<f64>,
}

impl Track {
    /// Expected position at a time: from its last position with the expected speed.
    fn place_at(&self, time: f64, expected: &Expected) -> f64 {
        match (self.times.last(), self.places.last()) {
            (Some(&last), Some(&place)) => place + (time - last) / expected.slowness,
            _ => f64::INFINITY,
        }
    }

    fn rise(&self) -> f64 {
        match (self.places.first(), self.places.last()) {
            (Some(first), Some(last)) => (last - first).abs(),
            _ => 0.0,
        }
    }
}

/// Follows voids over at least one wavelength each. Minima of phi over height, averaged over an eighth of a period and
/// located between nodes by a parabola, are linked to the track whose continuation is nearest, within a quarter of a
/// wavelength; a track ends when it has found no minimum for a quarter of a period.
pub(super) fn track_voids(
    rows: &Rows,
    bed: &Bed,
    expected: &Expected,
) -> Result<TrackedVoids, NoValue> {
    let wavelength = (expected.period / expected.slowness).abs();
    let smooth = smoothed(rows, expected.period / 8.0);
    let (mut open, mut closed): (Vec<Track>, Vec<Track>) = (Vec::new(), Vec::new());
    let mut gaps = Vec::new();
    for time in 0..smooth.times() {
        let voids = voids_of(&smooth.profile(time), bed, time, expected);
        gaps.extend(voids.windows(2).map(|pair| pair[1] - pair[0]));
        let now = time as f64;
        let lost = |track: &Track| {
            track.times.last().is_none_or(|last| now - last > 0.25 * expected.period)
        };
        let (ended, going): (Vec<Track>, Vec<Track>) = open.into_iter().partition(lost);
        closed.extend(ended);
        open = going;
        link(&mut open, voids, now, wavelength, expected);
    }
    closed.extend(open);
    let long: Vec<&Track> = closed.iter().filter(|track| track.rise() >= wavelength).collect();
    summary(&long, &gaps, rows)
}

fn smoothed(rows: &Rows, width: f64) -> Rows {
    let mut smooth = rows.clone();
    for row in &mut smooth.values {
        *row = running_mean(row, width);
    }
    smooth
}

/// Positions of sufficiently deep minima at places with waves, from the bottom upwards.
fn voids_of(profile: &[f64], bed: &Bed, time: usize, expected: &Expected) -> Vec<f64> {
    let depth = LEAST_DEPTH * expected.amplitude;
    let inverted: Vec<f64> = profile.iter().map(|phi| -phi).collect();
    let (bottom, top) = (bed.bottom[time].max(1), bed.top[time].min(profile.len() - 2));
    (bottom..=top)
        .filter(|&node| {
            expected.places[node][time]
                && inverted[node] > inverted[node - 1]
                && inverted[node] >= inverted[node + 1]
                && prominence(&inverted[bottom..=top], node - bottom) > depth
        })
        .map(|node| peak_near(&inverted, node))
        .collect()
}

/// Height of a peak above the higher one of the lowest points between it and the next higher peak on either side.
fn prominence(values: &[f64], peak: usize) -> f64 {
    let lowest = |side: &mut dyn Iterator<Item = &f64>| {
        let mut lowest = values[peak];
        for &value in side {
            if value > values[peak] {
                break;
            }
            lowest = lowest.min(value);
        }
        lowest
    };
    let below = lowest(&mut values[..peak].iter().rev());
    let above = lowest(&mut values[peak + 1..].iter());
    values[peak] - below.max(above)
}

fn link(open: &mut Vec<Track>, voids: Vec<f64>, now: f64, wavelength: f64, expected: &Expected) {
    let known = open.len();
    for place in voids {
        let distance = |track: &Track| (track.place_at(now, expected) - place).abs();
        let nearest = open[..known]
            .iter_mut()
            .filter(|track| track.times.last().is_some_and(|&last| last < now))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        match nearest {
            Some(track) if distance(track) < 0.25 * wavelength => {
                track.times.push(now);
                track.places.push(place);
            }
            _ => open.push(Track { times: vec![now], places: vec![place] }),
        }
    }
}

fn summary(tracks: &[&Track], gaps: &[f64], rows: &Rows) -> Result<TrackedVoids, NoValue> {
    let speeds: Vec<f64> = tracks
        .iter()
        .filter_map(|track| LineFit::of(&track.times, &track.places).ok())
        .map(|fit| fit.slope.value * rows.spacing / rows.interval)
        .collect();
    if speeds.len() < FEWEST || gaps.is_empty() {
        return Err(NoValue::because(format!(
            "{} voids could be followed over one wavelength; {FEWEST} are needed",
            speeds.len()
        )));
    }
    let speed = moments(&speeds)?;
    let gap = moments(gaps)?;
    let tracks = speeds.len();
    let independent = (tracks as f64).sqrt();
    Ok(TrackedVoids {
        speed: Estimate { value: speed.mean, error: speed.deviation / independent },
        speed_deviation: speed.deviation,
        spacing: Estimate {
            value: gap.mean * rows.spacing,
            error: gap.deviation * rows.spacing / independent,
        },
        tracks,
    })
}
