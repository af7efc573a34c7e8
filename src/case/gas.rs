//! The section of the gas: which kind it is.

use super::column::read_column;
use super::particles::Scales;
use super::section::Section;
use super::volume_averaged::read_volume_averaged;
use crate::domain::Bounds;
use crate::gas::GasModel;
use serde::Deserialize;
use std::ops::Range;

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Column,
    VolumeAveraged,
}

/// `[gas]`.
pub(super) fn read_gas(
    section: Section<'_>,
    scales: Scales,
    gravity: Option<f64>,
    bounds: Option<&Bounds>,
    stages: &[Range<f64>],
) -> Option<GasModel> {
    let kind: Option<Kind> = section.value("kind");
    if kind == Some(Kind::VolumeAveraged) {
        let model = read_volume_averaged(section, (scales, gravity), bounds, stages);
        return model.map(GasModel::VolumeAveraged);
    }
    let column = read_column(section, scales, gravity, bounds, stages);
    column.filter(|_| kind.is_some()).map(GasModel::Column)
}
