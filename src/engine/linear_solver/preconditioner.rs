//! The preconditioner: one multigrid cycle in single precision.
//!
//! A cycle only has to remove one or two digits of the error, not sixteen. In single precision it moves half as many
//! bytes, and a vector holds twice as many numbers. The iteration around it works in double precision, so the solution
//! is as accurate as without single precision \[Goeddeke2007\].
//!
//! The equation is scaled by powers of two, which causes no rounding, so that no number overflows or underflows.
//!
//! * Goeddeke2007: D. Göddeke, R. Strzodka, S. Turek, "Performance and accuracy of hardware-oriented native-, emulated-
//!   and mixed-precision solvers in FEM simulations", Int. J. Parallel Emergent Distrib. Syst. 22 (2007) 221-256.

use super::dot_product::Values;
use super::level_grid::LevelGrid;
use super::multigrid::{Cycle, Multigrid};
use super::operator::{Coefficients, Equation};
use crate::domain::Subdomain;
use crate::grid::{Field, LocalCells};
use crate::numbers::vectorised;
use crate::parallel::Communicator;

/// Smallest ratio of a non-zero coefficient to the largest: smaller ones are raised to it, so that sums of their
/// inverses do not overflow.
const SMALLEST: f32 = 1.0e-30;

/// M, and the equation that it solves approximately.
#[derive(Clone, Debug)]
pub(super) struct Preconditioner {
    multigrid: Multigrid,
    /// Factor by which the coefficients were multiplied.
    scale: f64,
    coefficients: Coefficients<f32>,
    right_hand_side: Field<f32>,
    solution: Field<f32>,
}

impl Preconditioner {
    pub(super) fn new(finest: &LevelGrid, cells: &LocalCells, subdomain: Subdomain) -> Self {
        Self {
            multigrid: Multigrid::new(finest, subdomain),
            scale: 1.0,
            coefficients: Coefficients::new(cells),
            right_hand_side: Field::new(cells, 1),
            solution: Field::new(cells, 1),
        }
    }

    /// Sets the coefficients, whose halos are current; `largest` is the largest of them on all ranks. This call is
    /// collective.
    pub(super) fn set_coefficients(
        &mut self,
        coefficients: &Coefficients,
        largest: f64,
        ranks: &dyn Communicator,
    ) {
        let scale = to_one(largest);
        let fields = coefficients.faces.iter().chain([&coefficients.diagonal]);
        let narrowed = |value: f64| {
            let at_least = if value > 0.0 { SMALLEST } else { 0.0 };
            ((value * scale) as f32).max(at_least)
        };
        for (to, from) in self.coefficients.fields().into_iter().zip(fields) {
            convert(from, to, narrowed);
        }
        self.scale = scale;
        self.multigrid.set_coefficients(&self.coefficients, ranks);
    }

    /// Computes z = M r for an r with this norm over all ranks. Halos are neither needed nor filled. This call is
    /// collective.
    pub(super) fn apply(
        &mut self,
        cycle: Cycle,
        (r, norm): (&Field, f64),
        ranks: &dyn Communicator,
    ) -> Preconditioned<'_> {
        let scale = to_one(norm);
        let Self { coefficients, right_hand_side, solution, .. } = self;
        let narrowed = |value: f64| (value * scale) as f32;
        convert(r, right_hand_side, narrowed);
        let mut equation = Equation { coefficients, right_hand_side, solution };
        self.multigrid.cycle(&mut equation, cycle, ranks);
        Preconditioned { solution, scale: self.scale / scale }
    }
}

/// z = M r as the cycle returns it: in single precision, and scaled. Its order in memory is that of r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Preconditioned<'a> {
    solution: &'a Field<f32>,
    /// Factor by which `solution` is multiplied to give z; a power of two.
    scale: f64,
}

impl Values for Preconditioned<'_> {
    #[inline(always)]
    fn row(self, start: usize, length: usize) -> impl Iterator<Item = f64> {
        self.solution.values()[start..][..length].iter().map(move |&z| f64::from(z) * self.scale)
    }
}

/// The power of two that brings a positive number between 1 and 2.
fn to_one(number: f64) -> f64 {
    const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    let exponent = number.to_bits() >> MANTISSA_BITS;
    f64::from_bits(2046_u64.saturating_sub(exponent).max(1) << MANTISSA_BITS)
}

vectorised!(
    /// Converts all values, those in halos too, between fields of one shape.
    fn convert(from: &Field, to: &mut Field<f32>, conversion: impl Fn(f64) -> f32) {
        for (to, &from) in to.values_mut().iter_mut().zip(from.values()) {
            *to = conversion(from);
        }
    }
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_bring_numbers_of_any_size_between_1_and_2() {
        for number in [1.0e-300, 3.0e-20, 0.75, 1.0, 1.5, 7.0e12, 1.0e300] {
            let scale = to_one(number);
            assert!((1.0..2.0).contains(&(number * scale)), "{number}: {scale}");
            assert_eq!(number * scale / scale, number);
        }
    }
}
