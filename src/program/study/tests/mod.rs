//! Studies as a whole, with simulated runs.

mod expansion;
mod fakes;
mod known;
mod refusals;
mod scheduler_files;
mod start;
mod work;
