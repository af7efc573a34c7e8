//! Instruments of a run, compared with known results: stress with the weight of a settled bed, granular temperature with
//! Haff's cooling, the flux through a plane with the volume that passes, displacements with free flight.

use crate::beds::{Bench, PERIODIC, PLATE, Run, law};
use std::f64::consts::PI;
use std::path::Path;
use talcum::case::Case;
use talcum::domain::EffectiveGravity;
use talcum::grid::ColumnGrid;
use talcum::instruments::{Instrument, Readings, Setting};

/// An instrument of a kind with these keys, begun for a run.
fn begin(kind: &str, keys: &str, run: &Run<'_>) -> Box<dyn Instrument> {
    let base = include_str!("../cases/good/plain.toml");
    let text = format!("{base}\n[measure.m]\nkind = \"{kind}\"\nevery = 0.1\n{keys}");
    let case = Case::from_text(&text, "case.toml", Path::new(""), &[]);
    let case = case.unwrap_or_else(|errors| panic!("{errors}"));
    let bounds = &run.domain.bounds;
    let column = ColumnGrid::new(bounds, 1.5, 1.0);
    let sizes = &run.state.sizes;
    let setting =
        Setting { bounds, sizes, column: &column, gas_grid: None, every: 0.1, start: 0.0 };
    case.instruments[0].kind.begin(&setting)
}

/// The values of a column of the only row.
fn column(readings: &Readings, instrument: &dyn Instrument, name: &str) -> Vec<f64> {
    let layout = instrument.layout();
    let place = layout.tables[0].columns.iter().position(|column| column.name == name);
    readings.rows[0].values[place.unwrap()].clone()
}

/// A bed that has settled on a plate: at rest but for a thousandth of its weight.
fn settled() -> Bench {
    let mut bench = Bench::new([5.0, 5.0, 20.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.2, 0.3);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 1.0e-3;
    bench.add_layers(250, (1.05, 0.55), &[1.0, 0.9], (0.01, 0.1));
    bench
}

#[test]
fn the_vertical_stress_of_a_settled_bed_is_the_weight_above() {
    const LAYERS: usize = 16;
    let mut run = settled().alone();
    run.steps(60_000);
    let mut instrument = begin("stress", &format!("layers = {LAYERS}\n"), &run);
    let readings = run.look(&mut *instrument).unwrap();
    let [contact, kinetic] =
        ["contact", "kinetic"].map(|name| column(&readings, &*instrument, name));
    let height = 20.0 / LAYERS as f64;
    let (area, weight) = (25.0, run.particles().map(|particle| particle.mass).sum::<f64>() / 25.0);
    let mut largest: f64 = 0.0;
    for layer in 0..LAYERS {
        let bottom = layer as f64 * height;
        // Averaged over the layer, a particle counts by the part of the layer that lies below it.
        let above = |z: f64| ((z - bottom) / height).clamp(0.0, 1.0);
        let expected: f64 = run
            .particles()
            .map(|particle| particle.mass * above(particle.position[2]) / area)
            .sum();
        let found = contact[9 * layer + 8] + kinetic[9 * layer + 8];
        largest = largest.max((found - expected).abs() / weight);
        // The control: half a particle's diameter higher the weight is another.
        let higher: f64 = run
            .particles()
            .map(|particle| particle.mass * above(particle.position[2] + 0.5) / area)
            .sum();
        if layer == 2 {
            assert!((found - higher).abs() > 0.03 * weight);
        }
    }
    // What is left of the motion: the bed's acceleration is 10^-4 g.
    assert!(largest < 1.0e-3, "{largest}");
    let bottom = column(&readings, &*instrument, "bottom_stress")[0];
    let of_bottom = contact[8] + kinetic[8];
    assert_eq!(bottom, of_bottom);
}

/// A dilute gas of frictionless spheres without weight, which cools by collisions alone.
fn granular_gas(restitution: f64) -> Bench {
    let mut bench = Bench::new([13.0, 13.0, 13.0], [PERIODIC; 3]);
    bench.contact = law(1.0e5, restitution, 0.0);
    bench.time_step = 2.0e-4;
    bench.add_layers(512, (1.6, 0.8), &[1.0], (0.25, 1.0));
    bench
}

/// Granular temperature after steps of the same number.
fn cooling(restitution: f64, looks: usize, steps: u64) -> Vec<f64> {
    let mut run = granular_gas(restitution).alone();
    let mut instrument = begin("stress", "layers = 1\n", &run);
    (0..looks)
        .map(|look| {
            if look > 0 {
                run.steps(steps);
            }
            let readings = run.look(&mut *instrument).unwrap();
            column(&readings, &*instrument, "granular_temperature")[0]
        })
        .collect()
}

#[test]
fn a_granular_gas_cools_by_haffs_law() {
    // dT/dt = -2 (1 - e^2) / 6 w T, w = 4 n d^2 chi sqrt(pi T) collisions per particle and time, chi of Carnahan &
    // Starling (Haff 1983): 1 / sqrt(T) grows linearly.
    let (restitution, solids) = (0.9, 512.0 * PI / 6.0 / 13.0_f64.powi(3));
    let chi = (1.0 - 0.5 * solids) / (1.0 - solids).powi(3);
    let density = 512.0 / 13.0_f64.powi(3);
    let rate = (1.0 - restitution * restitution) / 6.0 * 4.0 * density * chi * PI.sqrt();
    // The first 1.6 time units let velocities become normal.
    let temperatures = cooling(restitution, 6, 8_000);
    let slope = (temperatures[5].powf(-0.5) - temperatures[1].powf(-0.5)) / 6.4;
    // Some 2,000 collisions, each with a random impact: 2 %; velocities are not quite normal (Sonine's correction of the
    // rate, 1 %), contacts last for a hundredth of the time between them.
    assert!((slope / rate - 1.0).abs() < 0.08, "{slope} {rate}");
    assert!(temperatures[5] < 0.7 * temperatures[0]);
    // The control: elastic spheres do not cool; one in 200 is in a contact, whose spring holds a part of its energy.
    let elastic = cooling(1.0, 2, 20_000);
    assert!((elastic[1] / elastic[0] - 1.0).abs() < 5.0e-3, "{elastic:?}");
}

/// Particles in free flight through a box that repeats.
fn flight(velocities: &[[f64; 3]]) -> Bench {
    let mut bench = Bench::new([10.0, 10.0, 10.0], [PERIODIC; 3]);
    bench.time_step = 1.0e-2;
    for (k, &velocity) in velocities.iter().enumerate() {
        bench.add([1.0 + 3.0 * k as f64, 5.0, 4.0], velocity, 0.5);
    }
    bench
}

#[test]
fn the_flux_through_a_plane_adds_up_to_the_volume_that_passes() {
    const PLANE: &str = "at = \"plane\"\naxis = \"z\"\nposition = 5.0\n";
    let passed = |velocities: &[[f64; 3]]| {
        let mut run = flight(velocities).alone();
        let mut instrument = begin("probe", PLANE, &run);
        let flux = |run: &mut Run<'_>, instrument: &mut dyn Instrument| {
            column(&run.look(instrument).unwrap(), instrument, "solids_flux")[0]
        };
        // The area is 100; a look at each step for 4 time units.
        let looks = (0..400).map(|_| {
            run.steps(1);
            flux(&mut run, &mut *instrument) * 100.0 * 1.0e-2
        });
        looks.sum::<f64>()
    };
    let volume = PI / 6.0;
    // A section of a sphere is a parabola in time: the sum over 200 looks misses its integral by (dt v / d)^2 at most.
    assert!((passed(&[[0.3, 0.0, 0.5]]) - volume).abs() < 1.0e-4);
    assert!((passed(&[[0.0, 0.0, 0.5], [0.0, 0.1, 0.7]]) - 2.0 * volume).abs() < 2.0e-4);
    // The controls: one that flies along the plane, and one that flies away from it.
    assert_eq!(passed(&[[0.3, 0.0, 0.0]]), 0.0);
    assert_eq!(passed(&[[0.0, 0.0, -0.5]]), 0.0);
}

#[test]
fn displacements_of_free_flight_are_velocity_times_time() {
    let velocities = [[0.6, 0.0, 0.0], [0.0, -0.9, 0.3], [-0.2, 0.1, 1.1]];
    let mut run = flight(&velocities).alone();
    let mut instrument = begin("mixing", "window = 2.0\n", &run);
    run.look(&mut *instrument).unwrap();
    let mut last = Readings::default();
    for _ in 0..15 {
        run.steps(100);
        last = run.look(&mut *instrument).unwrap();
    }
    // After 15 time units, through the faces of the box: up to 16 of 10.
    let time = 15.0_f64;
    for (axis, name) in ["square_x", "square_y", "square_z"].into_iter().enumerate() {
        let mean = velocities.iter().map(|v| (v[axis] * time).powi(2)).sum::<f64>() / 3.0;
        let found = column(&last, &*instrument, name)[0];
        // Drifts are rounded to the quantum of positions, 10^-15 of the box, once a step.
        assert!((found - mean).abs() < 1.0e-9, "{name}: {found} {mean}");
    }
    // The control: the box is 10 long, no displacement inside of it has this square.
    assert!(column(&last, &*instrument, "square_z")[0] > 100.0 / 3.0);
}
