//! The commands of the program `talcum`. The crate `talcum` shows these modules as its own.

pub mod command_line;
pub mod post_processing;
pub mod study;
