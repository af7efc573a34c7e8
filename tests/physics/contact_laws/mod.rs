//! Contact laws, rolling friction and walls, compared with closed forms, each with a negative control.

mod coarse_graining;
mod custom;
mod documentation;
mod elastic;
mod hysteretic;
mod loops;
mod marked;
mod rolling;
mod twisting;
mod walls;

use crate::beds::{Bench, OPEN, PERIODIC, PLATE};
use talcum::contact::{ContactForceLaw, ContactLaw, ContactModel, RollingFriction};
use talcum::parallel::ParticleRecord;

/// A law without rolling friction.
fn smooth(law: ContactLaw) -> ContactModel {
    ContactModel::from(law)
}

/// A law with rolling friction.
fn rough(law: ContactLaw, rolling: RollingFriction) -> ContactModel {
    ContactModel { rolling: Some(rolling), ..law.into() }
}

/// Two equal spheres that meet head on, without anything else.
struct HeadOn<'a> {
    law: &'a ContactLaw,
    radius: f64,
    density: f64,
    /// Time steps per contact, as the law gives its duration.
    steps: f64,
}

/// What came of it.
#[derive(Clone, Copy, Debug)]
struct Rebound {
    /// Speed of separation over that of approach; nothing if the spheres stick.
    restitution: Option<f64>,
    /// Largest overlap.
    overlap: f64,
    /// Largest normal force.
    force: f64,
    /// Time of contact.
    duration: f64,
    /// Time step.
    step: f64,
}

impl HeadOn<'_> {
    fn mass(&self) -> f64 {
        self.density * 4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }

    fn step(&self) -> f64 {
        self.law.contact_duration(0.5 * self.mass(), 0.5 * self.radius) / self.steps
    }

    /// The impact at a relative speed.
    fn at(&self, speed: f64) -> Rebound {
        let r = self.radius;
        let mut bench = Bench::new([12.0 * r; 3], [PERIODIC, PERIODIC, OPEN]);
        bench.density = self.density;
        bench.skin = Some(0.1 * r);
        bench.interface = Some(smooth(self.law.clone()));
        bench.time_step = self.step();
        bench.add([6.0 * r, 6.0 * r, 4.0 * r], [0.0, 0.0, 0.5 * speed], r);
        bench.add([6.0 * r, 6.0 * r, 6.0 * r + 1.0e-6 * r], [0.0, 0.0, -0.5 * speed], r);
        let mut run = bench.alone();
        let step = bench.time_step;
        let mut out = Rebound { restitution: None, overlap: 0.0, force: 0.0, duration: 0.0, step };
        let mut touched = 0.0;
        loop {
            run.steps(1);
            let (lower, upper) = (run.particle(0), run.particle(1));
            let overlap = 2.0 * r - (upper.position[2] - lower.position[2]);
            out.overlap = out.overlap.max(overlap);
            out.force = out.force.max(upper.force[2]);
            let touching = !run.snapshot().pairs.is_empty();
            touched += if touching { 1.0 } else { 0.0 };
            out.duration = touched * step;
            if touched > 0.0 && !touching {
                out.restitution = Some((upper.velocity[2] - lower.velocity[2]) / speed);
                return out;
            }
            if touched > 40.0 * self.steps {
                return out;
            }
        }
    }
}

/// A weightless sphere of radius 0.5 and density 1 that has met the plate at (v_x, -v_z) with a spin about y.
fn rebound_from_plate(
    law: &ContactLaw,
    velocity: [f64; 2],
    spin: f64,
    step: f64,
) -> ParticleRecord {
    let mut bench = Bench::new([6.0; 3], [PERIODIC, PERIODIC, PLATE]);
    bench.interface = Some(smooth(law.clone()));
    bench.time_step = step;
    bench.add([3.0, 3.0, 0.5 + 1.0e-5], [velocity[0], 0.0, -velocity[1]], 0.5);
    bench.particles[0].angular_velocity = [0.0, spin, 0.0];
    let mut run = bench.alone();
    let mut touched = false;
    loop {
        run.steps(1);
        let touching = !run.snapshot().walls.is_empty();
        if touched && !touching {
            return run.particle(0);
        }
        touched |= touching;
    }
}
