//! Coordination numbers, from checkpoints.

use crate::analysis::{Coordination, InRegion, NoValue, Pair, Quantity, coordination};
use crate::output::checkpoint::Checkpoint;
use crate::output::{Cells, Column, ResultTable};
use crate::parallel::OneRank;
use crate::post_processing::{Findings, Kind, Measure, Results, Unmeasured};

pub(super) const MEASURE: Measure = Measure {
    name: "coordination",
    title: "Coordination number of the last checkpoint that counts",
    scalars: || vec![MEAN, ALONE],
    of_case: |_| Ok(()),
    find,
};

const MEAN: Kind =
    Kind::number("mean", Quantity::Number, "mean number of touching particles of a particle");
const ALONE: Kind =
    Kind::number("rattlers", Quantity::Number, "part of the particles that touch no other");

/// As many neighbours or more are counted together: no more fit around a sphere of equal size.
const MOST: usize = 12;

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let mut rows = Vec::new();
    for path in results.checkpoints()? {
        if let Some(checkpoint) = results.checkpoint(path)? {
            rows.push((checkpoint.clock.time(), of_checkpoint(&checkpoint)));
        }
    }
    let Some((_, last)) = rows.last() else {
        return Err(NoValue::because("no checkpoint is of these times").into());
    };
    let mut found = Findings::new(results.units());
    found.add(&MEAN, last.mean());
    found.add(&ALONE, last.fractions()[0]);
    let times = rows.iter().map(|(time, _)| *time).collect();
    let mut columns =
        vec![Column::numbers("time", results.units().time, "of the checkpoint", times)];
    let means = rows.iter().map(|(_, found)| found.mean()).collect();
    columns.push(Column::numbers("mean", "1", MEAN.meaning, means));
    for neighbours in 0..=MOST {
        let counts = rows.iter().map(|(_, found)| found.particles[neighbours]).collect();
        let about = "particles with so many neighbours; the last column holds those with more, too";
        columns.push(Column::new(&format!("neighbours_{neighbours}"), about, Cells::Whole(counts)));
    }
    found.tables.push(ResultTable::new("coordination/times", columns));
    Ok(found)
}

fn of_checkpoint(checkpoint: &Checkpoint) -> Coordination {
    let particle = |id: u64| InRegion { id, region: u64::MAX };
    let particles: Vec<InRegion> =
        checkpoint.particles.iter().map(|record| particle(record.id)).collect();
    let contacts = checkpoint.contacts.iter();
    let touching: Vec<Pair> =
        contacts.map(|contact| Pair::of(contact.lower, contact.higher)).collect();
    let mut found = coordination(&particles, &touching, 0, MOST, &OneRank);
    found.swap_remove(0)
}
