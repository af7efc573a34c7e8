//! The number of iterations for different contrasts, cell shapes and grid sizes.

use super::equations::Equation;
use talcum::linear_solver::Tolerance;

const TOLERANCE: Tolerance = Tolerance { relative: 1.0e-8, absolute: 0.0 };

/// The number of iterations. The residual is checked by plain loops.
fn iterations(equation: &Equation) -> usize {
    let outcome = equation.solve_on(&equation.even_decomposition([1; 3]), TOLERANCE);
    equation.check(&outcome, TOLERANCE.relative);
    outcome.iterations()
}

/// A bed with round bubbles in its lower two thirds, empty above. The mobilities are 1 and 1 / contrast.
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
fn iterations_do_not_grow_with_the_contrast_or_the_grid() {
    for contrast in [1.0, 1.0e3, 1.0e6, 1.0e9] {
        let counts = [16, 32].map(|n| iterations(&bubbling(n, contrast)));
        assert!(counts[1] <= 15 && counts[1] <= counts[0] + 3, "{contrast}: {counts:?}");
    }
}

#[test]
fn flat_and_long_cells_need_as_many_iterations_as_cubes() {
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
fn coarsening_along_the_wrong_axes_is_detected_by_more_iterations() {
    // Negative control of the test above: the coefficients of flat cells, but the lengths of cubes.
    let flat = Equation::in_box([24; 3], [96.0, 96.0, 24.0], [false; 3]);
    let wrong = Equation { lengths: [24.0; 3], ..flat.clone() };
    let [right, wrong] = [flat, wrong].map(|equation| iterations(&equation));
    assert!(wrong >= right + 4, "{right} {wrong}");
}
