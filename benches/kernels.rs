//! Nanoseconds per contact, per pair, per particle and per ghost for the parts of a step, in and out of cache.
//!
//! `scripts/bench --parts kernels` runs it and makes a table. Functions that are called within a step are timed within
//! steps of a bed at rest, by the timers of the phases; the others are called separately.
#![allow(missing_docs, reason = "criterion_group makes an undocumented function")]

#[path = "../tests/beds/mod.rs"]
mod beds;

use beds::{Bench, PERIODIC, Run, gas};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Vector3;
use std::hint::black_box;
use std::time::{Duration, Instant};
use talcum::contact::{Contact, ContactForceLaw, ContactLaw, ContactModel};
use talcum::coupling::{Bed, ColumnDeposition, DragShare};
use talcum::domain::{Bounds, Decomposition, Face, RankGrid};
use talcum::gas::{DragCorrelation, DragLaw};
use talcum::grid::{BoxGrid, Field};
use talcum::linear_solver::{PressureSolver, Tolerance};
use talcum::parallel::{Communicator, OneRank, ParticleHalo, migrate, run_on_threads};
use talcum::particles::{ContactHistories, ContactHistory};
use talcum::time_step::rebuild;
use talcum::timers::Phase;

/// Particles along an edge: 1,000 fit into the second-level cache, 125,000 (some 60 MB) into none.
const EDGES: [u64; 2] = [10, 50];
/// A cubic lattice that touches (three contacts per particle), and one of which all pairs are near but apart.
const TOUCHING: f64 = 0.999;
const APART: f64 = 1.05;
const SKIN: f64 = 0.08;

/// A cubic lattice at rest in a periodic box: nothing moves, so that each step costs the same.
fn lattice_bed(edge: u64, spacing: f64) -> Bench {
    let mut bench = Bench::new([edge as f64 * spacing; 3], [PERIODIC; 3]);
    bench.skin = Some(SKIN);
    // Lengths are rounded, so that a hair less than the spacing fits as often as it should.
    let fitting = spacing * (1.0 - 1.0e-9);
    bench.add_layers(edge.pow(3), (fitting, 0.5 * spacing), &[1.0], (0.0, 0.0));
    bench
}

/// Seconds that a rank has spent in a phase.
fn spent(run: &Run, phase: Phase) -> f64 {
    let phases = run.work.timers.over_ranks(run.ranks);
    phases.iter().find(|time| time.phase == phase).map_or(0.0, |time| time.mean)
}

/// Times one phase within steps; `count` tells how many items a step has.
fn time_phase(
    group: &mut BenchmarkGroup<WallTime>,
    name: &str,
    (bench, phase): (&Bench, Phase),
    count: impl Fn(&Run) -> usize,
) {
    let mut run = bench.alone();
    run.steps(2);
    let size = bench.particles.len();
    group.throughput(Throughput::Elements(count(&run) as u64));
    group.bench_function(format!("{name}/{size}"), |bencher| {
        bencher.iter_custom(|steps| {
            let before = spent(&run, phase);
            run.steps(steps);
            Duration::from_secs_f64(spent(&run, phase) - before)
        });
    });
}

fn particles(run: &Run) -> usize {
    run.state.particles.owned_count()
}

fn ghosts(run: &Run) -> usize {
    run.state.particles.count() - particles(run)
}

fn pairs(run: &Run) -> usize {
    run.state.contacts.pair_count()
}

fn within_steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for edge in EDGES {
        let mut touching = lattice_bed(edge, TOUCHING);
        time_phase(&mut group, "pair forces per contact", (&touching, Phase::Contacts), pairs);
        let mut custom = lattice_bed(edge, TOUCHING);
        let law = ContactLaw::custom("linear_spring_dashpot", custom.contact);
        custom.interface = Some(ContactModel::from(law));
        let name = "pair forces per contact, custom law";
        time_phase(&mut group, name, (&custom, Phase::Contacts), pairs);
        time_phase(
            &mut group,
            "integration per particle",
            (&touching, Phase::Integrate),
            particles,
        );
        time_phase(&mut group, "list check per particle", (&touching, Phase::Decide), particles);
        time_phase(&mut group, "image refresh per ghost", (&touching, Phase::CopyGhosts), ghosts);
        let apart = lattice_bed(edge, APART);
        time_phase(&mut group, "candidate check per pair", (&apart, Phase::Contacts), pairs);
        touching.gas = Some(gas(0.0));
        let phases = [
            ("coarse-graining and interpolation per particle", Phase::Gas),
            ("gas force per particle", Phase::GasForce),
        ];
        for (name, phase) in phases {
            time_phase(&mut group, name, (&touching, phase), particles);
        }
    }
    group.finish();
}

/// Contacts of one particle each: the law by itself.
fn contacts(count: usize) -> Vec<(Contact, ContactHistory)> {
    let contact = |index: usize| {
        let phase = index as f64;
        let contact = Contact {
            overlap: 1.0e-4,
            normal: Vector3::z(),
            relative_velocity: Vector3::new(0.3, 0.1, 1.0e-3) * (1.0 + 1.0e-3 * phase),
            relative_spin: Vector3::zeros(),
            reduced_mass: 0.26,
            reduced_radius: 0.25,
            reduced_inertia: 0.026,
            cohesion: 0.0,
        };
        (contact, ContactHistory::default())
    };
    (0..count).map(contact).collect()
}

fn laws(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("laws");
    let law = beds::law(2.0e5, 0.9, 0.1);
    for count in [1_000, 400_000] {
        let mut contacts = contacts(count);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(format!("contact law, one by one, per contact/{count}"), |bencher| {
            bencher.iter(|| {
                for (contact, history) in &mut contacts {
                    black_box(law.force(black_box(contact), history, 2.5e-4));
                }
            });
        });
        let fractions: Vec<f64> = (0..count).map(|i| 0.6 * i as f64 / count as f64).collect();
        for (name, drag) in
            [("creeping", DragLaw::WEN_YU_CREEPING), ("with Reynolds number", DragLaw::WEN_YU)]
        {
            group.bench_function(format!("drag, {name}, per particle/{count}"), |bencher| {
                bencher.iter(|| {
                    let drags = fractions.iter().map(|&phi| drag.scaled_drag(phi, 10.0));
                    drags.for_each(|drag| {
                        black_box(drag);
                    });
                });
            });
        }
    }
    group.finish();
}

fn grids(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("grid");
    for edge in EDGES {
        let bench = lattice_bed(edge, TOUCHING);
        let run = bench.alone();
        let grid = gas(0.0).grid(&bench.domain.bounds);
        let mut graining = ColumnDeposition::new(&grid, 100.0, [1.0, 1.0], DragShare::default());
        let mut bed = Bed::default();
        group.throughput(Throughput::Elements(particles(&run) as u64));
        group.bench_function(format!("coarse-graining per particle/{}", edge.pow(3)), |bencher| {
            bencher.iter(|| graining.deposit(&run.state.particles, &grid, &mut bed, &OneRank));
        });
    }
    group.finish();
}

fn lists(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("lists");
    group.sample_size(10);
    for edge in EDGES {
        let bench = lattice_bed(edge, TOUCHING);
        let mut run = bench.alone();
        run.steps(2);
        let width = run.work.list_range.ghost_width(1.0);
        group.throughput(Throughput::Elements(particles(&run) as u64));
        let name = format!("rebuild (sort, ghosts, list, memories) per particle/{}", edge.pow(3));
        group.bench_function(name, |bencher| {
            let talcum::setup::Run { state, domain, models, work, ranks } = &mut *run;
            bencher.iter(|| {
                rebuild(state, domain, models, work, *ranks)
                    .expect("all contacts have their place");
            });
        });
        group.bench_function(format!("sorting by cells per particle/{}", edge.pow(3)), |bencher| {
            let talcum::setup::Run { state, work, .. } = &mut *run;
            state.particles.drop_ghosts();
            bencher.iter(|| work.neighbours.sort_by_cells(&mut state.particles, width));
        });
    }
    group.finish();
}

/// One iteration of the pressure solve, a cycle of multigrid and the products around it, in a box whose lower half has
/// a thousandth of the mobility of the upper.
fn multigrid(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("multigrid");
    group.sample_size(10);
    for edge in [16, 64] {
        let bounds = Bounds::new(Vector3::repeat(edge as f64), [[Face::Wall; 2]; 3]);
        let (grid, decomposition) =
            (BoxGrid::new(&bounds, [edge; 3]), Decomposition::even(RankGrid([1; 3]), &bounds));
        let subdomain = decomposition.subdomain(&bounds, 0);
        let part = grid.local_cells(subdomain);
        let field = |of: &dyn Fn(usize) -> f64| {
            let mut field = Field::new(&part, 1);
            field.set_owned((0..edge.pow(3)).map(of));
            field
        };
        let mobility = field(&|cell| if cell < edge.pow(3) / 2 { 1.0e-3 } else { 1.0 });
        let outlet = field(&|cell| if cell >= edge.pow(3) - edge.pow(2) { 1.0 } else { 0.0 });
        let right = field(&|cell| (cell * 7919 % 1009) as f64 - 504.0);
        let mut solver = PressureSolver::new(&grid, subdomain);
        let set = solver.set_coefficients([&mobility; 3], Some(&outlet), &OneRank);
        set.expect("mobilities are positive");
        let mut solve = || {
            let (mut solution, tolerance) = (Field::new(&part, 1), Tolerance::relative(1.0e-8));
            let solved = solver.solve(&mut solution, &right, tolerance, &OneRank);
            solved.expect("converges").iterations
        };
        let iterations = solve();
        group.throughput(Throughput::Elements((edge.pow(3) * iterations) as u64));
        group.bench_function(
            format!("iteration of the pressure solve per cell/{}", edge.pow(3)),
            |bencher| {
                bencher.iter(&mut solve);
            },
        );
    }
    group.finish();
}

/// Runs `work` on two ranks as threads, each with its half of a touching lattice, until it has been done `times`;
/// the longer of their times.
fn on_two_ranks(
    bench: &Bench,
    times: u64,
    work: impl Fn(&mut talcum::setup::Run, &dyn Communicator) + Sync,
) -> Duration {
    let elapsed = run_on_threads(2, |ranks| {
        let mut run = bench.start(RankGrid::slabs(2, 2), ranks);
        ranks.any(false); // both are ready
        let begin = Instant::now();
        for _ in 0..times {
            work(&mut run.0, ranks);
        }
        begin.elapsed()
    });
    elapsed.into_iter().max().unwrap_or_default()
}

fn between_ranks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("two thread ranks");
    group.sample_size(10);
    for edge in EDGES {
        let bench = lattice_bed(edge, TOUCHING);
        let size = edge.pow(3);
        let start = |ranks: &dyn Communicator| ghosts(&bench.start(RankGrid::slabs(2, 2), ranks));
        let crossing = run_on_threads(2, start).into_iter().max().unwrap_or_default() as u64;
        group.throughput(Throughput::Elements(crossing));
        group.bench_function(format!("halo refresh per ghost/{size}"), |bencher| {
            bencher.iter_custom(|times| {
                on_two_ranks(&bench, times, |run, ranks| {
                    run.work.halo.refresh(&mut run.state.particles, ranks);
                })
            });
        });
        group.bench_function(format!("halo rebuild per ghost/{size}"), |bencher| {
            bencher.iter_custom(|times| {
                on_two_ranks(&bench, times, |run, ranks| {
                    let width = run.work.list_range.ghost_width(1.0);
                    let particles = &mut run.state.particles;
                    particles.drop_ghosts();
                    let mut halo = ParticleHalo::default();
                    let bounds = &run.domain.bounds;
                    let subdomain = run.work.decomposition.subdomain(bounds, ranks.rank());
                    halo.make_ghosts(particles, subdomain, width, ranks);
                    halo.follow(particles, |_| true, ranks);
                })
            });
        });
        // The cut goes up and down by a layer, so that one layer changes its owner each time.
        group.throughput(Throughput::Elements(edge.pow(2)));
        group.bench_function(format!("migration per moving particle/{size}"), |bencher| {
            bencher.iter_custom(|times| {
                on_two_ranks(&bench, times, |run, ranks| {
                    let decomposition = other_cut(&mut run.work.decomposition, &bench);
                    let mut histories = ContactHistories::default();
                    run.state.particles.drop_ghosts();
                    migrate(&mut run.state.particles, &mut histories, &decomposition, ranks);
                })
            });
        });
    }
    group.finish();
}

/// The middle plane moved by one layer from where it was, to and fro.
fn other_cut(decomposition: &mut Decomposition, bench: &Bench) -> Decomposition {
    let [lower, plane, upper] = *decomposition.cut_planes(2) else {
        unreachable!("two slabs have three planes")
    };
    let middle = 0.5 * (lower + upper);
    let moved = if plane == middle { middle + TOUCHING } else { middle };
    let across = |axis: usize| vec![0.0, bench.domain.bounds.lengths()[axis]];
    *decomposition =
        decomposition.with_cut_planes([across(0), across(1), vec![lower, moved, upper]]);
    decomposition.clone()
}

criterion_group! {
    name = kernels;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(20);
    targets = laws, within_steps, grids, multigrid, lists, between_ranks
}
criterion_main!(kernels);
