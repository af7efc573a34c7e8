//! The same bits on any number of ranks, on thread ranks within one process.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../beds/mod.rs"]
mod beds;

mod contact_set;
mod contacts_on_ranks;
mod dense_beds;
mod instruments;
mod rank_equality;
#[path = "../mpi_communicator/sparse_exchange.rs"]
mod sparse_exchange;
