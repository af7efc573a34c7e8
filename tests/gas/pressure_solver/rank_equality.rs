//! Solutions have the same bits for any decomposition.

use super::equations::{Equation, hashed};
use talcum::domain::Decomposition;
use talcum::linear_solver::Tolerance;

const TOLERANCE: Tolerance = Tolerance { relative: 1.0e-8, absolute: 0.0 };

/// Mobilities over six orders of magnitude: two layers of different magnitude, within which each cell is random.
fn rough(counts: [usize; 3], periodic: [bool; 3]) -> Equation {
    let number = move |at: [f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|a| (at[a] * counts[a] as f64) as usize);
        x + counts[0] * (y + counts[1] * z)
    };
    Equation::new(counts, periodic).with_mobility(|at| {
        let layer = if at[2] < 0.6 { 1.0e-4 } else { 1.0 };
        layer * 10.0_f64.powf(-2.0 * hashed(7, number(at)))
    })
}

fn decompositions(equation: &Equation) -> Vec<Decomposition> {
    let mut decompositions: Vec<Decomposition> =
        [[1, 1, 2], [1, 1, 3], [2, 2, 1], [1, 2, 4], [2, 2, 2]]
            .map(|ranks| equation.even_decomposition(ranks))
            .to_vec();
    let [nx, ny, nz] = equation.counts;
    decompositions.push(equation.decomposition_at([&[5], &[], &[3, nz - 3]]));
    decompositions.push(equation.decomposition_at([&[nx - 7], &[ny / 2 + 1], &[]]));
    decompositions.push(equation.decomposition_at([&[], &[], &[2, 5, 7]]));
    decompositions
}

#[test]
fn solutions_have_the_same_bits_for_any_decomposition() {
    let cases = [
        ([33, 17, 11], [false; 3]),
        ([21, 18, 13], [true, true, false]),
        ([16, 15, 24], [true, false, true]),
        // So many cells that two levels are divided among the ranks, where none of these is too narrow.
        ([34, 20, 16], [false; 3]),
    ];
    for (counts, periodic) in cases {
        let mut equation = rough(counts, periodic);
        for closed in [false, true] {
            if closed {
                equation.diagonal.fill(0.0);
            } else if periodic[2] {
                equation.diagonal[17] = 0.5;
            }
            let one = equation.solve_on(&equation.even_decomposition([1; 3]), TOLERANCE);
            one.result.unwrap();
            for decomposition in decompositions(&equation) {
                let several = equation.solve_on(&decomposition, TOLERANCE);
                let message = format!("{counts:?}, closed: {closed}, {:?}", decomposition.grid());
                assert_eq!(several.result, one.result, "{message}");
                assert!(several.bits() == one.bits(), "{message}");
            }
        }
    }
}

#[test]
fn a_change_of_the_last_bit_of_one_coefficient_is_detected() {
    // Negative control of the test above.
    let equation = rough([33, 17, 11], [false; 3]);
    let one = equation.solve_on(&equation.even_decomposition([1; 3]), TOLERANCE);
    let mut changed = equation.clone();
    let face = &mut changed.faces[1][1000];
    *face = f64::from_bits(face.to_bits() + 1);
    let other = changed.solve_on(&changed.even_decomposition([1; 3]), TOLERANCE);
    assert_ne!(one.bits(), other.bits());
}
