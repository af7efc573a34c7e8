//! Drag that depends on the agglomerates of particles: a glued ball that falls as a ball, and the same bits on any
//! ranks.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, PLATE, Snapshot, attraction, law};
use talcum::balance::Balance;
use talcum::domain::{Face, RankGrid};
use talcum::gas::{AgglomerateDrag, DragLaw};
use talcum::numbers::{random_of, uniform};
use talcum::parallel::run_on_threads;

const DIAMETER: f64 = 4.0e-5;
const DENSITY: f64 = 250.0;
const VISCOSITY: f64 = 1.8e-5;
const GAS_DENSITY: f64 = 1.2;
const GRAVITY: f64 = 9.81;

/// The places of the ball's 33 members, simple cubic, in diameters.
fn places() -> impl Iterator<Item = [f64; 3]> {
    let all = (0..125).map(|k| [k % 5, k / 5 % 5, k / 25].map(|x| f64::from(x) - 2.0));
    all.filter(|x| x.iter().map(|x| x * x).sum::<f64>() <= 4.0)
}

/// Diameter of the ball by its moments of inertia, and its packing.
fn ball() -> (f64, f64) {
    let square: f64 = places().flatten().map(|x| x * x).sum::<f64>() / 33.0;
    let diameter = 2.0 * (5.0 / 3.0 * square + 0.25).sqrt();
    (diameter * DIAMETER, 33.0 / diameter.powi(3))
}

/// Where the drag of a permeable ball, 3 pi mu D U (1 + 0.15 Re^0.687) Omega, is the weight less buoyancy.
fn terminal_velocity() -> f64 {
    let (diameter, packing) = ball();
    let members_volume = packing * std::f64::consts::PI / 6.0 * diameter.powi(3);
    let weight = members_volume * (DENSITY - GAS_DENSITY) * GRAVITY;
    let drag = |velocity: f64| {
        let reynolds = |d: f64| GAS_DENSITY * d * velocity / VISCOSITY;
        let sphere = |d: f64| {
            3.0 * std::f64::consts::PI * VISCOSITY * d * (1.0 + 0.15 * reynolds(d).powf(0.687))
        };
        let through = 33.0 * sphere(DIAMETER) * (1.0 - packing).powf(-3.65);
        let ratio = (4.5 * through / sphere(diameter)).sqrt();
        let inside = 1.0 - ratio.tanh() / ratio;
        let omega = 2.0 * ratio * ratio * inside / (2.0 * ratio * ratio + 3.0 * inside);
        sphere(diameter) * omega * velocity
    };
    let (mut below, mut above) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (below + above);
        (below, above) = if drag(middle) < weight { (middle, above) } else { (below, middle) };
    }
    below
}

/// Mean velocity relative to the gas far away of a glued ball, which begins at rest in gas that rises as fast as it should fall, and
/// the mean factor of its members' drag.
fn fall(agglomerates: Option<AgglomerateDrag>, factor: f64) -> [f64; 2] {
    let terminal = terminal_velocity();
    // Cells of 24 balls: what the ball does to the gas around it is spread over 1e4 of its volumes.
    let spacing = 100.0 * DIAMETER;
    let lengths = [4.0 * spacing, 4.0 * spacing, 6.0 * spacing];
    let mut bench = Bench::new(lengths, [PERIODIC, PERIODIC, [Face::Stop; 2]]);
    bench.contact = law(0.05, 0.5, 0.5);
    bench.gravity.magnitude = GRAVITY;
    bench.density = DENSITY;
    bench.skin = Some(0.15 * DIAMETER);
    bench.time_step = 1.0e-6;
    // Glued by a hundred times the weight of a particle, at the overlap that this makes.
    let force = 1.0e-8;
    bench.cohesion = Some(attraction((force, force), DIAMETER, (1.0e-8, 1.0e-6)));
    let pitch = DIAMETER - force / 0.05;
    for x in places() {
        let middle = lengths.map(|length| 0.5 * length);
        bench.add([0, 1, 2].map(|a| middle[a] + pitch * x[a]), [0.0; 3], 0.5 * DIAMETER);
    }
    let air = (GAS_DENSITY, VISCOSITY);
    let mut model = gas_on_cells(&bench, [4, 4, 6], air, DragLaw::WEN_YU, terminal);
    model.substeps = 20;
    model.coupling.agglomerates = agglomerates;
    model.coupling.drag.factor = factor;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    // Three relaxation times, then a mean over another one.
    let (diameter, packing) = ball();
    let relaxation = packing * DENSITY * diameter * diameter / (18.0 * VISCOSITY);
    let steps = (relaxation / bench.time_step) as u64;
    run.steps(3 * steps);
    let mut velocity = 0.0;
    for _ in 0..10 {
        run.steps(steps / 10);
        velocity += run.particles().map(|particle| particle.velocity[2]).sum::<f64>() / 330.0;
    }
    let factors = run.particles().map(|particle| particle.drag_factor).sum::<f64>() / 33.0;
    [(terminal - velocity) / terminal, factors]
}

#[test]
fn a_glued_ball_falls_as_fast_as_a_permeable_ball() {
    let looks = Some(AgglomerateDrag { every: 10, smallest: 2 });
    let [velocity, factor] = fall(looks, 1.0);
    println!("{velocity:.4} of {:.5} m/s, xi {factor:.4}", terminal_velocity());
    // The ball drags the gas of its cells along by 0.45 D / h = 2 % of its velocity; at first, for the first three looks, its members
    // have the drag of single ones.
    assert!((velocity - 1.0).abs() < 0.03, "{velocity}");
    assert!((0.1..0.14).contains(&factor), "{factor}");
    // The controls: one factor for all, or a look that finds no set that is large enough.
    for (looks, factor) in
        [(None, 1.0), (None, 0.2), (Some(AgglomerateDrag { every: 10, smallest: 34 }), 1.0)]
    {
        let [velocity, _] = fall(looks, factor);
        assert!((velocity - 1.0).abs() > 0.2, "{looks:?} {factor}: {velocity}");
    }
}

/// Crosses of seven glued particles between walls that a gas with inertia lifts, and that meet each other.
fn bed() -> Bench {
    let walls = [Face::Wall; 2];
    let mut bench = Bench::new([8.0, 8.0, 24.0], [PERIODIC, walls, PLATE]);
    bench.gravity.magnitude = 1.0;
    bench.contact = law(2.0e4, 0.3, 0.3);
    bench.time_step = 5.0e-4;
    bench.cohesion = Some(attraction((20.0, 5.0), 1.0, (0.02, 0.2)));
    (bench.balance, bench.skin) = (Some(Balance::new(40, 1.0)), None);
    for (x, y, z) in (0..20).map(|k| (k % 2, k / 2 % 2, k / 4)) {
        let mut generator = random_of(7, x + 2 * y + 4 * z, "crosses");
        let mut vary = || uniform(&mut generator) - 0.5;
        let middle = [x, y, z].map(|place| 2.0 + 4.0 * place as f64 + 0.8 * vary());
        let velocity = [3.0 * vary(), 3.0 * vary(), 3.0 * vary()];
        bench.add(middle, velocity, 0.5);
        for (axis, side) in (0..6).map(|k| (k / 2, 2.0 * f64::from(k as u32 % 2) - 1.0)) {
            let mut position = middle;
            position[axis] += 0.999 * side; // at the overlap of the attraction
            bench.add(position, velocity, 0.5);
        }
    }
    let mut model = gas_on_cells(&bench, [4, 4, 12], (0.01, 1.0 / 55.0), DragLaw::WEN_YU, 0.6);
    model.coupling.agglomerates = Some(AgglomerateDrag { every: 7, smallest: 2 });
    bench.volume_averaged = Some(model);
    bench
}

const GRIDS: [[usize; 3]; 5] = [[1, 1, 2], [1, 1, 3], [1, 1, 4], [2, 1, 1], [2, 1, 2]];

/// Steps of the particles, five in a step of the gas: a look each 35.
const STEPS: u64 = 1200;

#[test]
fn a_bed_of_agglomerates_has_one_answer_on_any_ranks() {
    let bench = bed();
    let whole = bench.on_ranks([1; 3], |run| run.steps(STEPS).snapshot());
    let members = whole.particles.iter().filter(|it| it.agglomerate_diameter > 0.0).count();
    let reduced = whole.particles.iter().filter(|it| it.drag_factor < 0.9).count();
    assert!(members > 100 && reduced > 100, "{members} in agglomerates, {reduced} with less drag");
    assert!(whole.looked_at.as_ref().is_some_and(|pairs| pairs.len() > 50));
    for grid in GRIDS {
        let bits = bench.on_ranks(grid, |run| run.steps(STEPS).snapshot().bits());
        assert!(bits == whole.bits(), "{grid:?}");
    }
    // Negative control: without the option it is another bed.
    let mut without = bench.clone();
    without.volume_averaged.as_mut().unwrap().coupling.agglomerates = None;
    let other = without.on_ranks([1; 3], |run| run.steps(STEPS).snapshot());
    assert!(other.particles[0].velocity != whole.particles[0].velocity);
    assert!(other.particles.iter().all(|it| it.drag_factor == 0.0) && other.looked_at.is_none());
}

#[test]
fn a_restart_between_looks_on_other_ranks_changes_nothing() {
    let bench = bed();
    let whole = bench.on_ranks([1; 3], |run| run.steps(STEPS).snapshot().bits());
    // Step 743 lies within a gas step, the look before it is at 735.
    let middle = bench.on_ranks([1, 1, 2], |run| run.steps(743).snapshot());
    let resumed = |middle: &Snapshot, grid: [usize; 3]| {
        let grid = RankGrid(grid);
        let mut ends = run_on_threads(grid.size(), |ranks| {
            bench.resume(middle, grid, ranks).steps(STEPS - 743).snapshot().bits()
        });
        ends.swap_remove(0)
    };
    for grid in [[1; 3], [1, 1, 3], [2, 1, 2]] {
        assert!(resumed(&middle, grid) == whole, "{grid:?}");
    }
    // Negative controls: without the pairs of the last look, or without the sizes, the future is another one.
    let forgotten = Snapshot { looked_at: Some(Vec::new()), ..middle.clone() };
    assert!(resumed(&forgotten, [1; 3]) != whole);
    let mut forgotten = middle;
    forgotten.particles.iter_mut().for_each(|particle| particle.agglomerate_diameter = 0.0);
    assert!(resumed(&forgotten, [1; 3]) != whole);
}

#[test]
fn a_stage_without_agglomerates_forgets_them() {
    let bench = bed();
    let middle = bench.on_ranks([1; 3], |run| run.steps(STEPS).snapshot());
    let mut without = bench.clone();
    without.volume_averaged.as_mut().unwrap().coupling.agglomerates = None;
    let resumed = run_on_threads(2, |ranks| {
        without.resume(&middle, RankGrid([1, 1, 2]), ranks).steps(5).snapshot()
    });
    let particles = &resumed[0].particles;
    assert!(particles.iter().all(|it| it.drag_factor == 0.0 && it.agglomerate_diameter == 0.0));
    assert!(resumed[0].looked_at.is_none() && middle.looked_at.is_some());
}
