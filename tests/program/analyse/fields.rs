//! Measures of series and profiles: waves, bed height, spectra, means, cycles, minimum fluidisation.

use super::made::{CASE, Made, column, noise, number, reason, text};
use std::f64::consts::{PI, TAU};
use talcum::analysis::SeriesRow;
use talcum::post_processing::TimeWindow;

fn times(count: u32, interval: f64) -> Vec<f64> {
    (0..count).map(|row| interval * f64::from(row)).collect()
}

/// A bed up to z = 90.
fn bed(z: f64, phi: f64) -> f64 {
    if z < 90.0 { phi } else { 0.0 }
}

const SPEED: f64 = 0.385;
const WAVELENGTH: f64 = 8.2;

fn wave(z: f64, t: f64) -> f64 {
    0.08 * (TAU * (z - SPEED * t) / WAVELENGTH).sin()
}

#[test]
fn waves_drawn_into_noise_are_measured_and_a_bed_without_has_none() {
    let times = times(600, 0.5);
    let made = Made::of(CASE);
    made.profiles(&times, |z, t| bed(z, 0.5 + wave(z, t) + 0.06 * noise(z, t)));
    let found = made.find("waves", TimeWindow::WHOLE);
    assert_eq!(text(&found, "waves.state"), "waves");
    let (speed, error) = number(&found, "waves.speed");
    // The signal is 1.6 times the noise; 1 % is what is asked for.
    assert!((speed / SPEED - 1.0).abs() < 0.01 && error < 0.01 * SPEED, "{speed} +- {error}");
    let (wavelength, _) = number(&found, "waves.wavelength");
    assert!((wavelength / WAVELENGTH - 1.0).abs() < 0.02, "{wavelength}");
    let (period, _) = number(&found, "waves.period");
    assert!((period * SPEED / WAVELENGTH - 1.0).abs() < 0.02, "{period}");
    let (amplitude, _) = number(&found, "waves.amplitude");
    assert!((amplitude / 0.08 - 1.0).abs() < 0.05, "{amplitude}");
    // Where and when: windows over the whole bed, all with waves.
    let heights = column(&found, "waves/windows", "height");
    assert!(heights.iter().all(|&height| (0.0..90.0).contains(&height)) && heights.len() > 10);

    // The controls: noise alone, of the same size as signal and noise together, and a bed at rest.
    let noisy = Made::of(CASE);
    noisy.profiles(&times, |z, t| bed(z, 0.5 + 0.14 * noise(z, t)));
    let found = noisy.find("waves", TimeWindow::WHOLE);
    assert_eq!(text(&found, "waves.state"), "disordered");
    assert!(reason(&found, "waves.speed").contains("waves were found in"));
    let still = Made::of(CASE);
    still.profiles(&times, |z, _| bed(z, 0.6));
    assert_eq!(text(&still.find("waves", TimeWindow::WHOLE), "waves.state"), "frozen");
}

#[test]
fn waves_are_measured_where_and_when_they_are() {
    let made = Made::of(CASE);
    // Below 45 waves; above, the bed stands still. Before t = 100 it stands everywhere.
    let phi = |z: f64, t: f64| {
        let moves = z < 45.0 && t >= 100.0;
        bed(z, 0.55 + if moves { wave(z, t) } else { 0.0 } + 0.004 * noise(z, t))
    };
    made.profiles(&times(900, 0.5), phi);
    let later = made.find("waves", TimeWindow { from: 120.0, to: f64::INFINITY });
    assert_eq!(text(&later, "waves.state"), "waves_in_part");
    let share = number(&later, "waves.share").0;
    assert!((0.35..0.75).contains(&share), "{share}");
    let (heights, speeds) =
        (column(&later, "waves/windows", "height"), column(&later, "waves/windows", "speed"));
    let with_waves = heights.iter().zip(&speeds).filter(|(_, speed)| speed.is_finite());
    assert!(with_waves.clone().count() > 3);
    assert!(with_waves.clone().all(|(height, _)| *height < 60.0));
    let earlier = made.find("waves", TimeWindow { from: 0.0, to: 99.0 });
    assert_eq!(text(&earlier, "waves.state"), "frozen");
}

#[test]
fn the_bed_has_its_height_expansion_and_pressure_drop() {
    let made = Made::of(CASE);
    // A bed of 30 at phi 0.6 for t < 50 that expands to 40 at phi 0.45: edges on nodes, half a node there.
    let phi = |z: f64, t: f64| {
        let (top, phi) = if t < 50.0 { (30.0, 0.6) } else { (40.5, 0.6 * 30.0 / 40.5) };
        match z {
            // The lowest node averages over a full cell, of which the plate fills one half; so it is at the surface.
            z if z == 0.0 || z == top => 0.5 * phi,
            z if z < top => phi,
            _ => 0.0,
        }
    };
    made.profiles(&times(101, 1.0), phi);
    // 18 over a cross-section of 25.
    let weight = 18.0 * 25.0;
    let row =
        |time: f64| SeriesRow { time, weight, grid_pressure_drop: 0.99, ..Default::default() };
    made.series(times(201, 0.5).into_iter().map(row));
    let found = made.find("bed", TimeWindow { from: 50.0, to: 100.0 });
    // Within a cell phi is taken as even: a tenth of the spacing of 1.5.
    assert!((number(&found, "bed.height").0 - 40.5).abs() < 0.15);
    assert!((number(&found, "bed.height_by_centre").0 - 40.5).abs() < 0.15);
    assert!((number(&found, "bed.expansion").0 - 0.35).abs() < 0.01);
    assert!((number(&found, "bed.solids_fraction").0 - 0.6 * 30.0 / 40.5).abs() < 1e-12);
    // 0.99 of the weight is the pressure drop.
    let weight = number(&found, "bed.weight_per_area").0;
    assert!((weight - 18.0).abs() < 1e-12, "{weight}");
    assert!((number(&found, "bed.pressure_drop").0 / weight - 0.99).abs() < 1e-9);
    // The control: the settled bed is not expanded.
    let settled = made.find("bed", TimeWindow { from: 0.0, to: 49.0 });
    assert!(number(&settled, "bed.expansion").0.abs() < 1e-12);
}

#[test]
fn times_before_there_is_a_bed_do_not_count() {
    let made = Made::of(CASE);
    // Loose particles for t < 20, then a bed of 30.
    let phi = |z: f64, t: f64| match (t < 20.0, z) {
        (true, z) if z < 80.0 => 0.2,
        (false, z) if z < 30.0 => 0.6,
        _ => 0.0,
    };
    made.profiles(&times(101, 1.0), phi);
    made.series(times(201, 0.5).into_iter().map(|time| SeriesRow { time, ..Default::default() }));
    let found = made.find("bed", TimeWindow::WHOLE);
    assert!((number(&found, "bed.height").0 - 30.0).abs() < 1.6);
    assert_eq!(column(&found, "bed/times", "time").len(), 81);
    // The control: where there is no bed at all, the reason is given.
    let loose = made.find("bed", TimeWindow { from: 0.0, to: 19.0 });
    assert!(reason(&loose, "bed.height").contains("nowhere above the threshold"));
}

#[test]
fn a_known_frequency_is_found_and_noise_has_none() {
    let made = Made::of(CASE);
    let frequency = 0.173;
    let row = |time: f64| SeriesRow {
        time,
        gas_force: 1.0 + 0.05 * (TAU * frequency * time).sin() + 0.05 * noise(1.0, time),
        plate_stress: 0.05 * noise(2.0, time),
        ..Default::default()
    };
    made.series(times(2000, 0.5).into_iter().map(row));
    let found = made.find("spectrum", TimeWindow::WHOLE);
    let (peak, error) = number(&found, "spectrum.gas_force");
    assert!((peak - frequency).abs() < 0.002 && error < 0.01, "{peak} +- {error}");
    assert!(reason(&found, "spectrum.plate_stress").contains("does not stand out"));
    assert!(reason(&found, "spectrum.bed_top").contains("constant"));
    // The variance of the series is the integral over its spectrum: a sine of 0.05, and uniform noise.
    let density = column(&found, "spectrum/gas_force", "density");
    let step = column(&found, "spectrum/gas_force", "frequency")[1];
    let variance = density.iter().sum::<f64>() * step;
    let expected = 0.05 * 0.05 * (0.5 + 1.0 / 3.0);
    assert!((variance / expected - 1.0).abs() < 0.05, "{variance} {expected}");
    let band = column(&found, "spectrum/gas_force", "upper");
    assert!(band.iter().zip(&density).all(|(upper, density)| upper > density));
    // Means: of the sine none but its offset; its error from correlated rows.
    let means = made.find("mean", TimeWindow::WHOLE);
    let (mean, error) = number(&means, "mean.gas_force");
    assert!((mean - 1.0).abs() < 4.0 * error + 1e-4 && error > 0.0, "{mean} +- {error}");
}

const U_MF: f64 = 0.05;

/// A ramp to 0.12 and back, by Ergun's form with a quadratic part of 0.3; U_mf is a tenth higher on the way back.
fn ramp(highest: f64, slope: f64) -> impl Iterator<Item = SeriesRow> {
    (0..1200_u32).map(move |row| {
        let up = row < 600;
        let part = f64::from(if up { row } else { 1199 - row }) / 599.0;
        let velocity = highest * part;
        let x = velocity / if up { U_MF } else { 1.1 * U_MF };
        let time = 0.5 * f64::from(row);
        SeriesRow {
            time,
            superficial_velocity: velocity,
            grid_pressure_drop: (0.7 * x + 0.3 * x * x).min(1.0) * slope + 0.02 * noise(0.0, time),
            centre_height: if x < 1.0 { 15.0 } else { 15.0 + 4.0 * (x - 1.0) },
            ..Default::default()
        }
    })
}

#[test]
fn a_made_ramp_gives_its_minimum_fluidisation_velocity() {
    let made = Made::of(CASE);
    made.series(ramp(0.12, 1.0));
    made.profiles(&times(601, 1.0), |z, _| if z < 30.0 { 0.62 } else { 0.0 });
    let found = made.find("u_mf", TimeWindow::WHOLE);
    let (up, error) = number(&found, "u_mf");
    assert!((up - U_MF).abs() < 3.0 * error + 1e-4 && error < 0.02 * U_MF, "{up} +- {error}");
    let (down, error) = number(&found, "u_mf.down");
    assert!((down - 1.1 * U_MF).abs() < 3.0 * error + 1e-4, "{down} +- {error}");
    assert!((number(&found, "u_mf.up_solids_fraction").0 - 0.62).abs() < 1e-12);
    // Wen-Yu in creeping flow: (St / 18) (1 - phi)^4.65, St = 55.
    let balance = 55.0 / 18.0 * 0.38_f64.powf(4.65);
    let found_balance = number(&found, "u_mf.up_balance").0;
    assert!((found_balance / balance - 1.0).abs() < 1e-9, "{found_balance} {balance}");
    assert!((number(&found, "u_mf.up_ratio").0 - up / balance).abs() < 1e-6);
    assert!((number(&found, "u_mf.hysteresis").0 + 0.1 * U_MF).abs() < 0.02 * U_MF);
    assert_eq!(column(&found, "u_mf/up", "superficial_velocity").len(), 600);
}

#[test]
fn a_ramp_without_a_plateau_gives_no_value_but_its_points() {
    let made = Made::of(CASE);
    made.series(ramp(0.045, 1.0));
    let found = made.find("u_mf", TimeWindow::WHOLE);
    assert!(reason(&found, "u_mf").contains("no plateau is reached"), "{}", reason(&found, "u_mf"));
    assert_eq!(column(&found, "u_mf/up", "pressure_drop").len(), 600);
    // What is missing is said, with the key that would give it.
    assert!(found.notes.iter().any(|note| note.contains("output.profiles")), "{:?}", found.notes);
    // The control: no ramp at all.
    let constant = Made::of(CASE);
    let row = |time: f64| SeriesRow { time, superficial_velocity: 0.1, ..Default::default() };
    constant.series(times(50, 0.5).into_iter().map(row));
    let found = constant.find("u_mf", TimeWindow::WHOLE);
    assert!(reason(&found, "u_mf.down").contains("constant"));
}

#[test]
fn a_vibrated_bed_is_averaged_over_its_cycle() {
    let vibrated = CASE.replace("[time]", "[vibration]\ngamma = 3.0\nfrequency = 0.16\n[time]");
    let made = Made::of(&vibrated);
    let row = |time: f64| {
        let phase = 2.0 * PI * 0.16 * time;
        let plate_stress = 1.0 + 0.8 * (phase - 0.5 * PI).sin() + 0.1 * noise(0.0, time);
        let bed_bottom = 0.3 * (1.0 + phase.cos());
        let superficial_velocity = 0.02 + 0.005 * phase.sin();
        SeriesRow { time, plate_stress, bed_bottom, superficial_velocity, ..Default::default() }
    };
    made.series(times(1600, 0.125).into_iter().map(row));
    let found = made.find("cycle", TimeWindow::WHOLE);
    assert_eq!(number(&found, "cycle.frequency").0, 0.16);
    // The sine is largest half a cycle after phase 0; its mean over a bin of a fortieth is 0.1 % smaller.
    let (peak, error) = number(&found, "cycle.plate_stress_peak");
    assert!((peak - 1.8).abs() < 4.0 * error + 0.002, "{peak} +- {error}");
    assert!((number(&found, "cycle.plate_stress_peak_phase").0 - 0.5).abs() < 0.08);
    assert!((number(&found, "cycle.lift").0 - 0.6).abs() < 0.01);
    assert!((number(&found, "cycle.flow_swing").0 - 0.01).abs() < 1.0e-4);
    // The bottom repeats itself exactly.
    let (_, error) = number(&found, "cycle.lift");
    assert!(error < 1.0e-12, "{error}");
    // The control: the same series of a plate at rest has no cycle.
    let still = Made::of(CASE);
    still.series(times(1600, 0.125).into_iter().map(row));
    let found = still.find("cycle", TimeWindow::WHOLE);
    assert!(reason(&found, "cycle.lift").contains("does not vibrate"));
}

#[test]
fn a_cycle_is_averaged_while_the_plate_vibrates_and_not_before_or_after() {
    let staged = CASE.replace("[time]", "[vibration]\ngamma = 3.0\nfrequency = 0.16\n[time]");
    let stages = "\n[[stage]]\nname = \"rest\"\nduration = 60.0\nvibration = \"off\"\n\
        [[stage]]\nname = \"shake\"\nduration = 50.0\nvibration = \"on\"\n[[stage]]\nname = \"shake on\"\nduration = 50.0\n\
        [[stage]]\nname = \"rest again\"\nduration = 40.0\nvibration = \"off\"\n";
    let made = Made::of(&(staged.replace("end = 1000.0\n", "") + stages));
    // At rest, the gas is off and the bottom lies still; else both repeat themselves exactly.
    let row = |time: f64| {
        let phase = 2.0 * PI * 0.16 * time;
        let vibrates = time > 60.0 && time <= 160.0;
        let bed_bottom = if vibrates { 0.3 * (1.0 + phase.cos()) } else { 0.0 };
        let superficial_velocity = if vibrates { 0.02 } else { 0.0 };
        SeriesRow { time, bed_bottom, superficial_velocity, ..Default::default() }
    };
    made.series(times(1600, 0.125).into_iter().map(row));
    let found = made.find("cycle", TimeWindow::WHOLE);
    // 100 times 0.16 cycles, of which those are complete that begin with phase -1/80.
    assert_eq!(number(&found, "cycle.cycles").0, 15.0);
    assert!(number(&found, "cycle.flow_swing").0 < 1.0e-12);
    let (lift, error) = number(&found, "cycle.lift");
    assert!((lift - 0.6).abs() < 0.01 && error < 1.0e-12, "{lift} +- {error}");
}
