//! The pressure equation in the form used by the gas solvers.

use super::conjugate_gradients::{ConjugateGradients, Start};
use super::convergence::{Convergence, LinearSolverError, Tolerance};
use super::dot_product::{DotProduct, largest_term};
use super::level_grid::LevelGrid;
use super::operator::{Coefficients, Equation};
use super::preconditioner::Preconditioner;
use super::rows::{copy_owned, rows};
use crate::domain::Subdomain;
use crate::grid::{BoxGrid, Field, LocalCells};
use crate::numbers::{Largest, vectorised};
use crate::parallel::{Communicator, FieldHalo};

/// Solves A p = b on the cells of the box; it keeps its memory from one solve to the next.
///
/// ```
/// # use talcum_engine as talcum;
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
/// let cells = grid.local_cells(subdomain);
/// let field = |value: f64| {
///     let mut field = Field::new(&cells, 1);
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
    cells: LocalCells,
    periodic: [bool; 3],
    halo: FieldHalo,
    coefficients: Coefficients,
    /// Whether no cell is coupled to zero, so that the mean of the solution is undetermined.
    closed: bool,
    preconditioner: Preconditioner,
    gradients: ConjugateGradients,
    right_hand_side: Field,
    solution: Field,
}

impl PressureSolver {
    /// A solver for a grid and a subdomain whose faces lie on cell faces ([`BoxGrid::aligned`]).
    ///
    /// The coarse grids follow from counts, spacing and periodicity of the whole grid. All memory is allocated here.
    pub fn new(grid: &BoxGrid, subdomain: Subdomain) -> Self {
        let cells = grid.local_cells(subdomain);
        let finest = LevelGrid::finest(grid, subdomain.decomposition);
        Self {
            cells,
            periodic: [0, 1, 2].map(|axis| grid.is_periodic(axis)),
            halo: FieldHalo::new(subdomain),
            coefficients: Coefficients::new(&cells),
            closed: true,
            preconditioner: Preconditioner::new(&finest, &cells, subdomain),
            gradients: ConjugateGradients::new(&cells, subdomain),
            right_hand_side: Field::new(&cells, 1),
            solution: Field::new(&cells, 1),
        }
    }

    /// Sets a_f, for the lower faces of cells along x, y and z, and d_c (zero if `None`), and builds the coarse levels.
    ///
    /// Only owned cells of the fields are read; their halos may have any width. Faces that lie in a non-periodic face
    /// of the box count as closed whatever the field contains there: an outlet of given pressure is expressed by d_c.
    /// This call is collective.
    ///
    /// # Errors
    /// If a coefficient is negative, infinite or undefined on any rank: the same error on all ranks.
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
        let Coefficients { faces, diagonal } = &self.coefficients;
        let mut coefficients = [largest(faces), largest([diagonal])];
        ranks.maximum(&mut coefficients);
        let [of_faces, of_diagonal] = coefficients;
        if of_faces.max(of_diagonal) == f64::INFINITY {
            let wrong: usize =
                self.coefficients.fields().iter().map(|field| not_allowed(field)).sum();
            return Err(LinearSolverError::Coefficients(ranks.total(wrong)));
        }
        self.closed = of_diagonal == 0.0;
        self.halo.refresh(&mut self.coefficients.fields(), ranks);
        self.preconditioner.set_coefficients(&self.coefficients, of_faces.max(of_diagonal), ranks);
        Ok(())
    }

    /// Closes the lower face of the box, and the faces of cells that are their own neighbours.
    fn close_lower_face(&mut self, axis: usize) {
        let closed = !self.periodic[axis] || self.cells.counts[axis] == 1;
        if closed && self.cells.start[axis] == 0 {
            let field = &mut self.coefficients.faces[axis];
            let rows: Vec<_> = field.slab(axis, 0..1).collect();
            rows.into_iter().for_each(|row| field.values_mut()[row].fill(0.0));
        }
    }

    /// Solves A p = b, starting from the values in `solution`. Only owned cells of both fields are read and set.
    ///
    /// In a closed box (d_c = 0 everywhere) the mean of the right-hand side is subtracted, and the solution has mean
    /// zero, over the cells that are coupled to others; in the other cells the solution has no meaning. This call is
    /// collective. The bits of the result do not depend on the decomposition.
    ///
    /// # Errors
    /// If the right-hand side or the start values are not finite, or after 200 iterations: the same error on all ranks;
    /// `solution` then keeps the start values.
    pub fn solve(
        &mut self,
        solution: &mut Field,
        right_hand_side: &Field,
        tolerance: Tolerance,
        ranks: &dyn Communicator,
    ) -> Result<Convergence, LinearSolverError> {
        copy_owned(solution, &mut self.solution);
        copy_owned(right_hand_side, &mut self.right_hand_side);
        let Self { preconditioner, gradients, closed, coefficients, .. } = self;
        let right = &mut self.right_hand_side;
        let removed_mean = if *closed {
            remove_mean(right, coefficients, gradients.scratch(), ranks)
        } else {
            0.0
        };
        let mut bounds = [largest_term(right, &*right), largest([&self.solution])];
        ranks.maximum(&mut bounds);
        let [of_squares, of_start] = bounds;
        let mut squared_norm = DotProduct::of_terms_up_to(of_squares);
        let norm = squared_norm.of(right, &*right, ranks).sqrt();
        if norm == 0.0 {
            self.solution.values_mut().fill(0.0);
            copy_owned(&self.solution, solution);
            return Ok(Convergence { removed_mean, ..Convergence::default() });
        }
        let start = Start {
            norm: (of_start == 0.0).then_some((norm, squared_norm)),
            allowed: (tolerance.relative * norm).max(tolerance.absolute),
        };
        let mut equation = Equation {
            coefficients: &self.coefficients,
            right_hand_side: right,
            solution: &mut self.solution,
        };
        let solved = gradients.solve(&mut equation, preconditioner, start, ranks)?;
        if *closed {
            remove_mean(&mut self.solution, &self.coefficients, gradients.scratch(), ranks);
        }
        copy_owned(&self.solution, solution);
        Ok(Convergence {
            iterations: solved.iterations,
            residual: solved.residual,
            right_hand_side: norm,
            removed_mean,
        })
    }
}

/// Subtracts the mean over the cells that are coupled to others, or over all cells if none is, and returns it: the sum
/// is exact. Overwrites `marks`. This call is collective.
fn remove_mean(
    field: &mut Field,
    coefficients: &Coefficients,
    marks: &mut Field,
    ranks: &dyn Communicator,
) -> f64 {
    coefficients.mark_coupled(marks);
    let mut cells = DotProduct::default().of(marks, &*marks, ranks);
    if cells == 0.0 {
        marks.values_mut().fill(1.0);
        cells = DotProduct::default().of(marks, &*marks, ranks);
    }
    let mean = DotProduct::default().of(field, &*marks, ranks) / cells;
    let length = field.row_length();
    for [row, mark] in rows([&*field, &*marks]) {
        let marks = &marks.values()[mark..][..length];
        let values = &mut field.values_mut()[row..][..length];
        values.iter_mut().zip(marks).for_each(|(value, mark)| *value -= mark * mean);
    }
    marks.values_mut().fill(0.0);
    mean
}

/// The largest of the owned values; infinity if one is negative, infinite or undefined (NaN).
fn largest<'a>(fields: impl IntoIterator<Item = &'a Field>) -> f64 {
    fields.into_iter().map(largest_value).fold(0.0, f64::max)
}

vectorised!(
    fn largest_value(field: &Field) -> f64 {
        let length = field.row_length();
        let mut largest = Largest::default();
        for [row] in rows([field]) {
            for &value in &field.values()[row..][..length] {
                largest.add(value);
            }
        }
        largest.value()
    }
);

/// Number of owned values that are negative, infinite or undefined (NaN).
fn not_allowed(field: &Field) -> usize {
    let length = field.row_length();
    let row = |[row]: [usize; 1]| &field.values()[row..][..length];
    let is_wrong = |value: &&f64| !(0.0..=f64::MAX).contains(*value);
    rows([field]).map(|at| row(at).iter().filter(is_wrong).count()).sum()
}
