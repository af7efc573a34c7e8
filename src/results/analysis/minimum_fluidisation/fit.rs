//! Ergun's form for the packed bed, and the plateau of the fluidised one.

use super::ramps::{Branch, Direction};
use crate::analysis::no_value::{Estimate, NoValue};
use crate::analysis::statistics::moments;

/// Fractions of the plateau between which the bed is treated as packed: below, the signal is small; above, parts of the
/// bed may already move.
const PACKED_BETWEEN: (f64, f64) = (0.1, 0.8);
/// Multiple of U_mf beyond which the plateau is determined.
const BEYOND: f64 = 1.2;
/// Smallest numbers of points for the packed bed and the plateau.
const FEWEST_PACKED: usize = 4;
const FEWEST_FLUIDISED: usize = 3;
/// Value of R^2 below which the packed part does not follow Ergun's form.
const LEAST_DETERMINATION: f64 = 0.9;
/// Largest relative rise of the plateau from its first to its last third.
const MOST_RISE: f64 = 0.15;
/// Largest relative change of height of a packed bed.
const MOST_EXPANSION: f64 = 0.05;
/// Number of rounds in which plateau and packed part are determined from each other.
const ROUNDS: usize = 8;

/// Minimum fluidisation of one ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Minimum fluidisation velocity.
    pub velocity: Estimate,
    /// a in dp = a U + b U^2, over the weight. 1 over velocity.
    pub linear: f64,
    /// b, likewise. 1 over the square of velocity.
    pub quadratic: f64,
    /// Fraction of the variance of the packed bed's points that the form explains, R^2.
    pub determination: f64,
    /// Level of the plateau over the weight.
    pub plateau: Estimate,
    /// Highest pressure drop over the weight, as the median of three neighbouring points: on a ramp up it exceeds the
    /// plateau if the bed is cohesive or adheres to its walls.
    pub peak: f64,
    /// Velocity of that peak.
    pub peak_velocity: f64,
    /// Solids fraction of the bulk in the upper half of the packed part, if it is known.
    pub solids_fraction: Option<Estimate>,
    /// Height of the bed there, if it is known. Length.
    pub bed_height: Option<f64>,
}

/// Fits one ramp. Fails, with a reason, if no plateau is reached, there are too few points, the packed part does not
/// follow Ergun's form, or the bed is not packed.
pub fn fit_branch(branch: &Branch) -> Result<Fit, NoValue> {
    let (packed, form, plateau) = packed_bed(branch)?;
    let plateau = level(branch, BEYOND * form.velocity(plateau))?;
    form.check(branch, &packed)?;
    check_packed(branch, &packed)?;
    let (peak, peak_velocity) = peak(branch);
    let upper = &packed[packed.len() / 2..];
    let mean =
        |column: &Vec<f64>| moments(&upper.iter().map(|&index| column[index]).collect::<Vec<_>>());
    Ok(Fit {
        velocity: form.estimate(plateau),
        linear: form.linear,
        quadratic: form.quadratic,
        determination: form.determination,
        plateau,
        peak,
        peak_velocity,
        solids_fraction: branch.solids_fractions.as_ref().and_then(|column| {
            let found = mean(column).ok()?;
            Some(Estimate {
                value: found.mean,
                error: found.deviation / (found.count as f64).sqrt(),
            })
        }),
        bed_height: branch.bed_heights.as_ref().and_then(|column| Some(mean(column).ok()?.mean)),
    })
}

/// Points of the packed bed, their form, and the approximate level of the plateau, determined from each other in turns.
fn packed_bed(branch: &Branch) -> Result<(Vec<usize>, Form, f64), NoValue> {
    let highest = branch.velocities[branch.velocities.len() - 1];
    let mut plateau = median_beyond(branch, 0.75 * highest);
    let mut packed = packed_points(branch, plateau)?;
    let mut form = Form::of(branch, &packed)?;
    for _ in 0..ROUNDS {
        let beyond = BEYOND * form.velocity(plateau);
        plateau = median_beyond(branch, beyond.min(0.75 * highest));
        packed = packed_points(branch, plateau)?;
        form = Form::of(branch, &packed)?;
    }
    Ok((packed, form, plateau))
}

/// Median pressure drop at velocities of at least `least`.
fn median_beyond(branch: &Branch, least: f64) -> f64 {
    let points = branch.velocities.iter().zip(&branch.pressure_drops);
    let mut values: Vec<f64> =
        points.filter(|(velocity, _)| **velocity >= least).map(|(_, drop)| *drop).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Points of positive velocity whose pressure drop lies between the two fractions of the plateau, before the first one
/// above.
fn packed_points(branch: &Branch, plateau: f64) -> Result<Vec<usize>, NoValue> {
    if plateau <= 0.0 {
        return Err(NoValue::because(
            "the pressure drop at the highest velocities is not positive",
        ));
    }
    let drops = &branch.pressure_drops;
    let above = drops.iter().position(|&drop| drop > PACKED_BETWEEN.1 * plateau);
    let packed: Vec<usize> = (0..above.unwrap_or(drops.len()))
        .filter(|&index| {
            drops[index] > PACKED_BETWEEN.0 * plateau && branch.velocities[index] > 0.0
        })
        .collect();
    if packed.len() < FEWEST_PACKED {
        return Err(NoValue::because(format!(
            "{} points have a pressure drop between {} and {} of the plateau's {plateau:.4}; {FEWEST_PACKED} of \
             the packed bed are needed",
            packed.len(),
            PACKED_BETWEEN.0,
            PACKED_BETWEEN.1
        )));
    }
    Ok(packed)
}

/// Level of the plateau beyond a velocity. Its error is that of blocks: thirds of the points, or single points if these
/// are few.
fn level(branch: &Branch, least: f64) -> Result<Estimate, NoValue> {
    let highest = branch.velocities[branch.velocities.len() - 1];
    let points = branch.velocities.iter().zip(&branch.pressure_drops);
    let drops: Vec<f64> =
        points.filter(|(velocity, _)| **velocity >= least).map(|(_, drop)| *drop).collect();
    if drops.len() < FEWEST_FLUIDISED {
        return Err(NoValue::because(format!(
            "no plateau is reached: the velocity goes to {highest:.6}, and {} points lie beyond {BEYOND} times the \
             apparent minimum fluidisation velocity, {:.6}; {FEWEST_FLUIDISED} are needed",
            drops.len(),
            least / BEYOND
        )));
    }
    let third = drops.len().div_ceil(3);
    let blocks: Vec<f64> =
        drops.chunks(third).map(|block| block.iter().sum::<f64>() / block.len() as f64).collect();
    let found = moments(&drops)?;
    let rise = blocks[blocks.len() - 1] - blocks[0];
    if rise > MOST_RISE * found.mean {
        return Err(NoValue::because(format!(
            "no plateau is reached: beyond {least:.6} the pressure drop still rises by {rise:.3} of the weight"
        )));
    }
    let between = moments(&blocks)?.deviation / (blocks.len() as f64).sqrt();
    let single = found.deviation / (found.count as f64).sqrt();
    Ok(Estimate { value: found.mean, error: between.max(single) })
}

fn check_packed(branch: &Branch, packed: &[usize]) -> Result<(), NoValue> {
    let Some(heights) = &branch.bed_heights else { return Ok(()) };
    let used = packed.iter().map(|&index| heights[index]);
    let lowest = used.clone().fold(f64::INFINITY, f64::min);
    let highest = used.fold(f64::NEG_INFINITY, f64::max);
    if highest - lowest > MOST_EXPANSION * lowest {
        return Err(NoValue::because(format!(
            "the bed is not packed where its pressure drop is fitted: its height changes from {lowest:.6} to \
             {highest:.6}"
        )));
    }
    Ok(())
}

/// The highest median of three neighbouring points, and its velocity.
fn peak(branch: &Branch) -> (f64, f64) {
    let middle = |values: &[f64]| {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[1]
    };
    branch
        .pressure_drops
        .windows(3)
        .zip(&branch.velocities[1..])
        .map(|(drops, &velocity)| (middle(drops), velocity))
        .fold((f64::NEG_INFINITY, 0.0), |best, point| if point.0 > best.0 { point } else { best })
}

/// dp = linear U + quadratic U^2, least squares without negative constants.
struct Form {
    linear: f64,
    quadratic: f64,
    determination: f64,
    /// Covariances of the constants: variance of `linear`, variance of `quadratic`, covariance of both.
    covariance: [f64; 3],
}

impl Form {
    fn of(branch: &Branch, packed: &[usize]) -> Result<Self, NoValue> {
        // Velocities are divided by the largest, so that the sums are of similar size.
        let unit = branch.velocities[packed[packed.len() - 1]];
        let points: Vec<(f64, f64)> = packed
            .iter()
            .map(|&index| (branch.velocities[index] / unit, branch.pressure_drops[index]))
            .collect();
        let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(x, y)| of(x, y)).sum::<f64>();
        let (x2, x3, x4) = (sum(&|x, _| x * x), sum(&|x, _| x * x * x), sum(&|x, _| x * x * x * x));
        let (xy, xxy) = (sum(&|x, y| x * y), sum(&|x, y| x * x * y));
        let determinant = x2 * x4 - x3 * x3;
        if determinant <= 1e-12 * x2 * x4 {
            return Err(NoValue::because("the packed bed's points have nearly one velocity"));
        }
        let both = ((xy * x4 - xxy * x3) / determinant, (xxy * x2 - xy * x3) / determinant);
        let (linear, quadratic) = match both {
            (linear, _) if linear < 0.0 => (0.0, xxy / x4),
            (_, quadratic) if quadratic < 0.0 => (xy / x2, 0.0),
            free => free,
        };
        let residuals: Vec<f64> =
            points.iter().map(|(x, y)| y - linear * x - quadratic * x * x).collect();
        let left: f64 = residuals.iter().map(|value| value * value).sum();
        let mean = sum(&|_, y| y) / points.len() as f64;
        let all = sum(&|_, y| (y - mean) * (y - mean));
        let variance = left / (points.len() as f64 - 2.0) * inflation(&residuals, left);
        let covariance = match (linear == 0.0, quadratic == 0.0) {
            (true, _) => [0.0, variance / x4, 0.0],
            (_, true) => [variance / x2, 0.0, 0.0],
            _ => [x4, x2, -x3].map(|entry| variance * entry / determinant),
        };
        let scales = [unit * unit, unit * unit * unit * unit, unit * unit * unit];
        Ok(Self {
            linear: linear / unit,
            quadratic: quadratic / (unit * unit),
            determination: if all > 0.0 { 1.0 - left / all } else { 0.0 },
            covariance: [0, 1, 2].map(|entry| covariance[entry] / scales[entry]),
        })
    }

    /// Velocity at which the form reaches a pressure drop.
    fn velocity(&self, plateau: f64) -> f64 {
        let root = (self.linear * self.linear + 4.0 * self.quadratic * plateau).sqrt();
        2.0 * plateau / (self.linear + root)
    }

    /// dU = (dP - U da - U^2 db) / (a + 2 b U).
    fn estimate(&self, plateau: Estimate) -> Estimate {
        let u = self.velocity(plateau.value);
        let [of_linear, of_quadratic, of_both] = self.covariance;
        let variance = plateau.error * plateau.error
            + u * u * (of_linear + u * u * of_quadratic + 2.0 * u * of_both);
        let slope = self.linear + 2.0 * self.quadratic * u;
        Estimate { value: u, error: variance.max(0.0).sqrt() / slope }
    }

    fn check(&self, branch: &Branch, packed: &[usize]) -> Result<(), NoValue> {
        if self.determination >= LEAST_DETERMINATION {
            return Ok(());
        }
        let way = if branch.direction == Direction::Up { "up" } else { "down" };
        Err(NoValue::because(format!(
            "on the way {way} the pressure drop does not rise with the velocity as in a packed bed (R^2 {:.2} of {} \
             points)",
            self.determination,
            packed.len()
        )))
    }
}

/// (1 + r) / (1 - r), where r is the correlation of one residual with the next: the factor of the variance for
/// residuals that are not independent.
fn inflation(residuals: &[f64], squares: f64) -> f64 {
    let products: f64 = residuals.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let r = if squares > 0.0 { (products / squares).clamp(0.0, 0.9) } else { 0.0 };
    (1.0 + r) / (1.0 - r)
}
