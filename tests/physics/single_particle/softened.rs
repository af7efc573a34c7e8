//! Softened cohesive spheres with scaled adhesion separate after impacts like the stiff ones, at the same speeds.

use crate::beds::{Bench, OPEN, PERIODIC, attraction, law};
use std::f64::consts::PI;
use talcum::contact::{ContactModel, ContactModuli, Jkr, VanDerWaals};
use talcum::rules::adhesion_factor;

const CUT_OFF: f64 = 1.0e-4;
const RANGE: f64 = 0.01;
const RESTITUTION: f64 = 0.9;
/// Stiffness of the real particles over that of the softened ones.
const REDUCTION: f64 = 100.0;

/// Two spheres of diameter and density 1 that meet from the range of their attraction.
struct Pair {
    contact: ContactModel,
    attraction: Option<VanDerWaals>,
    time_step: f64,
}

impl Pair {
    /// Speed of separation over that of approach, both at the range; nothing if they stick.
    fn restitution(&self, speed: f64) -> Option<f64> {
        let mut bench = Bench::new([4.0; 3], [PERIODIC, PERIODIC, OPEN]);
        bench.interface = Some(self.contact.clone());
        bench.cohesion = self.attraction.clone();
        bench.time_step = self.time_step;
        bench.add([2.0, 2.0, 1.0], [0.0, 0.0, 0.5 * speed], 0.5);
        bench.add([2.0, 2.0, 2.0 + RANGE], [0.0, 0.0, -0.5 * speed], 0.5);
        let mut run = bench.alone();
        let mut turned = 0;
        loop {
            run.steps(1);
            let (lower, upper) = (run.particle(0), run.particle(1));
            let velocity = upper.velocity[2] - lower.velocity[2];
            let separation = upper.position[2] - lower.position[2] - 1.0;
            if separation > RANGE {
                return Some(velocity / speed);
            }
            turned += u32::from(velocity > 0.0);
            if turned > 0 && velocity < 0.0 {
                return None;
            }
        }
    }
}

fn linear(stiffness: f64, attraction: VanDerWaals, speed: f64) -> Pair {
    let contact = PI * (PI / 12.0 / stiffness).sqrt() / 400.0;
    let time_step = contact.min(0.02 * attraction.cut_off / speed);
    Pair {
        contact: law(stiffness, RESTITUTION, 0.0).into(),
        attraction: Some(attraction),
        time_step,
    }
}

#[test]
fn softened_spheres_of_the_same_work_part_as_the_stiff_ones() {
    let real_stiffness = 2.0e7;
    // F0 / (k delta) = 0.02: the surface's part of the work is 200 times that of the stiff spring.
    let real = attraction((0.02 * real_stiffness * CUT_OFF, 0.0), 1.0, (CUT_OFF, RANGE));
    let scaled = real.keeping_work(adhesion_factor(REDUCTION, 1.0), 0.5).unwrap();
    let soft_stiffness = real_stiffness / REDUCTION;
    for speed in [0.16, 0.3] {
        let stiff = linear(real_stiffness, real.clone(), speed).restitution(speed).unwrap();
        let kept = linear(soft_stiffness, scaled.clone(), speed).restitution(speed).unwrap();
        println!("softened impact at {speed}: {kept:.4}, stiff {stiff:.4}");
        // The dashpot's first order of both (half a per cent of 1 - e^2 with 400 steps per contact), and the cut-off in
        // steps of a fiftieth, both enlarged by 1 / e^2 where most of the energy is lost.
        assert!((kept - stiff).abs() < 0.01, "{kept} {stiff}");
        assert!(stiff < 0.88 && stiff > 0.3, "adhesion matters: {stiff}");
        // Negative control: the force of the stiff particles on the soft spring.
        let unscaled = linear(soft_stiffness, real.clone(), speed).restitution(speed);
        assert!(unscaled.is_none_or(|unscaled| (unscaled - stiff).abs() > 0.05), "{unscaled:?}");
    }
}

#[test]
fn softened_spheres_of_jkr_part_as_the_stiff_ones() {
    let jkr = |modulus: f64, energy: f64| {
        Jkr::new(ContactModuli { normal: modulus, shear: modulus }, energy, 1.0, 0.0).unwrap()
    };
    let pair = |law: Jkr| Pair { contact: law.into(), attraction: None, time_step: 2.0e-6 };
    let (modulus, energy) = (1.0e7, 1.0);
    let soft_energy = energy * adhesion_factor(REDUCTION, 1.5);
    // Work of the neck: 7.09 (gamma^5 R*^4 / E*^2)^(1/3) with Gamma = 2 gamma; the spheres stick below a speed of 0.024.
    for speed in [0.03, 0.06] {
        let stiff = pair(jkr(modulus, energy)).restitution(speed);
        let kept = pair(jkr(modulus / REDUCTION, soft_energy)).restitution(speed);
        let (stiff, kept) = (stiff.unwrap(), kept.unwrap());
        println!("softened JKR at {speed}: {kept:.5}, stiff {stiff:.5}");
        assert!((kept - stiff).abs() < 2.0e-3, "{kept} {stiff}"); // 300 steps and more per contact
        assert!(stiff < 0.97, "adhesion matters: {stiff}");
        let unscaled = pair(jkr(modulus / REDUCTION, energy)).restitution(speed);
        assert!(unscaled.is_none_or(|unscaled| (unscaled - stiff).abs() > 0.03), "{unscaled:?}");
    }
}
