//! Reads a checkpoint of a run and prints its time, its particles and its digest.
//!
//! Run it with `cargo run --release --example read_checkpoint -- results/CASE/checkpoint-000000600000.h5`.

use std::path::Path;
use talcum::output::checkpoint;
use talcum::parallel::OneRank;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The first word after `--` on the command line is the name of the checkpoint.
    let path = std::env::args().nth(1).ok_or("give the name of a checkpoint")?;

    // A damaged file is refused: the checksum of the file and the digest of the state must be right.
    let (state, _written_by, digest) = checkpoint::read(Path::new(&path), &OneRank)?;

    println!("# time {}", state.clock.time());
    println!("# id, radius, position, velocity");
    for particle in &state.particles {
        let [x, y, z] = particle.position;
        let [u, v, w] = particle.velocity;
        println!("{} {} {x} {y} {z} {u} {v} {w}", particle.id, particle.radius);
    }
    println!("digest {digest}");
    Ok(())
}
