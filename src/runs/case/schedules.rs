//! Numbers that change with time.

use crate::input::{Node, Section};
use std::ops::Range;
use talcum_engine::numbers::Schedule;

/// The schedule of a key: a number, or a table whose times are counted from the start of the stage that sets it.
pub(super) fn read_schedule(
    section: &Section<'_>,
    name: &str,
    stages: &[Range<f64>],
) -> Option<Schedule> {
    let Some(table) = section.table(name) else {
        return section.number(name).map(Schedule::Constant);
    };
    let Range { start, end } = stages[table.node.stage].clone();
    match table.given(&["from", "values", "mean"])? {
        "from" => {
            let (from, to) = (table.number("from")?, table.number("to")?);
            Some(Schedule::Ramp { from, to, start, end })
        }
        "values" => {
            let (values, every) = (table.numbers("values")?, table.number("every")?);
            Some(Schedule::Steps { values, start, every })
        }
        _ => {
            let (mean, amplitude) = (table.number("mean")?, table.number("amplitude")?);
            Some(Schedule::Sine { mean, amplitude, frequency: table.number("frequency")?, start })
        }
    }
}

/// Start of the stage that sets a key.
pub(super) fn start_of(node: &Node, name: &str, stages: &[Range<f64>]) -> Option<f64> {
    node.get(name).map(|node| stages[node.stage].start)
}
