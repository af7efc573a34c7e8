//! The map of a bed's states, and its summary.

use super::WaveOptions;
use super::correlation::Window;
use super::field::Rows;
use super::front::{Front, find_front};
use super::map::{Cell, Examined, Judge, State, Tiling, examine};
use super::material::swept_share;
use super::motion::{Activity, Bed, SolidsFlux};
use super::pool::{Member, PooledWaves, pool};
use super::scale::{LEAST_PART, Scale, find_scale};
use super::voids::{Expected, TrackedVoids, track_voids};
use crate::analysis::no_value::{Estimate, NoValue};

/// Least fraction of a bed with waves for which the whole bed counts as having waves.
const WHOLE: f64 = 0.9;
/// Fraction of the material that waves must sweep if no window shows waves: gaps that open in beds without waves reach
/// up to 0.15.
const LEAST_SWEPT: f64 = 0.25;

/// Waves of all windows in which they were found. Standard errors are infinite if there are too few windows.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves {
    /// Speed, positive if they rise. Length over time.
    pub speed: Estimate,
    /// Time after which the pattern repeats.
    pub period: Result<Estimate, NoValue>,
    /// Speed times period. Length.
    pub wavelength: Result<Estimate, NoValue>,
    /// Amplitude of the sine with the variance of the travelling pattern, without noise. In a vibrated bed it is
    /// corrected for the average over the plate's period, but not for the shift of heights between nodes, which removes
    /// up to a fifth for waves of four nodes. Solids fraction.
    pub amplitude: Estimate,
    /// 1st and 99th percentile of phi, noise included: this is the lower one.
    pub lowest: f64,
    /// The upper one; see `lowest`.
    pub highest: f64,
}

/// Fractions of the windows that the bed fills, by state; their sum is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateShares {
    /// Fraction of the windows that are full of waves.
    pub waves: f64,
    /// Fraction of the windows with waves in places.
    pub intermittent: f64,
    /// Fraction that is still.
    pub frozen: f64,
    /// Fraction that rises as a plug.
    pub rising_plug: f64,
    /// Fraction that varies without waves.
    pub disordered: f64,
}

/// State of the whole bed. Waves that no window shows are recognised by the fraction of the material that they sweep:
/// nine tenths of it for `Waves`, a quarter for `WavesInPart`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BedState {
    /// Waves in at least nine tenths of the windows, in the whole window or in places.
    Waves,
    /// Waves in part of the heights or times; the bed is still or moves without waves elsewhere.
    WavesInPart,
    /// Waves start and stop at least twice at most heights.
    Intermittent,
    /// No waves; most of the bed is still.
    Frozen,
    /// No waves; most of the bed rises as a plug.
    RisingPlug,
    /// No waves, but most of the bed is in motion.
    Disordered,
}

/// State at one height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightState {
    /// Height of the windows' middle. Length.
    pub height: f64,
    /// Fraction of the time with waves; windows with waves in places count fully.
    pub waves_share: f64,
    /// Number of times that waves began or ended.
    pub changes: usize,
}

/// State of the bed at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeState {
    /// Time of the windows' middle.
    pub time: f64,
    /// Fractions of the bed in each state.
    pub shares: StateShares,
}

/// States of a bed over height and time, and its waves.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveMap {
    /// Windows, first over times, then over heights.
    pub cells: Vec<Cell>,
    /// Height of a window. Length.
    pub window_height: f64,
    /// Duration of a window.
    pub window_duration: f64,
    /// The bed as a whole.
    pub state: BedState,
    /// Fractions of the bed in each state.
    pub shares: StateShares,
    /// Fraction of the bed's material that waves sweep in the course of the record, periodic or not: layers in whose
    /// own frame phi has a standard deviation above `still_deviation` over time, and a pattern that rises through them.
    pub swept_share: f64,
    /// Height by height.
    pub heights: Vec<HeightState>,
    /// Time by time.
    pub times: Vec<TimeState>,
    /// Speed, period, wavelength and amplitude, or the reason why there are none.
    pub waves: Result<Waves, NoValue>,
    /// The front between waves and still bed, or the reason why there is none.
    pub front: Result<Front, NoValue>,
    /// The waves from the tracks of voids.
    pub voids: Result<TrackedVoids, NoValue>,
}

pub(super) fn map_rows(rows: &Rows, options: &WaveOptions) -> Result<WaveMap, NoValue> {
    if !rows.values.iter().flatten().any(|&phi| phi > 0.0) {
        return Err(NoValue::because("the field holds no solids"));
    }
    let bed = Bed::of(rows);
    let Scale { tiling, period, slowness } = find_scale(rows, &bed, options);
    let examined = examine(rows, &bed, &tiling);
    // A pattern that does not repeat within a window has a period longer than the window.
    let span = period.or(slowness.map(|_| tiling.times as f64));
    let activity = activity(rows, &examined, span, options);
    let expected = slowness.filter(|_| activity.is_some());
    let flux = SolidsFlux::of(rows);
    let judge = Judge {
        rows,
        flux: &flux,
        activity: activity.as_ref(),
        criterion: options.criterion(expected),
        still_deviation: options.still_deviation,
    };
    let cells: Vec<Cell> = examined.iter().map(|examined| judge.cell(examined)).collect();
    let found = Found { rows, bed: &bed, tiling: &tiling, examined: &examined, cells: &cells };
    let pooled = found.pool();
    let shares = shares(&cells.iter().collect::<Vec<_>>());
    let heights = height_states(&cells);
    let swept_share = swept_share(rows, options.still_deviation);
    let none = || NoValue::because("the bed has no waves");
    Ok(WaveMap {
        window_height: tiling.heights as f64 * rows.spacing,
        window_duration: tiling.times as f64 * rows.interval,
        state: bed_state(&shares, &heights, swept_share),
        shares,
        swept_share,
        heights,
        times: time_states(&cells),
        waves: pooled.as_ref().map(|pooled| found.waves(pooled)).map_err(Clone::clone),
        front: match (&pooled, &activity) {
            (Ok(_), Some(activity)) => find_front(rows, &bed, activity),
            _ => Err(none()),
        },
        voids: pooled.and_then(|pooled| found.voids(&pooled)),
        cells,
    })
}

/// The activity over the period of the waves: the places at which the field varies as it does where waves travel.
/// `None` if they travel hardly anywhere.
fn activity(
    rows: &Rows,
    examined: &[Examined],
    span: Option<f64>,
    options: &WaveOptions,
) -> Option<Activity> {
    let span = (libm::round(span?) as usize).clamp(2, rows.times());
    let filled = examined.iter().filter(|examined| examined.filled).count();
    let travelling: Vec<Window> = examined
        .iter()
        .filter(|examined| {
            let detection = examined.detection.as_ref();
            detection.is_some_and(|found| found.travels(options.criterion(None)))
        })
        .map(|examined| examined.window)
        .collect();
    if (travelling.len() as f64) < LEAST_PART * filled.max(1) as f64 {
        return None;
    }
    let mut activity = Activity::of(rows, span);
    activity.set_threshold(&travelling);
    Some(activity)
}

/// All results from which the properties of the waves are computed.
struct Found<'a> {
    rows: &'a Rows,
    bed: &'a Bed,
    tiling: &'a Tiling,
    examined: &'a [Examined],
    cells: &'a [Cell],
}

fn has_waves(cell: &Cell) -> bool {
    matches!(cell.state, State::Waves | State::Intermittent)
}

impl Found<'_> {
    fn pool(&self) -> Result<PooledWaves, NoValue> {
        let members: Vec<Member> = self
            .examined
            .iter()
            .zip(self.cells)
            .filter(|(_, cell)| has_waves(cell))
            .filter_map(|(examined, _)| {
                let detection = examined.detection.as_ref()?;
                Some(Member { detection, tile: self.tiling.tile(&examined.window) })
            })
            .collect();
        let filled = self.cells.iter().filter(|cell| cell.state != State::Empty).count();
        if (members.len() as f64) < LEAST_PART * filled as f64 || members.is_empty() {
            return Err(NoValue::because(format!(
                "waves were found in {} of the {filled} windows that the bed fills",
                members.len()
            )));
        }
        pool(&members, &self.tiling.grid())
    }

    /// Converts from nodes and intervals to the units of the field.
    fn waves(&self, pooled: &PooledWaves) -> Waves {
        let (spacing, interval) = (self.rows.spacing, self.rows.interval);
        let slowness = pooled.slowness;
        let value = spacing / (interval * slowness.value);
        let speed = Estimate { value, error: (value * slowness.error / slowness.value).abs() };
        let period = pooled.period.clone().map(|period| Estimate {
            value: period.value * interval,
            error: period.error * interval,
        });
        let wavelength = period.clone().map(|period| product(speed, period));
        let attenuation = period.as_ref().map_or(1.0, |found| self.rows.attenuation(found.value));
        let amplitude = pooled.squared_amplitude.value.sqrt();
        let error = 0.5 * pooled.squared_amplitude.error / amplitude;
        let (lowest, highest) = self.extremes();
        let amplitude = Estimate { value: amplitude / attenuation, error: error / attenuation };
        Waves { speed, period, wavelength, amplitude, lowest, highest }
    }

    /// The heights and times of all windows with waves.
    fn places(&self) -> Vec<Vec<bool>> {
        let mut inside = vec![vec![false; self.rows.times()]; self.rows.heights()];
        for (examined, cell) in self.examined.iter().zip(self.cells) {
            if has_waves(cell) {
                let window = &examined.window;
                for row in &mut inside[window.first_height..window.first_height + window.heights] {
                    row[window.first_time..window.first_time + window.times].fill(true);
                }
            }
        }
        inside
    }

    /// The 1st and 99th percentile of phi at places with waves.
    fn extremes(&self) -> (f64, f64) {
        let inside = self.places();
        let places = self.rows.values.iter().flatten().zip(inside.iter().flatten());
        let mut values: Vec<f64> =
            places.filter(|(_, inside)| **inside).map(|(phi, _)| *phi).collect();
        values.sort_by(f64::total_cmp);
        let at = |part: f64| values.get((part * values.len() as f64) as usize).copied();
        (at(0.01).unwrap_or(0.0), at(0.99).unwrap_or(0.0))
    }

    fn voids(&self, pooled: &PooledWaves) -> Result<TrackedVoids, NoValue> {
        let period = pooled.period.clone()?.value;
        let amplitude = pooled.squared_amplitude.value.sqrt();
        let slowness = pooled.slowness.value;
        let expected = Expected { places: self.places(), slowness, period, amplitude };
        track_voids(self.rows, self.bed, &expected)
    }
}

/// Product of two values whose errors are independent; positive.
fn product(a: Estimate, b: Estimate) -> Estimate {
    let value = (a.value * b.value).abs();
    let (of_a, of_b) = (a.error / a.value, b.error / b.value);
    Estimate { value, error: value * (of_a * of_a + of_b * of_b).sqrt() }
}

fn shares(cells: &[&Cell]) -> StateShares {
    let filled = cells.iter().filter(|cell| cell.state != State::Empty).count().max(1) as f64;
    let share =
        |state: State| cells.iter().filter(|cell| cell.state == state).count() as f64 / filled;
    StateShares {
        waves: share(State::Waves),
        intermittent: share(State::Intermittent),
        frozen: share(State::Frozen),
        rising_plug: share(State::RisingPlug),
        disordered: share(State::Disordered),
    }
}

fn time_states(cells: &[Cell]) -> Vec<TimeState> {
    let first = cells.chunk_by(|a, b| a.height == b.height).next().unwrap_or_default();
    first
        .iter()
        .enumerate()
        .map(|(column, cell)| {
            let at_once: Vec<&Cell> = cells.iter().skip(column).step_by(first.len()).collect();
            TimeState { time: cell.time, shares: shares(&at_once) }
        })
        .collect()
}

fn height_states(cells: &[Cell]) -> Vec<HeightState> {
    let filled: Vec<&Cell> = cells.iter().filter(|cell| cell.state != State::Empty).collect();
    filled
        .chunk_by(|a, b| a.height == b.height)
        .map(|row| {
            let shares =
                row.iter().map(|cell| if has_waves(cell) { cell.active_share } else { 0.0 });
            HeightState {
                height: row[0].height,
                waves_share: shares.sum::<f64>() / row.len() as f64,
                changes: row.windows(2).filter(|pair| is_on(pair[0]) != is_on(pair[1])).count(),
            }
        })
        .collect()
}

/// Whether waves fill more than half of a window.
fn is_on(cell: &Cell) -> bool {
    has_waves(cell) && cell.active_share > 0.5
}

fn bed_state(shares: &StateShares, heights: &[HeightState], swept: f64) -> BedState {
    let waves = shares.waves + shares.intermittent;
    if waves < LEAST_PART {
        if swept >= LEAST_SWEPT {
            return if swept >= WHOLE { BedState::Waves } else { BedState::WavesInPart };
        }
        if shares.frozen + shares.rising_plug <= shares.disordered {
            return BedState::Disordered;
        }
        let rises = shares.rising_plug > shares.frozen;
        return if rises { BedState::RisingPlug } else { BedState::Frozen };
    }
    let alternating = heights.iter().filter(|height| height.changes >= 2).count();
    if shares.waves < WHOLE && 2 * alternating > heights.len() {
        BedState::Intermittent
    } else if waves >= WHOLE {
        BedState::Waves
    } else {
        BedState::WavesInPart
    }
}
