//! The solver of the coarsest level: a dense LDL^T factorisation (Golub and Van Loan, "Matrix computations", section
//! 4.1), which every rank computes for itself. It uses double precision, since no digit would be left for coefficients
//! that differ greatly.

use super::operator::{Coefficients, Equation};

/// A pivot below this fraction of its diagonal element is a zero with rounding errors: the cell, or the last one of a
/// closed box, is not coupled to any cell that is not yet eliminated. Coefficients that differ by 10^12 give larger
/// pivots.
const ZERO_PIVOT: f64 = 1.0e-14;

/// The factors of A = L D L^T on a small level.
#[derive(Clone, Debug)]
pub(super) struct DirectSolver {
    size: usize,
    /// Rows of L below the diagonal.
    lower: Vec<f64>,
    /// 1 / D; zero for a zero pivot, so that the solution is zero in that cell.
    inverse_pivots: Vec<f64>,
    /// The diagonal of A during factorisation, then the solution.
    work: Vec<f64>,
}

impl DirectSolver {
    pub(super) fn new(size: usize) -> Self {
        let zeros = || vec![0.0; size];
        Self { size, lower: vec![0.0; size * size], inverse_pivots: zeros(), work: zeros() }
    }

    /// Factorises the operator of a level that this rank holds completely.
    pub(super) fn factorise(&mut self, coefficients: &Coefficients<f32>) {
        self.assemble(coefficients);
        let n = self.size;
        let (lower, diagonal) = (&self.lower, &mut self.work);
        diagonal.iter_mut().enumerate().for_each(|(row, d)| *d = lower[row * n + row]);
        for column in 0..n {
            let pivot = self.lower[column * n + column];
            let inverse = if pivot > ZERO_PIVOT * self.work[column] { 1.0 / pivot } else { 0.0 };
            self.inverse_pivots[column] = inverse;
            for row in column + 1..n {
                let factor = self.lower[row * n + column] * inverse;
                for other in column + 1..=row {
                    self.lower[row * n + other] -= factor * self.lower[other * n + column];
                }
            }
            for row in column + 1..n {
                self.lower[row * n + column] *= inverse;
            }
        }
    }

    fn assemble(&mut self, coefficients: &Coefficients<f32>) {
        let n = self.size;
        self.lower.fill(0.0);
        let [nx, ny, nz] = coefficients.diagonal.count();
        let counts = [nx, ny, nz];
        let index_of = |cell: [usize; 3]| cell[0] + nx * (cell[1] + ny * cell[2]);
        for index in 0..n {
            let cell = [index % nx, (index / nx) % ny, index / (nx * ny)];
            let at = cell.map(|along| along as isize);
            self.lower[index * n + index] += f64::from(coefficients.diagonal.at(at));
            for axis in 0..3 {
                let value = f64::from(coefficients.faces[axis].at(at));
                let mut below = cell;
                below[axis] = (cell[axis] + counts[axis] - 1) % counts[axis];
                let below = index_of(below);
                if below == index || value == 0.0 {
                    continue;
                }
                self.lower[index * n + index] += value;
                self.lower[below * n + below] += value;
                self.lower[index.max(below) * n + index.min(below)] -= value;
            }
        }
    }

    /// Solves A x = b; for a singular A the result is one of the solutions, if there are any.
    pub(super) fn solve(&mut self, equation: &mut Equation<f32>) {
        let n = self.size;
        let x = &mut self.work;
        x.iter_mut().zip(equation.right_hand_side.owned()).for_each(|(x, b)| *x = f64::from(b));
        for row in 0..n {
            let known = &self.lower[row * n..][..row];
            let sum = known.iter().zip(&x[..row]).fold(0.0, |sum, (l, x)| sum + l * x);
            x[row] -= sum;
        }
        x.iter_mut().zip(&self.inverse_pivots).for_each(|(x, inverse)| *x *= inverse);
        for row in (0..n).rev() {
            let value = x[row];
            let known = &self.lower[row * n..][..row];
            known.iter().zip(&mut x[..row]).for_each(|(l, x)| *x -= l * value);
        }
        equation.solution.set_owned(x.iter().map(|&value| value as f32));
    }
}
