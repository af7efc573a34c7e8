//! The contacts of particles with meshes: which of the touched facets act, and the histories that go with them.

use crate::domain::{Feature, Mesh, PosedWalls, WallPose};
use crate::particles::{Contacts, MeshMargin, Particles, WallPair};
use nalgebra::Vector3;
use std::ops::Range;

/// Gap over the radius of a particle up to which a facet is evaluated at each step.
const MARGIN: f64 = 0.03;

/// A facet on which a particle may feel a force.
struct TouchedFacet {
    slot: usize,
    facet: u32,
    distance: f64,
    nearest: Feature,
    /// The place of another facet of the same contact in the list of touched facets, or its own.
    parent: usize,
}

/// Finds the contacts of particles with meshes. `range` is the separation up to which any force acts.
///
/// A point of the mesh is a candidate if it is the nearest one of all facets that contain it: at a convex edge this
/// leaves one, at a concave edge one on each side. The candidates on touched facets that are connected by smooth edges
/// are one contact, at the nearest of them. A contact keeps its history as it passes from facet to facet. If two
/// contacts become one, the history of one of them is dropped, with the energy of its spring.
pub(crate) fn find_mesh_contacts(
    particles: &Particles,
    contacts: &mut Contacts,
    walls: PosedWalls<'_>,
    range: f64,
) {
    let mut touched = Vec::new();
    let mut start = 0;
    while let Some(&first) = contacts.wall_pairs.get(start) {
        let wall = first.wall as usize;
        let rest = &contacts.wall_pairs[start..];
        let Some(mesh) = walls.walls[wall].mesh() else {
            start += rest.partition_point(|pair| pair.wall == first.wall);
            continue;
        };
        let of_both = |pair: &&WallPair| (pair.wall, pair.particle) == (first.wall, first.particle);
        let count = rest.iter().take_while(of_both).count();
        let near = NearMesh { mesh, pose: &walls.poses[wall], slots: start..start + count };
        near.find_touched(particles, contacts, range, &mut touched);
        contacts.wall_acts[near.slots.clone()].fill(false);
        connect(mesh, &mut touched);
        choose(mesh, contacts, &touched);
        hand_on(mesh, contacts, &touched, near.slots);
        start += count;
    }
}

/// A particle near a mesh: the slots of it and the facets near it.
struct NearMesh<'a> {
    mesh: &'a Mesh,
    pose: &'a WallPose,
    slots: Range<usize>,
}

impl NearMesh<'_> {
    /// The facets that are not beyond the range, by ascending number.
    fn find_touched(
        &self,
        particles: &Particles,
        contacts: &mut Contacts,
        range: f64,
        touched: &mut Vec<TouchedFacet>,
    ) {
        touched.clear();
        let body = &particles.body[contacts.wall_pairs[self.slots.start].particle as usize];
        let place = self.pose.seen_at_rest(&body.position);
        let margin = &contacts.mesh_margins[self.slots.start];
        let is_valid = (place - margin.place).norm() + range < margin.gap;
        if !is_valid {
            self.find_close(contacts, place, body.radius, range);
        }
        for slot in self.slots.clone().filter(|&slot| contacts.facet_is_close[slot]) {
            let facet = contacts.wall_pairs[slot].facet;
            if self.mesh.least_distance(&place, facet) - body.radius > range {
                continue;
            }
            let found = self.mesh.nearest_on(&place, facet);
            let (distance, nearest) = (found.from.distance, found.feature);
            if distance - body.radius <= range {
                let parent = touched.len();
                touched.push(TouchedFacet { slot, facet, distance, nearest, parent });
            }
        }
    }

    /// Finds the facets that a particle at a place may touch until it has moved by a margin.
    fn find_close(&self, contacts: &mut Contacts, place: Vector3<f64>, radius: f64, range: f64) {
        let close = range + MARGIN * radius;
        let mut gap = f64::INFINITY;
        for slot in self.slots.clone() {
            let facet = contacts.wall_pairs[slot].facet;
            let here = self.mesh.least_distance(&place, facet) - radius;
            let is_close = here <= close;
            contacts.facet_is_close[slot] = is_close;
            if !is_close {
                gap = gap.min(here);
            }
        }
        contacts.mesh_margins[self.slots.start] = MeshMargin { place, gap };
    }
}

/// The place of a facet in the list of touched ones.
fn place_of(touched: &[TouchedFacet], facet: u32) -> Option<usize> {
    touched.binary_search_by_key(&facet, |it| it.facet).ok()
}

/// The place of the facet that stands for all that are connected to one.
fn root_of(touched: &[TouchedFacet], mut place: usize) -> usize {
    while touched[place].parent != place {
        place = touched[place].parent;
    }
    place
}

/// Connects touched facets that share a smooth edge.
fn connect(mesh: &Mesh, touched: &mut [TouchedFacet]) {
    if touched.len() < 2 {
        return;
    }
    for place in 0..touched.len() {
        for other in smooth_neighbours(mesh, touched[place].facet) {
            let Some(other) = place_of(touched, other) else { continue };
            let [one, other] = [place, other].map(|it| root_of(touched, it));
            touched[one.max(other)].parent = one.min(other);
        }
    }
}

/// The facets that share a smooth edge with one.
fn smooth_neighbours(mesh: &Mesh, facet: u32) -> impl Iterator<Item = u32> {
    let edges = mesh.facets()[facet as usize].edges.map(|edge| &mesh.edges()[edge as usize]);
    let smooth = edges.into_iter().filter(|edge| edge.is_smooth);
    smooth.flat_map(|edge| edge.facets.iter().copied()).filter(move |&other| other != facet)
}

/// Marks, for each contact, the facet that acts for it.
fn choose(mesh: &Mesh, contacts: &mut Contacts, touched: &[TouchedFacet]) {
    for (place, one) in touched.iter().enumerate() {
        let root = root_of(touched, place);
        let is_deeper = |(other_place, other): (usize, &TouchedFacet)| {
            (other.distance, other.facet) < (one.distance, one.facet)
                && root_of(touched, other_place) == root
                && is_candidate(mesh, touched, other)
        };
        let acts = is_candidate(mesh, touched, one) && !touched.iter().enumerate().any(is_deeper);
        contacts.wall_acts[one.slot] = acts;
    }
}

/// Whether the nearest point of a facet is also the nearest one of all other facets that contain it, and this facet is
/// the first of them.
fn is_candidate(mesh: &Mesh, touched: &[TouchedFacet], one: &TouchedFacet) -> bool {
    let agrees = |other: &TouchedFacet| other.nearest == one.nearest && other.facet >= one.facet;
    let contains = |other: &TouchedFacet| {
        let facet = &mesh.facets()[other.facet as usize];
        match one.nearest {
            Feature::Vertex(vertex) => facet.vertices.contains(&vertex),
            Feature::Edge(edge) => facet.edges.contains(&edge),
            Feature::Facet(_) => false,
        }
    };
    touched.iter().all(|other| agrees(other) || !contains(other))
}

/// Hands histories on to the facets that act now.
fn hand_on(mesh: &Mesh, contacts: &mut Contacts, touched: &[TouchedFacet], slots: Range<usize>) {
    for slot in slots {
        if !contacts.wall_touching[slot] || contacts.wall_acts[slot] {
            continue;
        }
        let facet = contacts.wall_pairs[slot].facet;
        let place = place_of(touched, facet)
            .or_else(|| smooth_neighbours(mesh, facet).find_map(|other| place_of(touched, other)));
        // Without a place the particle has left this part of the mesh: the law ends the contact.
        let Some(root) = place.map(|place| root_of(touched, place)) else { continue };
        let acts = |&place: &usize| {
            contacts.wall_acts[touched[place].slot] && root_of(touched, place) == root
        };
        let heir = (0..touched.len()).find(acts).map(|place| touched[place].slot);
        let state = std::mem::take(&mut contacts.wall_state[slot]);
        contacts.wall_touching[slot] = false;
        if let Some(heir) = heir.filter(|&heir| !contacts.wall_touching[heir]) {
            contacts.wall_state[heir] = state;
            contacts.wall_touching[heir] = true;
        }
    }
}
