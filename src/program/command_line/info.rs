//! `talcum info`: description of a checkpoint, or of the program itself.

use super::report::count_of;
use super::run::say;
use std::fmt::Write;
use std::path::Path;
use talcum_engine::numbers::instruction_set;
use talcum_engine::parallel::{Communicator, mpi_library};
use talcum_engine::state::Departed;
use talcum_results::output::{checkpoint, commit, hdf5_version};

/// Describes how the program was built.
pub(super) fn of_program(ranks: &dyn Communicator) -> anyhow::Result<()> {
    let mut message = format!("talcum {}\n", env!("CARGO_PKG_VERSION"));
    let ranks_are = match mpi_library() {
        Some(library) => format!("processes of MPI ({library}), or threads (--threads N)"),
        None => "threads (--threads N); built without MPI".to_owned(),
    };
    let entries = [
        ("commit", commit().to_owned()),
        ("ranks", ranks_are),
        ("HDF5", hdf5_version()),
        (
            "processor",
            format!("{}, vectors of {}", std::env::consts::ARCH, instruction_set().name()),
        ),
    ];
    for (name, entry) in entries {
        let _ = writeln!(message, "  {name:<24}{entry}");
    }
    say(ranks, message.trim_end())
}

/// Describes the contents of a checkpoint; the last line is the digest of its state.
pub(super) fn of_checkpoint(path: &Path, ranks: &dyn Communicator) -> anyhow::Result<()> {
    let (checkpoint, provenance, digest) = checkpoint::read(path, ranks)?;
    let particles = ranks.total(checkpoint.particles.len());
    let contacts = ranks.total(checkpoint.contacts.len());
    let at_walls = ranks.total(checkpoint.wall_contacts.len());
    let clock = &checkpoint.clock;
    let sizes = &checkpoint.sizes;
    let mut message = format!("{}: a Talcum checkpoint, whole\n", path.display());
    let mut line = |name: &str, value: String| {
        let _ = writeln!(message, "  {name:<24}{value}");
    };
    line("case", provenance.title);
    line("units", provenance.units);
    line(
        "time",
        format!("{} (step {}, step length {})", clock.time(), clock.step, clock.time_step),
    );
    line("particles", particles.to_string());
    for counter in Departed::COUNTERS {
        let [group, name] = counter.place;
        let value = (counter.get)(&checkpoint.departed);
        line(&format!("{} {name}", &group[1..]), format!("{value} ({})", counter.meaning));
    }
    for field in &checkpoint.custom.fields {
        line(field.name, format!("custom field: {}", field.meaning));
    }
    line("contacts", format!("{contacts} between particles, {at_walls} with walls"));
    line("diameters at the start", diameters(sizes.smallest_diameter, sizes.largest_diameter));
    line("written by", format!("talcum {}, commit {}", provenance.version, provenance.commit));
    let ranks_are = provenance.ranks_are.map(|kind| format!(" ({kind})")).unwrap_or_default();
    let count = count_of(provenance.ranks as usize, "rank");
    line("on", format!("{count}{ranks_are}, {}", provenance.machine));
    line("date", provenance.date);
    say(ranks, &format!("{message}digest {digest}"))
}

fn diameters(smallest: f64, largest: f64) -> String {
    if smallest == largest { smallest.to_string() } else { format!("{smallest} to {largest}") }
}
