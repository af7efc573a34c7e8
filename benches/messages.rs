//! Counts the messages of a step, for the scaling model of docs/performance-tables.md.
//!
//! `cargo bench --bench messages` prints a table in Markdown for a vibrated bed on thread ranks: the maxima over the
//! ranks.

#[path = "../tests/beds/mod.rs"]
mod beds;

use beds::{Bench, PERIODIC, PLATE, gas, shaken};
use std::cell::Cell;
use talcum::domain::RankGrid;
use talcum::parallel::{
    AxisNeighbours, Communicator, Exchange, FileAccess, Message, Pending, run_on_threads,
};

const STEPS: u64 = 4_000;
const GRIDS: [[usize; 3]; 4] = [[1, 1, 2], [2, 2, 1], [2, 2, 2], [4, 4, 1]];

/// Counts what is sent through another communicator.
struct Counting<'a> {
    inner: &'a dyn Communicator,
    counts: Cell<Counts>,
}

#[derive(Clone, Copy, Default)]
struct Counts {
    messages: u64,
    bytes: u64,
    reductions: u64,
    reduced_bytes: u64,
    sparse_exchanges: u64,
    sparse_messages: u64,
    sparse_bytes: u64,
}

impl Counting<'_> {
    fn count(&self, change: impl FnOnce(&mut Counts)) {
        let mut counts = self.counts.get();
        change(&mut counts);
        self.counts.set(counts);
    }

    fn reduction<T>(&self, values: &[T]) {
        self.count(|counts| {
            counts.reductions += 1;
            counts.reduced_bytes += size_of_val(values) as u64;
        });
    }
}

impl Communicator for Counting<'_> {
    fn rank(&self) -> usize {
        self.inner.rank()
    }

    fn size(&self) -> usize {
        self.inner.size()
    }

    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    ) {
        for (neighbour, bytes) in neighbours.iter().zip(outgoing) {
            if neighbour.is_some_and(|rank| rank != self.rank()) {
                self.count(|counts| {
                    counts.messages += 1;
                    counts.bytes += bytes.len() as u64;
                });
            }
        }
        self.inner.exchange(neighbours, outgoing, incoming);
    }

    fn start_exchange(&self, exchange: Exchange) -> Pending<'_, Exchange> {
        let Exchange { outgoing, .. } = &exchange;
        self.count(|counts| {
            counts.messages += outgoing.len() as u64;
            counts.bytes += outgoing.iter().map(|message| message.bytes.len() as u64).sum::<u64>();
        });
        self.inner.start_exchange(exchange)
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        let to_others = || outgoing.iter().filter(|message| message.rank != self.rank());
        self.count(|counts| {
            counts.sparse_exchanges += 1;
            counts.sparse_messages += to_others().count() as u64;
            counts.sparse_bytes +=
                to_others().map(|message| message.bytes.len() as u64).sum::<u64>();
        });
        self.inner.sparse_exchange(outgoing)
    }

    fn sum_exact(&self, values: &mut [f64]) {
        self.reduction(values);
        self.inner.sum_exact(values);
    }

    fn start_sum_exact(&self, values: Vec<f64>) -> Pending<'_, Vec<f64>> {
        self.reduction(&values);
        self.inner.start_sum_exact(values)
    }

    fn sum_integers(&self, values: &mut [i64]) {
        self.reduction(values);
        self.inner.sum_integers(values);
    }

    fn maximum(&self, values: &mut [f64]) {
        self.reduction(values);
        self.inner.maximum(values);
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        self.inner.gather_to_root(bytes)
    }

    fn broadcast_from_root(&self, bytes: &mut Vec<u8>) {
        self.inner.broadcast_from_root(bytes);
    }

    fn file_access(&self, path: &std::path::Path) -> FileAccess {
        self.inner.file_access(path)
    }

    fn kind(&self) -> &'static str {
        self.inner.kind()
    }
}

/// The counts of one rank.
struct RankCounts {
    counts: Counts,
    owned: usize,
    ghosts: usize,
}

/// Layers of 21 x 21 lattice sites on a plate, about 8,000 particles. Cut planes run through sites, so that particles
/// change their owners as they do in a disordered bed.
fn bed(with_gas: bool) -> Bench {
    let mut bench = Bench::new([21.0, 21.0, 21.0], [PERIODIC, PERIODIC, PLATE]);
    bench.skin = Some(0.08);
    bench.gravity = shaken(3.0, 0.16);
    bench.add_layers(8_000, (1.0, 0.55), &[0.97], (0.01, 1.0));
    bench.gas = with_gas.then(|| gas(0.1));
    bench
}

fn counts_on(bench: &Bench, grid: [usize; 3]) -> Vec<RankCounts> {
    let grid = RankGrid(grid);
    run_on_threads(grid.size(), |ranks| {
        let counting = Counting { inner: ranks, counts: Cell::default() };
        let mut run = bench.start(grid, &counting);
        counting.counts.set(Counts::default());
        run.steps(STEPS);
        let owned = run.state.particles.owned_count();
        let ghosts = run.state.particles.count() - owned;
        RankCounts { counts: counting.counts.get(), owned, ghosts }
    })
}

fn main() {
    println!(
        "| ranks | gas | particles per rank | ghosts per rank | messages per step | bytes sent per step | \
         reductions per step | bytes reduced per step | steps per sparse exchange | \
         messages per sparse exchange | bytes per sparse exchange |"
    );
    println!("{}|", "| --- ".repeat(11));
    for with_gas in [false, true] {
        let bench = bed(with_gas);
        for grid in GRIDS {
            let by_rank = counts_on(&bench, grid);
            let most =
                |of: &dyn Fn(&RankCounts) -> u64| by_rank.iter().map(of).max().unwrap_or_default();
            let per_step = |of: &dyn Fn(&Counts) -> u64| {
                most(&|rank: &RankCounts| of(&rank.counts)) as f64 / STEPS as f64
            };
            let exchanges = most(&|rank| rank.counts.sparse_exchanges) as f64;
            println!(
                "| {} | {} | {} | {} | {:.2} | {:.0} | {:.2} | {:.0} | {:.0} | {:.2} | {:.0} |",
                RankGrid(grid),
                if with_gas { "column" } else { "none" },
                most(&|rank| rank.owned as u64),
                most(&|rank| rank.ghosts as u64),
                per_step(&|counts| counts.messages),
                per_step(&|counts| counts.bytes),
                per_step(&|counts| counts.reductions),
                per_step(&|counts| counts.reduced_bytes),
                STEPS as f64 / exchanges,
                most(&|rank| rank.counts.sparse_messages) as f64 / exchanges,
                most(&|rank| rank.counts.sparse_bytes) as f64 / exchanges,
            );
        }
    }
}
