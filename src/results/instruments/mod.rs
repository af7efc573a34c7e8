//! Instruments that sample a run: `[measure.NAME]` of a case.
//!
//! An [`Instrument`] samples the state at its interval, keeps sums, and returns the results to be written;
//! it does not handle files. `output/instrument_file.rs` writes the data that it declares in its [`Layout`], and
//! checkpoints contain the data that it [stores](Instrument::stored). Formulas are those of [`analysis`](crate::analysis).
//!
//! A new kind is a file with its settings ([`RegisteredInstrument`]) and its instrument, its `mod` line, and its line in the
//! registry below.

mod average;
mod instrument;
mod layout;
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

pub use instrument::{CellValues, ContactLine, Instrument, Needs, Readings, Setting};
pub use layout::{Image, Layout, Rows, Table};
pub use plan::{InstrumentPlan, table_file_name};
pub use registered::{InstrumentValues, RegisteredInstrument};
pub use stored::{InstrumentState, Stored, StoredTable, WIDEST};
pub use view::View;

// The name of the file is the name of the kind in a case. These lines define the enum `InstrumentKind`, the words of
// `measure.NAME.kind`, their keys, and the reference in docs/input.md.
instrument_kinds! {
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
