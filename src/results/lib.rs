//! What Talcum reads off a state, and the files that it writes. The crate `talcum` shows these modules as its own.

pub mod analysis;
pub mod instruments;
pub mod output;
