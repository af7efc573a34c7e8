//! The solids fraction in the frame of the material, and the fraction of the material that waves sweep.
//!
//! A layer of material is identified by the mass below it, m = ∫ phi dz up to its height, which is constant while
//! particles keep their order along the vertical. In a bed that stands, rises as a plug or swings with its plate, each
//! layer keeps its phi. When a wave passes, layers become dilute and dense again one after another, from below; a
//! single void is visible as clearly as a train of them.

use super::field::Rows;
use super::motion::deviation;
use crate::analysis::numerics::interpolation::value_at;

/// Solids fraction at which a layer is as thick as the spacing of nodes.
const PACKED: f64 = 0.6;
/// Smallest correlation of changes in time with those along the material. Measured in beds of 5 x 5 diameters: 0.75 to
/// 0.97 in waves, -0.6 to 0.7 in the few layers that vary in plugs and beds at rest, next to gaps.
const LEAST_CORRELATION: f64 = 0.5;

/// Fraction of the bed's layers of material, without the lowest and the highest, in which phi has a standard deviation
/// above `least_deviation` over the record and a pattern that rises through the material.
///
/// The rise is measured by r = -<d phi/dt d phi/dm> / sqrt(<(d phi/dt)^2> <(d phi/dm)^2>), with means over the record
/// at constant m: it is 1 if a pattern of constant shape rises through the material, -1 if it sinks, 0 if it stands.
/// Differences in time are taken over the lag at which phi of the varying layers has lost half of its correlation, so
/// that noise has little effect. The result is 0 for beds of fewer than three layers.
pub(super) fn swept_share(rows: &Rows, least_deviation: f64) -> f64 {
    let layers = layers(rows);
    let varies = |layer: &Vec<f64>| deviation(layer) > least_deviation;
    let Some(lag) = half_time(layers.iter().filter(|layer| varies(layer))) else { return 0.0 };
    let inner = layers.len().saturating_sub(2);
    let swept = layers
        .windows(3)
        .filter(|three| varies(&three[1]) && rise(three, lag.div_ceil(2)) > LEAST_CORRELATION)
        .count();
    swept as f64 / inner.max(1) as f64
}

/// phi of each layer of material over time, from the lowest layer upwards.
fn layers(rows: &Rows) -> Vec<Vec<f64>> {
    let profiles: Vec<Vec<f64>> = (0..rows.times()).map(|time| rows.profile(time)).collect();
    let mass: f64 = profiles.iter().flatten().sum();
    let count = libm::round(mass / profiles.len() as f64 / PACKED) as usize;
    let mut layers = vec![Vec::with_capacity(profiles.len()); count];
    for profile in &profiles {
        for (layer, place) in layers.iter_mut().zip(places_of_layers(profile, count)) {
            layer.push(value_at(profile, place));
        }
    }
    layers
}

/// The first lag, in intervals, at which the autocorrelation of rows falls below one half, or half of the record;
/// `None` without rows.
fn half_time<'a>(rows: impl Iterator<Item = &'a Vec<f64>>) -> Option<usize> {
    let changes: Vec<Vec<f64>> = rows
        .map(|row| {
            let mean = row.iter().sum::<f64>() / row.len() as f64;
            row.iter().map(|value| value - mean).collect()
        })
        .collect();
    let times = changes.first()?.len();
    let covariance = |lag: usize| {
        let products =
            changes.iter().flat_map(|row| row.iter().zip(&row[lag..]).map(|(a, b)| a * b));
        products.sum::<f64>() / (times - lag) as f64
    };
    let half = 0.5 * covariance(0);
    Some((1..times / 2).find(|&lag| covariance(lag) < half).unwrap_or(times / 2))
}

/// The correlation r of the middle one of three layers, with central differences over `step` intervals to either side.
fn rise(three: &[Vec<f64>], step: usize) -> f64 {
    let [below, row, above] = [&three[0], &three[1], &three[2]];
    let (mut products, mut in_time, mut along) = (0.0, 0.0, 0.0);
    for time in step..row.len().saturating_sub(step) {
        let change = row[time + step] - row[time - step];
        let difference = above[time] - below[time];
        products -= change * difference;
        in_time += change * change;
        along += difference * difference;
    }
    products / (in_time * along).sqrt().max(f64::MIN_POSITIVE)
}

/// Positions of the middles of `count` layers of equal mass, in nodes: where the mass below, linear between the edges
/// half-way between nodes, is (k + 1/2) / count of the whole.
fn places_of_layers(profile: &[f64], count: usize) -> Vec<f64> {
    let share = profile.iter().sum::<f64>() / count as f64;
    let (mut node, mut below) = (0, 0.0);
    (0..count)
        .map(|layer| {
            let mass = (layer as f64 + 0.5) * share;
            while node + 1 < profile.len() && below + profile[node] < mass {
                below += profile[node];
                node += 1;
            }
            let part = ((mass - below) / profile[node].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            node as f64 - 0.5 + part
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_lie_where_the_mass_below_them_is_theirs() {
        // The upper half is half as dense, so layers are twice as thick there.
        let profile = [0.6, 0.6, 0.6, 0.6, 0.3, 0.3, 0.3, 0.3];
        let places = places_of_layers(&profile, 6);
        let expected = [0.0, 1.0, 2.0, 3.0, 4.5, 6.5];
        for (place, expected) in places.iter().zip(expected) {
            assert!((place - expected).abs() < 1e-12, "{places:?}");
        }
    }
}
