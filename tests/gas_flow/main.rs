//! The gas in three dimensions, alone: exact answers, orders of convergence, published numbers, one answer.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

mod cavity;
mod driver;
mod exact;
mod fixed_bed;
mod jet;
mod manufactured;
mod manufactured_in_space;
mod outlet;
mod ranks;
mod source;
mod taylor_green;
