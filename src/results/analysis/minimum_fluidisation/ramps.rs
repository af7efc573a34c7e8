//! Division of a series into a ramp up and a ramp down.

use crate::analysis::no_value::{NoValue, require_finite};

/// Relative difference, in units of the largest velocity, below which velocities are equal.
const EQUAL: f64 = 1e-9;
/// Smallest number of points of a ramp, and smallest fraction of the range of velocities that it spans.
const FEWEST_POINTS: usize = 4;
const LEAST_SPAN: f64 = 0.5;

/// Columns of a run's table, with one value for each time.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    /// Superficial gas velocity.
    pub velocities: &'a [f64],
    /// Pressure drop over the bed's weight per area, or gas force over the weight.
    pub pressure_drops: &'a [f64],
    /// Height of the bed. Length.
    pub bed_heights: Option<&'a [f64]>,
    /// Solids fraction of the bulk: without the layers at the bottom and the surface.
    pub solids_fractions: Option<&'a [f64]>,
}

/// Direction in which the velocity changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// It rises.
    Up,
    /// It falls.
    Down,
}

/// The points of one ramp, by ascending velocity; rows with the same velocity give one point, the mean of their later
/// half.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Whether the velocity rises or falls.
    pub direction: Direction,
    /// Superficial gas velocities.
    pub velocities: Vec<f64>,
    /// Pressure drops over the weight.
    pub pressure_drops: Vec<f64>,
    /// Bed heights, if the series has them.
    pub bed_heights: Option<Vec<f64>>,
    /// Solids fractions of the bulk, if the series has them.
    pub solids_fractions: Option<Vec<f64>>,
}

impl Branch {
    /// The pressure drop at a velocity, by linear interpolation between points; `None` outside.
    pub(super) fn pressure_drop_at(&self, velocity: f64) -> Option<f64> {
        let above = self.velocities.iter().position(|&other| other >= velocity)?;
        if above == 0 {
            return (self.velocities[0] <= velocity).then_some(self.pressure_drops[0]);
        }
        let (x0, x1) = (self.velocities[above - 1], self.velocities[above]);
        let (y0, y1) = (self.pressure_drops[above - 1], self.pressure_drops[above]);
        Some(y0 + (velocity - x0) / (x1 - x0) * (y1 - y0))
    }
}

/// The ramps up and down, or the reason why there is no such ramp. The ramp up ends with the first rows at the highest
/// velocity, and begins with the last rows at the lowest velocity before; the ramp down begins with the last rows at
/// the highest velocity, and ends with the first rows at the lowest velocity after that.
pub(super) fn split(series: &Series) -> Result<[Result<Branch, NoValue>; 2], NoValue> {
    check(series)?;
    let velocities = series.velocities;
    let highest = velocities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = velocities.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = highest.abs().max(lowest.abs());
    if highest - lowest <= EQUAL * scale {
        return Err(NoValue::because(format!("the gas velocity is constant, {highest}")));
    }
    let is_highest = |&velocity: &f64| velocity >= highest - EQUAL * scale;
    let first_top = velocities.iter().position(is_highest).unwrap_or(0);
    let last_top = velocities.iter().rposition(is_highest).unwrap_or(0);
    let minimum = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let before = &velocities[..=first_top];
    let least = minimum(before) + EQUAL * scale;
    let start = before.iter().rposition(|&velocity| velocity <= least).unwrap_or(0);
    let after = &velocities[last_top..];
    let least = minimum(after) + EQUAL * scale;
    let end = last_top + after.iter().position(|&velocity| velocity <= least).unwrap_or(0);
    let span = LEAST_SPAN * (highest - lowest);
    let same = |a: usize, b: usize| (velocities[a] - velocities[b]).abs() <= EQUAL * scale;
    let run_start = |row: usize| (0..=row).rev().take_while(|&other| same(row, other)).last();
    let run_end = |row: usize| (row..velocities.len()).take_while(|&other| same(row, other)).last();
    let rows = |first: usize, last: usize| {
        run_start(first).unwrap_or(first)..run_end(last).unwrap_or(last) + 1
    };
    Ok([
        branch(series, Direction::Up, rows(start, first_top), span),
        branch(series, Direction::Down, rows(last_top, end), span),
    ])
}

fn check(series: &Series) -> Result<(), NoValue> {
    require_finite("velocities", series.velocities)?;
    require_finite("pressure_drops", series.pressure_drops)?;
    let count = series.velocities.len();
    let lengths = [
        Some(series.pressure_drops.len()),
        series.bed_heights.map(<[f64]>::len),
        series.solids_fractions.map(<[f64]>::len),
    ];
    if lengths.into_iter().flatten().any(|length| length != count) {
        return Err(NoValue::because("the columns differ in length"));
    }
    if count < FEWEST_POINTS {
        return Err(NoValue::because(format!(
            "there are {count} rows; {FEWEST_POINTS} are needed"
        )));
    }
    Ok(())
}

fn branch(
    series: &Series,
    direction: Direction,
    rows: std::ops::Range<usize>,
    least_span: f64,
) -> Result<Branch, NoValue> {
    let velocities = &series.velocities[rows.clone()];
    let scale = velocities.iter().fold(0.0_f64, |scale, velocity| scale.max(velocity.abs()));
    let mut points: Vec<(f64, std::ops::Range<usize>)> = Vec::new();
    for row in rows {
        let velocity = series.velocities[row];
        match points.last_mut() {
            Some((same, range)) if (velocity - *same).abs() <= EQUAL * scale => range.end = row + 1,
            _ => points.push((velocity, row..row + 1)),
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let span =
        points.last().map_or(0.0, |last| last.0) - points.first().map_or(0.0, |first| first.0);
    if points.len() < FEWEST_POINTS || span < least_span {
        let way = if direction == Direction::Up { "rise" } else { "fall" };
        return Err(NoValue::because(format!(
            "the gas velocity does not {way} far enough: {} velocities over {span:.6}",
            points.len()
        )));
    }
    let mean = |column: &[f64]| -> Vec<f64> {
        points.iter().map(|(_, range)| mean_of_later_half(&column[range.clone()])).collect()
    };
    Ok(Branch {
        direction,
        velocities: points.iter().map(|(velocity, _)| *velocity).collect(),
        pressure_drops: mean(series.pressure_drops),
        bed_heights: series.bed_heights.map(mean),
        solids_fractions: series.solids_fractions.map(mean),
    })
}

fn mean_of_later_half(values: &[f64]) -> f64 {
    let later = &values[values.len() / 2..];
    later.iter().sum::<f64>() / later.len() as f64
}
