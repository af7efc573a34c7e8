//! Distribution functions of chi-square and Student's t, and their inverses.
//!
//! Series and continued fractions of the incomplete gamma and beta functions: NIST Digital Library of
//! Mathematical Functions, sections 8.7, 8.9 and 8.17 (<https://dlmf.nist.gov>).

/// Relative accuracy of series, fractions and inversions.
const ACCURACY: f64 = 1e-14;
/// Largest number of terms of a series or fraction; both converge in about sqrt(a) terms near x = a.
const MOST_TERMS: usize = 100_000;
/// Replaces a zero denominator in a continued fraction (Lentz).
const TINY: f64 = 1e-300;

/// Upper regularised incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a), for a > 0 and x >= 0.
pub fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let prefactor = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        (1.0 - prefactor * lower_series(a, x)).clamp(0.0, 1.0)
    } else {
        (prefactor * upper_fraction(a, x)).clamp(0.0, 1.0)
    }
}

/// sum_n x^n / (a (a + 1) ... (a + n)).
fn lower_series(a: f64, x: f64) -> f64 {
    let (mut term, mut total) = (1.0 / a, 1.0 / a);
    for n in 1..MOST_TERMS {
        term *= x / (a + n as f64);
        total += term;
        if term < ACCURACY * total {
            break;
        }
    }
    total
}

/// The continued fraction 1 / (x + 1 - a - (1 (1 - a)) / (x + 3 - a - ...)) by Lentz's method.
fn upper_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..MOST_TERMS {
        let numerator = -(n as f64) * (n as f64 - a);
        b += 2.0;
        d = 1.0 / away_from_zero(numerator * d + b);
        c = away_from_zero(b + numerator / c);
        fraction *= d * c;
        if (d * c - 1.0).abs() < ACCURACY {
            break;
        }
    }
    fraction
}

fn away_from_zero(value: f64) -> f64 {
    if value.abs() < TINY { TINY } else { value }
}

/// Regularised incomplete beta function I_x(a, b), for a, b > 0 and 0 <= x <= 1.
pub fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let logarithm = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
        + a * libm::log(x)
        + b * libm::log1p(-x);
    libm::exp(logarithm) * beta_fraction(a, b, x) / a
}

fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for n in 1..MOST_TERMS {
        let m = n as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut factor = 1.0;
        for numerator in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + numerator * d);
            c = away_from_zero(1.0 + numerator / c);
            factor *= d * c;
        }
        fraction *= factor;
        if (factor - 1.0).abs() < ACCURACY {
            break;
        }
    }
    fraction
}

/// Probability that chi-square with `freedom` degrees of freedom is below `value`.
pub fn chi_square_probability(value: f64, freedom: f64) -> f64 {
    1.0 - upper_gamma(0.5 * freedom, 0.5 * value)
}

/// The value below which chi-square with `freedom` degrees of freedom lies with the given probability.
pub fn chi_square_quantile(probability: f64, freedom: f64) -> f64 {
    invert(probability, freedom.max(1.0), |value| chi_square_probability(value, freedom))
}

/// Probability that |t| of Student's distribution with `freedom` degrees of freedom exceeds `value`.
pub fn student_two_sided(value: f64, freedom: f64) -> f64 {
    incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + value * value))
}

/// The bound that |t| of Student's distribution does not exceed with the given probability (confidence).
pub fn student_bound(confidence: f64, freedom: f64) -> f64 {
    invert(confidence, 2.0, |value| 1.0 - student_two_sided(value, freedom))
}

/// The argument, above 0, at which an increasing distribution function reaches a probability; by bisection.
fn invert(probability: f64, guess: f64, distribution: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, guess);
    while distribution(high) < probability && high < 1e300 {
        low = high;
        high *= 2.0;
    }
    while high - low > ACCURACY * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if distribution(middle) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of Abramowitz and Stegun, 26.8 and 26.10; five digits.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (probability, freedom, expected) in [
            (0.95, 1.0, 3.84146),
            (0.975, 10.0, 20.4832),
            (0.025, 10.0, 3.24697),
            (0.5, 100.0, 99.3341),
        ] {
            let quantile = chi_square_quantile(probability, freedom);
            assert!((quantile / expected - 1.0).abs() < 1e-5, "{quantile} {expected}");
        }
        for (confidence, freedom, expected) in [
            (0.95, 1.0, 12.7062),
            (0.95, 2.0, 4.30265),
            (0.95, 10.0, 2.22814),
            (0.99, 30.0, 2.74999),
        ] {
            let bound = student_bound(confidence, freedom);
            assert!((bound / expected - 1.0).abs() < 1e-5, "{bound} {expected}");
        }
    }

    #[test]
    fn exponential_and_uniform_are_special_cases() {
        // Q(1, x) = exp(-x), I_x(1, 1) = x.
        assert!((upper_gamma(1.0, 3.0) - libm::exp(-3.0)).abs() < 1e-14);
        assert!((upper_gamma(1.0, 0.3) - libm::exp(-0.3)).abs() < 1e-14);
        assert!((incomplete_beta(1.0, 1.0, 0.3) - 0.3).abs() < 1e-14);
    }
}
