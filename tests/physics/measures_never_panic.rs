//! Any input gives a value or a reason, but never a panic or an undefined value.

use proptest::prelude::*;
use talcum::analysis::LineFit;
use talcum::analysis::bed_height::{BedHeightOptions, Profile, bed_height};
use talcum::analysis::bubbles::{BubbleOptions, VoidageField, find_bubbles};
use talcum::analysis::minimum_fluidisation::{Series, minimum_fluidisation};
use talcum::analysis::phase_average::{PhaseOptions, phase_average};
use talcum::analysis::residence::{Crossing, Gate, residence_times, solids_flux};
use talcum::analysis::spectrum::welch;
use talcum::analysis::statistics::{block_errors, correlated_mean};
use talcum::analysis::waves::{SolidsFractionField, WaveOptions, map_waves};

/// Numbers of all kinds: solids fractions, zeros, repeated values, huge ones, and what is not a number.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => 0.0..0.7_f64,
        2 => Just(0.0),
        1 => Just(0.5),
        1 => -1e3..1e3_f64,
    ]
}

fn odd_number() -> impl Strategy<Value = f64> {
    prop_oneof![6 => number(), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY), 1 => Just(1e300)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn waves(
        values in prop::collection::vec(number(), 0..900),
        heights in 0..14_usize,
        sizes in (odd_number(), odd_number()),
        frequency in prop::option::of(odd_number()),
    ) {
        let count = values.len().checked_div(heights).map_or(values.len(), |times| times * heights);
        let field = SolidsFractionField {
            values: &values[..count], heights, lowest: 0.0, spacing: sizes.0, start: 0.0, interval: sizes.1,
        };
        let options = WaveOptions { vibration_frequency: frequency, ..WaveOptions::default() };
        if let Ok(map) = map_waves(&field, &options) {
            for cell in map.cells {
                prop_assert!(cell.chance.is_finite() && cell.travelling_share.is_finite());
                prop_assert!(cell.material_velocity.value.is_finite());
            }
        }
        let sized = WaveOptions {
            window_height: Some(sizes.0), window_duration: Some(sizes.1), ..WaveOptions::default()
        };
        let even = SolidsFractionField { spacing: 1.0, interval: 1.0, ..field };
        let _ = map_waves(&even, &sized);
    }

    #[test]
    fn series(values in prop::collection::vec(odd_number(), 0..200), segment in 0..64_usize) {
        let other: Vec<f64> = values.iter().rev().copied().collect();
        let _ = (correlated_mean(&values), block_errors(&values), LineFit::of(&values, &other));
        if let Ok(spectrum) = welch(&values, 0.1, segment, 0.95) {
            let _ = spectrum.dominant();
        }
        let options = PhaseOptions { frequency: 0.7, origin: 0.3, bins: segment, skipped_cycles: 1 };
        let times: Vec<f64> = (0..values.len()).map(|index| 0.1 * index as f64).collect();
        let _ = phase_average(&times, &values, &options);
        let series = Series {
            velocities: &values,
            pressure_drops: &other,
            bed_heights: Some(&other),
            solids_fractions: Some(&values),
        };
        if let Ok(found) = minimum_fluidisation(&series)
            && let Ok(ramp) = found.up
            && let Ok(fit) = ramp.fit
        {
            prop_assert!(fit.velocity.value.is_finite() && fit.velocity.value > 0.0);
        }
        let profile = Profile { solids_fractions: &values, spacing: 1.5 };
        let _ = bed_height(&profile, &BedHeightOptions::default());
    }

    #[test]
    fn fields_and_crossings(
        values in prop::collection::vec(0.3..1.0_f64, 60),
        events in prop::collection::vec((0..9_u64, 0..4_usize, odd_number(), any::<bool>()), 0..60),
    ) {
        let field = VoidageField {
            values: &values, cells: [3, 4, 5], origin: [0.0; 3], spacing: [1.0; 3], periodic: [true; 2],
        };
        let bubbles = find_bubbles(&field, &BubbleOptions::default());
        let volume: f64 = bubbles.iter().flatten().map(|bubble| bubble.volume).sum();
        prop_assert!(volume <= 60.0);
        let crossings: Vec<Crossing> = events
            .into_iter()
            .map(|(particle, plane, time, upwards)| Crossing { particle, plane, time, upwards, mass: 1.0 })
            .collect();
        let _ = solids_flux(&crossings, 2, 1.0, 1.0);
        let gate = |plane| Gate { plane, upwards: true };
        let _ = residence_times(&crossings, gate(0), gate(1), 5);
    }
}

#[test]
fn a_bed_whose_mass_is_negative_has_no_height_but_does_no_harm() {
    // More mass below the bottom than below the top.
    let profile = [-5.0, -1.0, 1.0, 5.5, 0.0, 0.0, -9.5];
    let field = SolidsFractionField {
        values: &profile.repeat(24),
        heights: 7,
        lowest: 0.0,
        spacing: 1.0,
        start: 0.0,
        interval: 1.0,
    };
    let map = map_waves(&field, &WaveOptions::default());
    assert!(map.is_ok_and(|map| map.waves.is_err()));
}
