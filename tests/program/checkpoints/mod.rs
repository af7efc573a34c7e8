//! Checkpoints are read back unchanged on any number of ranks, and anything else is rejected with a message.

mod former_files;
mod optional_fields;
mod reading_back;
mod refusals;

use bytemuck::Zeroable;
use std::path::Path;
use talcum::output::Provenance;
use talcum::output::checkpoint::{Checkpoint, read};
use talcum::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, WallContactRecord, run_on_threads,
};
use talcum::particles::{ContactState, CustomFields};
use talcum::state::{Clock, Departed, GasReport, SizeRange};
use xxhash_rust::xxh3::xxh3_128;

/// A state of so many particles, of which this rank has every n-th.
fn share(count: u64, step: u64, ranks: &dyn Communicator) -> Checkpoint {
    let mine = |id: &u64| (id + 1) % ranks.size() as u64 == ranks.rank() as u64;
    let particle = |id| {
        let x = id as f64 / 3.0;
        let mut particle: ParticleRecord = Zeroable::zeroed();
        bytemuck::cast_slice_mut::<_, f64>(std::slice::from_mut(&mut particle)).fill(x);
        let species = (id / 10 % 2) as f64;
        let particle = ParticleRecord { id, velocity: [-x, 1.0e-300, -0.0], species, ..particle };
        without_agglomerate(particle)
    };
    let spring = [1.0e-9, -2.0e-9, 0.0];
    let contact = |k: u64| ContactRecord {
        lower: 7 * (k / 3),
        higher: 7 * (k / 3) + 3 - k % 3,
        state: ContactState {
            tangential_spring: spring,
            largest_overlap: k as f64,
            rolling_angle: if k.is_multiple_of(2) { [0.0; 3] } else { [0.1, -0.2, 0.3] },
            twisting_angle: if k.is_multiple_of(3) { 0.0 } else { 0.02 },
        },
    };
    let wall_contact = |k| WallContactRecord {
        particle: k / 2,
        wall: 1 - k % 2,
        facet: (k % 3) as f64,
        state: ContactState {
            tangential_spring: spring,
            largest_overlap: 0.1,
            rolling_angle: [0.0, 0.01, 0.0],
            twisting_angle: -0.03,
        },
    };
    let cell = |cell: u64| CellRecord {
        cell,
        lower_velocity: [0.0, 1.0 / 3.0, 2.0 / 3.0],
        upper_velocity: [1.0, 4.0 / 3.0, 5.0 / 3.0],
        pressure: 2.0,
        voidage: 7.0 / 3.0,
    };
    Checkpoint {
        clock: Clock { step, origin_time: 0.1, origin_step: 1, time_step: 2.5e-4 },
        departed: Departed { count: 2, volume: 1.04 },
        sizes: SizeRange { smallest_diameter: 0.8, largest_diameter: 1.2, largest_mass: 1.7 },
        case_text: "title = \"Grüße\"\n".repeat(if count > 5 { 6000 } else { 1 }),
        case_folder: "/some/where".to_owned(),
        particles: (0..count).map(|k| k * 10).filter(mine).map(particle).collect(),
        custom: CustomFields::default(),
        contacts: (0..count / 2).filter(mine).map(contact).collect(),
        wall_contacts: (0..count / 4).filter(mine).map(wall_contact).collect(),
        cells: (0..count / 3).filter(mine).map(cell).collect(),
        gas_report: GasReport {
            iterations: 7,
            raised_cells: 1,
            courant: 0.2,
            momentum_error: 1.0e-12,
        },
        looked_at: None,
        energy: None,
        instruments: Vec::new(),
    }
}

/// The record of a particle whose drag does not follow from an agglomerate.
fn without_agglomerate(particle: ParticleRecord) -> ParticleRecord {
    ParticleRecord {
        agglomerate_diameter: 0.0,
        agglomerate_packing: 0.0,
        drag_factor: 0.0,
        ..particle
    }
}

fn provenance(ranks: &dyn Communicator) -> Provenance {
    Provenance::here_and_now("A bed", "dimensionless", ranks)
}

/// All ranks' shares as one, sorted.
fn whole(shares: Vec<Checkpoint>) -> Checkpoint {
    let mut shares = shares.into_iter();
    let mut whole = shares.next().unwrap();
    for share in shares {
        assert_eq!(
            (share.clock, share.departed, share.sizes),
            (whole.clock, whole.departed, whole.sizes)
        );
        assert_eq!(share.case_text, whole.case_text);
        whole.particles.extend(share.particles);
        whole.contacts.extend(share.contacts);
        whole.wall_contacts.extend(share.wall_contacts);
        whole.cells.extend(share.cells);
    }
    whole.particles.sort_by_key(|particle| particle.id);
    whole.contacts.sort_by_key(|contact| (contact.lower, contact.higher));
    whole.wall_contacts.sort_by_key(|contact| (contact.particle, contact.wall));
    whole.cells.sort_by_key(|cell| cell.cell);
    whole
}

/// The words in which a file is refused, the same on two ranks.
fn refusal(path: &Path) -> String {
    let refusals = run_on_threads(2, |ranks| read(path, ranks).map(|_| "read").unwrap_err());
    assert_eq!(refusals[0], refusals[1]);
    assert_eq!(refusals[0].path, path);
    refusals[0].message.clone()
}

/// Changes a checkpoint in a way that no damage could, and appends its checksum again.
pub(crate) fn forge(path: &Path, change: impl FnOnce(&hdf5::File)) {
    let bytes = std::fs::read(path).unwrap();
    std::fs::write(path, &bytes[..bytes.len() - 40]).unwrap();
    let file = hdf5::File::open_rw(path).unwrap();
    change(&file);
    file.close().unwrap();
    let mut bytes = std::fs::read(path).unwrap();
    let length = bytes.len() as u64;
    assert!(length < 1 << 22, "one block");
    let hash = xxh3_128(&xxh3_128(&bytes).to_be_bytes());
    bytes.extend_from_slice(b"\nTalcum seal  2\n");
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(&hash.to_be_bytes());
    std::fs::write(path, bytes).unwrap();
}
