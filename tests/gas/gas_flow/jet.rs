//! Numbers with their derivatives: with respect to place to second order, with respect to time to first order.

use std::ops::{Add, Mul};

/// A function at a place and a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    /// d/dx, d/dy, d/dz.
    pub(crate) slope: [f64; 3],
    /// Second derivatives.
    pub(crate) bend: [[f64; 3]; 3],
    /// d/dt.
    pub(crate) rate: f64,
}

impl Jet {
    /// The same everywhere, at all times.
    pub(crate) fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; 3], bend: [[0.0; 3]; 3], rate: 0.0 }
    }

    /// A function of one coordinate, from its value and first two derivatives.
    pub(crate) fn along(axis: usize, [value, slope, bend]: [f64; 3]) -> Self {
        let mut jet = Self::constant(value);
        (jet.slope[axis], jet.bend[axis][axis]) = (slope, bend);
        jet
    }

    /// A function of time, from its value and first derivative.
    pub(crate) fn in_time([value, rate]: [f64; 2]) -> Self {
        Self { rate, ..Self::constant(value) }
    }

    /// f(self), from f and its first two derivatives there.
    fn chained(self, [f, first, second]: [f64; 3]) -> Self {
        let (s, b) = (self.slope, self.bend);
        let bend = [0, 1, 2].map(|i| [0, 1, 2].map(|j| first * b[i][j] + second * s[i] * s[j]));
        Self { value: f, slope: s.map(|s| first * s), bend, rate: first * self.rate }
    }

    /// 1 / self.
    pub(crate) fn inverse(self) -> Self {
        let inverse = 1.0 / self.value;
        self.chained([inverse, -inverse.powi(2), 2.0 * inverse.powi(3)])
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: [0, 1, 2].map(|i| self.slope[i] + other.slope[i]),
            bend: [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.bend[i][j] + other.bend[i][j])),
            rate: self.rate + other.rate,
        }
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let mixed = |i: usize, j: usize| {
            let ends = a.value * b.bend[i][j] + a.bend[i][j] * b.value;
            ends + a.slope[i] * b.slope[j] + a.slope[j] * b.slope[i]
        };
        Self {
            value: a.value * b.value,
            slope: [0, 1, 2].map(|i| a.value * b.slope[i] + a.slope[i] * b.value),
            bend: [0, 1, 2].map(|i| [0, 1, 2].map(|j| mixed(i, j))),
            rate: a.value * b.rate + a.rate * b.value,
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
}

#[test]
fn jets_differentiate() {
    // (x^2 t) / (1 + x z) at x = 2, z = 3, t = 5.
    let x = Jet::along(0, [2.0, 1.0, 0.0]);
    let z = Jet::along(2, [3.0, 1.0, 0.0]);
    let jet = x * x * Jet::in_time([5.0, 1.0]) * (Jet::constant(1.0) + x * z).inverse();
    let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1.0e-12); // some ulps, after cancellation
    near(jet.value, 20.0 / 7.0);
    near(jet.rate, 4.0 / 7.0);
    near(jet.slope[0], 5.0 * (2.0 * 2.0 + 4.0 * 3.0) / 49.0);
    near(jet.slope[2], -5.0 * 8.0 / 49.0);
    near(jet.bend[0][0], 10.0 / 343.0);
    near(jet.bend[2][2], 5.0 * 32.0 / 343.0);
    near(jet.bend[0][2], -5.0 * 4.0 * (3.0 + 6.0) / 343.0);
}
