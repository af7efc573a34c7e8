//! The pressure solver against plain loops, closed forms, and itself on other decompositions.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

mod accuracy;
mod convergence;
mod equations;
mod failures;
mod rank_equality;
