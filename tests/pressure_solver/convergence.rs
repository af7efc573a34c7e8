//! Numbers of iterations: contrasts, anisotropic cells, grid sizes.

use crate::equations::Equation;
use talcum::linear_solver::Tolerance;

const TOLERANCE: Tolerance = Tolerance { relative: 1.0e-8, absolute: 0.0 };

/// Iterations, and a check of the residual by plain loops.
fn iterations(equation: &Equation) -> usize {
    let outcome = equation.solve_on(&equation.even_cut([1; 3]), TOLERANCE);
    equation.check(&outcome, TOLERANCE.relative);
    outcome.iterations()
}

/// A bed with round bubbles in its lower two thirds, empty above: mobilities 1 and 1 / contrast.
fn bubbling(n: usize, contrast: f64) -> Equation {
    let bubbles = [([0.3, 0.4, 0.2], 0.14), ([0.7, 0.6, 0.35], 0.18), ([0.35, 0.75, 0.5], 0.11)];
    Equation::new([n; 3], [false; 3]).with_mobility(|at| {
        let inside = |&(centre, radius): &([f64; 3], f64)| {
            (0..3).map(|a| (at[a] - centre[a]).powi(2)).sum::<f64>() < radius * radius
        };
        let empty = at[2] > 0.65 || bubbles.iter().any(inside);
        if empty { 1.0 } else { 1.0 / contrast }
    })
}

#[test]
fn jumps_of_six_and_nine_orders_of_magnitude_do_no_harm() {
    for contrast in [1.0, 1.0e3, 1.0e6, 1.0e9] {
        let counts = [16, 32].map(|n| iterations(&bubbling(n, contrast)));
        assert!(counts[1] <= 15 && counts[1] <= counts[0] + 3, "{contrast}: {counts:?}");
    }
}

#[test]
fn cells_of_any_shape_need_as_many_iterations_as_cubes() {
    let n = [24, 24, 24];
    for edges in
        [[1.0, 1.0, 1.0], [1.0, 1.0, 4.0], [1.0, 4.0, 4.0], [4.0, 1.0, 1.0], [1.0, 2.0, 4.0]]
    {
        let lengths = [0, 1, 2].map(|a| n[a] as f64 * edges[a]);
        let count = iterations(&Equation::in_box(n, lengths, [false; 3]));
        assert!(count <= 9, "{edges:?}: {count}");
    }
}

#[test]
fn coarsening_that_does_not_know_the_shape_of_cells_needs_more() {
    // Control of the test above: the coefficients of flat cells on a grid that is told that they are cubes.
    let flat = Equation::in_box([24; 3], [96.0, 96.0, 24.0], [false; 3]);
    let misled = Equation { lengths: [24.0; 3], ..flat.clone() };
    let [knowing, misled] = [flat, misled].map(|equation| iterations(&equation));
    assert!(misled >= knowing + 4, "{knowing} {misled}");
}
