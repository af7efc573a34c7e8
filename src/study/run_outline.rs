//! What is known of a run from its case.

use std::collections::BTreeMap;

/// What is known of a run before it begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RunOutline {
    /// When it ends.
    pub(crate) end_time: f64,
    /// Its sections `[measure.NAME]`, each with the names of its numbers.
    pub(crate) measures: BTreeMap<String, Vec<&'static str>>,
    /// Measures of `talcum analyse` that find nothing on it, and why.
    pub(crate) impossible: BTreeMap<&'static str, String>,
}
