//! A custom field, a quantity outside of the crate: heat is conducted between touching spheres.
//!
//! Run it with `cargo build --release --example custom_field` and then
//! `mpirun -n 2 target/release/examples/custom_field results/heat`. It prints the same digest on any number of ranks, and
//! after a restart.
//!
//! The temperature of a particle moves with it from rank to rank, is known to ghosts at each step, and is part of
//! snapshots (`particles.vtkhdf`, for ParaView) and of checkpoints (`/particles/temperature`).

use std::path::Path;
use talcum::contact::{ContactExchange, FrictionCap, LinearSpringDashpot, TouchingParticles};
use talcum::domain::{Face, RankGrid};
use talcum::fields::{Column, Field, Kind, Unit};
use talcum::output::checkpoint::{self, Checkpoint};
use talcum::output::{Head, ParticleSnapshots, Provenance, SnapshotFormat};
use talcum::parallel::{Communicator, MpiRanks, ParticleRecord};
use talcum::particles::Body;
use talcum::setup::{Layers, Run, Setup, Snapshot};
use talcum::state::Physics;

/// Conduction through the contact of two smooth spheres of conductivity k (Batchelor and O'Brien 1977,
/// doi:10.1098/rspa.1977.0100): Q = 2 k a (T_1 - T_2), with the radius of the contact a = sqrt(delta r*).
#[derive(Debug)]
struct Conduction {
    /// k, heat per time, length and temperature.
    conductivity: f64,
    /// c, heat per mass and temperature.
    heat_capacity: f64,
}

impl ContactExchange for Conduction {
    fn field(&self) -> Field {
        Field::new("temperature", Kind::Number, Unit::Named("K"), "temperature of the particle")
    }

    fn flow(&self, contact: &TouchingParticles, [first, second]: [f64; 2]) -> f64 {
        let radius = (contact.overlap.max(0.0) * contact.reduced_radius).sqrt();
        2.0 * self.conductivity * radius * (first - second)
    }

    /// Of 10,000 K between spheres that touch over a radius of 1.
    fn largest_flow(&self) -> f64 {
        2.0e4 * self.conductivity
    }

    /// dT/dt = Q / (m c).
    fn rate(&self, particle: &Body, inflow: f64) -> f64 {
        inflow / (particle.mass * self.heat_capacity)
    }
}

/// A bed that settles; its lower half is hot at the start.
fn setup() -> Result<Setup, Box<dyn std::error::Error>> {
    let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.7, 0.3, FrictionCap::Contact)?;
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];
    let layers = Layers { count: 300, spacing: 1.1, jitter: 0.04, seed: 1, ..Layers::default() };
    let temperature =
        |particle: &ParticleRecord| if particle.position[2] < 4.0 { 400.0 } else { 300.0 };
    Ok(Setup::new([6.0, 6.0, 30.0], faces, Physics::new(law, 4.0e-4))?
        .gravity(1.0)
        .layers(&layers)
        .exchange(Conduction { conductivity: 20.0, heat_capacity: 1.0 }, temperature))
}

/// Adds the particles of this rank, with their temperatures, to a file of snapshots. Collective.
fn write_snapshot(
    file: &mut ParticleSnapshots,
    run: &Run,
) -> Result<(), Box<dyn std::error::Error>> {
    let particles: Vec<ParticleRecord> = run.particles().collect();
    let temperatures = run.state.particles.custom_fields().column(0);
    Ok(file.append(run.time(), &particles, &[temperatures], run.ranks)?)
}

/// This rank's part of a state as a checkpoint without a case.
fn checkpoint_of(part: Snapshot) -> Checkpoint {
    Checkpoint {
        clock: part.clock,
        departed: part.departed,
        sizes: part.sizes,
        case_text: String::new(),
        case_folder: String::new(),
        particles: part.particles,
        custom: part.custom,
        contacts: part.pairs,
        wall_contacts: part.walls,
        cells: part.cells,
        gas_report: part.gas_report,
        looked_at: part.looked_at,
        energy: None,
        instruments: Vec::new(),
    }
}

/// This rank's part of the state in a checkpoint.
fn snapshot_of(part: Checkpoint) -> Snapshot {
    Snapshot {
        clock: part.clock,
        departed: part.departed,
        sizes: part.sizes,
        particles: part.particles,
        custom: part.custom,
        pairs: part.contacts,
        walls: part.wall_contacts,
        cells: part.cells,
        gas_report: part.gas_report,
        looked_at: part.looked_at,
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder for the results")?;
    let ranks = MpiRanks::start()?;
    std::fs::create_dir_all(&folder)?;
    let (setup, grid) = (setup()?, RankGrid::slabs(1, ranks.size()));

    let provenance = Provenance::here_and_now("heat", "dimensionless", &ranks);
    let head = Head { case_text: "", provenance: &provenance };
    let field = Conduction { conductivity: 20.0, heat_capacity: 1.0 }.field();
    let format =
        SnapshotFormat { columns: vec![Column::of_field(&field)], ..SnapshotFormat::default() };
    let path = Path::new(&folder).join("particles.vtkhdf");
    let mut snapshots = ParticleSnapshots::open(&path, &format, head, None, &ranks)?;

    let mut run = setup.start(grid, &ranks)?;
    run.steps(10_000)?;
    write_snapshot(&mut snapshots, &run)?;

    // A checkpoint in the middle, from which the run is continued.
    let path = Path::new(&folder).join("middle.h5");
    checkpoint::write(
        &path,
        &checkpoint_of(run.snapshot()?.share_of(&ranks)),
        &provenance,
        &ranks,
    )?;
    drop(run);
    let (middle, ..) = checkpoint::read(&path, &ranks)?;
    let mut run = setup.resume(&snapshot_of(middle).gathered(&ranks), grid, &ranks)?;
    run.steps(10_000)?;
    write_snapshot(&mut snapshots, &run)?;

    // Each particle has the same heat capacity: the sum of temperatures is the heat of the bed.
    let mut heat = [run.state.particles.custom_fields().column(0).iter().sum::<f64>() as i64];
    ranks.sum_integers(&mut heat);
    let digest = run.digest()?;
    if ranks.is_root() {
        println!("mean temperature {:.0} K", heat[0] as f64 / 300.0);
        println!("digest {digest}");
    }
    Ok(())
}
