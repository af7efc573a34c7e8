//! `talcum analyse` on results folders that were made by hand, so that the answers are known, and on real runs.

mod command;
mod fields;
pub(crate) mod made;
mod particles;
