//! Sizes of windows that fit the waves of a bed.

use super::WaveOptions;
use super::correlation::SlownessGrid;
use super::field::Rows;
use super::map::{Examined, Tiling, examine};
use super::motion::Bed;
use super::pool::{Member, pool};

/// Windows that are tried first, as parts of the record and of the bed.
const PARTS_OF_RECORD: [usize; 6] = [1, 2, 4, 8, 16, 32];
const PARTS_OF_BED: [usize; 3] = [2, 4, 8];
/// Smallest window, in heights and times.
const FEWEST_HEIGHTS: usize = 6;
const FEWEST_TIMES: usize = 24;
/// The part of the windows that must have waves: more than chance gives, of however many windows.
pub(super) const LEAST_PART: f64 = 0.04;
/// Chance of a pattern that counts though it does not repeat: a thousand windows of all sizes are tried.
const CERTAIN: f64 = 1.0e-6;
/// Sizes of a window in periods and wavelengths.
const PERIODS: f64 = 3.0;
const WAVELENGTHS: f64 = 2.5;

/// Fewest heights of a window in a bed that is twice as high: waves that repeat regularly cannot be told from
/// chance by fewer.
const ENOUGH_HEIGHTS: f64 = 14.0;

/// Distance between windows in periods: not a multiple of half a period, so that their ends fall on different phases.
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
    /// Part of the windows in which a pattern travels.
    share: f64,
    slowness: f64,
    /// None if the pattern does not repeat within a window.
    period: Option<f64>,
    /// Whether so many windows show it that chance does not: large windows are few, and one of few is soon met by chance among
    /// so many sizes.
    is_certain: bool,
}

/// Tries windows of several sizes; those in most of which a pattern travels and repeats give period and wavelength, from
/// which follow the windows that are used. If none repeats, those are used in most of which a pattern travels. The options'
/// sizes go before all.
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

/// Windows of several sizes in some of which a pattern travels.
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

/// What windows of one size show; None if a pattern travels in too few.
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
    let certain = members.iter().filter(|member| member.detection.chance(None) < CERTAIN).count();
    let is_certain = certain >= 2 && 2 * certain >= filled;
    Some(Trial { tiling, share, slowness: waves.slowness.value, period, is_certain })
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
