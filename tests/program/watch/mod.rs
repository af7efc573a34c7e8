//! `talcum watch` on folders made by hand, and on a real run.

mod page;
mod report;
mod terminal;
mod visitors;

use crate::analyse::made::{CASE, Made};
use talcum::analysis::SeriesRow;

/// A bed whose top rises from 40, with rows up to a time.
fn made(last: u32) -> Made {
    let made = Made::of(CASE);
    made.series((0..=last).map(|time| SeriesRow {
        time: f64::from(time),
        grid_pressure_drop: 0.98,
        bed_top: 40.0 + 0.5 * f64::from(time),
        fluctuating_kinetic_energy: 2.0,
        particles: 500.0,
        ..SeriesRow::default()
    }));
    made
}
