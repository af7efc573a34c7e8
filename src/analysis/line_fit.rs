//! Straight lines through points that are spread over ranks.

use super::exact_sums::totals;
use crate::parallel::Communicator;

/// y = intercept + slope x by least squares, with standard errors.
///
/// With n points, their means x_m and y_m, S_xx = sum of (x - x_m)^2 and S_xy = sum of (x - x_m)(y - y_m), the slope
/// is S_xy / S_xx. With s^2 = sum of squared residuals / (n - 2) the errors are s / sqrt(S_xx) of the slope, and s
/// sqrt(1/n + x_m^2 / S_xx) of the intercept. They hold for residuals that are independent of each other and of one
/// variance. (Draper & Smith, "Applied Regression Analysis", chapter 1.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// Rise of y over x.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
    /// Standard error of the slope.
    pub slope_error: f64,
    /// Standard error of the intercept.
    pub intercept_error: f64,
    /// s, the standard deviation of the residuals.
    pub deviation: f64,
    /// Number of points.
    pub points: u64,
}

impl LineFit {
    /// The line through all ranks' points [x, y]; none through fewer than three points, through points of one x, or
    /// through undefined ones. Collective.
    pub fn through(points: &[[f64; 2]], ranks: &dyn Communicator) -> Option<Self> {
        let [n, x, y] = totals(points.iter().map(|&[x, y]| [1.0, x, y]), ranks);
        let [x_mean, y_mean] = [x / n, y / n];
        let centred = || points.iter().map(|&[x, y]| [x - x_mean, y - y_mean]);
        let [xx, xy] = totals(centred().map(|[x, y]| [x * x, x * y]), ranks);
        let slope = xy / xx;
        let residuals = centred().map(|[x, y]| [(y - slope * x) * (y - slope * x)]);
        let [squares] = totals(residuals, ranks);
        if n < 3.0 || xx <= 0.0 || !slope.is_finite() {
            return None; // on all ranks: the sums are the same everywhere
        }
        let variance = squares / (n - 2.0);
        Some(Self {
            slope,
            intercept: y_mean - slope * x_mean,
            slope_error: (variance / xx).sqrt(),
            intercept_error: (variance * (1.0 / n + x_mean * x_mean / xx)).sqrt(),
            deviation: variance.sqrt(),
            points: n as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{normal, random_of};
    use crate::parallel::run_on_threads;

    fn fit_on(n: usize, points: &[[f64; 2]]) -> Option<LineFit> {
        let fits = run_on_threads(n, |ranks| {
            let here = points.iter().skip(ranks.rank()).step_by(n).copied();
            LineFit::through(&here.collect::<Vec<_>>(), ranks)
        });
        assert!(fits.iter().all(|fit| *fit == fits[0]));
        fits[0]
    }

    #[test]
    fn a_line_is_found_within_its_errors_on_any_ranks() {
        let mut inside = 0;
        for trial in 0..100 {
            let mut generator = random_of(3, trial, "line");
            let points: Vec<[f64; 2]> = (0..50)
                .map(|k| [f64::from(k), 2.0 - 0.3 * f64::from(k) + normal(&mut generator)])
                .collect();
            let fit = fit_on(1, &points).unwrap();
            inside += u32::from((fit.slope + 0.3).abs() < 1.96 * fit.slope_error);
            if trial < 4 {
                assert_eq!(fit_on(trial as usize + 1, &points), Some(fit));
            }
        }
        // 95 expected; four standard deviations (2.2) below and above.
        assert!((86..=100).contains(&inside), "{inside}");
    }

    #[test]
    fn no_line_through_too_few_or_upright_points() {
        assert_eq!(fit_on(2, &[[0.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(fit_on(2, &[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(fit_on(1, &[[0.0, 1.0], [1.0, f64::NAN], [2.0, 3.0]]), None);
    }
}
