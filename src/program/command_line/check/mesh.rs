//! What `talcum check` says about a mesh.

use super::point;
use std::fmt::Write as _;
use std::ops::RangeInclusive;
use talcum_engine::domain::{Edge, Mesh, join_vertices};

/// Open corners that are nearer to each other than this part of the mesh's size are probably meant to be the same.
const GAP: f64 = 1.0e-3;
/// Height of a facet over its longest edge, below which it is a sliver.
const SLIVER: f64 = 1.0e-3;
/// Ratios of the sizes of mesh and box outside which the units of the file are doubtful.
const USUAL: RangeInclusive<f64> = 0.01..=100.0;

/// Number of triangles, place, and what may be wrong with a mesh in a box of this size.
pub(super) fn describe_mesh(mesh: &Mesh, box_size: f64) -> String {
    let [lower, upper] = mesh.extent();
    let size = (upper - lower).norm();
    let count = mesh.facets().len();
    let mut message =
        format!("mesh of {count} triangles from {} to {}", point(&lower), point(&upper));
    if mesh.is_closed() {
        let _ = write!(message, ", closed, volume {:.4}", mesh.volume().abs());
    } else {
        message += ", open";
    }
    for (count, what) in [
        (edges(mesh, |edge| edge.facets.len() == 1), "of one triangle"),
        (edges(mesh, |edge| edge.facets.len() > 2), "of three or more triangles"),
        (
            edges(mesh, |edge| mesh.is_turned(edge)),
            "between triangles that are opposite ways round",
        ),
    ] {
        if count > 0 {
            let _ = write!(message, ", {count} edges {what}");
        }
    }
    let gaps = open_corners_near_others(mesh, GAP * size);
    if gaps > 0 {
        let _ = write!(message, ", {gaps} corners at gaps narrower than {:.3e}", GAP * size);
    }
    let slivers = (0..count as u32).filter(|&facet| slenderness(mesh, facet) < SLIVER).count();
    if slivers > 0 {
        let _ = write!(message, ", {slivers} slivers of triangles");
    }
    let ratio = size / box_size;
    if !USUAL.contains(&ratio) {
        let _ = write!(message, ", {ratio:.3e} times the size of the box: is mesh.scale right?");
    }
    message
}

fn edges(mesh: &Mesh, is_counted: impl Fn(&Edge) -> bool) -> usize {
    mesh.edges().iter().filter(|edge| is_counted(edge)).count()
}

/// The number of corners of edges of one triangle that are nearer than a distance to another such corner.
fn open_corners_near_others(mesh: &Mesh, distance: f64) -> usize {
    let open = mesh.edges().iter().filter(|edge| edge.facets.len() == 1);
    let mut corners: Vec<u32> = open.flat_map(|edge| edge.vertices).collect();
    corners.sort_unstable();
    corners.dedup();
    let points: Vec<_> = corners.iter().map(|&corner| mesh.vertices()[corner as usize]).collect();
    points.len() - join_vertices(&points, distance).0.len()
}

/// Height of a facet over its longest edge.
fn slenderness(mesh: &Mesh, facet: u32) -> f64 {
    let [a, b, c] = mesh.corners(facet);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    (b - a).cross(&(c - a)).norm() / (longest * longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn tetrahedron(apex: f64, facets: &[[u32; 3]]) -> Mesh {
        let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z() * apex];
        Mesh::new(vertices, facets, 0.5).unwrap()
    }

    const OUTWARDS: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

    #[test]
    fn a_sound_mesh_is_closed_and_has_a_volume() {
        let message = describe_mesh(&tetrahedron(1.0, &OUTWARDS), 2.0);
        assert_eq!(
            message,
            "mesh of 4 triangles from (0, 0, 0) to (1, 1, 1), closed, volume 0.1667"
        );
    }

    #[test]
    fn what_is_wrong_is_counted() {
        let mut turned = OUTWARDS;
        turned[1].swap(0, 1);
        let cases = [
            (tetrahedron(1.0, &OUTWARDS[1..]), 2.0, "open, 3 edges of one triangle"),
            (
                tetrahedron(1.0, &turned),
                2.0,
                "open, 3 edges between triangles that are opposite ways round",
            ),
            (tetrahedron(1.0e-5, &OUTWARDS), 2.0, "2 slivers of triangles"),
            (
                tetrahedron(1.0, &OUTWARDS),
                0.001,
                "1.732e3 times the size of the box: is mesh.scale right?",
            ),
        ];
        for (mesh, box_size, words) in cases {
            let message = describe_mesh(&mesh, box_size);
            assert!(message.contains(words), "{message}");
        }
    }

    #[test]
    fn gaps_are_corners_that_nearly_meet() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0e-4, 0.0], [1.0, 1.0001], [0.0, 1.0]];
        let vertices = points.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec();
        let split = Mesh::new(vertices.clone(), &[[0, 1, 2], [3, 4, 5]], 0.5).unwrap();
        assert!(
            describe_mesh(&split, 1.0).contains("2 corners at gaps"),
            "{}",
            describe_mesh(&split, 1.0)
        );
        let whole = Mesh::new(vertices, &[[0, 1, 2], [0, 2, 5]], 0.5).unwrap();
        assert!(!describe_mesh(&whole, 1.0).contains("gaps"));
    }
}
