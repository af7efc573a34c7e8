//! The coarsest level: a dense factorisation, the same on every rank.

use super::operator::Coefficients;
use crate::grid::Field;

/// A pivot below this part of its diagonal is what rounding leaves of nothing: the cell, or the last one of a closed
/// box, is held by no other that is not yet eliminated. Coefficients that differ by 10^12 leave larger ones.
const NOTHING: f64 = 1.0e-14;

/// A = L D L^T of a small level.
#[derive(Clone, Debug)]
pub(super) struct DirectSolver {
    size: usize,
    /// Rows of L below the diagonal.
    lower: Vec<f64>,
    /// 1 / D; zero where nothing is left, so that the number of that cell is zero.
    inverse_pivots: Vec<f64>,
    numbers: Vec<f64>,
}

impl DirectSolver {
    pub(super) fn new(size: usize) -> Self {
        let zeros = || vec![0.0; size];
        Self { size, lower: vec![0.0; size * size], inverse_pivots: zeros(), numbers: zeros() }
    }

    /// Factorises the operator of a whole level.
    pub(super) fn factorise(&mut self, coefficients: &Coefficients) {
        self.assemble(coefficients);
        let n = self.size;
        let (lower, diagonal) = (&self.lower, &mut self.numbers);
        diagonal.iter_mut().enumerate().for_each(|(row, d)| *d = lower[row * n + row]);
        for column in 0..n {
            let pivot = self.lower[column * n + column];
            let inverse = if pivot > NOTHING * self.numbers[column] { 1.0 / pivot } else { 0.0 };
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

    fn assemble(&mut self, coefficients: &Coefficients) {
        let n = self.size;
        self.lower.fill(0.0);
        let [nx, ny, nz] = coefficients.diagonal.count();
        let counts = [nx, ny, nz];
        let number = |cell: [usize; 3]| cell[0] + nx * (cell[1] + ny * cell[2]);
        for place in 0..n {
            let cell = [place % nx, (place / nx) % ny, place / (nx * ny)];
            let at = cell.map(|index| index as isize);
            self.lower[place * n + place] += coefficients.diagonal.at(at);
            for axis in 0..3 {
                let value = coefficients.faces[axis].at(at);
                let mut below = cell;
                below[axis] = (cell[axis] + counts[axis] - 1) % counts[axis];
                let below = number(below);
                if below == place || value == 0.0 {
                    continue;
                }
                self.lower[place * n + place] += value;
                self.lower[below * n + below] += value;
                self.lower[place.max(below) * n + place.min(below)] -= value;
            }
        }
    }

    /// x = A^-1 b; of a singular system some solution, if there is one.
    pub(super) fn solve(&mut self, right: &Field, solution: &mut Field) {
        let n = self.size;
        let x = &mut self.numbers;
        x.iter_mut().zip(right.owned()).for_each(|(x, b)| *x = b);
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
        solution.set_owned(x.iter().copied());
    }
}
