//! The front between the part of a bed that has waves and the part that is still.

use super::field::Rows;
use super::motion::{Activity, Bed};
use crate::analysis::LineFit;
use crate::analysis::no_value::{Estimate, NoValue};

/// Largest fraction of a column's heights that may lie on the wrong side of the front.
const MOST_MISPLACED: f64 = 0.15;
/// Number of heights at either end of the bed that a front must leave free.
const MARGIN: usize = 2;
/// Smallest number of columns with a front.
const FEWEST: usize = 4;

/// A front that moves through the bed.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// Whether the waves are below the front (and the still part above it).
    pub waves_below: bool,
    /// Times at which there is a front.
    pub times: Vec<f64>,
    /// Its height at these times. Length.
    pub heights: Vec<f64>,
    /// Its speed from a straight line through its heights; negative if it descends. Length over time.
    pub speed: Estimate,
    /// Fraction of the variance of the heights that the line explains, R^2.
    pub determination: f64,
}

/// Finds the height at each time that best separates active from still places, and the speed at which it moves.
pub(super) fn find_front(rows: &Rows, bed: &Bed, activity: &Activity) -> Result<Front, NoValue> {
    let columns: Vec<Column> =
        (0..activity.columns()).filter_map(|column| Column::of(bed, activity, column)).collect();
    let total = |of: &dyn Fn(&Column) -> usize| columns.iter().map(of).sum::<usize>();
    let waves_below =
        total(&|column| column.split(true).1) <= total(&|column| column.split(false).1);
    let (mut times, mut heights) = (Vec::new(), Vec::new());
    for column in &columns {
        let (place, misplaced) = column.split(waves_below);
        let inside = place >= MARGIN && place + MARGIN <= column.active.len();
        if inside && misplaced as f64 <= MOST_MISPLACED * column.active.len() as f64 {
            times.push(rows.time_of(activity.time(column.index) as f64));
            heights.push(rows.height_of((column.bottom + place) as f64 - 0.5));
        }
    }
    if times.len() < FEWEST {
        let found = times.len();
        return Err(NoValue::because(format!(
            "at {found} of {} times a height parts waves from a still bed; {FEWEST} are needed",
            columns.len()
        )));
    }
    let fit = LineFit::of(&times, &heights)?;
    let error = fit.slope.error * inflation(&times, &heights, fit.slope.value, fit.intercept.value);
    let speed = Estimate { value: fit.slope.value, error };
    Ok(Front { waves_below, times, heights, speed, determination: fit.determination })
}

/// sqrt((1 + r) / (1 - r)), where r is the correlation of one residual with the next: the factor by which the error of
/// a slope increases if residuals are not independent (first-order process).
fn inflation(x: &[f64], y: &[f64], slope: f64, intercept: f64) -> f64 {
    let residuals: Vec<f64> = x.iter().zip(y).map(|(x, y)| y - slope * x - intercept).collect();
    let squares: f64 = residuals.iter().map(|value| value * value).sum();
    let products: f64 = residuals.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let r = if squares > 0.0 { (products / squares).clamp(0.0, 0.9) } else { 0.0 };
    ((1.0 + r) / (1.0 - r)).sqrt()
}

/// The active nodes of the bed at one time.
struct Column {
    index: usize,
    bottom: usize,
    active: Vec<bool>,
}

impl Column {
    fn of(bed: &Bed, activity: &Activity, index: usize) -> Option<Self> {
        let time = activity.time(index);
        let (bottom, top) = (*bed.bottom.get(time)?, *bed.top.get(time)?);
        let active = (bottom..=top).map(|height| activity.is_active(height, index)).collect();
        (top > bottom + 2 * MARGIN).then_some(Self { index, bottom, active })
    }

    /// The number of nodes below the front for which the fewest are on the wrong side of it, and the number of these.
    fn split(&self, waves_below: bool) -> (usize, usize) {
        let mut misplaced = self.active.iter().filter(|&&active| active == waves_below).count();
        let mut best = (0, misplaced);
        for (index, &active) in self.active.iter().enumerate() {
            if active == waves_below {
                misplaced -= 1;
            } else {
                misplaced += 1;
            }
            if misplaced < best.1 {
                best = (index + 1, misplaced);
            }
        }
        best
    }
}
