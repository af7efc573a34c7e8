//! Tridiagonal systems of linear equations.

/// The equations, row by row; solved without pivoting, which is permitted for matrices that are diagonally dominant by
/// rows or columns, or symmetric and positive definite.
pub(super) struct Tridiagonal {
    /// Coefficients of the unknown before, of the row's own and of the next.
    rows: Vec<[f64; 3]>,
    right: Vec<f64>,
}

impl Tridiagonal {
    pub(super) fn with_capacity(rows: usize) -> Self {
        Self { rows: Vec::with_capacity(rows), right: Vec::with_capacity(rows) }
    }

    /// Adds a row; the first coefficient of the first row and the last one of the last row are ignored.
    pub(super) fn push(&mut self, row: [f64; 3], right: f64) {
        self.rows.push(row);
        self.right.push(right);
    }

    /// The unknowns: not finite if the equations have no solution.
    pub(super) fn solve(mut self) -> Vec<f64> {
        for row in 1..self.rows.len() {
            let factor = self.rows[row][0] / self.rows[row - 1][1];
            self.rows[row][1] -= factor * self.rows[row - 1][2];
            self.right[row] -= factor * self.right[row - 1];
        }
        let mut next = 0.0;
        for row in (0..self.rows.len()).rev() {
            let above = if row + 1 < self.rows.len() { self.rows[row][2] * next } else { 0.0 };
            next = (self.right[row] - above) / self.rows[row][1];
            self.right[row] = next;
        }
        self.right
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_solves_diagonally_dominant_equations(
            rows in prop::collection::vec(([-1.0..1.0f64, 2.1..3.0, -1.0..1.0], -1.0..1.0f64), 1..50),
        ) {
            let mut system = Tridiagonal::with_capacity(rows.len());
            rows.iter().for_each(|&(row, right)| system.push(row, right));
            let found = system.solve();
            for (k, ([below, here, above], right)) in rows.iter().enumerate() {
                let before = if k > 0 { below * found[k - 1] } else { 0.0 };
                let after = found.get(k + 1).map_or(0.0, |next| above * next);
                // Numbers up to 10, each of three operations rounded.
                prop_assert!((before + here * found[k] + after - right).abs() < 1.0e-13);
            }
        }
    }
}
