//! Studies as a whole, with runs that are made up.

mod expansion;
mod fakes;
mod known;
mod refusals;
mod start;
mod work;
