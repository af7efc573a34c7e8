//! Computing rate of ranks whose messages take time, as between machines.
//!
//! `cargo bench --bench machines` prints a table in Markdown for a settled bed on thread ranks, by the time of a
//! message, at 10 Gbit/s. The time of a step in microseconds is that of the fastest of several windows of steps, since
//! ranks may share cores with other programs.

#[path = "../tests/beds/mod.rs"]
mod beds;

use beds::delayed::{Delayed, Network};
use beds::{Bench, PERIODIC, PLATE};
use std::time::Instant;
use talcum::domain::{EffectiveGravity, RankGrid};
use talcum::parallel::run_on_threads;

const GRIDS: [[usize; 3]; 2] = [[1, 1, 2], [2, 1, 2]];
const COUNTS: [u64; 2] = [3_000, 24_000];
/// Microseconds; 0 and any bandwidth for messages as they are.
const LATENCIES: [f64; 4] = [0.0, 2.0, 10.0, 50.0];
const WINDOWS: usize = 15;
const STEPS: u64 = 200;

/// A dense bed at rest on a plate, as high as wide.
fn bed(count: u64) -> Bench {
    let side = (count as f64).cbrt().round();
    let mut bench = Bench::new([side, side, 2.0 * side], [PERIODIC, PERIODIC, PLATE]);
    bench.skin = None;
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.add_layers(count, (1.0, 0.5), &[1.0], (0.001, 0.01));
    bench
}

/// Microseconds of a step.
fn step_time(bench: &Bench, grid: [usize; 3], latency: f64) -> f64 {
    let grid = RankGrid(grid);
    let bandwidth = if latency > 0.0 { 1250.0 } else { f64::INFINITY };
    let found = run_on_threads(grid.size(), |ranks| {
        let delayed = Delayed { ranks, network: Network { latency, bandwidth } };
        let mut run = bench.start(grid, &delayed);
        let windows = (0..WINDOWS).map(|_| {
            let begin = Instant::now();
            run.steps(STEPS);
            begin.elapsed().as_secs_f64() * 1.0e6 / STEPS as f64
        });
        windows.fold(f64::INFINITY, f64::min)
    });
    found[0]
}

fn main() {
    let columns = LATENCIES.map(|latency| format!("{latency} us"));
    println!("| particles | ranks | {} |", columns.join(" | "));
    println!("{}|", "| --- ".repeat(2 + LATENCIES.len()));
    for count in COUNTS {
        let bench = bed(count);
        for grid in GRIDS {
            let times = LATENCIES.map(|latency| {
                let time = step_time(&bench, grid, latency);
                format!("{time:.1}")
            });
            println!("| {count} | {} | {} |", grid.iter().product::<usize>(), times.join(" | "));
        }
    }
}
