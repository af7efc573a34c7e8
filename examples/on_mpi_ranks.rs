//! A bed on MPI ranks: the same digest on any number of them.
//!
//! Run it with `cargo build --release --example on_mpi_ranks` and then
//! `mpirun -n 2 target/release/examples/on_mpi_ranks`.

use talcum::contact::{FrictionCap, LinearSpringDashpot};
use talcum::domain::{Face, RankGrid};
use talcum::parallel::{Communicator, MpiRanks};
use talcum::setup::{Layers, Setup};
use talcum::state::Physics;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Starts MPI; it ends when `ranks` goes out of scope, at the end of this function.
    let ranks = MpiRanks::start()?;

    // Every rank builds the same setup, dimensionless as in the example `run_a_bed`, and keeps its share of the
    // particles.
    let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.7, 0.3, FrictionCap::Contact)?;
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];
    let layers = Layers { count: 300, spacing: 1.2, jitter: 0.05, seed: 1, ..Layers::default() };
    let setup = Setup::new([6.0, 6.0, 30.0], faces, Physics::new(law, 4.0e-4))?;

    // The ranks divide the box along y (axis 1): a bed has particles at each y, but not at each height.
    let grid = RankGrid::slabs(1, ranks.size());
    let mut run = setup.gravity(1.0).layers(&layers).start(grid, &ranks)?;

    run.steps(2000)?;

    // All ranks call a collective method, also if only one of them prints the result.
    let (count, digest) = (run.particle_count(), run.digest()?);
    if ranks.is_root() {
        println!("{count} particles on {} ranks", ranks.size());
        println!("digest {digest}");
    }
    Ok(())
}
