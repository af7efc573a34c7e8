//! Blocks of pairs side by side, in lanes, and the evaluation of contact laws for them.

mod block;
mod coming;
mod law;
mod sizes;
mod vectors;

pub(crate) use block::{ContactBlock, ExcessForce, FourForces, require_within};
pub(crate) use coming::ComingBlocks;
pub(crate) use law::{BlockHistories, PairsOfBlock, evaluate_lanes};
pub(crate) use sizes::{ManySizes, OneSize, ReducedSizes, Sizes, SizesAtWall, SizesOfPairs};
pub(crate) use vectors::{FourVectors, overlap_and_normal, overlaps_and_normals, vector};
