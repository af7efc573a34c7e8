//! `talcum analyse` on results folders made by hand, for which the results are known, and on real runs.

mod command;
mod fields;
pub(crate) mod made;
mod particles;
