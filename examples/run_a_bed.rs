//! A bed from Rust: 300 cohesionless spheres fall onto a plate, and their mean height is printed over time.
//!
//! Run it with `cargo run --release --example run_a_bed`.

use talcum::contact::{FrictionCap, LinearSpringDashpot};
use talcum::domain::Face;
use talcum::setup::{Layers, Run, Setup};
use talcum::state::Physics;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Dimensionless: density of the solid, diameter and gravity are 1, so that time is in units of sqrt(d / g).
    // Contact: normal and tangential stiffness, restitution, friction. The `?` after a call hands an error on to who
    // called, here to the end of the program, which prints it.
    let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.7, 0.3, FrictionCap::Contact)?;

    // What acts on the particles, and the length of a step, here a fortieth of the duration of a contact.
    let physics = Physics::new(law, 4.0e-4);

    // The box: periodic along x and y; a plate below, and nothing above.
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];

    // The particles: layers of a lattice, each particle a little off its site.
    let layers = Layers { count: 300, spacing: 1.2, jitter: 0.05, seed: 1, ..Layers::default() };

    let mut run =
        Setup::new([6.0, 6.0, 30.0], faces, physics)?.gravity(1.0).layers(&layers).start_alone()?;

    println!("time  mean height");
    for _ in 0..20 {
        println!("{:4.1}  {:.4}", run.time(), mean_height(&run));
        run.steps(500)?;
    }
    println!("{:4.1}  {:.4}", run.time(), mean_height(&run));

    // A hash of the whole state: two runs of the same digest are the same in every bit.
    println!("digest {}", run.digest()?);
    Ok(())
}

/// Mean height of the centres.
fn mean_height(run: &Run) -> f64 {
    let heights: f64 = run.particles().map(|particle| particle.position[2]).sum();
    heights / run.particles().count() as f64
}
