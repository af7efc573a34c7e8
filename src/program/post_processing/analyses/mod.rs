//! The analyses of `talcum analyse`, each in a file of its own.

mod agglomerates;
mod bed;
mod bubbles;
mod coordination;
mod cycle;
mod flux;
mod mean;
mod mixing;
mod repose;
mod spectrum;
mod u_mf;
mod waves;

use super::Analysis;

/// All analyses, in the order in which they are printed.
pub const ANALYSES: [&Analysis; 12] = [
    &bed::ANALYSIS,
    &waves::ANALYSIS,
    &u_mf::ANALYSIS,
    &mean::ANALYSIS,
    &spectrum::ANALYSIS,
    &cycle::ANALYSIS,
    &flux::ANALYSIS,
    &mixing::ANALYSIS,
    &coordination::ANALYSIS,
    &agglomerates::ANALYSIS,
    &bubbles::ANALYSIS,
    &repose::ANALYSIS,
];
