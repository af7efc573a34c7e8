//! The measures of `talcum analyse`, each in a file of its own.

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

use super::Measure;

/// All measures, in the order in which they are printed.
pub const MEASURES: [&Measure; 12] = [
    &bed::MEASURE,
    &waves::MEASURE,
    &u_mf::MEASURE,
    &mean::MEASURE,
    &spectrum::MEASURE,
    &cycle::MEASURE,
    &flux::MEASURE,
    &mixing::MEASURE,
    &coordination::MEASURE,
    &agglomerates::MEASURE,
    &bubbles::MEASURE,
    &repose::MEASURE,
];
