//! Agglomerates: connected sets of persistent contacts, and what they are like.
//!
//! Source: Liu, van Wachem, Mudde, Chen & van Ommen, Powder Technology (2016), sections 2.3 and 2.4.
//!
//! No rank gathers an agglomerate: a bed may be one. Members find label and image by [`components`]; sums over
//! members (exact, rounded once) meet on the rendezvous rank of the label. Results depend on ids, positions and
//! contacts alone.

mod distribution;
mod properties;
#[cfg(test)]
mod tests;

pub use distribution::{MassWeightedMeans, SizeDistribution};
pub use properties::Agglomerate;

use super::components::{Link, Membership, components};
use super::exact_sums::{Keyed, totals_by_key};
use super::pair::{Pair, at_rendezvous};
use super::periodicity::Periodicity;
use super::rendezvous::{Answers, ask, send_to_rendezvous};
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;
use properties::Body;

/// What is known of a particle at the time of a look.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ParticleSample {
    /// Global id.
    pub id: u64,
    /// Mass.
    pub mass: f64,
    /// Radius.
    pub radius: f64,
    /// Centre, in any periodic image.
    pub position: Vector3<f64>,
    /// Velocity.
    pub velocity: Vector3<f64>,
}

/// How agglomerates are found at one time.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// The particles that this rank owns.
    pub particles: &'a [ParticleSample],
    /// Pairs that make agglomerates: the contacts kept since t_0. Held by any rank.
    pub bonds: &'a [Pair],
    /// Pairs that touch now, for the coordination number. Held by any rank, or by several.
    pub touching: &'a [Pair],
    /// The box.
    pub periodicity: Periodicity,
    /// Sets of fewer particles are no agglomerates (15 in the paper).
    pub smallest: u64,
}

/// The agglomerates of one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Agglomerates {
    /// The agglomerate of each of this rank's particles, in their order: the smallest id of its members. None for a
    /// particle whose set is too small.
    pub labels: Vec<Option<u64>>,
    /// The centre of each of this rank's particles where it lies in the unwrapped agglomerate: relative to the
    /// particle whose id is the label, which lies in the box.
    pub unwrapped: Vec<Vector3<f64>>,
    /// Those whose label meets on this rank, by ascending label. Each agglomerate is on one rank.
    pub found: Vec<Agglomerate>,
}

impl Search<'_> {
    /// Finds all agglomerates. A bond or contact of a particle that no rank owns is left out. Collective.
    pub fn run(&self, ranks: &dyn Communicator) -> Agglomerates {
        let links = self.links(ranks);
        let ids: Vec<u64> = self.particles.iter().map(|particle| particle.id).collect();
        let sets = components(&ids, &links, ranks);
        let sizes = sizes_by_label(&sets, ranks);
        let size = |set: &Membership| sizes.get(set.label).unwrap_or(0);
        let large = |set: &Membership| (size(set) >= self.smallest).then_some(set.label);
        let labels: Vec<Option<u64>> = sets.iter().map(large).collect();
        let contacts = self.contacts_by_label(&ids, &labels, &links, ranks);
        let bodies = self.particles.iter().zip(&sets);
        let bodies = bodies.map(|(particle, set)| Body::new(particle, set, &self.periodicity));
        let bodies: Vec<Body> = bodies.collect();
        let unwrapped = bodies.iter().map(|body| body.position).collect();
        let members = bodies.into_iter().zip(&labels).filter(|(_, label)| label.is_some());
        let members: Vec<Body> = members.map(|(body, _)| body).collect();
        let mut found = properties::of_bodies(&members, &self.periodicity, ranks);
        properties::add_contacts(&mut found, &contacts);
        Agglomerates { labels, unwrapped, found }
    }

    /// The bonds with the images of their ends, on the rendezvous rank of the lower id. Collective.
    fn links(&self, ranks: &dyn Communicator) -> Vec<Link> {
        #[derive(Clone, Copy, Pod, Zeroable)]
        #[repr(C)]
        struct Place {
            id: u64,
            known: u64,
            position: Vector3<f64>,
        }
        let places = self.particles.iter().map(|particle| {
            let position = self.periodicity.wrapped(particle.position);
            Place { id: particle.id, known: 1, position }
        });
        let mut places = send_to_rendezvous(places, |place| place.id, ranks);
        places.sort_unstable_by_key(|place| place.id);
        let place_of = |id: u64| {
            let place = places.binary_search_by_key(&id, |place| place.id);
            place.map_or_else(|_| Place::zeroed(), |place| places[place])
        };
        let bonds = at_rendezvous(self.bonds, ranks);
        let known = ask(bonds.iter().flat_map(Pair::ends), place_of, ranks);
        let link = |bond: &Pair| {
            let [a, b] = bond.ends().map(|id| known.get(id).filter(|place| place.known == 1));
            let image = self.periodicity.nearest_image(&a?.position, &b?.position);
            Some(Link::new(bond.ends(), image))
        };
        bonds.iter().filter_map(link).collect()
    }

    /// Counts [bonds, contacts of two members, contacts of a member] as seen from members, on the rendezvous rank of
    /// the label: a bond of two members counts twice. Collective.
    fn contacts_by_label(
        &self,
        ids: &[u64],
        labels: &[Option<u64>],
        bonds: &[Link],
        ranks: &dyn Communicator,
    ) -> Vec<Keyed<3>> {
        let touching = at_rendezvous(self.touching, ranks);
        let ends = touching.iter().flat_map(Pair::ends);
        let ends = ends.chain(bonds.iter().flat_map(|bond| bond.ends));
        let labels = labels_of(ends, ids, labels, ranks);
        let label = |id: u64| labels.get(id).and_then(LabelOfParticle::label);
        let mut counts = Vec::new();
        for [a, b] in bonds.iter().map(|bond| bond.ends.map(label)) {
            // Both ends of a bond have one label.
            counts.extend(a.and(b).map(|key| Keyed { key, values: [2.0, 0.0, 0.0] }));
        }
        for [a, b] in touching.iter().map(|pair| pair.ends().map(label)) {
            let within = f64::from(a == b);
            let of_end = |key: u64| Keyed { key, values: [0.0, within, 1.0] };
            counts.extend([a, b].into_iter().flatten().map(of_end));
        }
        totals_by_key(counts, ranks)
    }
}

impl Agglomerates {
    /// Ids and unwrapped centres of the members of one agglomerate, ascending, on the rendezvous rank of its label;
    /// nothing on the others. That rank holds all of them: for single agglomerates, not for a bed that is one.
    /// `particles` are those of the search. Collective.
    pub fn members(
        &self,
        label: u64,
        particles: &[ParticleSample],
        ranks: &dyn Communicator,
    ) -> Vec<(u64, Vector3<f64>)> {
        #[derive(Clone, Copy, Pod, Zeroable)]
        #[repr(C)]
        struct Member {
            id: u64,
            position: Vector3<f64>,
        }
        let all = particles.iter().zip(&self.labels).zip(&self.unwrapped);
        let members = all.filter(|((_, of), _)| **of == Some(label));
        let members =
            members.map(|((particle, _), &position)| Member { id: particle.id, position });
        let mut members = send_to_rendezvous(members, |_| label, ranks);
        members.sort_unstable_by_key(|member| member.id);
        members.into_iter().map(|member| (member.id, member.position)).collect()
    }
}

/// A particle's agglomerate, as it travels.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LabelOfParticle {
    id: u64,
    label: u64,
    in_agglomerate: u64,
}

impl LabelOfParticle {
    fn label(self) -> Option<u64> {
        (self.in_agglomerate == 1).then_some(self.label)
    }
}

/// The labels of particles that any rank owns. Collective.
fn labels_of(
    asked: impl Iterator<Item = u64>,
    ids: &[u64],
    labels: &[Option<u64>],
    ranks: &dyn Communicator,
) -> Answers<LabelOfParticle> {
    let records = ids.iter().zip(labels).filter_map(|(&id, label)| {
        label.map(|label| LabelOfParticle { id, label, in_agglomerate: 1 })
    });
    let mut here = send_to_rendezvous(records, |record| record.id, ranks);
    here.sort_unstable_by_key(|record| record.id);
    let answer = |id: u64| {
        let place = here.binary_search_by_key(&id, |record| record.id);
        place.map_or_else(|_| LabelOfParticle::zeroed(), |place| here[place])
    };
    ask(asked, answer, ranks)
}

/// Number of members of the sets of this rank's particles. Collective.
fn sizes_by_label(sets: &[Membership], ranks: &dyn Communicator) -> Answers<u64> {
    let mut labels: Vec<u64> = sets.iter().map(|set| set.label).collect();
    labels.sort_unstable();
    let counted = labels.chunk_by(|a, b| a == b).map(|group| [group[0], group.len() as u64]);
    let mut here = send_to_rendezvous(counted, |count| count[0], ranks);
    here.sort_unstable();
    let size = |label: u64| {
        let first = here.partition_point(|count| count[0] < label);
        let of_label = here[first..].iter().take_while(|count| count[0] == label);
        of_label.map(|count| count[1]).sum()
    };
    ask(labels, size, ranks)
}
