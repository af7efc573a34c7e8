//! States of a bed over windows of height and time.

use super::correlation::{SlownessGrid, Window};
use super::detection::{Criterion, Detection};
use super::field::Rows;
use super::motion::{Activity, Bed, SolidsFlux};
use crate::analysis::no_value::Estimate;

/// State of the bed in a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The bed does not fill the window.
    Empty,
    /// Waves travel through the whole window.
    Waves,
    /// Waves travel through part of the window's heights and times; the rest is still.
    Intermittent,
    /// No pattern travels; the solids fraction is constant, or its pattern stays in place.
    Frozen,
    /// The material rises, and its pattern with it.
    RisingPlug,
    /// The solids fraction varies, or the material sinks, but no pattern travels.
    Disordered,
}

/// A window of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Height of the window's middle. Length.
    pub height: f64,
    /// Time of the window's middle.
    pub time: f64,
    /// State of the bed there.
    pub state: State,
    /// Speed of the pattern, positive if it rises; given if the state is `Waves` or `Intermittent`, or if the pattern
    /// of a rising plug could be followed. Length over time.
    pub speed: Option<f64>,
    /// Mean velocity of the material, from the mass balance. Length over time.
    pub material_velocity: Estimate,
    /// Standard deviation of phi over time, at constant height.
    pub deviation: f64,
    /// Fraction of the variance of phi that travels, 0 to 1.
    pub travelling_share: f64,
    /// Probability that noise would show such a pattern.
    pub chance: f64,
    /// Fraction of the window's heights and times that vary like waves.
    pub active_share: f64,
}

/// Sizes of the windows and distances between them, in nodes and intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tiling {
    pub(super) heights: usize,
    pub(super) times: usize,
    pub(super) height_step: usize,
    pub(super) time_step: usize,
}

impl Tiling {
    pub(super) fn grid(&self) -> SlownessGrid {
        SlownessGrid::new(self.times, self.heights - 1)
    }

    /// All windows, first over times, then over heights.
    pub(super) fn windows(&self, rows: &Rows) -> Vec<Window> {
        let mut windows = Vec::new();
        if self.heights > rows.heights() || self.times > rows.times() {
            return windows;
        }
        for first_height in (0..=rows.heights() - self.heights).step_by(self.height_step) {
            for first_time in (0..=rows.times() - self.times).step_by(self.time_step) {
                let (heights, times) = (self.heights, self.times);
                windows.push(Window { first_height, heights, first_time, times });
            }
        }
        windows
    }

    /// Number of the tile to which a window belongs in the jackknife.
    pub(super) fn tile(&self, window: &Window) -> usize {
        // Larger than the number of columns of any record.
        const COLUMNS: usize = 1 << 20;
        window.first_height / self.heights * COLUMNS + window.first_time / self.times
    }
}

/// A window with its results.
#[derive(Clone, Debug)]
pub(super) struct Examined {
    pub(super) window: Window,
    pub(super) filled: bool,
    pub(super) detection: Option<Detection>,
}

/// Searches for travelling patterns in every window that the bed fills.
pub(super) fn examine(rows: &Rows, bed: &Bed, tiling: &Tiling) -> Vec<Examined> {
    let grid = tiling.grid();
    let windows = tiling.windows(rows).into_iter();
    windows
        .map(|window| {
            let filled = bed.fills(&window);
            let detection =
                filled.then(|| Detection::of(rows, window, &grid, tiling.heights - 1)).flatten();
            Examined { window, filled, detection }
        })
        .collect()
}

/// Criteria that distinguish the states.
pub(super) struct Judge<'a> {
    pub(super) rows: &'a Rows,
    pub(super) flux: &'a SolidsFlux,
    /// Places and times at which the bed varies like waves; `None` if no wave was found.
    pub(super) activity: Option<&'a Activity>,
    pub(super) criterion: Criterion,
    /// Standard deviation over time below which phi is constant.
    pub(super) still_deviation: f64,
}

impl Judge<'_> {
    pub(super) fn cell(&self, examined: &Examined) -> Cell {
        let window = &examined.window;
        let middle = |first: usize, count: usize| first as f64 + 0.5 * (count as f64 - 1.0);
        let detection = examined.detection.as_ref();
        let mut cell = Cell {
            height: self.rows.height_of(middle(window.first_height, window.heights)),
            time: self.rows.time_of(middle(window.first_time, window.times)),
            state: State::Empty,
            speed: None,
            material_velocity: self.flux.velocity(window),
            deviation: detection.map_or(0.0, |found| found.covariance.variance().sqrt()),
            travelling_share: detection.map_or(0.0, |found| found.share),
            chance: detection.map_or(1.0, |found| found.chance(self.criterion.expected)),
            active_share: self.activity.map_or(0.0, |activity| activity.share(window)),
        };
        if examined.filled {
            let travelling = detection.filter(|found| found.travels(self.criterion));
            cell.speed =
                travelling.map(|found| self.rows.spacing / (self.rows.interval * found.slowness));
            cell.state = self.state(&cell, window);
            if matches!(cell.state, State::Frozen | State::Disordered) {
                cell.speed = None;
            }
        }
        cell
    }

    fn state(&self, cell: &Cell, window: &Window) -> State {
        let velocity = cell.material_velocity;
        let duration = window.times as f64 * self.rows.interval;
        // The material must rise by at least a quarter of the spacing of heights within the window.
        let rises = velocity.value > 3.0 * velocity.error
            && velocity.value * duration > 0.25 * self.rows.spacing;
        let sinks = -velocity.value > 3.0 * velocity.error
            && -velocity.value * duration > self.rows.spacing;
        let moves_along = |speed: f64| rises && (speed - velocity.value).abs() < 0.25 * speed.abs();
        match cell.speed {
            Some(speed) if moves_along(speed) => State::RisingPlug,
            Some(_) if cell.active_share >= 0.75 => State::Waves,
            Some(_) if cell.active_share >= 0.25 => State::Intermittent,
            _ if sinks || !self.stands(cell, window) => State::Disordered,
            _ if rises => State::RisingPlug,
            _ => State::Frozen,
        }
    }

    /// Whether phi is constant, or most of its variance in the window is a pattern that stays in place, or it varies
    /// much less than in windows with waves.
    fn stands(&self, cell: &Cell, window: &Window) -> bool {
        let variance = cell.deviation * cell.deviation;
        let quiet = self.activity.is_some() && cell.active_share < 0.25;
        quiet
            || cell.deviation < self.still_deviation
            || variance < standing_variance(self.rows, window)
    }
}

/// Variance over height of the mean over time.
fn standing_variance(rows: &Rows, window: &Window) -> f64 {
    let heights = window.first_height..window.first_height + window.heights;
    let means: Vec<f64> = heights
        .map(|height| {
            let part = &rows.values[height][window.first_time..window.first_time + window.times];
            part.iter().sum::<f64>() / part.len() as f64
        })
        .collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    means.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / means.len() as f64
}
