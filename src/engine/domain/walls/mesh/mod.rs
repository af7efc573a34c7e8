//! Meshes of triangles: walls of any shape.

mod nearest;
mod planes;
mod tree;
mod vertices;

pub use self::nearest::{Feature, NearestOnFacet};
pub use self::vertices::{MeshError, join_vertices};

use self::planes::Planes;
use self::tree::Tree;
use super::from_surface::FromSurface;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;

/// A surface of triangles, which are called facets. Particles may touch it from both sides.
///
/// Facets that share an edge or a corner share its number, so that distances from this edge or corner have the same
/// bits from all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vector3<f64>>,
    edges: Vec<Edge>,
    facets: Vec<Facet>,
    planes: Vec<Planes>,
    tree: Tree,
    encloses: Option<Enclosure>,
}

/// A triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// The numbers of its corners.
    pub vertices: [u32; 3],
    /// The numbers of its edges; edge k leads from corner k to the next.
    pub edges: [u32; 3],
    /// Its unit normal, by the right-hand rule.
    pub normal: Vector3<f64>,
}

/// An edge of one or more facets.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The numbers of its ends, ascending.
    pub vertices: [u32; 2],
    /// The facets on it, ascending.
    pub facets: Vec<u32>,
    /// Whether it joins two facets that bend by less than the feature angle: a particle that touches both has one
    /// contact with them.
    pub is_smooth: bool,
}

/// What distinguishes the inside of a closed mesh from its outside: the sums of the normals of the facets at each edge and at
/// each corner, there weighted by the angles of the facets, all outwards (Baerentzen and Aanaes 2005,
/// doi:10.1109/TVCG.2005.49).
#[derive(Clone, Debug, PartialEq)]
struct Enclosure {
    outwards: f64,
    of_edges: Vec<Vector3<f64>>,
    of_vertices: Vec<Vector3<f64>>,
}

impl Mesh {
    /// A mesh of facets, each given by the numbers of its corners in counterclockwise order as seen from outside.
    /// `feature_angle`, in radians, is the bend from which an edge counts as sharp.
    ///
    /// # Errors
    /// If there is no facet, or a facet has no area or names a corner that does not exist.
    pub fn new(
        vertices: Vec<Vector3<f64>>,
        corners: &[[u32; 3]],
        feature_angle: f64,
    ) -> Result<Self, MeshError> {
        if corners.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut edges = Edges::default();
        let mut facets = Vec::with_capacity(corners.len());
        for (number, &of_facet) in corners.iter().enumerate() {
            let normal =
                normal_of(&vertices, of_facet).ok_or(MeshError::NoArea { facet: number })?;
            let edges = [0, 1, 2].map(|k| edges.add(of_facet[k], of_facet[(k + 1) % 3], number));
            facets.push(Facet { vertices: of_facet, edges, normal });
        }
        let mut edges = edges.edges;
        for edge in &mut edges {
            let bend = bend_of(edge, &facets, &vertices);
            edge.is_smooth = bend.is_some_and(|bend| bend < feature_angle);
        }
        let corners_of = |facet: &Facet| facet.vertices.map(|k| vertices[k as usize]);
        let tree = Tree::of(facets.iter().map(corners_of));
        let planes = facets.iter().map(|facet| Planes::of(&facet.normal, corners_of(facet)));
        let planes = planes.collect();
        let mesh = Self { vertices, edges, facets, planes, tree, encloses: None };
        let encloses = mesh.is_closed().then(|| Enclosure::of(&mesh));
        Ok(Self { encloses, ..mesh })
    }

    /// Its facets.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// Its edges.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Its corners.
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// The corners of a facet.
    pub fn corners(&self, facet: u32) -> [Vector3<f64>; 3] {
        self.facets[facet as usize].vertices.map(|vertex| self.vertices[vertex as usize])
    }

    /// The lowest and the highest coordinates.
    pub fn extent(&self) -> [Vector3<f64>; 2] {
        self.tree.extent()
    }

    /// Whether each edge joins two facets that run along it in opposite directions: the mesh then has an inside and an
    /// outside.
    pub fn is_closed(&self) -> bool {
        self.edges.iter().all(|edge| edge.facets.len() == 2 && !self.is_turned(edge))
    }

    /// Whether the two facets of an edge run along it in the same direction: one of them is turned inside out.
    pub fn is_turned(&self, edge: &Edge) -> bool {
        let runs_up = |&facet: &u32| {
            let corners = self.facets[facet as usize].vertices;
            (0..3).any(|k| [corners[k], corners[(k + 1) % 3]] == edge.vertices)
        };
        edge.facets.len() == 2 && runs_up(&edge.facets[0]) == runs_up(&edge.facets[1])
    }

    /// The numbers of all facets that may be nearer to a point than this distance, in no particular order.
    pub fn facets_near(&self, point: &Vector3<f64>, distance: f64) -> impl Iterator<Item = u32> {
        self.tree.facets_near(point, distance)
    }

    /// A lower bound of the distance of a point from a facet, which is the distance itself except beside a corner.
    #[inline(always)]
    pub fn least_distance(&self, point: &Vector3<f64>, facet: u32) -> f64 {
        self.planes[facet as usize].least_distance(point)
    }

    /// Distance and direction of a point from the nearest facet; among several, from that of the lowest number.
    pub fn nearest(&self, point: &Vector3<f64>) -> FromSurface {
        self.nearest_on(point, self.nearest_facet(point)).from
    }

    fn nearest_facet(&self, point: &Vector3<f64>) -> u32 {
        self.tree.nearest(point, |facet| self.nearest_on(point, facet).from.distance)
    }

    /// Whether a point lies in the room that a closed mesh surrounds; an open one surrounds none.
    pub fn surrounds(&self, point: &Vector3<f64>) -> bool {
        let Some(enclosure) = &self.encloses else { return false };
        let facet = self.nearest_facet(point);
        let NearestOnFacet { from, feature } = self.nearest_on(point, facet);
        let outwards = match feature {
            Feature::Vertex(number) => enclosure.of_vertices[number as usize],
            Feature::Edge(number) => enclosure.of_edges[number as usize],
            Feature::Facet(number) => self.facets[number as usize].normal,
        };
        enclosure.outwards * outwards.dot(&from.direction) < 0.0
    }

    /// Volume within a closed mesh, negative if its facets are all turned inside out.
    pub fn volume(&self) -> f64 {
        let origin = self.vertices[0];
        let part = |facet: u32| {
            let [a, b, c] = self.corners(facet).map(|corner| corner - origin);
            a.dot(&b.cross(&c)) / 6.0
        };
        (0..self.facets.len() as u32).map(part).sum()
    }
}

impl Enclosure {
    fn of(mesh: &Mesh) -> Self {
        let mut of_edges = vec![Vector3::zeros(); mesh.edges.len()];
        let mut of_vertices = vec![Vector3::zeros(); mesh.vertices.len()];
        for (number, facet) in mesh.facets.iter().enumerate() {
            let corners = mesh.corners(number as u32);
            for k in 0..3 {
                of_edges[facet.edges[k] as usize] += facet.normal;
                let [one, other] = [1, 2].map(|step| corners[(k + step) % 3] - corners[k]);
                let angle = angle_between(&one, &other);
                of_vertices[facet.vertices[k] as usize] += facet.normal * angle;
            }
        }
        Self { outwards: mesh.volume().signum(), of_edges, of_vertices }
    }
}

/// The edges found so far, by their ends.
#[derive(Default)]
struct Edges {
    edges: Vec<Edge>,
    by_ends: FxHashMap<[u32; 2], u32>,
}

impl Edges {
    /// Adds a facet to the edge between two corners, and returns the edge's number.
    fn add(&mut self, one: u32, other: u32, facet: usize) -> u32 {
        let vertices = [one.min(other), one.max(other)];
        let number = *self.by_ends.entry(vertices).or_insert_with(|| {
            self.edges.push(Edge { vertices, facets: Vec::new(), is_smooth: false });
            self.edges.len() as u32 - 1
        });
        self.edges[number as usize].facets.push(facet as u32);
        number
    }
}

/// The unit normal of a facet by the right-hand rule; `None` if the facet has no area.
fn normal_of(vertices: &[Vector3<f64>], corners: [u32; 3]) -> Option<Vector3<f64>> {
    let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
    (b - a).cross(&(c - a)).try_normalize(0.0)
}

/// The angle by which a surface bends at an edge of two facets, in radians: 0 if they lie in one plane. It does not
/// depend on the direction of their normals.
fn bend_of(edge: &Edge, facets: &[Facet], vertices: &[Vector3<f64>]) -> Option<f64> {
    let [one, other] = edge.facets[..] else { return None };
    let [first, last] = edge.vertices.map(|vertex| vertices[vertex as usize]);
    let along = (last - first).normalize();
    let away = |facet: u32| {
        let corners = facets[facet as usize].vertices;
        let opposite = corners.into_iter().find(|corner| !edge.vertices.contains(corner))?;
        let arm = vertices[opposite as usize] - first;
        Some(arm - along * along.dot(&arm))
    };
    Some(angle_between(&away(one)?, &-away(other)?))
}

/// The angle between two vectors, in radians.
fn angle_between(one: &Vector3<f64>, other: &Vector3<f64>) -> f64 {
    libm::atan2(one.cross(other).norm(), one.dot(other))
}

#[cfg(test)]
mod tests;
