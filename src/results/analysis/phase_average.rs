//! Means of a series over the phase of a given frequency.

use crate::analysis::no_value::{NoValue, require_finite, require_positive};

/// Smallest number of cycles from which an error can be computed.
const FEWEST_CYCLES: usize = 2;
/// Fraction of a cycle by which a record may miss its ends while the cycle still counts.
const TOLERANCE: f64 = 1e-6;

/// Zero of the phase, number of bins, and cycles that are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseOptions {
    /// Frequency f of the cycle.
    pub frequency: f64,
    /// Time of phase 0.
    pub origin: f64,
    /// Number of bins B. Bin b is centred on phase b / B.
    pub bins: usize,
    /// Complete cycles left out at the start.
    pub skipped_cycles: usize,
}

/// Means over phase.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseAverage {
    /// Phase of each bin's centre, as a fraction of a cycle from 0 to below 1.
    pub phases: Vec<f64>,
    /// Mean over the cycles of each bin's mean in a cycle; `None` if no cycle has samples there. Unit of the series.
    pub means: Vec<Option<f64>>,
    /// Standard error of that mean from the spread between cycles; `None` if fewer than two cycles have samples there.
    pub errors: Vec<Option<f64>>,
    /// Standard deviation between cycles, likewise.
    pub deviations: Vec<Option<f64>>,
    /// Mean of each bin in each cycle, \[cycle\]\[bin\].
    pub cycles: Vec<Vec<Option<f64>>>,
    /// Mean over phase of the means, and its standard error between cycles; `None` if a bin is empty.
    pub cycle_mean: Option<crate::analysis::no_value::Estimate>,
    /// Time at which the first counted cycle begins.
    pub start: f64,
}

/// Averages samples at equal phase, f (t - origin) modulo 1.
///
/// Cycles are complete periods from phase -1/(2B) on, so that the first bin is not divided. Samples need not be evenly
/// spaced in time; within a bin of a cycle they have equal weights. The bins of a cycle are averaged first and the
/// cycles then, so that cycles are the independent values from which errors are computed. Times must not decrease.
///
/// Fails if fewer than two complete cycles are left, or no bin has samples in two cycles.
pub fn phase_average(
    times: &[f64],
    values: &[f64],
    options: &PhaseOptions,
) -> Result<PhaseAverage, NoValue> {
    check(times, values, options)?;
    let bins = options.bins;
    // In cycles, with the first bin's lower edge at 0.
    let place = |time: f64| (time - options.origin) * options.frequency + 0.5 / bins as f64;
    let (first, last) = (place(times[0]), place(times[times.len() - 1]));
    let begin = libm::ceil(first - TOLERANCE) + options.skipped_cycles as f64;
    // The last sample represents the interval after it, up to the typical length.
    let step = (last - first) / (times.len() - 1) as f64;
    let complete = libm::floor(last + step + TOLERANCE) - begin;
    if complete < FEWEST_CYCLES as f64 {
        return Err(NoValue::because(format!(
            "the record has {} complete cycles beyond the {} left out; {FEWEST_CYCLES} are needed",
            complete.max(0.0),
            options.skipped_cycles
        )));
    }
    let mut sums = vec![vec![(0.0, 0.0); bins]; complete as usize];
    for (&time, &value) in times.iter().zip(values) {
        // The place is rounded, so that a sample on the edge of a bin falls into the same bin in every cycle.
        let place = libm::round((place(time) - begin) * bins as f64 / TOLERANCE) * TOLERANCE;
        if place >= 0.0 && place < complete * bins as f64 {
            let bin = place as usize;
            let sum = &mut sums[bin / bins][bin % bins];
            *sum = (sum.0 + value, sum.1 + 1.0);
        }
    }
    let mean = |&(sum, count): &(f64, f64)| (count > 0.0).then(|| sum / count);
    let cycles: Vec<Vec<Option<f64>>> =
        sums.iter().map(|cycle| cycle.iter().map(mean).collect()).collect();
    let start = options.origin + (begin - 0.5 / bins as f64) / options.frequency;
    summary(cycles, bins, start)
}

fn check(times: &[f64], values: &[f64], options: &PhaseOptions) -> Result<(), NoValue> {
    require_finite("times", times)?;
    require_finite("values", values)?;
    require_positive("the frequency", options.frequency)?;
    require_finite("origin", &[options.origin])?;
    if times.len() != values.len() || times.len() < 2 {
        let (times, values) = (times.len(), values.len());
        return Err(NoValue::because(format!(
            "there are {times} times and {values} values; two of both are needed"
        )));
    }
    if times.windows(2).any(|pair| pair[1] < pair[0]) {
        return Err(NoValue::because("the times decrease"));
    }
    if options.bins == 0 {
        return Err(NoValue::because("there are no bins"));
    }
    Ok(())
}

fn summary(
    cycles: Vec<Vec<Option<f64>>>,
    bins: usize,
    start: f64,
) -> Result<PhaseAverage, NoValue> {
    let columns: Vec<Spread> =
        (0..bins).map(|bin| spread(cycles.iter().filter_map(|cycle| cycle[bin]))).collect();
    if columns.iter().all(|column| column.deviation.is_none()) {
        return Err(NoValue::because("no bin of phase has samples in two cycles"));
    }
    let complete: Vec<f64> = cycles
        .iter()
        .filter_map(|cycle| cycle.iter().copied().sum::<Option<f64>>())
        .map(|sum| sum / bins as f64)
        .collect();
    let over_cycles = spread(complete.into_iter());
    Ok(PhaseAverage {
        phases: (0..bins).map(|bin| bin as f64 / bins as f64).collect(),
        means: columns.iter().map(|column| column.mean).collect(),
        errors: columns.iter().map(Spread::error).collect(),
        deviations: columns.iter().map(|column| column.deviation).collect(),
        cycle_mean: over_cycles
            .mean
            .zip(over_cycles.error())
            .map(|(value, error)| crate::analysis::no_value::Estimate { value, error }),
        cycles,
        start,
    })
}

struct Spread {
    count: f64,
    mean: Option<f64>,
    deviation: Option<f64>,
}

impl Spread {
    fn error(&self) -> Option<f64> {
        self.deviation.map(|deviation| deviation / self.count.sqrt())
    }
}

fn spread(values: impl Iterator<Item = f64>) -> Spread {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count.max(1.0);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    Spread {
        count,
        mean: (count > 0.0).then_some(mean),
        deviation: (count > 1.0).then(|| (squares / (count - 1.0)).sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::PI;

    const FREQUENCY: f64 = 0.16;

    fn options(bins: usize, skipped_cycles: usize) -> PhaseOptions {
        PhaseOptions { frequency: FREQUENCY, origin: 1.3, bins, skipped_cycles }
    }

    /// 1 + 2 sin(2 pi x) + 0.5 cos(4 pi x), x the phase, averaged over a bin.
    fn harmonic(phase: f64, bins: usize) -> f64 {
        let part = |n: f64| {
            let x = PI * n / bins as f64;
            if bins == 0 { 1.0 } else { x.sin() / x }
        };
        1.0 + 2.0 * part(1.0) * (2.0 * PI * phase).sin()
            + 0.5 * part(2.0) * (4.0 * PI * phase).cos()
    }

    fn series(seed: u64, noise: f64, even: bool) -> (Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut time = 0.0;
        let (mut times, mut values) = (Vec::new(), Vec::new());
        while time < 40.0 / FREQUENCY {
            let phase = (time - 1.3) * FREQUENCY;
            let uniform = (random.random::<f64>() - 0.5) * 12.0_f64.sqrt();
            times.push(time);
            values.push(harmonic(phase, 0) + noise * uniform);
            time += if even { 0.05 } else { 0.1 * random.random::<f64>() };
        }
        (times, values)
    }

    #[test]
    fn harmonics_are_met_within_their_errors_with_even_and_uneven_times() {
        for even in [true, false] {
            let (times, values) = series(1, 0.3, even);
            let average = phase_average(&times, &values, &options(25, 3)).unwrap();
            assert_eq!(average.cycles.len(), 36, "{even}");
            let mut squares = 0.0;
            for bin in 0..25 {
                let (mean, error) = (average.means[bin].unwrap(), average.errors[bin].unwrap());
                squares += ((mean - harmonic(average.phases[bin], 25)) / error).powi(2) / 25.0;
            }
            // Mean square of 25 deviations over their errors: 1 with a deviation of 0.28.
            assert!((0.3..2.2).contains(&squares), "{squares}");
            let mean = average.cycle_mean.unwrap();
            assert!((mean.value - 1.0).abs() < 4.0 * mean.error, "{mean:?}");
        }
    }

    #[test]
    fn errors_are_those_between_cycles() {
        // The noise is constant during a cycle, so samples within a cycle do not reduce it.
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let offsets: Vec<f64> = (0..41).map(|_| random.random::<f64>()).collect();
        let (times, mut values) = series(1, 0.0, true);
        for (time, value) in times.iter().zip(&mut values) {
            *value += offsets[((time - 1.3) * FREQUENCY + 1.02) as usize];
        }
        let average = phase_average(&times, &values, &options(25, 0)).unwrap();
        let expected = (1.0 / 12.0_f64 / average.cycles.len() as f64).sqrt();
        for error in average.errors {
            // 39 cycles: the deviation has an error of 11 %.
            assert!((error.unwrap() / expected - 1.0).abs() < 0.35);
        }
    }

    #[test]
    fn a_wrong_frequency_shows_no_harmonic() {
        let (times, values) = series(1, 0.0, true);
        let wrong = PhaseOptions { frequency: 0.1873, ..options(25, 0) };
        let average = phase_average(&times, &values, &wrong).unwrap();
        let largest = average.means.iter().flatten().map(|mean| (mean - 1.0).abs());
        assert!(largest.fold(0.0, f64::max) < 0.5);
    }

    #[test]
    fn left_out_cycles_do_not_count_and_short_records_say_so() {
        let (times, mut values) = series(1, 0.0, true);
        for (time, value) in times.iter().zip(&mut values) {
            if *time < 1.3 + 1.9 / FREQUENCY {
                *value = 1e6;
            }
        }
        let average = phase_average(&times, &values, &options(25, 2)).unwrap();
        assert!(average.means.iter().flatten().all(|mean| mean.abs() < 4.0));
        let reason = phase_average(&times, &values, &options(25, 38)).unwrap_err();
        assert!(reason.reason().contains("1 complete cycles beyond the 38 left out"), "{reason}");
        assert!(phase_average(&[1.0, 0.0], &[0.0, 0.0], &options(4, 0)).is_err());
    }
}
