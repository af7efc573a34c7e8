//! Sizes of windows that suit the waves of a bed.

use super::WaveOptions;
use super::correlation::SlownessGrid;
use super::field::Rows;
use super::map::{Examined, Tiling, examine};
use super::motion::{Bed, SolidsFlux};
use super::pool::{Member, pool};

/// Windows that are tried first, as fractions of the record and of the bed.
const PARTS_OF_RECORD: [usize; 6] = [1, 2, 4, 8, 16, 32];
const PARTS_OF_BED: [usize; 3] = [2, 4, 8];
/// Smallest window, in heights and times.
const FEWEST_HEIGHTS: usize = 6;
const FEWEST_TIMES: usize = 24;
/// The fraction of the windows that must have waves: more than chance gives, for any number of windows.
pub(super) const LEAST_PART: f64 = 0.04;
/// Probability, for the windows of one size together, of a pattern that counts although it does not repeat: about
/// twenty sizes are tried.
const CERTAIN: f64 = 1.0e-6;
/// Relative difference from their mean below which the slownesses of windows belong to the same waves.
const AGREEMENT: f64 = 0.25;
/// Sizes of a window in periods and wavelengths.
const PERIODS: f64 = 3.0;
const WAVELENGTHS: f64 = 2.5;

/// Smallest number of heights of a window in a bed that is twice as high: with fewer, waves that repeat regularly
/// cannot be distinguished from chance.
const ENOUGH_HEIGHTS: f64 = 14.0;

/// Distance between windows in periods: not a multiple of half a period, so that their ends have different phases.
const TIME_STEP: f64 = 0.4;

/// Windows for a bed, and its waves if there are any: period in intervals, slowness in intervals per node.
pub(super) struct Scale {
    pub(super) tiling: Tiling,
    pub(super) period: Option<f64>,
    pub(super) slowness: Option<f64>,
}

/// Waves of the windows of one size.
struct Trial {
    tiling: Tiling,
    /// Fraction of the windows in which a pattern travels.
    share: f64,
    slowness: f64,
    /// `None` if the pattern does not repeat within a window.
    period: Option<f64>,
    /// Whether enough windows show it, with one speed, to exclude chance and a moving plug.
    is_certain: bool,
}

/// Tries windows of several sizes. Among those in which a pattern travels and repeats, the size with the largest
/// fraction of such windows gives period and wavelength, which determine the windows to be used. If no pattern repeats,
/// the size with the largest fraction of windows with a travelling pattern is used. Sizes given in the options take
/// precedence.
pub(super) fn find_scale(rows: &Rows, bed: &Bed, options: &WaveOptions) -> Scale {
    let extent = bed_heights(bed).clamp(FEWEST_HEIGHTS, rows.heights());
    let trials = trials(rows, bed, extent, options);
    let best = |of: &dyn Fn(&&Trial) -> bool| {
        let found = trials.iter().filter(of);
        found.reduce(|best, trial| if trial.share > best.share { trial } else { best })
    };
    let best = best(&|trial| trial.period.is_some()).or_else(|| best(&|trial| trial.is_certain));
    let (period, slowness) = (best.and_then(|best| best.period), best.map(|best| best.slowness));
    let wavelength = slowness.zip(period).map(|(slowness, period)| period / slowness.abs());
    let tried = |size: fn(&Tiling) -> usize| best.map(|best| size(&best.tiling) as f64);
    let times = period.map(|period| PERIODS * period).or(tried(|tiling| tiling.times));
    let heights = wavelength.map(|length| WAVELENGTHS * length).or(tried(|tiling| tiling.heights));
    let times = times.unwrap_or(rows.times() as f64 / 4.0);
    let heights = heights.unwrap_or(extent as f64 / 6.0);
    let heights = heights.max(ENOUGH_HEIGHTS.min(0.5 * extent as f64));
    let times = options.window_duration.map_or(times, |duration| duration / rows.interval);
    let heights = options.window_height.map_or(heights, |height| height / rows.spacing);
    let tiling = tiling(rows, extent, times, heights, period);
    Scale { tiling, period, slowness }
}

/// Window sizes for which a pattern travels in some of the windows.
fn trials(rows: &Rows, bed: &Bed, extent: usize, options: &WaveOptions) -> Vec<Trial> {
    let mut trials = Vec::new();
    for part in PARTS_OF_RECORD {
        let times = rows.times() / part;
        for part in PARTS_OF_BED {
            let heights = extent / part;
            if times < FEWEST_TIMES.min(rows.times()) || heights < FEWEST_HEIGHTS {
                continue;
            }
            let tiling = Tiling { heights, times, height_step: heights, time_step: times };
            trials.extend(try_windows(rows, bed, tiling, options));
        }
    }
    trials
}

fn tiling(rows: &Rows, extent: usize, times: f64, heights: f64, period: Option<f64>) -> Tiling {
    let times = (libm::round(times) as usize).clamp(FEWEST_TIMES.min(rows.times()), rows.times());
    let heights = (libm::round(heights) as usize).clamp(FEWEST_HEIGHTS, extent);
    let time_step = period.map_or(times / 4, |period| (TIME_STEP * period) as usize).max(1);
    Tiling { heights, times, height_step: (heights / 4).max(1), time_step }
}

/// Median over time of the bed's height in nodes.
fn bed_heights(bed: &Bed) -> usize {
    let mut extents: Vec<usize> = bed
        .top
        .iter()
        .zip(&bed.bottom)
        .map(|(top, bottom)| (top + 1).saturating_sub(*bottom))
        .collect();
    extents.sort_unstable();
    extents[extents.len() / 2]
}

/// Results for windows of one size; `None` if a pattern travels in too few of them.
fn try_windows(rows: &Rows, bed: &Bed, tiling: Tiling, options: &WaveOptions) -> Option<Trial> {
    let examined = examine(rows, bed, &tiling);
    let members = travelling(&examined, &tiling, options);
    let filled = examined.iter().filter(|examined| examined.filled).count();
    let share = members.len() as f64 / filled.max(1) as f64;
    if share < LEAST_PART {
        return None;
    }
    let waves = pool(&members, &SlownessGrid::new(tiling.times, tiling.heights - 1)).ok()?;
    let period = waves.period.ok().map(|period| period.value);
    // A wave has one speed; spurious waves in noise that neighbours share have any speed.
    let agrees = |member: &&Member<'_>| {
        (member.detection.slowness / waves.slowness.value - 1.0).abs() < AGREEMENT
    };
    let chances = members.iter().filter(agrees).map(|m| m.detection.chance(None)).collect();
    let is_certain = chance_of_most(chances, filled) < CERTAIN
        && !is_carried(rows, &examined, waves.slowness.value);
    Some(Trial { tiling, share, slowness: waves.slowness.value, period, is_certain })
}

/// Whether the material moves with at least half the speed of the pattern: this is the pattern of a plug, whose speed
/// such windows show poorly.
fn is_carried(rows: &Rows, examined: &[Examined], slowness: f64) -> bool {
    let flux = SolidsFlux::of(rows);
    let filled = examined.iter().filter(|examined| examined.filled);
    let velocities: Vec<f64> = filled.map(|found| flux.velocity(&found.window).value).collect();
    let velocity = velocities.iter().sum::<f64>() / velocities.len() as f64;
    let speed = rows.spacing / (rows.interval * slowness);
    2.0 * velocity * speed.signum() > speed.abs()
}

/// Probability that noise would show such a clear pattern in three quarters of `n` independent windows, and in at least
/// two: the k-th lowest of n probabilities is below p with a probability of at most C(n, k) p^k. 1 if fewer windows
/// show any.
fn chance_of_most(mut chances: Vec<f64>, n: usize) -> f64 {
    let most = (3 * n).div_ceil(4).max(2);
    if chances.len() < most {
        return 1.0;
    }
    chances.sort_unstable_by(f64::total_cmp);
    let highest = chances[most - 1];
    (0..most).map(|k| (n - k) as f64 / (k + 1) as f64 * highest).product()
}

/// The windows in which a pattern travels.
pub(super) fn travelling<'a>(
    examined: &'a [Examined],
    tiling: &Tiling,
    options: &WaveOptions,
) -> Vec<Member<'a>> {
    examined
        .iter()
        .filter_map(|examined| {
            let detection = examined.detection.as_ref()?;
            let tile = tiling.tile(&examined.window);
            detection.travels(options.criterion(None)).then_some(Member { detection, tile })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_windows_together_leave_chance_less_room_than_each_alone() {
        // A vibrated bed whose voids merge on their way up: three parts of its height, each over the whole record.
        let bed = vec![3.5e-9, 3.6e-6, 3.2e-6];
        assert!(chance_of_most(bed.clone(), 3) < CERTAIN);
        // One window alone is not enough, nor are these three of five, nor two that only just count.
        assert_eq!(chance_of_most(vec![1.4e-10], 1), 1.0);
        assert_eq!(chance_of_most(bed, 5), 1.0);
        let barely = WaveOptions::default().greatest_chance;
        let chance = chance_of_most(vec![barely, 1.0e-9], 2);
        assert!((chance / (barely * barely) - 1.0).abs() < 1.0e-12);
    }
}
