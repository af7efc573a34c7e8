//! A custom table: number of particles that touch the plate, and kinetic energy, at intervals.
//!
//! Run it with `cargo run --release --example custom_output -- table.csv`.

use std::fs::File;
use std::io::{BufWriter, Write};
use talcum::contact::{FrictionCap, LinearSpringDashpot};
use talcum::domain::Face;
use talcum::setup::{Layers, Run, Setup};
use talcum::state::Physics;

/// Steps between two rows.
const INTERVAL: u64 = 250;
/// Number of rows after the first.
const ROWS: u64 = 20;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The first word after `--` on the command line is the name of the file.
    let path = std::env::args().nth(1).ok_or("give the name of the table")?;
    let mut table = BufWriter::new(File::create(path)?);

    let mut run = bed()?;
    writeln!(table, "time,touching,kinetic_energy")?;
    write_row(&mut table, &mut run)?;
    for _ in 0..ROWS {
        run.steps(INTERVAL)?;
        write_row(&mut table, &mut run)?;
    }
    // Writes what is still in memory; an error of the disk ends the program here.
    table.flush()?;
    Ok(())
}

/// 200 spheres above a plate; dimensionless, as in the example `run_a_bed`.
fn bed() -> Result<Run<'static>, Box<dyn std::error::Error>> {
    let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.7, 0.3, FrictionCap::Contact)?;
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];
    let layers = Layers { count: 200, spacing: 1.2, jitter: 0.05, seed: 2, ..Layers::default() };
    let setup = Setup::new([6.0, 6.0, 30.0], faces, Physics::new(law, 4.0e-4))?;
    Ok(setup.gravity(1.0).layers(&layers).start_alone()?)
}

/// A row: the time, the number of particles that touch the plate, and the kinetic energy of all of them, without that
/// of rotation.
fn write_row(table: &mut impl Write, run: &mut Run) -> Result<(), Box<dyn std::error::Error>> {
    // The whole state has a record for each contact with a wall; the plate is the only wall here.
    let touching = run.snapshot()?.walls.len();
    let energy: f64 = run
        .particles()
        .map(|particle| {
            let [x, y, z] = particle.velocity;
            0.5 * particle.mass * (x * x + y * y + z * z)
        })
        .sum();
    writeln!(table, "{},{touching},{energy:e}", run.time())?;
    Ok(())
}
