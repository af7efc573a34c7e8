//! Pressure equations on the whole grid, their solution for any decomposition, and their residual by plain loops.

use nalgebra::Vector3;
use talcum::domain::{Bounds, Decomposition, Face, RankGrid, Subdomain};
use talcum::grid::{BoxGrid, Field, LocalCells};
use talcum::linear_solver::{Convergence, LinearSolverError, PressureSolver, Tolerance};
use talcum::parallel::{Communicator, run_on_threads};

/// An equation on the whole grid, x fastest.
#[derive(Clone)]
pub(crate) struct Equation {
    pub(crate) counts: [usize; 3],
    pub(crate) lengths: [f64; 3],
    pub(crate) periodic: [bool; 3],
    pub(crate) faces: [Vec<f64>; 3],
    pub(crate) diagonal: Vec<f64>,
    pub(crate) right: Vec<f64>,
}

/// A number in [0, 1) from two integers (SplitMix64).
pub(crate) fn hashed(stream: u64, number: usize) -> f64 {
    let mut z = (stream << 40).wrapping_add(number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 * 0.5_f64.powi(53)
}

impl Equation {
    /// Coefficients area / distance in cubes of edge 1, an outlet on the upper z face if z is not periodic, and a
    /// right-hand side that is different in each cell.
    pub(crate) fn new(counts: [usize; 3], periodic: [bool; 3]) -> Self {
        Self::in_box(counts, counts.map(|count| count as f64), periodic)
    }

    pub(crate) fn in_box(counts: [usize; 3], lengths: [f64; 3], periodic: [bool; 3]) -> Self {
        let cells: usize = counts.iter().product();
        let spacing = [0, 1, 2].map(|axis| lengths[axis] / counts[axis] as f64);
        let volume: f64 = spacing.iter().product();
        let faces = spacing.map(|h| vec![volume / (h * h); cells]);
        let top = cells - counts[0] * counts[1];
        let outlet = if periodic[2] { 0.0 } else { 2.0 * volume / spacing[2].powi(2) };
        let diagonal = (0..cells).map(|cell| if cell >= top { outlet } else { 0.0 }).collect();
        let right = (0..cells).map(|cell| hashed(1, cell) - 0.3).collect();
        let mut equation = Self { counts, lengths, periodic, faces, diagonal, right };
        equation.close();
        equation
    }

    /// No flow through faces of the box that are not periodic.
    pub(crate) fn close(&mut self) {
        for axis in 0..3 {
            for cell in 0..self.cells() {
                if self.indices(cell)[axis] == 0 && !self.periodic[axis] {
                    self.faces[axis][cell] = 0.0;
                }
            }
        }
    }

    /// Multiplies each coefficient by the harmonic mean of the mobilities of its two cells.
    pub(crate) fn with_mobility(mut self, mobility: impl Fn([f64; 3]) -> f64) -> Self {
        let here = |indices: [usize; 3]| {
            mobility([0, 1, 2].map(|a| (indices[a] as f64 + 0.5) / self.counts[a] as f64))
        };
        let mobilities: Vec<f64> = (0..self.cells()).map(|cell| here(self.indices(cell))).collect();
        for axis in 0..3 {
            for cell in 0..self.cells() {
                let below = self.below(cell, axis).unwrap_or(cell);
                let (a, b) = (mobilities[cell], mobilities[below]);
                self.faces[axis][cell] *= 2.0 * a * b / (a + b);
            }
        }
        self.diagonal.iter_mut().zip(&mobilities).for_each(|(d, m)| *d *= m);
        self
    }

    pub(crate) fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    /// The indices of a cell along x, y and z.
    pub(crate) fn indices(&self, cell: usize) -> [usize; 3] {
        let [nx, ny, _] = self.counts;
        [cell % nx, cell / nx % ny, cell / (nx * ny)]
    }

    /// The cell below along an axis.
    pub(crate) fn below(&self, cell: usize, axis: usize) -> Option<usize> {
        let [nx, ny, _] = self.counts;
        let stride = [1, nx, nx * ny][axis];
        match self.indices(cell)[axis] {
            0 if self.periodic[axis] => Some(cell + stride * (self.counts[axis] - 1)),
            0 => None,
            _ => Some(cell - stride),
        }
    }

    /// b - A p.
    pub(crate) fn residual(&self, p: &[f64]) -> Vec<f64> {
        let mut residual: Vec<f64> = (0..self.cells())
            .map(|cell| self.right[cell] - self.diagonal[cell] * p[cell])
            .collect();
        for axis in 0..3 {
            for cell in 0..self.cells() {
                if let Some(below) = self.below(cell, axis) {
                    let flow = self.faces[axis][cell] * (p[cell] - p[below]);
                    residual[cell] -= flow;
                    residual[below] += flow;
                }
            }
        }
        residual
    }

    /// D p, D being the diagonal of A.
    fn scaled_by_diagonal(&self, p: &[f64]) -> Vec<f64> {
        let mut sums = self.diagonal.clone();
        for axis in 0..3 {
            for cell in 0..self.cells() {
                if let Some(below) = self.below(cell, axis) {
                    sums[cell] += self.faces[axis][cell];
                    sums[below] += self.faces[axis][cell];
                }
            }
        }
        sums.iter().zip(p).map(|(sum, p)| sum * p).collect()
    }

    /// Checks the residual of a solution by plain loops.
    pub(crate) fn check(&self, outcome: &Outcome, relative: f64) {
        outcome.result.unwrap();
        let residual = norm(&self.residual(&outcome.solution));
        // The tolerance, and the rounding of the loops here, which add in another order than the solver.
        let rounding = 2.0 * f64::EPSILON * norm(&self.scaled_by_diagonal(&outcome.solution));
        let allowed = relative * norm(&self.right) + rounding;
        assert!(residual <= allowed, "{:?}: {residual} {allowed}", self.counts);
    }

    pub(crate) fn bounds(&self) -> Bounds {
        let face = |periodic| if periodic { Face::Periodic } else { Face::Wall };
        Bounds::new(Vector3::from(self.lengths), self.periodic.map(|periodic| [face(periodic); 2]))
    }

    pub(crate) fn grid(&self) -> BoxGrid {
        BoxGrid::new(&self.bounds(), self.counts)
    }

    /// Cut planes on cell faces, with subdomains of as equal size as possible.
    pub(crate) fn even_decomposition(&self, ranks: [usize; 3]) -> Decomposition {
        let even = Decomposition::even(RankGrid(ranks), &self.bounds());
        self.grid().aligned(&even, [2; 3]).expect("there are enough cells")
    }

    /// Cut planes at given cell faces, in addition to the faces of the box.
    pub(crate) fn decomposition_at(&self, planes: [&[usize]; 3]) -> Decomposition {
        let ranks = planes.map(|planes| planes.len() + 1);
        let grid = self.grid();
        let cut_planes = [0, 1, 2].map(|axis| {
            let faces = planes[axis].iter().map(|&face| face as f64 * grid.spacing()[axis]);
            [0.0].into_iter().chain(faces).chain([self.bounds().lengths()[axis]]).collect()
        });
        Decomposition::even(RankGrid(ranks), &self.bounds()).with_cut_planes(cut_planes)
    }

    /// Solves on the ranks of a decomposition, starting from zero, and returns the solution on the whole grid.
    pub(crate) fn solve_on(&self, decomposition: &Decomposition, tolerance: Tolerance) -> Outcome {
        self.solve_from(&vec![0.0; self.cells()], decomposition, tolerance)
    }

    pub(crate) fn solve_from(
        &self,
        start: &[f64],
        decomposition: &Decomposition,
        tolerance: Tolerance,
    ) -> Outcome {
        let solved = run_on_threads(decomposition.grid().size(), |ranks| {
            let bounds = self.bounds();
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            let local = self.grid().local_cells(subdomain);
            let mut solution = self.local_field(start, &local);
            let result = self.solve_on_rank(&mut solution, subdomain, tolerance, ranks);
            (local, result, solution)
        });
        let mut solution = vec![f64::NAN; self.cells()];
        let first = solved[0].1;
        for (local, result, field) in &solved {
            assert_eq!(format!("{result:?}"), format!("{first:?}"), "ranks differ");
            self.for_each_cell_of(local, |cell, indices| solution[cell] = field.at(indices));
        }
        Outcome { result: first, solution }
    }

    fn solve_on_rank(
        &self,
        solution: &mut Field,
        subdomain: Subdomain,
        tolerance: Tolerance,
        ranks: &dyn Communicator,
    ) -> Result<Convergence, LinearSolverError> {
        let mut solver = PressureSolver::new(&self.grid(), subdomain);
        let local = self.grid().local_cells(subdomain);
        let [x, y, z] = self.faces.each_ref().map(|face| self.local_field(face, &local));
        let diagonal = self.local_field(&self.diagonal, &local);
        solver.set_coefficients([&x, &y, &z], Some(&diagonal), ranks)?;
        solver.solve(solution, &self.local_field(&self.right, &local), tolerance, ranks)
    }

    fn local_field(&self, values: &[f64], local: &LocalCells) -> Field {
        let mut field = Field::new(local, 1);
        self.for_each_cell_of(local, |cell, indices| *field.at_mut(indices) = values[cell]);
        field
    }

    fn for_each_cell_of(&self, local: &LocalCells, mut work: impl FnMut(usize, [isize; 3])) {
        for cell in 0..self.cells() {
            let indices = self.indices(cell);
            if (0..3).all(|a| local.start[a] <= indices[a] && indices[a] < local.end(a)) {
                work(cell, [0, 1, 2].map(|a| (indices[a] - local.start[a]) as isize));
            }
        }
    }
}

/// The result of all ranks together.
pub(crate) struct Outcome {
    pub(crate) result: Result<Convergence, LinearSolverError>,
    pub(crate) solution: Vec<f64>,
}

impl Outcome {
    pub(crate) fn iterations(&self) -> usize {
        self.result.expect("the equation has a solution").iterations
    }

    pub(crate) fn bits(&self) -> Vec<u64> {
        self.solution.iter().map(|value| value.to_bits()).collect()
    }
}

/// Euclidean norm.
pub(crate) fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}
