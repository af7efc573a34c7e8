//! The gas in three dimensions, alone: exact answers, orders of convergence, published numbers, one answer.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

mod cavity;
mod driver;
mod exact;
mod manufactured;
mod ranks;
mod taylor_green;
