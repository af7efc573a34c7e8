//! Estimate of the memory that a case needs, before any of it is allocated, and the free memory of the machines.

use anyhow::bail;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs::read_to_string;
use talcum_engine::parallel::Communicator;
use talcum_runs::case::{Amount, BedStart, Case};

/// Total bytes per particle: columns, ghosts, lists and contacts of a settled bed.
const PER_PARTICLE: f64 = 600.0;
/// Bytes per cell of a volume-averaged gas: its fields, those of its steps, and the levels of the multigrid (measured
/// from 32^3 to 96^3).
const PER_CELL: f64 = 550.0;
/// Bytes per process: the program, MPI, HDF5.
const PER_PROCESS: f64 = 50.0e6;
/// Solids fraction of a random packing: an upper bound for a bed that is given by its height.
const PACKED: f64 = 0.64;

/// Total memory that a case needs, in bytes; the number of particles from a file is not known yet.
pub(super) fn needed(case: &Case, particles: Option<f64>, ranks: &dyn Communicator) -> f64 {
    let particles = particles.unwrap_or_else(|| expected_particles(case));
    let cells = case
        .volume_averaged()
        .map_or(0.0, |model| model.grid.counts().iter().map(|&count| count as f64).product());
    particles * PER_PARTICLE + cells * PER_CELL + ranks.processes() as f64 * PER_PROCESS
}

fn expected_particles(case: &Case) -> f64 {
    match (&case.particles.start, case.particles.amount) {
        (BedStart::Lattice { .. } | BedStart::Random { .. }, Some(Amount::Count(count))) => {
            count as f64
        }
        (_, Some(Amount::FillHeight(height))) => {
            let height = height.min(case.domain.bounds.lengths().z);
            let sphere = PI / 6.0 * case.particles.reference_diameter.powi(3);
            PACKED * case.domain.cross_section() * height / sphere
        }
        _ => 0.0,
    }
}

/// Refuses a case that exceeds the memory of the machines. Collective.
pub(super) fn require(
    case: &Case,
    any_memory: bool,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let (needed, free) = (needed(case, None, ranks), free_on_all(ranks));
    if any_memory || free.is_none_or(|free| needed <= free) {
        return Ok(());
    }
    bail!(
        "the case needs about {:.1} GB of memory, and {:.1} GB are free here: use more machines, or run it \
         anyway with --any-memory",
        1.0e-9 * needed,
        1.0e-9 * free.unwrap_or_default()
    )
}

/// Free memory of all machines that have a rank, in bytes; `None` if it is not known. Equal on all ranks.
fn free_on_all(ranks: &dyn Communicator) -> Option<f64> {
    let host = read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let here = format!("{}\n{}", host.trim(), free_here().unwrap_or(f64::NAN));
    let gathered = ranks.gather_to_root(here.as_bytes()).unwrap_or_default();
    let mut by_host = BTreeMap::new();
    for text in gathered.iter().map(|bytes| String::from_utf8_lossy(bytes)) {
        let (host, free) = text.split_once('\n').unwrap_or_default();
        by_host.insert(host.to_owned(), free.parse::<f64>().unwrap_or(f64::NAN));
    }
    let mut sum = [if ranks.is_root() { by_host.values().sum() } else { f64::NEG_INFINITY }];
    ranks.maximum(&mut sum);
    sum[0].is_finite().then_some(sum[0])
}

/// Free memory of this machine, or of the process group that a batch system has made for the job.
fn free_here() -> Option<f64> {
    let table = read_to_string("/proc/meminfo").ok()?;
    let line = table.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let machine = 1024.0 * line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()?;
    let number = |name: &str| {
        read_to_string(format!("/sys/fs/cgroup/memory.{name}")).ok()?.trim().parse::<f64>().ok()
    };
    let group = number("max").zip(number("current")).map(|(most, used)| most - used);
    Some(group.map_or(machine, |group| machine.min(group)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::parallel::run_on_threads;

    #[test]
    fn machines_are_counted_once_whatever_their_ranks() {
        let alone = run_on_threads(1, free_on_all)[0].unwrap();
        let shared = run_on_threads(3, free_on_all);
        // The free memory changes between two checks, but by far less than the memory of a machine.
        assert!(shared.iter().all(|free| *free == shared[0]));
        assert!((shared[0].unwrap() / alone - 1.0).abs() < 0.5);
    }
}
