//! `talcum info`.

use super::report::count_of;
use super::run::say;
use crate::output::checkpoint;
use crate::parallel::Communicator;
use std::fmt::Write;
use std::path::Path;

/// Describes what is in a checkpoint; the last line is the digest of its state.
pub(super) fn info(path: &Path, ranks: &dyn Communicator) -> anyhow::Result<()> {
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
    line("left the box", checkpoint.departed.count.to_string());
    line("contacts", format!("{contacts} between particles, {at_walls} with walls"));
    line("diameters at the start", diameters(sizes.smallest_diameter, sizes.largest_diameter));
    line("written by", format!("talcum {}, commit {}", provenance.version, provenance.commit));
    line("on", format!("{}, {}", count_of(provenance.ranks as usize, "rank"), provenance.machine));
    line("date", provenance.date);
    say(ranks, &format!("{message}digest {digest}"));
    Ok(())
}

fn diameters(smallest: f64, largest: f64) -> String {
    if smallest == largest { smallest.to_string() } else { format!("{smallest} to {largest}") }
}
