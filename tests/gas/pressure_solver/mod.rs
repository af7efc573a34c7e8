//! The pressure solver, compared with plain loops, closed forms, and itself on other decompositions.

mod accuracy;
mod convergence;
mod equations;
mod failures;
mod rank_equality;
