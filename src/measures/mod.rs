//! Measures that sample a run: `[measure.NAME]` of a case.
//!
//! A measure is a [`Measure`]: it looks at the state at its interval, keeps sums, and says what is to be written; it
//! knows no files. `output/measure_file.rs` writes what it declares in its [`Layout`], checkpoints keep what it
//! [stores](Measure::stored). Formulas are those of [`analysis`](crate::analysis).
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

// The name of the file is the name of the kind in a case. From these lines follow the enum `MeasureKind`, the words of
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
