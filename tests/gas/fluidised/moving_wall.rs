//! The gas sticks to walls of the box that move, as particles do.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, PLATE};
use nalgebra::Vector3;
use std::path::Path;
use talcum::case::Case;
use talcum::domain::{Face, RankGrid, WallMotion};
use talcum::gas::DragLaw;
use talcum::gas::volume_averaged::{Boundary, Inlet, Profile};
use talcum::numbers::Schedule;
use talcum::parallel::run_on_threads;
use talcum::setup::Setup;

const SPEED: f64 = 0.4;
const HEIGHT: f64 = 4.0;

/// Gas alone between a plate at rest and a lid in motion, at a steady state; velocity along x in its cells.
fn between_plates(lid: Vector3<f64>) -> Vec<f64> {
    let mut bench = Bench::new([3.0, 3.0, HEIGHT], [PERIODIC, PERIODIC, [Face::Wall; 2]]);
    bench.time_step = 0.01;
    let lid_motion = WallMotion { velocity: lid, ..WallMotion::REST };
    bench.domain.walls.last_mut().expect("the lid").motion = lid_motion;
    let mut model = gas_on_cells(&bench, [1, 1, 8], (1.0, 1.0), DragLaw::WEN_YU, 0.0);
    model.gas.boundaries[2] = [Boundary::NO_SLIP, Boundary::NO_SLIP];
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    // 40 time units: the slowest mode has decayed by exp(-pi^2 nu t / H^2) = 2e-11.
    run.steps(4000);
    run.state.gas.volume_averaged().unwrap().fields.velocity[0].owned().collect()
}

#[test]
fn a_lid_of_the_box_in_motion_drives_couette_flow() {
    let error = |velocity: &[f64]| {
        let exact = |k: usize| SPEED * (k as f64 + 0.5) / 8.0;
        let errors = velocity.iter().enumerate().map(|(k, u)| (u - exact(k)).abs());
        errors.fold(0.0, f64::max)
    };
    // The profile is linear, which central differences keep exactly; 1e-9 is what has not decayed, and the pressure.
    let found = error(&between_plates(Vector3::new(SPEED, 0.0, 0.0)));
    assert!(found < 1.0e-9, "{found}");
    // Negative controls: a lid at rest, and one that moves along the other axis.
    for other in [Vector3::zeros(), Vector3::new(0.0, SPEED, 0.0)] {
        assert!(error(&between_plates(other)) > 0.4 * SPEED);
    }
}

/// A box of gas between a plate and a lid, HEIGHT above it.
const COUETTE: &str = r#"
title = "Couette flow"
units = "dimensionless"
[box]
lengths = [3.0, 3.0, 4.0]
x = "periodic"
y = "periodic"
z = "wall"
# walls
[particles]
count = 1
diameter = 0.1
reference_diameter = 1.0
density = 1.0
[particles.start]
kind = "lattice"
spacing = 1.0
[gravity]
magnitude = 0.0
[contact]
law = "linear_spring_dashpot"
normal_stiffness = 1.0e3
poisson_ratio = 0.3
restitution = 0.9
friction = 0.1
[gas]
kind = "volume_averaged"
viscosity = 1.0
density = 1.0
drag = "wen_yu"
cells = [1, 1, 8]
substeps = 1
filter_width = 0.0
z = "no_slip"
driving = [0.0, 0.0, 0.0]
[time]
step = 1.0e-3
end = 10.0
[output]
series = 1.0
"#;

/// The case with what `[[wall]]` says of the lid.
fn case_of(wall: &str) -> Case {
    let text = COUETTE.replace("# walls", wall);
    Case::from_text(&text, "couette.toml", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// The gas of a case without its particle at a steady state: velocity along x in its cells.
fn gas_of(case: &Case) -> Vec<f64> {
    let physics = case.stages[0].physics.clone();
    let mut run = Setup::in_domain(case.domain.clone(), physics).sizes(case.size_range().unwrap());
    run = run.skin(0.05);
    let mut run = run.start_alone().unwrap();
    // 20 time units: exp(-pi^2 nu t / H^2) = 4e-6 of the slowest mode is left.
    run.steps(20_000).unwrap();
    run.state.gas.volume_averaged().unwrap().fields.velocity[0].owned().collect()
}

#[test]
fn a_case_file_moves_the_wall_of_a_face_and_the_gas_sticks_to_it() {
    let lid = |more: &str| gas_of(&case_of(&format!("[[wall]]\nface = \"z upper\"\n{more}")));
    let error = |velocity: &[f64]| {
        let exact = |k: usize| SPEED * (k as f64 + 0.5) / 8.0;
        let errors = velocity.iter().enumerate().map(|(k, u)| (u - exact(k)).abs());
        errors.fold(0.0, f64::max)
    };
    let found = error(&lid("velocity = [0.4, 0.0, 0.0]"));
    assert!(found < 1.0e-5, "{found}"); // what has not decayed
    // Negative controls: a lid at rest, one that moves along the other axis, and one that has not started.
    for other in [
        "contact = { friction = 0.2 }",
        "velocity = [0.0, 0.4, 0.0]",
        "velocity = [0.4, 0.0, 0.0]\nstart = 1e3",
    ] {
        assert!(error(&lid(other)) > 0.4 * SPEED, "{other}");
    }
    // Inwards it may not move: the gas reaches from face to face.
    let text = case_of("[[wall]]\nface = \"z upper\"\nvelocity = [0.4, 0.0, 0.0]").text;
    let inwards = text.replace("[0.4, 0.0, 0.0]", "[0.0, 0.0, -0.4]");
    let error = Case::from_text(&inwards, "couette.toml", Path::new(""), &[]).unwrap_err();
    assert!(error.to_string().contains("cannot move inwards"), "{error}");
}

/// A bed beside a wall that swings in its plane, in a gas whose inflow rises.
fn beside_a_swinging_wall(amplitude: f64) -> Bench {
    let walls = [Face::Wall; 2];
    let mut bench = Bench::new([8.0, 6.0, 12.0], [walls, walls, PLATE]);
    bench.gravity.magnitude = 1.0;
    bench.add_layers(100, (1.12, 0.6), &[1.0, 0.8], (0.05, 0.1));
    let amplitude = Vector3::new(0.0, amplitude, 0.5 * amplitude);
    bench.domain.walls[0].motion = WallMotion { amplitude, frequency: 5.0, ..WallMotion::REST };
    let mut model = gas_on_cells(&bench, [4, 3, 6], (0.01, 1.0 / 55.0), DragLaw::WEN_YU, 0.0);
    let velocity = Schedule::Ramp { from: 0.1, to: 0.5, start: 0.0, end: 0.05 };
    let inlet = Inlet { velocity, profile: Profile::Parabolic, jet: None };
    model.gas.boundaries[2][0] = Boundary::Inlet(inlet);
    bench.volume_averaged = Some(model);
    bench
}

#[test]
fn walls_and_inflow_that_change_in_time_give_the_same_bits_on_any_ranks_and_through_restarts() {
    let bench = beside_a_swinging_wall(0.02);
    let whole = bench.on_ranks([1; 3], |run| run.steps(120).snapshot().bits());
    for grid in [[1, 1, 2], [2, 1, 1]] {
        let bits = bench.on_ranks(grid, |run| run.steps(120).snapshot().bits());
        assert!(bits == whole, "{grid:?}");
    }
    // Step 53 lies within a gas step.
    let middle = bench.on_ranks([1, 1, 2], |run| run.steps(53).snapshot());
    let resumed = run_on_threads(2, |ranks| {
        bench.resume(&middle, RankGrid([2, 1, 1]), ranks).steps(67).snapshot().bits()
    });
    assert!(resumed.iter().all(|bits| *bits == whole));
    // Negative control: the motion matters, and to the gas: no particle touches the wall so soon.
    let cells = |amplitude: f64| {
        let bench = beside_a_swinging_wall(amplitude);
        bench.on_ranks([1; 3], |run| run.steps(5).snapshot().cells)
    };
    assert!(cells(0.02) != cells(0.0));
}
