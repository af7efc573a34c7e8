//! A contact law of your own, outside of the crate: `cargo run --release --example own_contact_law`.
//!
//! The law is a linear spring without dashpot and friction. Two particles meet head on; without a dashpot they must
//! separate with the speed at which they met.

#![allow(missing_docs, reason = "an example is not an interface")]

use nalgebra::Vector3;
use std::error::Error;
use std::f64::consts::PI;
use talcum::contact::{
    Contact, ContactForce, ContactForceLaw, ContactLaw, ContactModel, ForceLaws, InvalidContactLaw,
    add_pair_forces,
};
use talcum::domain::PosedWalls;
use talcum::numbers::Quantum;
use talcum::particles::{
    ContactHistories, ContactHistory, Contacts, DriftStep, InteractionRanges, ListRange,
    NeighbourList, Particles, Weight, kick, kick_and_drift,
};

/// F_n = k_n delta.
#[derive(Debug)]
struct LinearSpring {
    /// Stiffness k_n, force per overlap.
    stiffness: f64,
}

impl LinearSpring {
    /// Makes a law from its stiffness k_n.
    ///
    /// # Errors
    /// If the stiffness is not positive: a law cannot exist with parameters that have no meaning.
    fn new(stiffness: f64) -> Result<Self, InvalidContactLaw> {
        if stiffness > 0.0 {
            return Ok(Self { stiffness });
        }
        let (parameter, allowed) = ("normal_stiffness", "positive");
        Err(InvalidContactLaw { parameter, value: stiffness, allowed })
    }
}

impl ContactForceLaw for LinearSpring {
    #[inline(always)]
    fn force(&self, contact: &Contact, _: &mut ContactHistory, _dt: f64) -> ContactForce {
        let normal = self.stiffness * contact.overlap;
        ContactForce { normal, tangential: Vector3::zeros(), friction_normal: normal.abs() }
    }

    fn stiffness(&self, _overlap: f64, _reduced_radius: f64) -> f64 {
        self.stiffness
    }

    /// pi sqrt(m* / k_n), half a period of the oscillator.
    fn contact_duration(&self, reduced_mass: f64, _reduced_radius: f64) -> f64 {
        PI * (reduced_mass / self.stiffness).sqrt()
    }

    fn largest_force(&self, overlap: f64, _reduced_radius: f64) -> f64 {
        self.stiffness * overlap
    }
}

/// Two particles of this mass and radius 1/2 that meet head on; the speed at which they separate.
fn speed_of_rebound(law: LinearSpring, mass: f64, speed: f64) -> Result<f64, Box<dyn Error>> {
    let dt = law.contact_duration(0.5 * mass, 0.25) / 200.0;
    let limit = law.largest_force(0.2, 0.25);
    let quantum = Quantum::spanning(64.0 * limit);
    let contact = ContactModel { law: ContactLaw::custom("linear_spring", law), rolling: None };
    let laws = ForceLaws {
        contact: &contact,
        at_walls: &[],
        cohesion: None,
        ranges: InteractionRanges::default(),
        dt,
        limit,
        force_quantum: quantum,
        torque_quantum: quantum,
    };
    let mut particles = Particles::default();
    particles.push(0, Vector3::zeros(), Vector3::x() * (0.5 * speed), 0.5, mass);
    particles.push(1, Vector3::x() * 1.001, Vector3::x() * (-0.5 * speed), 0.5, mass);
    // One list for the whole collision: its range covers all that the particles can move.
    let (mut contacts, range) = (Contacts::default(), ListRange { interaction: 0.0, skin: 1.0 });
    NeighbourList::default().rebuild(
        &particles,
        &mut contacts,
        PosedWalls { walls: &[], poses: &[] },
        range,
        &ContactHistories::default(),
    )?;
    let step =
        DriftStep { dt, quantum: Quantum::spanning(4.0), weight: Weight { gravity: 0.0, quantum } };
    for _ in 0..400 {
        contacts.moved(kick_and_drift(&mut particles, None, step));
        add_pair_forces(&mut particles, &mut contacts, &laws)?;
        kick(&mut particles, dt);
    }
    Ok(particles.body[1].velocity.x - particles.body[0].velocity.x)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (stiffness, mass, speed) = (1.0e5, 0.5, 2.0);
    let found = speed_of_rebound(LinearSpring::new(stiffness)?, mass, speed)?;
    println!("met at a speed of {speed}, separated at {found:.6}");
    // The integrator's error over a collision of 200 steps is of order (pi / 200)^2.
    if (found / speed - 1.0).abs() > 1.0e-3 {
        return Err(format!("a spring without dashpot must return the speed, not {found}").into());
    }
    Ok(())
}
