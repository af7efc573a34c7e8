//! Tracking of bubbles over time.

use super::detection::Bubble;
use crate::analysis::LineFit;
use crate::analysis::no_value::{Estimate, NoValue, require_finite, require_positive};

/// Parameters for tracking bubbles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackingOptions {
    /// The largest distance of a bubble's centroid from its expected position. Length.
    pub farthest: f64,
    /// The largest ratio of its volumes at successive times: beyond it, the bubble has merged or split, and is another
    /// one.
    pub largest_growth: f64,
    /// Lengths of the grid along x and y where it is periodic. Length.
    pub periods: [Option<f64>; 2],
    /// Smallest number of times in a track; at least three.
    pub fewest_times: usize,
}

/// A bubble tracked over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Successive times at which it was found.
    pub times: Vec<f64>,
    /// The bubble at these times.
    pub bubbles: Vec<Bubble>,
    /// Velocity upwards: slope of the centroid's height over time. Length over time.
    pub rise_velocity: Estimate,
}

/// Tracks bubbles through a series of times. Among all pairs of a known bubble and a new one, the nearest are joined
/// first (positions are extrapolated from the last two times; at equal distances the earlier track, then the earlier
/// bubble, comes first). Tracks shorter than `fewest_times` are left out.
///
/// Fails if the times do not increase or differ in number from the frames, or if options are not valid.
pub fn track_bubbles(
    times: &[f64],
    frames: &[Vec<Bubble>],
    options: &TrackingOptions,
) -> Result<Vec<Track>, NoValue> {
    check(times, frames, options)?;
    let (mut open, mut closed): (Vec<OpenTrack>, Vec<OpenTrack>) = (Vec::new(), Vec::new());
    for (&time, frame) in times.iter().zip(frames) {
        let joined = join(&open, frame, time, options);
        let mut going = Vec::new();
        for (index, mut track) in open.into_iter().enumerate() {
            match joined.iter().find(|pair| pair.0 == index) {
                Some(&(_, bubble)) => {
                    track.times.push(time);
                    track.bubbles.push(frame[bubble]);
                    going.push(track);
                }
                None => closed.push(track),
            }
        }
        let is_new = |bubble: &usize| joined.iter().all(|pair| pair.1 != *bubble);
        going.extend(
            (0..frame.len())
                .filter(is_new)
                .map(|bubble| OpenTrack { times: vec![time], bubbles: vec![frame[bubble]] }),
        );
        open = going;
    }
    closed.extend(open);
    let fewest = options.fewest_times.max(3);
    Ok(closed.into_iter().filter(|track| track.times.len() >= fewest).filter_map(finish).collect())
}

fn check(times: &[f64], frames: &[Vec<Bubble>], options: &TrackingOptions) -> Result<(), NoValue> {
    require_finite("times", times)?;
    require_positive("the farthest distance", options.farthest)?;
    if times.len() != frames.len() {
        let (times, frames) = (times.len(), frames.len());
        return Err(NoValue::because(format!("there are {times} times and {frames} frames")));
    }
    if times.windows(2).any(|pair| pair[1] <= pair[0]) {
        return Err(NoValue::because("the times do not increase"));
    }
    if options.largest_growth.is_nan() || options.largest_growth <= 1.0 {
        let growth = options.largest_growth;
        return Err(NoValue::because(format!("the largest growth is {growth}; it must exceed 1")));
    }
    Ok(())
}

struct OpenTrack {
    times: Vec<f64>,
    bubbles: Vec<Bubble>,
}

impl OpenTrack {
    /// Expected position of the centroid; `None` without a bubble.
    fn expected(&self, time: f64, options: &TrackingOptions) -> Option<[f64; 3]> {
        let last = self.bubbles.last()?.centroid;
        let [.., before, _] = &self.bubbles[..] else { return Some(last) };
        let count = self.times.len();
        let part = (time - self.times[count - 1]) / (self.times[count - 1] - self.times[count - 2]);
        let step = difference(last, before.centroid, options);
        Some([0, 1, 2].map(|direction| last[direction] + part * step[direction]))
    }
}

/// a - b, by the nearest images along periodic directions.
fn difference(a: [f64; 3], b: [f64; 3], options: &TrackingOptions) -> [f64; 3] {
    let mut difference = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    for (value, period) in difference.iter_mut().zip(options.periods) {
        if let Some(period) = period {
            *value -= period * libm::round(*value / period);
        }
    }
    difference
}

/// Pairs (track, bubble), nearest first, each track and bubble once.
fn join(
    open: &[OpenTrack],
    frame: &[Bubble],
    time: f64,
    options: &TrackingOptions,
) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (index, track) in open.iter().enumerate() {
        let (Some(expected), Some(last)) = (track.expected(time, options), track.bubbles.last())
        else {
            continue;
        };
        for (number, bubble) in frame.iter().enumerate() {
            let growth = (bubble.volume / last.volume).max(last.volume / bubble.volume);
            let [x, y, z] = difference(bubble.centroid, expected, options);
            let distance = (x * x + y * y + z * z).sqrt();
            if growth <= options.largest_growth && distance <= options.farthest {
                pairs.push((distance, index, number));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut joined: Vec<(usize, usize)> = Vec::new();
    for (_, track, bubble) in pairs {
        if joined.iter().all(|pair| pair.0 != track && pair.1 != bubble) {
            joined.push((track, bubble));
        }
    }
    joined
}

fn finish(track: OpenTrack) -> Option<Track> {
    let heights: Vec<f64> = track.bubbles.iter().map(|bubble| bubble.centroid[2]).collect();
    let fit = LineFit::of(&track.times, &heights).ok()?;
    Some(Track { times: track.times, bubbles: track.bubbles, rise_velocity: fit.slope })
}
