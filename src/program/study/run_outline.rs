//! Data on a run from its case.

use std::collections::BTreeMap;

/// Data on a run before it begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RunOutline {
    /// Time at which it ends.
    pub(crate) end_time: f64,
    /// Its sections `[measure.NAME]`, each with the names of its numbers.
    pub(crate) instruments: BTreeMap<String, Vec<String>>,
    /// Measures of `talcum analyse` that find nothing on it, with the reasons.
    pub(crate) impossible: BTreeMap<&'static str, String>,
}
