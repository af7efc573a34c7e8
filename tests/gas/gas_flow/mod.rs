//! The volume-averaged gas alone: exact solutions, orders of convergence, published numbers, and the same bits on any
//! ranks.

mod cavity;
mod driver;
mod exact;
mod fixed_bed;
mod gresho;
mod jet;
mod manufactured;
mod manufactured_in_space;
mod outlet;
mod ranks;
mod round_column;
mod source;
mod taylor_green;
