//! Straight lines by least squares.

use super::no_value::{Estimate, NoValue, require_finite};
use talcum_engine::parallel::{Communicator, OneRank};
use talcum_engine::particle_sets::exact_sums::totals;

/// y = intercept + slope x by least squares, with standard errors.
///
/// With n points, their means x_m and y_m, S_xx = sum of (x - x_m)^2 and S_xy = sum of (x - x_m)(y - y_m), the slope is
/// S_xy / S_xx. With s^2 = sum of squared residuals / (n - 2), the errors are s / sqrt(S_xx) for the slope, and s
/// sqrt(1/n + x_m^2 / S_xx) for the intercept. They hold for independent residuals with equal variance. (Draper &
/// Smith, "Applied Regression Analysis", chapter 1.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// Increase of y with x, in the unit of y over that of x.
    pub slope: Estimate,
    /// Value at x = 0, in the unit of y.
    pub intercept: Estimate,
    /// s, the standard deviation of the points about the line, with n - 2 degrees of freedom.
    pub residual: f64,
    /// Fraction of the variance of y that the line explains, R^2; 1 if y is constant.
    pub determination: f64,
    /// Number of points.
    pub points: u64,
}

impl LineFit {
    /// The line through points of one rank.
    ///
    /// Fails for fewer than three points, if all x are equal, or if a number is not finite.
    pub fn of(x: &[f64], y: &[f64]) -> Result<Self, NoValue> {
        require_finite("x", x)?;
        require_finite("y", y)?;
        if x.len() != y.len() {
            let (across, along) = (x.len(), y.len());
            return Err(NoValue::because(format!("there are {across} x and {along} y")));
        }
        let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(&x, &y)| [x, y]).collect();
        Self::through(&points, &OneRank)
    }

    /// The line through the points [x, y] of all ranks, with the same bits for any distribution over ranks. Collective.
    ///
    /// Fails on all ranks for fewer than three points, if all x are equal, or if a number is not finite.
    pub fn through(points: &[[f64; 2]], ranks: &dyn Communicator) -> Result<Self, NoValue> {
        let [n, x, y] = totals(points.iter().map(|&[x, y]| [1.0, x, y]), ranks);
        let [x_mean, y_mean] = [x / n, y / n];
        let centred = || points.iter().map(|&[x, y]| [x - x_mean, y - y_mean]);
        let [xx, xy, yy] = totals(centred().map(|[x, y]| [x * x, x * y, y * y]), ranks);
        let slope = xy / xx;
        let residuals = centred().map(|[x, y]| [(y - slope * x) * (y - slope * x)]);
        let [squares] = totals(residuals, ranks);
        // The sums are equal on all ranks, and so are the results.
        if n < 3.0 {
            return Err(NoValue::because(format!(
                "there are {n} points; a line with errors needs three"
            )));
        }
        if xx <= 0.0 || !slope.is_finite() {
            return Err(NoValue::because("all points have the same x, or one is not a number"));
        }
        let variance = squares / (n - 2.0);
        let of_intercept = variance * (1.0 / n + x_mean * x_mean / xx);
        Ok(Self {
            slope: Estimate { value: slope, error: (variance / xx).sqrt() },
            intercept: Estimate { value: y_mean - slope * x_mean, error: of_intercept.sqrt() },
            residual: variance.sqrt(),
            determination: if yy > 0.0 { 1.0 - squares / yy } else { 1.0 },
            points: n as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::numbers::{normal, random_of};
    use talcum_engine::parallel::run_on_threads;

    fn fit_on(n: usize, points: &[[f64; 2]]) -> Result<LineFit, NoValue> {
        let fits = run_on_threads(n, |ranks| {
            let here = points.iter().skip(ranks.rank()).step_by(n).copied();
            LineFit::through(&here.collect::<Vec<_>>(), ranks)
        });
        assert!(fits.iter().all(|fit| *fit == fits[0]));
        fits[0].clone()
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
            inside += u32::from((fit.slope.value + 0.3).abs() < 1.96 * fit.slope.error);
            if trial < 4 {
                assert_eq!(fit_on(trial as usize + 1, &points), Ok(fit));
            }
        }
        // 95 expected; four standard deviations (2.2) below and above.
        assert!((86..=100).contains(&inside), "{inside}");
    }

    #[test]
    fn no_line_through_too_few_or_upright_points() {
        let reason = |n, points: &[[f64; 2]]| fit_on(n, points).unwrap_err().to_string();
        assert!(reason(2, &[[0.0, 1.0], [1.0, 2.0]]).contains("2 points"));
        assert!(reason(2, &[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]).contains("same x"));
        assert!(fit_on(1, &[[0.0, 1.0], [1.0, f64::NAN], [2.0, 3.0]]).is_err());
        assert!(LineFit::of(&[0.0, 1.0, 2.0], &[0.0, 1.0]).is_err());
    }

    #[test]
    fn line_and_its_errors_are_those_of_a_worked_example() {
        // By hand: x mean 2, y mean 3.9; xx 10, xy 19.8; residuals 0.06, -0.02, -0.2, 0.22, -0.06.
        let fit = LineFit::of(&[0.0, 1.0, 2.0, 3.0, 4.0], &[0.0, 1.9, 3.7, 6.1, 7.8]).unwrap();
        assert!((fit.slope.value - 1.98).abs() < 1e-12, "{fit:?}");
        assert!((fit.intercept.value + 0.06).abs() < 1e-12, "{fit:?}");
        let left: f64 = [0.06, -0.02, -0.2, 0.22, -0.06].iter().map(|x: &f64| x * x).sum();
        assert!((fit.residual - (left / 3.0).sqrt()).abs() < 1e-12, "{fit:?}");
        assert!((fit.slope.error - (left / 30.0).sqrt()).abs() < 1e-12);
        assert!((fit.determination - (1.0 - left / 39.3)).abs() < 1e-3);
    }
}
