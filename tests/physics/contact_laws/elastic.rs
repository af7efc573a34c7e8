//! Hertz-Mindlin and JKR: Chung & Ooi's impacts, restitution, pull-off and sticking, oblique impacts.

use super::{HeadOn, rebound_from_plate, smooth};
use crate::beds::{Bench, OPEN, PERIODIC};
use std::f64::consts::PI;
use talcum::contact::{ContactForceLaw, ContactLaw, ContactModuli, Elasticity, HertzMindlin, Jkr};

fn hertz(body: Elasticity, other: Elasticity, restitution: f64, friction: f64) -> ContactLaw {
    let moduli = ContactModuli::between(body, other).unwrap();
    ContactLaw::HertzMindlin(HertzMindlin::new(moduli, restitution, friction).unwrap())
}

fn material(young_modulus: f64, poisson_ratio: f64) -> Elasticity {
    Elasticity { young_modulus, poisson_ratio }
}

const RIGID: Elasticity = Elasticity { young_modulus: f64::INFINITY, poisson_ratio: 0.3 };

/// Chung & Ooi (2011), test 1: two spheres of 10 mm at +-10 m/s.
#[test]
fn chung_and_ooi_test_1() {
    let glass = (material(48.0e9, 0.2), 2800.0, [274.11e-6, 10.697e3, 40.34e-6]);
    let limestone = (material(20.0e9, 0.25), 2500.0, [368.30e-6, 7.108e3, 54.20e-6]);
    for (body, density, expected) in [glass, limestone] {
        let law = hertz(body, body, 1.0, 0.35);
        let out = HeadOn { law: &law, radius: 0.01, density, steps: 2000.0 }.at(20.0);
        let found = [out.overlap, out.force, out.duration];
        println!("Chung & Ooi T1: {found:?}, closed form {expected:?}");
        for (found, expected) in found.iter().zip(expected) {
            // Digits of the table; begin and end of the contact within a step of 2000.
            assert!((found / expected - 1.0).abs() < 1.0e-3, "{found} {expected}");
        }
        // Negative control: another Poisson's ratio.
        let wrong = hertz(material(body.young_modulus, 0.3), body, 1.0, 0.35);
        let out = HeadOn { law: &wrong, radius: 0.01, density, steps: 2000.0 }.at(20.0);
        assert!((out.force / expected[1] - 1.0).abs() > 2.0e-3);
    }
}

/// Chung & Ooi (2011), test 2: a sphere of 100 mm at 0.2 m/s on a rigid wall.
#[test]
fn chung_and_ooi_test_2() {
    let aluminium = (material(70.0e9, 0.3), 2699.0, [49.717e-6, 11.370e3, 731.6e-6]);
    let magnesium = (material(40.0e9, 0.35), 1800.0, [52.123e-6, 7.233e3, 767.0e-6]);
    for (body, density, expected) in [aluminium, magnesium] {
        let law = hertz(body, RIGID, 1.0, 0.35);
        let radius = 0.1;
        let mut bench = Bench::new([1.0; 3], [PERIODIC, PERIODIC, crate::beds::PLATE]);
        bench.density = density;
        bench.skin = Some(0.01);
        bench.interface = Some(smooth(law));
        bench.time_step = expected[2] / 2000.0;
        bench.add([0.5, 0.5, radius + 1.0e-9], [0.0, 0.0, -0.2], radius);
        let mut run = bench.alone();
        let mut found = [0.0_f64; 3];
        for _ in 0..2100 {
            run.steps(1);
            let sphere = run.particle(0);
            found[0] = found[0].max(radius - sphere.position[2]);
            found[1] = found[1].max(sphere.force[2]);
            found[2] += if run.snapshot().walls.is_empty() { 0.0 } else { bench.time_step };
        }
        println!("Chung & Ooi T2: {found:?}, closed form {expected:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1.0e-3, "{found} {expected}");
        }
        // Negative control: an elastic wall of the same material would be softer by 2^(2/5).
        assert!((found[0] / (expected[0] * 2.0_f64.powf(0.4)) - 1.0).abs() > 0.1);
    }
}

/// Chung & Ooi (2011), test 3: what comes out is the restitution coefficient that goes in.
#[test]
fn restitution_of_hertz_impacts_is_the_one_given_at_any_speed() {
    let (oxide, iron) = (material(380.0e9, 0.23), material(100.0e9, 0.25));
    for restitution in [0.2, 0.5, 0.8, 1.0] {
        let law = hertz(oxide, iron, restitution, 0.0);
        for speed in [0.39, 3.9] {
            let out =
                HeadOn { law: &law, radius: 2.5e-3, density: 4000.0, steps: 4000.0 }.at(speed);
            let found = out.restitution.unwrap();
            println!("e {restitution}, v {speed}: {found:.5}");
            // The dashpot sees velocities half a step old, and pulls at the end, where it fades as delta^(1/4).
            assert!((found - restitution).abs() < 2.0e-3, "{found} for {restitution}");
        }
    }
}

/// 0.5 radius, density 1: stiff enough for the overlap to stay below a thousandth.
fn stiff(restitution: f64, friction: f64) -> ContactLaw {
    let body = material(1.0e7, 0.3);
    hertz(body, RIGID, restitution, friction)
}

#[test]
fn oblique_and_spinning_impacts_in_gross_sliding() {
    let (mu, vx, vz, step) = (0.1, 2.0, 1.0, 2.0e-6);
    let out = rebound_from_plate(&stiff(1.0, mu), [vx, vz], 0.0, step);
    // The impulse of a contact of some 2000 steps, relative error (omega dt)^2.
    let bound = 1.0e-5;
    assert!((out.velocity[0] - (vx - mu * 2.0 * vz)).abs() < bound, "{:?}", out.velocity);
    assert!((out.angular_velocity[1] - 2.5 * mu * 2.0 * vz / 0.5).abs() < 5.0 * bound);
    let spun = rebound_from_plate(&stiff(1.0, mu), [0.0, vz], 8.0, step);
    assert!((spun.velocity[0] - mu * 2.0 * vz).abs() < bound, "{:?}", spun.velocity);
    // Negative control: another friction.
    let other = rebound_from_plate(&stiff(1.0, 1.1 * mu), [vx, vz], 0.0, step);
    assert!((other.velocity[0] - out.velocity[0]).abs() > 10.0 * bound);
}

/// Young's modulus 1 MPa, surface energy 0.1 J/m^2: an overlap scale of 0.5 % of the radius.
fn jkr(surface_energy: f64) -> (Jkr, ContactModuli) {
    let body = material(1.0e8, 0.3);
    let moduli = ContactModuli::between(body, body).unwrap();
    (Jkr::new(moduli, surface_energy, 1.0, 0.3).unwrap(), moduli)
}

const SMALL: f64 = 20.0e-6;
const ENERGY: f64 = 0.05;

/// Energy lost as the neck tears, 0.165749 * 8 pi gamma R* c^4 / R*: from delta = 0 to the tearing of the neck.
fn tearing_work(moduli: ContactModuli) -> f64 {
    let reduced = 0.5 * SMALL;
    let root = (PI * ENERGY / moduli.normal).sqrt();
    let scale = 2.0 * root * (2.0 * reduced * root).cbrt();
    let primitive = |s: f64| 2.0 / 3.0 * s.powi(7) - 0.25 * s.powi(4) - 4.0 / 15.0 * s.powi(10);
    8.0 * PI * ENERGY * reduced * scale * (primitive(1.0) - primitive(0.25_f64.cbrt()))
}

#[test]
fn jkr_spheres_stick_below_the_speed_that_the_neck_can_hold() {
    let (law, moduli) = jkr(ENERGY);
    let law = ContactLaw::Jkr(law);
    let density = 1000.0;
    let pair = HeadOn { law: &law, radius: SMALL, density, steps: 4000.0 };
    let stick = (2.0 * tearing_work(moduli) / (0.5 * pair.mass())).sqrt();
    println!("JKR spheres stick below {stick:.5e}");
    // The first step of the contact may begin anywhere within it: 8/9 F_c v dt of energy.
    assert!(pair.at(0.99 * stick).restitution.is_none());
    assert!(pair.at(1.01 * stick).restitution.is_some());
    for times in [1.2, 2.0, 5.0] {
        let found = pair.at(times * stick).restitution.unwrap();
        let expected = (1.0 - 1.0 / (times * times)).sqrt();
        println!("JKR at {times} times that: e {found:.5}, closed form {expected:.5}");
        assert!((found - expected).abs() < 4.0e-3, "{found} {expected}");
        // Negative control: spheres that part at zero overlap lose nothing.
        assert!((found - 1.0).abs() > 0.01);
    }
}

/// A sphere under a ceiling, at the end of its neck: held by a little less than 3 pi gamma R, not by more.
#[test]
fn the_pull_off_force_of_jkr_holds_a_weight() {
    let (law, _) = jkr(ENERGY);
    let (density, radius) = (1000.0, SMALL);
    let mass = density * 4.0 / 3.0 * PI * radius.powi(3);
    let pull_off = 3.0 * PI * ENERGY * radius;
    assert!((law.pull_off_force(radius) / pull_off - 1.0).abs() < 1.0e-14);
    let damped = {
        let body = material(1.0e8, 0.3);
        let moduli = ContactModuli::between(body, body).unwrap();
        ContactLaw::Jkr(Jkr::new(moduli, ENERGY, 0.05, 0.3).unwrap())
    };
    let hangs = |weight: f64| {
        let faces = [talcum::domain::Face::Open, talcum::domain::Face::Wall];
        let mut bench = Bench::new([10.0 * radius; 3], [OPEN, OPEN, faces]);
        bench.density = density;
        bench.skin = Some(0.1 * radius);
        bench.interface = Some(smooth(damped.clone()));
        bench.gravity =
            talcum::domain::EffectiveGravity { magnitude: weight / mass, vibration: None };
        bench.time_step = damped.contact_duration(mass, radius) / 100.0;
        bench.add([5.0 * radius, 5.0 * radius, 9.0 * radius + 1.0e-4 * radius], [0.0; 3], radius);
        let mut run = bench.alone();
        run.steps(20_000);
        !run.snapshot().walls.is_empty()
    };
    assert!(hangs(0.85 * pull_off));
    // Negative control, and the other side.
    assert!(!hangs(1.05 * pull_off));
}
