//! Measures that sample a run: `[measure.NAME]` of a case.
//!
//! A measure is a [`Measure`]: it samples the state at its interval, keeps sums, and returns the results to be written;
//! it does not handle files. `output/measure_file.rs` writes the data that it declares in its [`Layout`], and
//! checkpoints contain the data that it [stores](Measure::stored). Formulas are those of [`analysis`](crate::analysis).
//!
//! A new kind is a file with its settings ([`RegisteredMeasure`]) and its measure, its `mod` line, and its line in the
//! registry below.

mod average;
mod layout;
mod measure;
mod plan;
mod registered;
mod stored;
mod view;
#[macro_use]
mod registry;

mod agglomerates;
mod cell_sums;
mod clusters;
mod contacts;
mod coordination;
mod mixing;
mod phase_average;
mod probe;
mod stress;
mod time_average;

pub use layout::{Column, Fixed, Image, Layout, Rows, Table};
pub use measure::{CellValues, ContactLine, Findings, Measure, Needs, Setting};
pub use plan::{MeasurePlan, table_file_name};
pub use registered::{MeasureValues, RegisteredMeasure};
pub use stored::{MeasureState, Stored, StoredTable, WIDEST};
pub use view::View;

// The name of the file is the name of the kind in a case. These lines define the enum `MeasureKind`, the words of
// `measure.NAME.kind`, their keys, and the reference in docs/input.md.
measure_kinds! {
    coordination::Coordination,
    agglomerates::Agglomerates,
    contacts::Contacts,
    stress::Stress,
    phase_average::PhaseAverages,
    mixing::Mixing,
    probe::Probe,
    time_average::TimeAverage,
    clusters::Clusters,
}
