//! The point of a facet that is nearest to a given one, and where on the facet it lies.

use super::Mesh;
use crate::domain::walls::from_surface::FromSurface;
use nalgebra::Vector3;

/// A corner, an edge or the interior of a facet, by its number in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// A corner.
    Vertex(u32),
    /// An edge without its ends.
    Edge(u32),
    /// A facet without its edges.
    Facet(u32),
}

/// The point of a facet that is nearest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestOnFacet {
    /// Distance and direction of the given point from it.
    pub from: FromSurface,
    /// Where it lies.
    pub feature: Feature,
}

impl Mesh {
    /// The point of a facet that is nearest to a given point.
    ///
    /// It lies in the facet if the given point is above it, and else on the nearest of the corners and edges. Distances
    /// from an edge or a corner do not depend on the facet, to the bit, so facets that share it agree on its rank.
    pub fn nearest_on(&self, point: &Vector3<f64>, facet: u32) -> NearestOnFacet {
        let planes = &self.planes[facet as usize];
        let [height, inwards @ ..] = planes.heights(point);
        if inwards.into_iter().all(|height| height >= 0.0) {
            let from = FromSurface::above(height, planes.normal());
            return NearestOnFacet { from, feature: Feature::Facet(facet) };
        }
        let of_facet = &self.facets[facet as usize];
        let offset_from = |vertex: u32| point - self.vertices[vertex as usize];
        let of_vertices = of_facet.vertices.map(|k| Some((offset_from(k), Feature::Vertex(k))));
        let of_edges =
            of_facet.edges.map(|k| Some((self.offset_from_edge(point, k)?, Feature::Edge(k))));
        let rank = |(offset, feature): &(Vector3<f64>, Feature)| (offset.norm_squared(), *feature);
        let found = of_vertices
            .into_iter()
            .chain(of_edges)
            .flatten()
            .reduce(|best, other| if rank(&other) < rank(&best) { other } else { best });
        let (offset, feature) = found.unwrap_or((Vector3::zeros(), Feature::Facet(facet)));
        NearestOnFacet { from: FromSurface::at(offset), feature }
    }

    /// The vector to a point from the nearest one of an edge; `None` if an end of the edge is nearer.
    fn offset_from_edge(&self, point: &Vector3<f64>, edge: u32) -> Option<Vector3<f64>> {
        let [first, last] =
            self.edges[edge as usize].vertices.map(|vertex| self.vertices[vertex as usize]);
        let (along, arm) = (last - first, point - first);
        let part = arm.dot(&along) / along.norm_squared();
        (0.0 < part && part < 1.0).then(|| arm - along * part)
    }
}
