//! Preconditioned conjugate gradients.

use super::coarsening::LevelGrid;
use super::convergence::{Convergence, LinearSolverError, Tolerance};
use super::exact_dot::{DotProduct, RunningDot};
use super::hierarchy::{Cycle, Hierarchy};
use super::operator::{Coefficients, apply, residual};
use super::rows::rows;
use crate::domain::Subdomain;
use crate::grid::{BoxGrid, Field, LocalCells};
use crate::numbers::{VectorWork, in_wide_vectors};
use crate::parallel::{Communicator, FieldHalo};

/// Iterations after which a solve is given up.
const ITERATION_LIMIT: usize = 200;

/// Solves A p = b on the cells of the box; holds all that it needs between two solves.
///
/// ```
/// use nalgebra::Vector3;
/// use talcum::domain::{Bounds, Decomposition, Face, RankGrid};
/// use talcum::grid::{BoxGrid, Field};
/// use talcum::linear_solver::{PressureSolver, Tolerance};
/// use talcum::parallel::OneRank;
///
/// // Flow through a column of 10 cells, each with resistance 1, from a source at the bottom to an outlet on top.
/// let bounds = Bounds::new(Vector3::new(1.0, 1.0, 10.0), [[Face::Wall; 2]; 3]);
/// let grid = BoxGrid::new(&bounds, [1, 1, 10]);
/// let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
/// let subdomain = decomposition.subdomain(&bounds, 0);
/// let part = grid.local_cells(subdomain);
/// let field = |value: f64| {
///     let mut field = Field::new(&part, 1);
///     field.set_owned((0..10).map(|_| value));
///     field
/// };
/// let (face, mut outlet, mut source) = (field(1.0), field(0.0), field(0.0));
/// *outlet.at_mut([0, 0, 9]) = 2.0; // the face is half a cell away
/// *source.at_mut([0, 0, 0]) = 1.0;
///
/// let mut solver = PressureSolver::new(&grid, subdomain);
/// solver.set_coefficients([&face, &face, &face], Some(&outlet), &OneRank)?;
/// let mut pressure = field(0.0);
/// solver.solve(&mut pressure, &source, Tolerance::relative(1.0e-12), &OneRank)?;
/// assert!((pressure.at([0, 0, 0]) - 9.5).abs() < 1.0e-9);
/// # Ok::<(), talcum::linear_solver::LinearSolverError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PressureSolver {
    part: LocalCells,
    periodic: [bool; 3],
    halo: FieldHalo,
    coefficients: Coefficients,
    /// Nothing holds the mean of the solution: no cell has a diagonal.
    closed: bool,
    hierarchy: Hierarchy,
    right: Field,
    solution: Field,
    residual: Field,
    preconditioned: Field,
    direction: Field,
    image: Field,
}

impl PressureSolver {
    /// For a grid whose cut has its planes on cell faces ([`BoxGrid::aligned`]).
    ///
    /// The coarse grids follow from counts, spacing and periodicity of the whole grid. All memory is taken here.
    pub fn new(grid: &BoxGrid, subdomain: Subdomain) -> Self {
        let part = grid.local_cells(subdomain);
        let zero = || Field::new(&part, 1);
        Self {
            part,
            periodic: [0, 1, 2].map(|axis| grid.is_periodic(axis)),
            halo: FieldHalo::new(subdomain),
            coefficients: Coefficients::new(&part),
            closed: true,
            hierarchy: Hierarchy::new(&LevelGrid::finest(grid, subdomain.decomposition), subdomain),
            right: zero(),
            solution: zero(),
            residual: zero(),
            preconditioned: zero(),
            direction: zero(),
            image: zero(),
        }
    }

    /// Sets a_f, on the lower faces of cells for x, y and z, and d_c (none: 0), and builds the coarse levels.
    ///
    /// Of the fields, owned cells are read; their halos may be of any width. Faces on the box's own faces, other than
    /// periodic ones, count as closed whatever stands there: an outlet of given pressure is a diagonal. Collective.
    ///
    /// # Errors
    /// If a coefficient is negative, infinite or undefined, on all ranks.
    pub fn set_coefficients(
        &mut self,
        faces: [&Field; 3],
        diagonal: Option<&Field>,
        ranks: &dyn Communicator,
    ) -> Result<(), LinearSolverError> {
        for (axis, faces) in faces.into_iter().enumerate() {
            copy_owned(faces, &mut self.coefficients.faces[axis]);
            self.close_lower_face(axis);
        }
        match diagonal {
            Some(diagonal) => copy_owned(diagonal, &mut self.coefficients.diagonal),
            None => self.coefficients.diagonal.values_mut().fill(0.0),
        }
        let allowed = |value: f64| (0.0..=f64::MAX).contains(&value);
        let fields = self.coefficients.fields();
        let wrong: usize = fields.iter().map(|field| count(field, |a| !allowed(a))).sum();
        let holding = count(&self.coefficients.diagonal, |d| d > 0.0);
        let mut counts = [wrong as i64, holding as i64];
        ranks.sum_integers(&mut counts);
        if counts[0] != 0 {
            return Err(LinearSolverError::Coefficients(counts[0] as usize));
        }
        self.closed = counts[1] == 0;
        self.halo.refresh(&mut self.coefficients.fields(), ranks);
        self.hierarchy.set_coefficients(&self.coefficients, ranks);
        Ok(())
    }

    /// Nothing passes the box's own lower face, nor between a cell and itself.
    fn close_lower_face(&mut self, axis: usize) {
        let closed = !self.periodic[axis] || self.part.counts[axis] == 1;
        if closed && self.part.start[axis] == 0 {
            let field = &mut self.coefficients.faces[axis];
            let rows: Vec<_> = field.slab(axis, (0, 1)).collect();
            rows.into_iter().for_each(|row| field.values_mut()[row].fill(0.0));
        }
    }

    /// Solves A p = b from the start value in `solution`, of which owned cells are read and set.
    ///
    /// In a closed box (no diagonal anywhere) the mean of the right-hand side is taken away, and the solution has
    /// mean zero. Collective; the result is the same bits on any cut.
    ///
    /// # Errors
    /// If the right-hand side or the start value is not finite, or the limit of 200 iterations is reached: on all
    /// ranks, and `solution` keeps the start value.
    pub fn solve(
        &mut self,
        solution: &mut Field,
        right_hand_side: &Field,
        tolerance: Tolerance,
        ranks: &dyn Communicator,
    ) -> Result<Convergence, LinearSolverError> {
        copy_owned(solution, &mut self.solution);
        copy_owned(right_hand_side, &mut self.right);
        let removed_mean =
            if self.closed { self.remove_mean(Of::RightHandSide, ranks) } else { 0.0 };
        let size = DotProduct::default().of(&self.right, &self.right, ranks).sqrt();
        if size == 0.0 {
            self.solution.values_mut().fill(0.0);
            copy_owned(&self.solution, solution);
            return Ok(Convergence { removed_mean, ..Convergence::default() });
        }
        let allowed = (tolerance.relative * size).max(tolerance.absolute);
        let (iterations, residual) = self.iterate(allowed, ranks)?;
        if self.closed {
            self.remove_mean(Of::Solution, ranks);
        }
        copy_owned(&self.solution, solution);
        Ok(Convergence { iterations, residual, right_hand_side: size, removed_mean })
    }

    /// Runs of conjugate gradients, until b - A p, formed anew, is as small as allowed or as rounding lets it be; number of iterations, and
    /// norm of the residual.
    fn iterate(
        &mut self,
        allowed: f64,
        ranks: &dyn Communicator,
    ) -> Result<(usize, f64), LinearSolverError> {
        let mut run = Run::default();
        let mut done = 0;
        loop {
            self.halo.refresh(&mut [&mut self.solution], ranks);
            residual(&self.coefficients, &self.solution, &self.right, &mut self.residual);
            let size = run.squares.of(&self.residual, &self.residual, ranks).sqrt();
            if !(size + allowed).is_finite() {
                return Err(LinearSolverError::NotFinite);
            }
            if size <= allowed || (done > 0 && size <= self.rounding(ranks)) {
                return Ok((done, size));
            }
            self.run(&mut run, &mut done, (size, allowed), ranks)?;
        }
    }

    /// What rounding makes of b - A p: 2^-52 |D p|, D being the diagonal of A. No solution in doubles is better than
    /// about that. Collective.
    fn rounding(&mut self, ranks: &dyn Communicator) -> f64 {
        self.coefficients.scale_by_diagonal(&self.solution, &mut self.image);
        DotProduct::default().of(&self.image, &self.image, ranks).sqrt() * f64::EPSILON
    }

    /// Conjugate gradients from the residual at hand, of a norm above what is allowed, until the residual that they
    /// carry along is as small.
    fn run(
        &mut self,
        run: &mut Run,
        done: &mut usize,
        (mut size, allowed): (f64, f64),
        ranks: &dyn Communicator,
    ) -> Result<(), LinearSolverError> {
        let mut last_energy = f64::INFINITY;
        while size > allowed {
            let failed =
                LinearSolverError::NotConverged { iterations: *done, residual: size, allowed };
            if *done == ITERATION_LIMIT {
                return Err(failed);
            }
            let mut energy = self.precondition(run, ranks);
            if energy <= 0.0 {
                run.cycle = Cycle::V;
                last_energy = f64::INFINITY;
                energy = self.precondition(run, ranks);
            }
            let beta = energy / last_energy;
            last_energy = energy;
            let towards = &self.preconditioned;
            in_wide_vectors(Turn { beta, towards, direction: &mut self.direction });
            self.halo.refresh(&mut [&mut self.direction], ranks);
            let dot = run.curvatures.begin();
            let dot = apply(&self.coefficients, &self.direction, &mut self.image, dot);
            let curvature = run.curvatures.finish(dot, [&self.direction, &self.image], ranks);
            let running = in_wide_vectors(Advance {
                length: energy / curvature,
                direction: &self.direction,
                image: &self.image,
                solution: &mut self.solution,
                residual: &mut self.residual,
                squares: run.squares.begin(),
            });
            let square = run.squares.finish(running, [&self.residual, &self.residual], ranks);
            if !square.is_finite() {
                return Err(failed);
            }
            size = square.sqrt();
            *done += 1;
        }
        Ok(())
    }

    /// z = M r, and r . z. Collective.
    fn precondition(&mut self, run: &mut Run, ranks: &dyn Communicator) -> f64 {
        let equation = (&self.residual, &mut self.preconditioned);
        self.hierarchy.cycle(&self.coefficients, equation, run.cycle, ranks);
        run.energies.of(&self.residual, &self.preconditioned, ranks)
    }

    /// Subtracts the mean over all cells, summed exactly; returns it.
    fn remove_mean(&mut self, of: Of, ranks: &dyn Communicator) -> f64 {
        let Self { solution, right, image, part, .. } = self;
        let field = match of {
            Of::RightHandSide => right,
            Of::Solution => solution,
        };
        image.values_mut().fill(1.0);
        let sum = DotProduct::default().of(field, image, ranks);
        let mean = sum / part.counts.iter().product::<usize>() as f64;
        for [row] in rows([field]) {
            let row = row..row + part.count[0];
            field.values_mut()[row].iter_mut().for_each(|value| *value -= mean);
        }
        image.values_mut().fill(0.0);
        mean
    }
}

/// The owned numbers of another field, whose halo may have another width.
fn copy_owned(from: &Field, to: &mut Field) {
    let length = from.count()[0];
    for [source, target] in rows([from, &*to]) {
        to.values_mut()[target..][..length].copy_from_slice(&from.values()[source..][..length]);
    }
}

/// How many owned numbers are of a kind.
fn count(field: &Field, is: impl Fn(f64) -> bool) -> usize {
    let length = field.count()[0];
    let row = |[row]: [usize; 1]| &field.values()[row..][..length];
    rows([field]).map(|place| row(place).iter().filter(|&&value| is(value)).count()).sum()
}

/// What is kept from run to run of a solve: the magnitudes of dot products, and the kind of cycle.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// r . r
    squares: DotProduct,
    /// r . M r
    energies: DotProduct,
    /// p . A p
    curvatures: DotProduct,
    /// V once W was found not to be positive definite.
    cycle: Cycle,
}

impl Default for Run {
    fn default() -> Self {
        let [squares, energies, curvatures] = [DotProduct::default(); 3];
        Self { squares, energies, curvatures, cycle: Cycle::W }
    }
}

/// What a mean is taken from.
#[derive(Clone, Copy)]
enum Of {
    RightHandSide,
    Solution,
}

/// p = z + beta p.
struct Turn<'a> {
    beta: f64,
    towards: &'a Field,
    direction: &'a mut Field,
}

impl VectorWork for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let length = self.direction.count()[0];
        for [row] in rows([self.direction]) {
            let towards = &self.towards.values()[row..][..length];
            for (p, z) in self.direction.values_mut()[row..][..length].iter_mut().zip(towards) {
                *p = z + self.beta * *p;
            }
        }
    }
}

/// x += alpha p, r -= alpha q, and r . r.
struct Advance<'a> {
    length: f64,
    direction: &'a Field,
    image: &'a Field,
    solution: &'a mut Field,
    residual: &'a mut Field,
    squares: RunningDot,
}

impl VectorWork for Advance<'_> {
    type Output = RunningDot;

    #[inline(always)]
    fn run(mut self) -> RunningDot {
        let length = self.direction.count()[0];
        for [row] in rows([self.direction]) {
            let p = &self.direction.values()[row..][..length];
            for (x, p) in self.solution.values_mut()[row..][..length].iter_mut().zip(p) {
                *x += self.length * p;
            }
            let q = &self.image.values()[row..][..length];
            let r = &mut self.residual.values_mut()[row..][..length];
            for (r, q) in r.iter_mut().zip(q) {
                *r -= self.length * q;
            }
            self.squares.add_row(r, r);
        }
        self.squares
    }
}
