//! The gas has the same bits on any decomposition, and after a restart.

use super::driver::{Flow, PERIODIC, Problem, no_slip, wall};
use nalgebra::Vector3;
use talcum::domain::Decomposition;
use talcum::gas::volume_averaged::{Boundary, Inlet, Profile};
use talcum::numbers::Schedule;
use talcum::parallel::run_on_threads;

/// The bits of a cell's record: its number, velocities at lower and at upper faces, pressure, voidage.
type Record = [u64; 9];

/// A dense, rough bed between walls, gas in through the bottom and out through two faces: whatever can be at a cut.
fn problem() -> Problem {
    let velocity = Schedule::Sine { mean: 0.4, amplitude: 0.2, frequency: 3.0, start: 0.0 };
    let inlet = Boundary::Inlet(Inlet { velocity, profile: Profile::Parabolic, jet: None });
    let outlet = |pressure| Boundary::Outlet { pressure };
    let boundaries = [[Boundary::FreeSlip, outlet(0.1)], PERIODIC, [inlet, outlet(0.0)]];
    let mut problem = Problem::new([1.0, 0.7, 2.1], [8, 6, 14], boundaries);
    (problem.gas.density, problem.gas.viscosity) = (1.2, 0.01);
    problem
}

fn walled() -> Problem {
    let mut problem = problem();
    let lid = wall(Vector3::new(0.5, -0.3, 0.0));
    let [_, _, [inlet, _]] = problem.gas.boundaries.clone();
    problem.gas.boundaries =
        [no_slip(), [inlet, Boundary::Outlet { pressure: 0.0 }], [Boundary::FreeSlip, lid]];
    problem
}

fn rough([x, y, z]: [f64; 3], t: f64) -> f64 {
    let bed = if z < 1.3 { 0.5 } else { 0.98 };
    bed + 0.02 * (91.0 * x + 37.0 * y + t).sin() * (71.0 * z - 53.0 * y).cos()
}

fn advance(flow: &mut Flow, steps: usize) {
    for _ in 0..steps {
        let t = 10.0 * flow.time;
        let beta = |x: [f64; 3]| 1.0e5 * (1.0 - rough(x, t)).powi(3);
        flow.bed.voidage = flow.field(None, |x| rough(x, t));
        flow.bed.momentum_transfer = flow.field(None, beta);
        flow.bed.transferred_velocity =
            [0, 1, 2].map(|a| flow.field(None, |x| beta(x) * 0.3 * (40.0 * x[a] + t).sin()));
        flow.driven_step(2.0e-3, Vector3::new(0.1, 0.2, 0.0), None).unwrap();
    }
}

/// Records of the whole box in the order of cells, from those of its parts.
fn whole(counts: [usize; 3], parts: Vec<Vec<([usize; 3], Record)>>) -> Vec<Record> {
    let mut all = vec![[0; 9]; counts.iter().product()];
    for ([i, j, k], record) in parts.into_iter().flatten() {
        all[i + counts[0] * (j + counts[1] * k)] = record;
    }
    all
}

fn records(flow: &Flow) -> Vec<([usize; 3], Record)> {
    let global = |cell: [isize; 3]| [0, 1, 2].map(|a| flow.part.start[a] + cell[a] as usize);
    let record = |cell| bytemuck::cast(flow.state.record(&flow.part, cell));
    flow.cells().into_iter().map(|cell| (global(cell), record(cell))).collect()
}

fn run(
    problem: &Problem,
    decomposition: &Decomposition,
    steps: usize,
    from: Option<&[Record]>,
) -> Vec<Record> {
    let parts = run_on_threads(decomposition.grid().size(), |ranks| {
        let mut flow = problem.start_on(decomposition, ranks);
        match from {
            None => flow.set(|_| [0.0; 3], |_| 0.0, |x| rough(x, 0.0)),
            Some(all) => restore(&mut flow, all),
        }
        advance(&mut flow, steps);
        records(&flow)
    });
    whole(problem.counts, parts)
}

/// The state of a checkpoint after five steps.
fn restore(flow: &mut Flow, all: &[Record]) {
    flow.time = (0..5).fold(0.0, |time, _| time + 2.0e-3);
    let [x, y, _] = flow.part.counts;
    for cell in flow.cells() {
        let [i, j, k] = [0, 1, 2].map(|a| flow.part.start[a] + cell[a] as usize);
        flow.state.restore(cell, &bytemuck::cast(all[i + x * (j + y * k)]));
    }
    flow.solver.fill_halos(&flow.gas, &mut flow.state, flow.ranks);
}

#[test]
fn all_cuts_give_the_same_bits() {
    for problem in [problem(), walled()] {
        let one = run(&problem, &problem.even_cut([1; 3]), 10, None);
        for ranks in [[1, 1, 2], [1, 1, 3], [4, 1, 1], [2, 2, 1], [1, 3, 1], [2, 1, 2], [2, 2, 2]] {
            let even = problem.even_cut(ranks);
            assert!(run(&problem, &even, 10, None) == one, "{ranks:?}");
        }
        let even = problem.even_cut([2, 1, 3]);
        let uneven =
            even.with_cut_planes([vec![0.0, 0.3, 1.0], vec![0.0, 0.7], vec![0.0, 0.3, 1.6, 2.1]]);
        assert!(run(&problem, &uneven, 10, None) == one);
    }
}

#[test]
fn a_restart_on_other_ranks_gives_the_same_bits() {
    for problem in [problem(), walled()] {
        let without = run(&problem, &problem.even_cut([1, 1, 2]), 9, None);
        let checkpoint = run(&problem, &problem.even_cut([1, 1, 3]), 5, None);
        let again = |from: &[Record]| run(&problem, &problem.even_cut([2, 2, 1]), 4, Some(from));
        assert!(again(&checkpoint) == without);
        // Control: one velocity, by less than a millionth.
        let mut wrong = checkpoint.clone();
        wrong[100][3] ^= 1 << 30;
        assert!(again(&wrong) != without);
        // Control: velocities in outlets, which no cell has at its lower face, are needed.
        let mut wrong = checkpoint;
        wrong.iter_mut().for_each(|record| record[4..7].fill(0));
        assert!(again(&wrong) != without);
    }
}
