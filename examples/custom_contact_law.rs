//! A custom contact law, outside of the crate: `cargo run --release --example custom_contact_law`.
//!
//! The law is a linear spring without dashpot and friction. Two particles meet head on; without a dashpot they must
//! separate with the speed at which they met.

#![allow(missing_docs, reason = "an example is not an interface")]

use nalgebra::Vector3;
use std::error::Error;
use std::f64::consts::PI;
use talcum::contact::{Contact, ContactForce, ContactForceLaw, ContactLaw, InvalidContactLaw};
use talcum::domain::Face;
use talcum::particles::ContactHistory;
use talcum::setup::{Setup, Sphere};
use talcum::state::Physics;

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
        let (parameter, allowed) = ("normal_stiffness", "positive".to_owned());
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

/// Lets two particles of diameter and density 1 meet head on in a box without walls; returns the speed at which they
/// separate.
fn speed_of_rebound(law: LinearSpring, speed: f64) -> Result<f64, Box<dyn Error>> {
    let dt = law.contact_duration(0.5 * PI / 6.0, 0.25) / 200.0;
    let law = ContactLaw::custom("linear_spring", law);
    let sphere = |x: f64, along_x: f64| Sphere {
        position: [x, 2.0, 2.0],
        velocity: [along_x, 0.0, 0.0],
        radius: 0.5,
        density: 1.0,
    };
    let mut run = Setup::new([4.0; 3], [[Face::Open; 2]; 3], Physics::new(law, dt))?
        .particle(sphere(1.0, 0.5 * speed))
        .particle(sphere(2.001, -0.5 * speed))
        .start_alone()?;
    run.steps(400)?;
    let velocity = |id: u64| run.particle(id).map(|particle| particle.velocity[0]);
    let (one, other) = velocity(0).zip(velocity(1)).ok_or("a particle has left the box")?;
    Ok(other - one)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (stiffness, speed) = (1.0e5, 2.0);
    let found = speed_of_rebound(LinearSpring::new(stiffness)?, speed)?;
    println!("met at a speed of {speed}, separated at {found:.6}");
    // The integrator's error over a collision of 200 steps is of order (pi / 200)^2.
    if (found / speed - 1.0).abs() > 1.0e-3 {
        return Err(format!("a spring without dashpot must return the speed, not {found}").into());
    }
    Ok(())
}
