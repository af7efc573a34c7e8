//! A contact law from outside the crate has the same bits as a law of the registry.

use crate::beds::{Bench, PERIODIC, PLATE};
use std::path::Path;
use talcum::case::Case;
use talcum::contact::{
    Contact, ContactForce, ContactForceLaw, ContactLaw, ContactModel, ContactModuli, HertzMindlin,
    RollingFriction, RollingKind,
};
use talcum::domain::EffectiveGravity;
use talcum::gas::{DragCorrelation, DragLaw, GasModel};
use talcum::particles::ContactHistory;

const STEPS: u64 = 4000;

/// A law that the crate does not know: that of Hertz and Mindlin, with its force scaled.
#[derive(Debug)]
struct Scaled {
    law: HertzMindlin,
    factor: f64,
}

impl ContactForceLaw for Scaled {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        let force = self.law.force(contact, history, dt);
        ContactForce { normal: force.normal * self.factor, ..force }
    }

    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.law.stiffness(overlap, reduced_radius)
    }

    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
        self.law.contact_duration(reduced_mass, reduced_radius)
    }

    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.law.largest_force(overlap, reduced_radius)
    }
}

fn hertz() -> HertzMindlin {
    HertzMindlin::new(ContactModuli { normal: 1.0e5, shear: 3.0e4 }, 0.5, 0.3).unwrap()
}

/// A bed that falls onto the plate.
fn bed(law: ContactLaw, rolling: bool, diameters: &[f64]) -> Bench {
    let mut bench = Bench::new([4.0, 4.0, 12.0], [PERIODIC, PERIODIC, PLATE]);
    let springs = RollingKind::ElasticPlastic { damping: 0.3 };
    let rolling = rolling.then(|| RollingFriction::new(springs, 0.2).unwrap());
    bench.interface = Some(ContactModel { rolling, ..law.into() });
    bench.gravity = EffectiveGravity { magnitude: 5.0, vibration: None };
    bench.time_step = 4.0e-4;
    bench.skin = Some(0.05);
    bench.add_layers(63, (1.25, 0.7), diameters, (0.05, 2.0));
    bench
}

fn end(law: ContactLaw, rolling: bool, diameters: &[f64], ranks: usize) -> Vec<u8> {
    let bench = bed(law, rolling, diameters);
    bench.on_ranks([1, 1, ranks], |run| {
        let end = run.steps(STEPS).snapshot();
        assert!(end.pairs.len() > 20, "the bed is dense: {}", end.pairs.len());
        end.bits()
    })
}

#[test]
fn custom_law_has_the_bits_of_the_registered_one() {
    for (rolling, diameters) in [(false, &[1.0][..]), (false, &[1.0, 0.9]), (true, &[1.0, 0.9])] {
        let expected = end(hertz().into(), rolling, diameters, 1);
        for ranks in 1..=3 {
            let same = ContactLaw::custom("scaled_hertz", Scaled { law: hertz(), factor: 1.0 });
            assert!(end(same, rolling, diameters, ranks) == expected, "{ranks} ranks, {rolling}");
        }
        // Negative control: another factor is seen.
        let other =
            ContactLaw::custom("scaled_hertz", Scaled { law: hertz(), factor: 1.0 + 1e-12 });
        assert!(end(other, rolling, diameters, 1) != expected);
    }
}

#[test]
fn custom_law_has_its_name_and_equals_itself_only() {
    let one = ContactLaw::custom("scaled_hertz", Scaled { law: hertz(), factor: 1.0 });
    let other = ContactLaw::custom("scaled_hertz", Scaled { law: hertz(), factor: 1.0 });
    assert_eq!(one.name(), "scaled_hertz");
    assert_eq!(one, one.clone());
    assert_ne!(one, other);
}

/// Stokes drag of a single sphere.
#[derive(Debug)]
struct Stokes;

impl DragCorrelation for Stokes {
    fn scaled_drag(&self, _solids_fraction: f64, _reynolds: f64) -> f64 {
        1.0
    }

    fn depends_on_reynolds(&self) -> bool {
        false
    }
}

/// What a restart makes of the text in a checkpoint: its error.
fn error_of_restart(case: &Case, overrides: &[String]) -> Option<String> {
    let read = Case::from_text(&case.text, "checkpoint", Path::new(""), overrides);
    read.err().map(|errors| errors.to_string())
}

#[test]
fn restart_without_the_custom_law_is_refused() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/smoke/staged.toml");
    let case = Case::read(&path, &[]).unwrap();
    assert_eq!(error_of_restart(&case, &[]), None);

    let law = ContactLaw::custom("scaled_hertz", Scaled { law: hertz(), factor: 1.0 });
    let own = case.clone().with_contact_law(&law).unwrap();
    assert!(own.stages.iter().all(|stage| stage.physics.contact.first().law == law));
    let error = error_of_restart(&own, &[]).unwrap();
    assert!(error.contains("contact.law") && error.contains("scaled_hertz"), "{error}");
    let known = ["contact.law=linear_spring_dashpot".to_owned()];
    assert_eq!(error_of_restart(&own, &known), None);

    let drag = DragLaw::custom("stokes", Stokes);
    let own = case.with_drag_law(&drag).unwrap();
    let laws = own.stages.iter().filter_map(|stage| match &stage.physics.gas {
        GasModel::Column(gas) => Some(&gas.drag),
        _ => None,
    });
    assert!(laws.clone().count() > 0 && laws.into_iter().all(|law| *law == drag));
    let error = error_of_restart(&own, &[]).unwrap();
    assert!(error.contains("gas.drag") && error.contains("stokes"), "{error}");
}
