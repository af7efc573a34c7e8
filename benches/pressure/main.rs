//! Numbers of iterations and times of the pressure solver for fluidised beds.
//!
//! ```text
//! cargo bench --bench pressure -- [--largest 64] [--write FOLDER]
//! ```
//!
//! `--write` also writes the systems to a folder, where scripts/bench_pressure solves them with hypre.

mod systems;

use std::path::PathBuf;
use systems::{System, local_field, solids_fraction};
use talcum::grid::Field;
use talcum::linear_solver::{Convergence, PressureSolver, Tolerance};
use talcum::parallel::{Communicator, OneRank, run_on_threads};

const TOLERANCE: f64 = 1.0e-8;

/// The time reported is the shortest of so many batches of repetitions, each of which takes about so many seconds.
const BATCHES: usize = 5;
const SECONDS: f64 = 0.3;

/// The solver of a rank, with its cells of the system and of the solution.
struct Solve<'a> {
    system: &'a System,
    solver: PressureSolver,
    faces: [Field; 3],
    diagonal: Field,
    right: Field,
    solution: Field,
}

impl<'a> Solve<'a> {
    fn new(system: &'a System, ranks: &dyn Communicator) -> Self {
        let (grid, decomposition) = system.grid(ranks.size());
        let bounds = system.bounds();
        let subdomain = decomposition.subdomain(&bounds, ranks.rank());
        let cells = grid.local_cells(subdomain);
        Self {
            system,
            solver: PressureSolver::new(&grid, subdomain),
            faces: system.faces.each_ref().map(|face| local_field(face, &cells)),
            diagonal: local_field(&system.diagonal, &cells),
            right: local_field(&system.right, &cells),
            solution: Field::new(&cells, 1),
        }
    }

    fn set_up(&mut self, ranks: &dyn Communicator) {
        let faces = self.faces.each_ref();
        let set = self.solver.set_coefficients(faces, Some(&self.diagonal), ranks);
        set.expect("mobilities are positive");
    }

    fn solve(&mut self, ranks: &dyn Communicator) -> Convergence {
        self.solution.values_mut().fill(0.0);
        let tolerance = Tolerance::relative(TOLERANCE);
        let solved = self.solver.solve(&mut self.solution, &self.right, tolerance, ranks);
        solved.unwrap_or_else(|error| panic!("{:?}: {error}", self.system.counts))
    }
}

/// The number of iterations, and the bits of the solution, rank by rank. Since the box is divided along z, they are in
/// the order of the grid.
fn on_ranks(system: &System, ranks: usize) -> (usize, Vec<u64>) {
    let solved = run_on_threads(ranks, |ranks| {
        let mut solve = Solve::new(system, ranks);
        solve.set_up(ranks);
        let iterations = solve.solve(ranks).iterations;
        (iterations, solve.solution.owned().map(f64::to_bits).collect::<Vec<_>>())
    });
    let iterations = solved[0].0;
    (iterations, solved.into_iter().flat_map(|(_, bits)| bits).collect())
}

/// Processor time of this thread in seconds, which other programs on the machine do not change.
fn processor_time() -> f64 {
    let times = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux counts time");
    let nanoseconds = times.split(' ').next().and_then(|number| number.parse::<f64>().ok());
    nanoseconds.expect("the first number is the time on a processor") * 1.0e-9
}

/// The shortest mean time of a batch of repetitions, in seconds.
fn shortest(mut work: impl FnMut()) -> f64 {
    let mut time = |repetitions: usize| {
        let start = processor_time();
        (0..repetitions).for_each(|_| work());
        (processor_time() - start) / repetitions as f64
    };
    let first = time(1); // touches all memory
    let repetitions = (SECONDS / first.max(1.0e-4)).ceil() as usize;
    (0..BATCHES).map(|_| time(repetitions)).fold(f64::INFINITY, f64::min)
}

/// The times of set-up and solve on one core, in seconds.
fn times(system: &System) -> [f64; 2] {
    let mut solve = Solve::new(system, &OneRank);
    let set_up = shortest(|| solve.set_up(&OneRank));
    [
        set_up,
        shortest(|| {
            solve.solve(&OneRank);
        }),
    ]
}

fn print_row(n: usize, contrast: f64, system: &System) {
    let one = on_ranks(system, 1);
    let several = [2, 4].map(|ranks| on_ranks(system, ranks));
    let same = several.iter().all(|other| other.1 == one.1);
    let [set_up, solve] = times(system);
    let cells = n.pow(3) as f64;
    println!(
        "{n:>4}^3 {contrast:>8.0e} {:>5} {:>4} {:>4} {:>9} {set_up:>9.4} {solve:>9.4} {:>10.2e} {:>6.1}",
        one.0,
        several[0].0,
        several[1].0,
        if same { "the same" } else { "DIFFERENT" },
        cells / (set_up + solve),
        solve / cells / one.0 as f64 * 1.0e9,
    );
}

/// The value after a flag on the command line.
fn value_of(flag: &str) -> Option<String> {
    std::env::args().skip_while(|argument| argument != flag).nth(1)
}

fn main() -> std::io::Result<()> {
    let largest = value_of("--largest").and_then(|n| n.parse().ok()).unwrap_or(128);
    let folder = value_of("--write").map(PathBuf::from);
    println!(
        "              iterations on             bits        set-up  solve      cells/s   ns/cell"
    );
    println!(
        "cells   contrast  1    2    4 ranks  on ranks   s         s          per core  and iteration"
    );
    for n in [32, 64, 128].into_iter().filter(|&n| n <= largest) {
        let solids = solids_fraction(n);
        for contrast in [1.0, 1.0e3, 1.0e6] {
            let system = System::bed(n, &solids, contrast);
            if let Some(folder) = &folder {
                system.write(&folder.join(format!("{n}-{contrast:.0e}.system")))?;
            }
            print_row(n, contrast, &system);
        }
    }
    Ok(())
}
