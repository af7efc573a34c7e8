//! Dispersion coefficients from the growth of the mean square displacement.
//!
//! S^2(t) = <(dr)^2> / 2 grows as D t for a random walk. Liu et al. (2016) take D as the largest slope of a secant of
//! S^2 from its origin, in one window: [`largest_secant`]. Over several successive windows, the slope of a straight
//! line through S^2 from a lag on (after the ballistic part) gives one value per window, and their scatter gives the
//! error: [`Dispersion::fitted`].

use crate::analysis::statistics::SampleMean;

/// Half mean square displacements of successive windows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dispersion {
    /// Lag and S^2 by axis, for all complete windows.
    windows: Vec<Vec<(f64, [f64; 3])>>,
    present: Vec<(f64, [f64; 3])>,
}

impl Dispersion {
    /// Adds S^2 by axis at a lag from the start of the present window.
    pub fn add(&mut self, lag: f64, half_square: [f64; 3]) {
        self.present.push((lag, half_square));
    }

    /// Closes a window; the next lag belongs to a new one.
    pub fn end_window(&mut self) {
        self.windows.push(std::mem::take(&mut self.present));
    }

    /// Complete windows for one axis: points of lag and S^2.
    fn curves(&self, axis: usize) -> impl Iterator<Item = Vec<[f64; 2]>> + '_ {
        let point = move |&(lag, squares): &(f64, [f64; 3])| [lag, squares[axis]];
        self.windows.iter().map(move |window| window.iter().map(point).collect())
    }

    /// D along an axis: mean of the slopes of straight lines through S^2 from a lag on, one for each complete window.
    /// `None` with fewer than two windows that have at least two such lags.
    pub fn fitted(&self, axis: usize, from: f64) -> Option<SampleMean> {
        let slopes =
            self.curves(axis).filter_map(|curve| slope_between(&curve, from, f64::INFINITY));
        SampleMean::of(&slopes.collect::<Vec<_>>()).ok()
    }

    /// D along an axis as in the paper: mean of the largest secants, one for each complete window.
    pub fn by_secants(&self, axis: usize) -> Option<SampleMean> {
        let secants = self.curves(axis).filter_map(|curve| largest_secant(&curve));
        SampleMean::of(&secants.collect::<Vec<_>>()).ok()
    }
}

/// The largest S^2 / t among points [t, S^2], t > 0. It is biased upwards by scatter of S^2, and by ballistic motion.
pub fn largest_secant(curve: &[[f64; 2]]) -> Option<f64> {
    let secants = curve.iter().filter(|[lag, _]| *lag > 0.0).map(|[lag, square]| square / lag);
    secants.fold(None, |largest: Option<f64>, secant| {
        Some(largest.map_or(secant, |largest| largest.max(secant)))
    })
}

/// The slope of the straight line through the points [t, S^2] with from <= t <= to, by least squares with an intercept.
/// No error is given, since the points of one curve depend on each other.
pub fn slope_between(curve: &[[f64; 2]], from: f64, to: f64) -> Option<f64> {
    let points = || curve.iter().filter(|[lag, _]| (from..=to).contains(lag));
    let n = points().count() as f64;
    let [x, y] = [0, 1].map(|k| points().map(|point| point[k]).sum::<f64>() / n);
    let xx: f64 = points().map(|point| (point[0] - x) * (point[0] - x)).sum();
    let xy: f64 = points().map(|point| (point[0] - x) * (point[1] - y)).sum();
    (n >= 2.0 && xx > 0.0).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secants_and_slopes_of_known_curves() {
        // Ballistic at first, then with D = 0.5, then confined.
        let square = |t: f64| if t < 1.0 { t * t / 2.0 } else { (0.5 * t).min(2.0) };
        let curve: Vec<[f64; 2]> =
            (0..100).map(|k| f64::from(k) * 0.1).map(|t| [t, square(t)]).collect();
        assert!((largest_secant(&curve).unwrap() - 0.5).abs() < 1e-12);
        assert!((slope_between(&curve, 1.0, 4.0).unwrap() - 0.5).abs() < 1e-12);
        // Control: over the whole range the line is too flat.
        assert!(slope_between(&curve, 0.0, 10.0).unwrap() < 0.3);
        assert_eq!(slope_between(&curve, 20.0, 30.0), None);
        assert_eq!(largest_secant(&[]), None);
    }
}
