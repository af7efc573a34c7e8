//! The order of accuracy; closed boxes and narrow ones.

use super::equations::{Equation, norm};
use std::f64::consts::PI;
use talcum::linear_solver::Tolerance;

const TIGHT: Tolerance = Tolerance { relative: 1.0e-11, absolute: 0.0 };

/// Distance from the face at which coefficients are evaluated, in cells.
const AT_FACES: f64 = 0.0;

/// Largest error of -div(a grad p) = b in the unit cube with p = cos(pi x) cos(2 pi y) sin(pi z / 2 + ...) and
/// a = 1 + x/2 + y z: walls without flow at x and y, p given on top.
fn error_on(n: usize, shift: f64) -> f64 {
    let pressure =
        |[x, y, z]: [f64; 3]| (PI * x).cos() * (2.0 * PI * y).cos() * (0.5 * PI * z).cos();
    let slope = |[x, y, z]: [f64; 3]| {
        let [a, b, c] = [PI * x, 2.0 * PI * y, 0.5 * PI * z];
        [
            -PI * a.sin() * b.cos() * c.cos(),
            -2.0 * PI * a.cos() * b.sin() * c.cos(),
            -0.5 * PI * a.cos() * b.cos() * c.sin(),
        ]
    };
    let mobility = |[x, y, z]: [f64; 3]| 1.0 + 0.5 * x + y * z;
    let grad_mobility = |[_, y, z]: [f64; 3]| [0.5, z, y];
    let source = |at: [f64; 3]| {
        let laplacian = -(1.0 + 4.0 + 0.25) * PI * PI * pressure(at);
        let (g, s) = (grad_mobility(at), slope(at));
        -(mobility(at) * laplacian + g[0] * s[0] + g[1] * s[1] + g[2] * s[2])
    };
    let h = 1.0 / n as f64;
    let mut equation = Equation::in_box([n; 3], [1.0; 3], [false; 3]);
    for cell in 0..equation.cells() {
        let centre = equation.indices(cell).map(|i| (i as f64 + 0.5) * h);
        for axis in 0..3 {
            let mut face = centre;
            face[axis] += (shift - 0.5) * h;
            equation.faces[axis][cell] = h * mobility(face);
        }
        equation.right[cell] = source(centre) * h.powi(3);
        let [x, y, _] = centre;
        if equation.diagonal[cell] > 0.0 {
            // p = 0 on top: cos(pi / 2).
            equation.diagonal[cell] = 2.0 * h * mobility([x, y, 1.0 + shift * h]);
        }
    }
    equation.close();
    let outcome = equation.solve_on(&equation.even_decomposition([1; 3]), TIGHT);
    outcome.result.unwrap();
    let error = |cell: usize| {
        let centre = equation.indices(cell).map(|i| (i as f64 + 0.5) * h);
        (outcome.solution[cell] - pressure(centre)).abs()
    };
    (0..equation.cells()).map(error).fold(0.0, f64::max)
}

/// The observed order of accuracy from each grid to the next finer one.
fn orders(shift: f64) -> Vec<f64> {
    let errors: Vec<f64> = [8, 16, 32, 64].map(|n| error_on(n, shift)).to_vec();
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn the_solution_is_second_order_accurate() {
    // On the coarsest grid a wave has 8 cells. From 16 cells on the leading term of the error dominates; the next term
    // changes the observed order by less than 0.1.
    let orders = orders(AT_FACES);
    assert!((orders[1] - 2.0).abs() < 0.1 && (orders[2] - 2.0).abs() < 0.1, "{orders:?}");
}

#[test]
fn coefficients_evaluated_half_a_cell_off_are_detected_as_first_order() {
    let orders = orders(AT_FACES + 0.5);
    assert!(orders[2] < 1.2, "first order is expected: {orders:?}");
}

#[test]
fn in_a_closed_box_the_mean_is_removed_from_sources_and_solution() {
    for periodic in [[false; 3], [true; 3], [true, false, true]] {
        let mut equation = Equation::new([12, 9, 14], periodic);
        equation.diagonal.fill(0.0);
        let mean = equation.right.iter().sum::<f64>() / equation.cells() as f64;
        let outcome = equation.solve_on(&equation.even_decomposition([1, 1, 2]), TIGHT);
        let convergence = outcome.result.unwrap();
        // The rounding errors of both sums are below 1e-12.
        assert!((convergence.removed_mean - mean).abs() < 1.0e-12, "{convergence:?}");
        equation.right.iter_mut().for_each(|value| *value -= mean);
        equation.check(&outcome, TIGHT.relative);
        let sum: f64 = outcome.solution.iter().sum();
        assert!(sum.abs() < 1.0e-12 * norm(&outcome.solution) * equation.cells() as f64);
    }
}

/// The corners of a box around a round column: nothing flows to or from them.
#[test]
fn cells_that_are_coupled_to_none_have_no_part_in_the_mean() {
    let mut equation = Equation::new([12, 12, 14], [false, false, true]);
    equation.diagonal.fill(0.0);
    let is_open = |equation: &Equation, cell: usize| {
        let [i, j, _] = equation.indices(cell);
        (i as f64 - 5.6).hypot(j as f64 - 5.3) < 5.4
    };
    for (axis, cell) in (0..3).flat_map(|axis| (0..12 * 12 * 14).map(move |cell| (axis, cell))) {
        let below = equation.below(cell, axis);
        if !is_open(&equation, cell) || below.is_some_and(|below| !is_open(&equation, below)) {
            equation.faces[axis][cell] = 0.0;
        }
    }
    let open: Vec<bool> = (0..equation.cells()).map(|cell| is_open(&equation, cell)).collect();
    let count = open.iter().filter(|&&open| open).count() as f64;
    equation.right.iter_mut().zip(&open).filter(|(_, open)| !**open).for_each(|(b, _)| *b = 0.0);
    let outcome = equation.solve_on(&equation.even_decomposition([2, 1, 2]), TIGHT);
    let mean = equation.right.iter().sum::<f64>() / count;
    // The rounding errors of both sums are below 1e-12.
    assert!((outcome.result.unwrap().removed_mean - mean).abs() < 1.0e-12);
    assert!((mean * count / equation.cells() as f64 - mean).abs() > 1.0e-3); // a control: over all cells it is another
    let pairs = equation.right.iter_mut().zip(&open);
    pairs.filter(|(_, open)| **open).for_each(|(value, _)| *value -= mean);
    equation.check(&outcome, TIGHT.relative);
}

#[test]
fn in_a_box_with_an_outlet_no_mean_is_removed() {
    // Negative control of the test above.
    let equation = Equation::new([12, 9, 14], [false; 3]);
    let outcome = equation.solve_on(&equation.even_decomposition([1; 3]), TIGHT);
    assert_eq!(outcome.result.unwrap().removed_mean, 0.0);
    assert!(outcome.solution.iter().sum::<f64>().abs() > 1.0);
    equation.check(&outcome, TIGHT.relative);
}

#[test]
fn grids_of_one_cell_and_of_odd_counts_are_solved() {
    let cases = [
        ([1, 1, 1], [false; 3]),
        ([1, 1, 200], [true, true, false]),
        ([1, 40, 30], [true, false, false]),
        ([33, 17, 9], [false; 3]),
        ([33, 17, 9], [true, true, true]),
        ([2, 2, 50], [true, true, false]),
        ([3, 5, 101], [true, true, false]),
    ];
    for (counts, periodic) in cases {
        let mut equation = Equation::new(counts, periodic);
        if periodic[2] {
            equation.diagonal[0] = 0.1;
        }
        let outcome = equation.solve_on(&equation.even_decomposition([1; 3]), TIGHT);
        equation.check(&outcome, TIGHT.relative);
        let iterations = outcome.iterations();
        assert!(iterations <= 14, "{counts:?}: {iterations}");
    }
}

#[test]
fn a_converged_start_value_needs_no_iteration_and_zero_sources_give_zero_pressure() {
    let mut equation = Equation::new([16; 3], [false; 3]);
    let decomposition = equation.even_decomposition([1; 3]);
    let solved = equation.solve_on(&decomposition, TIGHT);
    let again = equation.solve_from(&solved.solution, &decomposition, Tolerance::relative(1.0e-10));
    assert_eq!((again.iterations(), again.bits()), (0, solved.bits()));
    equation.right.fill(0.0);
    let rest = equation.solve_from(&solved.solution, &decomposition, TIGHT);
    assert_eq!((rest.iterations(), rest.solution), (0, vec![0.0; equation.cells()]));
}

#[test]
fn start_values_that_are_nearly_zero_change_no_bit() {
    let equation = Equation::new([16; 3], [false; 3]);
    let decomposition = equation.even_decomposition([1, 1, 2]);
    let expected = equation.solve_on(&decomposition, TIGHT);
    for (value, is_same) in [(1.0e-200, true), (1.0e-3, false)] {
        let start = vec![value; equation.cells()];
        let found = equation.solve_from(&start, &decomposition, TIGHT);
        assert_eq!(found.bits() == expected.bits(), is_same, "{value}");
    }
}

/// The preconditioner works in single precision, whose numbers lie between 1e-38 and 3e38.
#[test]
fn powers_of_two_in_coefficients_and_sources_are_powers_of_two_in_the_solution() {
    let equation = Equation::new([12, 9, 14], [false; 3]);
    let decomposition = equation.even_decomposition([1; 3]);
    let expected = equation.solve_on(&decomposition, TIGHT);
    for [coefficients, sources] in [[-400, -300], [-200, 150], [300, 400]] {
        let mut scaled = equation.clone();
        let by = |values: &mut [f64], exponent: i32| {
            values.iter_mut().for_each(|value| *value *= 2.0_f64.powi(exponent));
        };
        scaled.faces.iter_mut().for_each(|faces| by(faces, coefficients));
        by(&mut scaled.diagonal, coefficients);
        by(&mut scaled.right, sources);
        let mut outcome = scaled.solve_on(&decomposition, TIGHT);
        by(&mut outcome.solution, coefficients - sources);
        assert_eq!(outcome.iterations(), expected.iterations());
        assert_eq!(outcome.bits(), expected.bits(), "2^{coefficients}, 2^{sources}");
    }
}

#[test]
fn coefficients_too_small_for_single_precision_are_no_harm() {
    // A layer that lets almost nothing through, and a cell behind such faces; what flows into that cell must be as small.
    let mut equation = Equation::new([12, 9, 14], [false; 3]);
    let layer = 12 * 9;
    equation.faces[2][5 * layer..6 * layer].fill(1.0e-45);
    equation.right[..5 * layer].fill(0.0);
    let cell = 9 * layer + 50;
    for (axis, stride) in [1, 12, layer].into_iter().enumerate() {
        equation.faces[axis][cell] = 1.0e-40;
        equation.faces[axis][cell + stride] = 1.0e-40;
    }
    equation.right[cell] = 1.0e-40;
    let outcome = equation.solve_on(&equation.even_decomposition([1, 1, 2]), TIGHT);
    equation.check(&outcome, TIGHT.relative);
    assert!(outcome.iterations() <= 14, "{}", outcome.iterations());
}
