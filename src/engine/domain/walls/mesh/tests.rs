//! Distances from facets are those of the nearest of many points, the tree finds what a search of all facets finds, and edges and
//! insides are recognised.

use super::*;
use std::f64::consts::PI;

/// The unit cube with its first corner at the origin, two facets a side, outwards.
pub(super) fn cube(feature_angle: f64) -> Mesh {
    let vertices =
        (0..8).map(|k| Vector3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)));
    let squares =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facets = squares.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).concat();
    Mesh::new(vertices.collect(), &facets, feature_angle).unwrap()
}

/// A surface of waves without symmetry, of 512 facets.
fn waves() -> Mesh {
    const SIDE: u32 = 17;
    let place = |k: u32| {
        let [x, y] = [k % SIDE, k / SIDE].map(|k| f64::from(k) / 4.0 - 2.0);
        Vector3::new(x, y, 0.4 * (1.7 * x).sin() * (2.3 * y + 0.4).cos() + 0.1 * x)
    };
    let square = |k: u32| [[k, k + 1, k + SIDE + 1], [k, k + SIDE + 1, k + SIDE]];
    let columns = |row: u32| (0..SIDE - 1).map(move |column| row * SIDE + column);
    let facets: Vec<_> = (0..SIDE - 1).flat_map(columns).flat_map(square).collect();
    Mesh::new((0..SIDE * SIDE).map(place).collect(), &facets, 0.5).unwrap()
}

fn probes() -> Vec<Vector3<f64>> {
    let places = [-1.9, -0.83, -0.1, 0.37, 0.9, 1.6];
    let line = |x: f64, y: f64| places.map(|z| Vector3::new(x, y, 0.7 * z));
    places.iter().flat_map(|&x| places.iter().flat_map(move |&y| line(x, y))).collect()
}

#[test]
fn nearest_points_are_the_nearest_of_many_on_each_facet() {
    const COUNT: usize = 200;
    let mesh = waves();
    for facet in [0, 77, 300] {
        let [a, b, c] = mesh.corners(facet);
        let on_row =
            |u: usize| (0..=COUNT - u).map(move |v| [u, v].map(|k| k as f64 / COUNT as f64));
        let points: Vec<_> =
            (0..=COUNT).flat_map(on_row).map(|[u, v]| a + (b - a) * u + (c - a) * v).collect();
        for probe in probes() {
            let found = mesh.nearest_on(&probe, facet).from;
            let nearest = points.iter().map(|it| (probe - it).norm()).fold(f64::INFINITY, f64::min);
            // Points lie up to 0.003 apart, so that the nearest of them is at most half of this farther.
            assert!((-1.0e-12..2.0e-3).contains(&(nearest - found.distance)), "{facet} {probe}");
            let foot = probe - found.direction * found.distance;
            let back = mesh.nearest_on(&foot, facet).from.distance;
            assert!(back < 1.0e-14, "rounding of some sums: {back}");
        }
    }
}

#[test]
fn a_tilted_flat_mesh_has_the_distances_of_its_plane() {
    let normal = Vector3::new(0.36, -0.48, 0.8);
    let [one, other] = [Vector3::new(0.8, 0.6, 0.0), Vector3::new(-0.48, 0.64, 0.6)];
    let corners = [[-3.0, -3.0], [4.0, -3.0], [0.3, 0.2], [4.0, 4.0], [-3.0, 4.0]];
    let vertices = corners.map(|[u, v]| one * u + other * v).to_vec();
    let mesh = Mesh::new(vertices, &[[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]], 0.5).unwrap();
    for probe in probes() {
        let found = mesh.nearest(&probe);
        let height = normal.dot(&probe);
        // Rounding of some products.
        assert!((found.distance - height.abs()).abs() < 1.0e-14, "{probe}: {found:?} {height}");
        assert!(
            (found.direction - normal * height.signum()).norm() < 1.0e-14,
            "{probe}: {found:?}"
        );
    }
}

#[test]
fn the_tree_finds_what_a_search_of_all_facets_finds() {
    let mesh = waves();
    let all = || 0..mesh.facets().len() as u32;
    let mut found_in_all = 0;
    for probe in probes() {
        let distance = |facet: u32| mesh.nearest_on(&probe, facet).from.distance;
        let nearest = all().map(distance).fold(f64::INFINITY, f64::min);
        assert_eq!(mesh.nearest(&probe).distance, nearest);
        let near = |facet: &u32| distance(*facet) < 0.4;
        let mut by_tree: Vec<u32> = mesh.facets_near(&probe, 0.4).filter(near).collect();
        by_tree.sort_unstable();
        assert_eq!(by_tree, all().filter(near).collect::<Vec<_>>());
        found_in_all += mesh.facets_near(&probe, 0.4).count();
    }
    // Negative control: the tree leaves facets out.
    assert!(found_in_all < probes().len() * mesh.facets().len() / 10, "{found_in_all}");
}

#[test]
fn bounds_of_distances_are_lower_ones_and_mostly_exact() {
    let mesh = waves();
    let (mut exact, mut count) = (0, 0);
    for probe in probes() {
        for facet in 0..mesh.facets().len() as u32 {
            let distance = mesh.nearest_on(&probe, facet).from.distance;
            let bound = mesh.least_distance(&probe, facet);
            assert!(bound <= distance, "{probe} {facet}: {bound} {distance}");
            count += usize::from(distance < 0.4);
            exact += usize::from(distance < 0.4 && bound > distance - 1.0e-12);
        }
    }
    assert!(2 * exact > count, "{exact} {count}");
}

#[test]
fn features_are_corners_edges_and_facets() {
    let mesh = cube(0.5);
    let feature = |x: f64, y: f64, z: f64| {
        let point = Vector3::new(x, y, z);
        mesh.nearest_on(&point, mesh.nearest_facet(&point)).feature
    };
    assert!(matches!(feature(0.7, 0.2, 1.3), Feature::Facet(_)));
    assert!(matches!(feature(0.7, -0.2, 1.3), Feature::Edge(_)));
    assert_eq!(feature(1.7, -0.2, 1.3), Feature::Vertex(5));
}

#[test]
fn edges_are_smooth_below_the_feature_angle() {
    let count = |angle: f64| cube(angle).edges().iter().filter(|edge| edge.is_smooth).count();
    // 12 edges bend by a right angle; 6 are diagonals of the sides.
    assert_eq!([0.5 * PI - 1.0e-9, 0.5 * PI + 1.0e-9].map(count), [6, 18]);
}

#[test]
fn bends_do_not_depend_on_the_direction_of_normals() {
    let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::new(0.5, -1.0, 0.3)];
    let bend = |facets: [[u32; 3]; 2]| {
        let mesh = Mesh::new(vertices.clone(), &facets, 0.0).unwrap();
        let edge = mesh.edges().iter().find(|edge| edge.facets.len() == 2).unwrap();
        bend_of(edge, mesh.facets(), mesh.vertices()).unwrap()
    };
    let expected = 0.3_f64.atan();
    let turned = [[[0, 1, 2], [1, 0, 3]], [[0, 1, 2], [0, 1, 3]], [[2, 1, 0], [0, 1, 3]]];
    for found in turned.map(bend) {
        assert!((found - expected).abs() < 1.0e-15, "rounding: {found}");
    }
}

#[test]
fn closed_meshes_surround_their_inside() {
    let mesh = cube(0.5);
    assert!(mesh.is_closed() && (mesh.volume() - 1.0).abs() < 1.0e-15);
    let is_inside = |point: &Vector3<f64>| point.iter().all(|x| (0.0..1.0).contains(x));
    let inside: Vec<_> = probes().into_iter().filter(|it| mesh.surrounds(it)).collect();
    assert_eq!(inside, probes().into_iter().filter(is_inside).collect::<Vec<_>>());
    assert!(!inside.is_empty() && !waves().is_closed());
    // The same cube with all facets inside out.
    let corners: Vec<_> = mesh.facets().iter().map(|facet| facet.vertices).collect();
    let reversed: Vec<_> = corners.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let turned = Mesh::new(mesh.vertices().to_vec(), &reversed, 0.5).unwrap();
    assert!(turned.surrounds(&Vector3::new(0.3, 0.4, 0.6)) && turned.volume() < 0.0);
    // Negative control: one facet turned inside out.
    let mut one_turned = corners;
    one_turned[3].swap(0, 1);
    let broken = Mesh::new(mesh.vertices().to_vec(), &one_turned, 0.5).unwrap();
    assert!(!broken.is_closed());
    assert_eq!(broken.edges().iter().filter(|edge| broken.is_turned(edge)).count(), 3);
}

#[test]
fn facets_without_area_are_refused() {
    let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::x() * 2.0];
    assert_eq!(Mesh::new(vertices.clone(), &[[0, 1, 2]], 0.5), Err(MeshError::NoArea { facet: 0 }));
    assert_eq!(Mesh::new(vertices, &[], 0.5), Err(MeshError::Empty));
}

#[test]
fn corners_that_are_the_same_are_joined() {
    let points = [0.0, 1.0, 1.0e-9, 1.0 - 1.0e-9, 0.5].map(|x| Vector3::new(x, -x, 3.0));
    let (kept, numbers) = join_vertices(&points, 1.0e-8);
    assert_eq!(numbers, [0, 1, 0, 1, 2]);
    assert_eq!(kept, [points[0], points[1], points[4]]);
    // Negative control: a distance below that of the points.
    assert_eq!(join_vertices(&points, 1.0e-10).1, [0, 1, 2, 3, 4]);
}
