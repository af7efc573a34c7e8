//! Ramps generated from Ergun's form with noise.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A bed with U_mf = 0.05 according to dp = a U + b U^2, whose packing is looser by a factor on the way down.
struct Drawn {
    velocities: Vec<f64>,
    drops: Vec<f64>,
    heights: Vec<f64>,
    fractions: Vec<f64>,
}

const U_MF: f64 = 0.05;

fn draw(highest: f64, quadratic_part: f64, overshoot: f64, noise: f64) -> Drawn {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let rows = 300;
    let mut drawn = Drawn { velocities: vec![], drops: vec![], heights: vec![], fractions: vec![] };
    for row in 0..2 * rows {
        let rising = row < rows;
        let part =
            if rising { row as f64 } else { (2 * rows - 1 - row) as f64 } / (rows - 1) as f64;
        let velocity = highest * part;
        let x = velocity / if rising { U_MF } else { 1.1 * U_MF };
        let form = (1.0 - quadratic_part) * x + quadratic_part * x * x;
        let limit = if rising && x < 1.0 + overshoot { 1.0 + overshoot } else { 1.0 };
        drawn.velocities.push(velocity);
        drawn.drops.push(form.min(limit) + noise * (random.random::<f64>() - 0.5));
        drawn.heights.push(if x < 1.0 { 12.0 } else { 12.0 + 3.0 * (x - 1.0) });
        drawn.fractions.push(if rising { 0.62 } else { 0.60 });
    }
    drawn
}

impl Drawn {
    fn series(&self) -> Series<'_> {
        Series {
            velocities: &self.velocities,
            pressure_drops: &self.drops,
            bed_heights: Some(&self.heights),
            solids_fractions: Some(&self.fractions),
        }
    }

    fn reason(&self) -> String {
        minimum_fluidisation(&self.series()).unwrap().up.unwrap().fit.unwrap_err().to_string()
    }
}

#[test]
fn straight_and_curved_packed_beds_give_their_velocity() {
    // For a quadratic part of 0.45, Re_mf is about 55, and a line through the origin is off by a tenth.
    for quadratic_part in [0.0, 0.15, 0.45, 1.0] {
        for noise in [0.0, 0.1] {
            let drawn = draw(0.12, quadratic_part, 0.0, noise);
            let found = minimum_fluidisation(&drawn.series()).unwrap();
            let up = found.up.unwrap().fit.unwrap();
            let down = found.down.unwrap().fit.unwrap();
            let tolerance = |fit: &Fit| 3.0 * fit.velocity.error + 1e-3 * U_MF;
            assert!((up.velocity.value - U_MF).abs() < tolerance(&up), "{quadratic_part} {up:?}");
            assert!((down.velocity.value - 1.1 * U_MF).abs() < tolerance(&down), "{down:?}");
            assert!(up.velocity.error < 0.02 * U_MF, "{up:?}");
            assert!((up.plateau.value - 1.0).abs() < 0.01);
            let hysteresis = found.hysteresis.unwrap();
            let off = (hysteresis.velocity.value + 0.1 * U_MF).abs();
            assert!(off < 3.0 * hysteresis.velocity.error + 2e-3 * U_MF, "{hysteresis:?}");
            assert!(hysteresis.pressure_drop > 0.05);
        }
    }
}

#[test]
fn a_line_through_the_origin_is_wrong_for_a_curved_bed() {
    let drawn = draw(0.12, 0.45, 0.0, 0.0);
    let fit = minimum_fluidisation(&drawn.series()).unwrap().up.unwrap().fit.unwrap();
    let packed: Vec<(f64, f64)> = drawn.velocities[..300]
        .iter()
        .zip(&drawn.drops)
        .filter(|(_, drop)| (0.1..0.8).contains(*drop))
        .map(|(velocity, drop)| (*velocity, *drop))
        .collect();
    let slope = packed.iter().map(|(u, p)| u * p).sum::<f64>()
        / packed.iter().map(|(u, _)| u * u).sum::<f64>();
    assert!((1.0 / slope / U_MF - 1.0).abs() > 0.08);
    assert!((fit.velocity.value / U_MF - 1.0).abs() < 1e-6, "{fit:?}");
}

#[test]
fn overshoot_packing_and_balance_are_reported() {
    let drawn = draw(0.12, 0.1, 0.25, 0.02);
    let found = minimum_fluidisation(&drawn.series()).unwrap();
    let up = found.up.unwrap().fit.unwrap();
    assert!((up.velocity.value / U_MF - 1.0).abs() < 0.01, "{up:?}");
    assert!((up.peak - 1.25).abs() < 0.03, "{up:?}");
    let down = found.down.unwrap().fit.unwrap();
    assert!(down.peak < 1.03);
    assert!((up.solids_fraction.unwrap().value - 0.62).abs() < 1e-12);
    assert!((up.bed_height.unwrap() - 12.0).abs() < 1e-12);
    let ratio = ratio_to_balance(&up, |phi| 0.05 * (1.0 - phi) / 0.38).unwrap();
    assert!((ratio.value - 1.0).abs() < 3.0 * ratio.error + 1e-3, "{ratio:?}");
    assert!(ratio_to_balance(&up, |_| 0.0).is_err());
}

#[test]
fn steps_of_velocity_are_averaged_over_their_later_half() {
    let (mut velocities, mut drops) = (vec![], vec![]);
    for step in 0..24 {
        let velocity = 0.005 * f64::from(step);
        for row in 0..20 {
            velocities.push(velocity);
            // The first rows of a step have not settled.
            drops.push((velocity / U_MF).min(1.0) + if row < 8 { 0.5 } else { 0.0 });
        }
    }
    let series = Series {
        velocities: &velocities,
        pressure_drops: &drops,
        bed_heights: None,
        solids_fractions: None,
    };
    let found = minimum_fluidisation(&series).unwrap();
    let fit = found.up.unwrap().fit.unwrap();
    assert!((fit.velocity.value / U_MF - 1.0).abs() < 1e-6, "{fit:?}");
    assert!(found.down.unwrap_err().reason().contains("does not fall far enough"));
    assert!(ratio_to_balance(&fit, |phi| phi).unwrap_err().reason().contains("unknown"));
}

#[test]
fn a_bed_in_si_units_gives_the_same_part() {
    let drawn = draw(0.12, 0.45, 0.0, 0.05);
    let metres: Vec<f64> = drawn.velocities.iter().map(|velocity| 1e-3 * velocity).collect();
    let heights: Vec<f64> = drawn.heights.iter().map(|height| 1e-5 * height).collect();
    let series = Series { velocities: &metres, bed_heights: Some(&heights), ..drawn.series() };
    let a = minimum_fluidisation(&series).unwrap().up.unwrap().fit.unwrap();
    let b = minimum_fluidisation(&drawn.series()).unwrap().up.unwrap().fit.unwrap();
    assert!((a.velocity.value / (1e-3 * b.velocity.value) - 1.0).abs() < 1e-9);
}

#[test]
fn beds_that_give_no_value_say_why() {
    assert!(draw(0.045, 0.1, 0.0, 0.02).reason().contains("no plateau is reached"));
    assert!(draw(0.055, 0.1, 0.0, 0.02).reason().contains("no plateau is reached"));
    let mut expanding = draw(0.12, 0.1, 0.0, 0.02);
    for (height, velocity) in expanding.heights.iter_mut().zip(&expanding.velocities) {
        *height = 12.0 * (1.0 + 4.0 * velocity);
    }
    assert!(expanding.reason().contains("the bed is not packed"));
    // A pressure drop that increases with the cube of the velocity's distance from a third of U_mf.
    let mut other = draw(0.12, 0.1, 0.0, 0.0);
    for (drop, velocity) in other.drops.iter_mut().zip(&other.velocities) {
        let x = velocity / U_MF;
        *drop = if x < 1.0 { 0.5 + 1.2 * (x - 0.5) * (x - 0.5) * (x - 0.5) } else { 1.0 };
    }
    assert!(other.reason().contains("R^2"), "{}", other.reason());
    let constant = Drawn {
        velocities: vec![0.1; 50],
        drops: vec![1.0; 50],
        heights: vec![1.0; 50],
        fractions: vec![0.6; 50],
    };
    let reason = minimum_fluidisation(&constant.series()).unwrap_err();
    assert!(reason.reason().contains("constant"));
}
