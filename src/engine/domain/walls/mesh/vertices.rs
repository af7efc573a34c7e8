//! Corners of triangles that are the same point up to rounding become one.

use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use thiserror::Error;

/// The reason why triangles make no mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MeshError {
    /// There are no triangles.
    #[error("has no triangle")]
    Empty,
    /// A triangle has no area.
    #[error("triangle {} has no area", .facet + 1)]
    NoArea {
        /// Its number, from 0.
        facet: usize,
    },
}

/// Replaces points that are no farther from each other than a distance by the first of them. Returns the remaining
/// points, in their order, and the number of the remaining point for each given one.
pub fn join_vertices(points: &[Vector3<f64>], distance: f64) -> (Vec<Vector3<f64>>, Vec<u32>) {
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    let mut cells: FxHashMap<Vector3<i64>, Vec<u32>> = FxHashMap::default();
    let mut numbers = Vec::with_capacity(points.len());
    for point in points {
        let cell = point.map(|x| (x / distance).floor() as i64);
        let near = cells_around(cell).filter_map(|cell| cells.get(&cell)).flatten().copied();
        let is_same = |&number: &u32| (kept[number as usize] - point).norm() <= distance;
        let number = near.filter(is_same).min().unwrap_or(kept.len() as u32);
        if number as usize == kept.len() {
            kept.push(*point);
            cells.entry(cell).or_default().push(number);
        }
        numbers.push(number);
    }
    (kept, numbers)
}

/// A cell and its 26 neighbours.
fn cells_around(cell: Vector3<i64>) -> impl Iterator<Item = Vector3<i64>> {
    let steps = || -1..=1;
    steps().flat_map(move |x| {
        steps().flat_map(move |y| steps().map(move |z| cell + Vector3::new(x, y, z)))
    })
}
