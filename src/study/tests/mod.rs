//! Studies as a whole, with runs that are made up.

mod expansion;
mod fakes;
mod known;
mod refusals;
mod scheduler_files;
mod start;
mod work;
