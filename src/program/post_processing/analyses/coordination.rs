//! Coordination numbers, from checkpoints.

use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured};
use rustc_hash::FxHashMap;
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::{Coordination, NoValue};
use talcum_results::output::checkpoint::Checkpoint;
use talcum_results::output::{Cells, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "coordination",
    title: "Coordination number of the last checkpoint that counts",
    scalars: || vec![MEAN, ALONE],
    of_case: |_| Ok(()),
    find,
};

const MEAN: Kind =
    Kind::number("mean", Unit::One, "mean number of touching particles of a particle");
const ALONE: Kind =
    Kind::number("rattlers", Unit::One, "part of the particles that touch no other");

/// Number of neighbours from which particles are counted together: no more fit around a sphere of equal size.
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
        vec![Column::numbers("time", results.units().of(Unit::Time), "of the checkpoint", times)];
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

/// Coordination numbers from a checkpoint, which contains each touching pair once.
fn of_checkpoint(checkpoint: &Checkpoint) -> Coordination {
    let mut numbers: FxHashMap<u64, u32> =
        checkpoint.particles.iter().map(|particle| (particle.id, 0)).collect();
    for contact in &checkpoint.contacts {
        for id in [contact.lower, contact.higher] {
            numbers.entry(id).and_modify(|number| *number += 1);
        }
    }
    Coordination::of(numbers.into_values(), MOST)
}
