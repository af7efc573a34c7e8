//! Equations that cannot be solved give the same error on all ranks.

use super::equations::Equation;
use talcum::linear_solver::{LinearSolverError, Tolerance};

const TOLERANCE: Tolerance = Tolerance { relative: 1.0e-8, absolute: 0.0 };

/// A box with an outlet. The cells below z = 4 are closed off, and more flows into them than out of them.
fn closed_off() -> Equation {
    let mut equation = Equation::new([8, 8, 16], [false; 3]);
    for cell in 4 * 64..5 * 64 {
        equation.faces[2][cell] = 0.0;
    }
    equation
}

#[test]
fn an_equation_without_solution_is_an_error_and_the_start_values_are_kept() {
    let equation = closed_off();
    let start: Vec<f64> = (0..equation.cells()).map(|cell| cell as f64).collect();
    for ranks in [1, 3] {
        let outcome =
            equation.solve_from(&start, &equation.even_decomposition([1, 1, ranks]), TOLERANCE);
        let error = outcome.result.unwrap_err();
        assert!(matches!(error, LinearSolverError::NotConverged { .. }), "{error}");
        assert!(error.to_string().contains("did not converge"));
        assert_eq!(outcome.solution, start);
    }
}

#[test]
fn a_closed_region_without_sources_is_not_an_error() {
    // Negative control of the test above: only the right-hand side makes it fail.
    let mut equation = closed_off();
    equation.right[..4 * 64].fill(0.0);
    equation.solve_on(&equation.even_decomposition([1; 3]), TOLERANCE).result.unwrap();
}

#[test]
fn negative_infinite_and_undefined_coefficients_are_refused() {
    for wrong in [-1.0e-300, f64::NAN, f64::INFINITY] {
        let mut equation = Equation::new([8; 3], [false; 3]);
        equation.faces[1][300] = wrong;
        equation.diagonal[2] = wrong;
        let result = equation.solve_on(&equation.even_decomposition([1, 1, 3]), TOLERANCE).result;
        assert_eq!(result.unwrap_err(), LinearSolverError::Coefficients(2));
    }
}

#[test]
fn infinite_and_undefined_sources_and_start_values_are_refused() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let equation = Equation::new([8; 3], [false; 3]);
        let decomposition = equation.even_decomposition([1, 1, 3]);
        let mut start = vec![0.0; equation.cells()];
        start[500] = wrong;
        let result = equation.solve_from(&start, &decomposition, TOLERANCE).result;
        assert_eq!(result.unwrap_err(), LinearSolverError::NotFinite);
        let mut sources = equation.clone();
        sources.right[3] = wrong;
        let result = sources.solve_on(&decomposition, TOLERANCE).result;
        assert_eq!(result.unwrap_err(), LinearSolverError::NotFinite);
    }
}
