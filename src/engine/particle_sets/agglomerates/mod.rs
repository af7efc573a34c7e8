//! Agglomerates: connected sets of persistent contacts, and their properties.
//!
//! Source: Liu, van Wachem, Mudde, Chen & van Ommen, Powder Technology (2016), sections 2.3 and 2.4.
//!
//! No rank gathers an agglomerate, since a whole bed may be one. Members find their label and image as those of
//! [connected sets](super::components). Sums over members are made of integers, part by part of a rank, and are
//! completed on the rendezvous rank of the label. Results depend only on ids, positions and contacts.

mod distribution;
mod properties;
#[cfg(test)]
mod tests;

pub use distribution::{MassWeightedMeans, SizeDistribution};
pub use properties::Agglomerate;

use super::components::{ConnectedSets, NodeIds, NodeLink};
use super::ownership::{Foreign, Ownership};
use super::pair::Pair;
use super::periodicity::Periodicity;
use super::rendezvous::{ask, send_keyed, send_to_rendezvous};
use crate::numbers::sorted_by_key;
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;
use properties::Members;
use rustc_hash::FxHashMap;

/// Data of a particle at the time of a sample.
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

/// A search for agglomerates at one time.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// The particles that this rank owns, by ascending id.
    pub particles: &'a [ParticleSample],
    /// Pairs that form agglomerates: the contacts kept since t_0. Each is on one rank, preferably one that owns one of
    /// its particles.
    pub bonds: &'a [Pair],
    /// Pairs that touch now, for the coordination number. Each is on one rank, likewise.
    pub touching: &'a [Pair],
    /// The box.
    pub periodicity: Periodicity,
    /// Sets of fewer particles do not count as agglomerates (15 in the paper).
    pub smallest: u64,
}

/// The agglomerates at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Agglomerates {
    /// The agglomerate of each of this rank's particles, in their order: the smallest id of its members. `None` for a
    /// particle whose set is too small.
    pub labels: Vec<Option<u64>>,
    /// The centre of each of this rank's particles in the unwrapped agglomerate: relative to the particle whose id is
    /// the label, which lies in the box.
    pub unwrapped: Vec<Vector3<f64>>,
    /// Agglomerates whose label has its rendezvous on this rank, by ascending label. Each is on one rank.
    pub found: Vec<Agglomerate>,
}

/// Numbers of bonds, contacts of two members, and contacts of a member.
type Counts = [i64; 3];

impl Search<'_> {
    /// Finds all agglomerates. A bond or contact of a particle without an owner is left out. Collective.
    pub fn run(&self, ranks: &dyn Communicator) -> Agglomerates {
        let owned = Ownership::of(self.particles.iter().map(|particle| particle.id).collect());
        let ends = self.bonds.iter().chain(self.touching).flat_map(Pair::ends);
        let foreign = ends.filter(|&id| owned.place_of(id).is_none()).collect();
        let foreign = Foreign::find(foreign, &owned, ranks);
        let nodes = NodeIds::of(&owned, &foreign);
        let links = self.links(&nodes, ranks);
        let sets = ConnectedSets::of(&nodes, &links, ranks);
        let large = self.large_parts(&sets, ranks);
        let label = |place: usize| sets.part_of(place).and_then(|part| large[part]);
        let labels: Vec<Option<u64>> = (0..self.particles.len()).map(label).collect();
        let contacts = self.contacts_by_label(&nodes, &labels, &links, ranks);
        let unwrapped = self.particles.iter().enumerate().map(|(place, particle)| {
            let wrapped = self.periodicity.wrapped(particle.position);
            self.periodicity.shifted(wrapped, sets.image_of(place))
        });
        let unwrapped: Vec<Vector3<f64>> = unwrapped.collect();
        let members = Members {
            particles: self.particles,
            positions: &unwrapped,
            sets: &sets,
            large: &large,
            periodicity: self.periodicity,
        };
        let mut found = members.agglomerates(ranks);
        properties::add_contacts(&mut found, &contacts);
        Agglomerates { labels, unwrapped, found }
    }

    /// The bonds with the images of their ends. Collective.
    fn links(&self, nodes: &NodeIds<'_>, ranks: &dyn Communicator) -> Vec<NodeLink> {
        let wrapped = |place: usize| self.periodicity.wrapped(self.particles[place].position);
        let foreign = nodes.foreign.ask(nodes.owned, wrapped, ranks);
        let first = self.particles.len();
        let position = |node: u32| match node as usize {
            place if place < first => wrapped(place),
            place => foreign[place - first],
        };
        let link = |bond: &Pair| {
            let [a, b] = bond.ends().map(|id| nodes.node_of(id));
            let ends = [a?, b?];
            let [from, to] = ends.map(position);
            Some(NodeLink { ends, image: self.periodicity.nearest_image(&from, &to) })
        };
        self.bonds.iter().filter_map(link).collect()
    }

    /// The labels of the parts whose sets are large enough. Collective.
    fn large_parts(&self, sets: &ConnectedSets, ranks: &dyn Communicator) -> Vec<Option<u64>> {
        let mut members = vec![0_u64; sets.parts.len()];
        for part in (0..self.particles.len()).filter_map(|place| sets.part_of(place)) {
            members[part] += 1;
        }
        let counted = sets.parts.iter().zip(&members).map(|(part, &count)| (part.label, count));
        let here = sorted_by_key(send_keyed(counted, ranks), |count| count.0);
        let size = |label: u64| {
            let first = here.partition_point(|count| count.0 < label);
            let of_label = here[first..].iter().take_while(|count| count.0 == label);
            of_label.map(|count| count.1).sum::<u64>()
        };
        let labels = sets.parts.iter().map(|part| part.label);
        let sizes = ask(labels.clone(), size, ranks);
        labels
            .map(|label| sizes.get(label).filter(|&size| size >= self.smallest).map(|_| label))
            .collect()
    }

    /// Counts [bonds, contacts of two members, contacts of a member] from the side of members, on the rendezvous rank
    /// of the label, so that a bond of two members counts twice. By ascending label. Collective.
    fn contacts_by_label(
        &self,
        nodes: &NodeIds<'_>,
        labels: &[Option<u64>],
        bonds: &[NodeLink],
        ranks: &dyn Communicator,
    ) -> Vec<(u64, Counts)> {
        let known = |place: usize| LabelOfParticle::of(labels[place]);
        let foreign = nodes.foreign.ask(nodes.owned, known, ranks);
        let label = |node: u32| match labels.get(node as usize) {
            Some(label) => *label,
            None => foreign[node as usize - labels.len()].label(),
        };
        let mut counts = LabelCounts::default();
        for [a, b] in bonds.iter().map(|bond| bond.ends.map(label)) {
            // Both ends of a bond have the same label.
            if let Some(label) = a.and(b) {
                counts.add(label, [2, 0, 0]);
            }
        }
        let touching = self.touching.iter().filter_map(|pair| {
            let [a, b] = pair.ends().map(|id| nodes.node_of(id));
            Some([label(a?), label(b?)])
        });
        for ends in touching {
            let within = i64::from(ends[0] == ends[1]);
            ends.into_iter().flatten().for_each(|label| counts.add(label, [0, within, 1]));
        }
        counts.totals(ranks)
    }
}

/// Counts by label.
#[derive(Default)]
struct LabelCounts {
    counts: FxHashMap<u64, Counts>,
    /// The counts of the last label, which are not among the others yet: the next label is often the same.
    last: Option<(u64, Counts)>,
}

impl LabelCounts {
    #[inline]
    fn add(&mut self, label: u64, counts: Counts) {
        match &mut self.last {
            Some((last, sums)) if *last == label => add_counts(sums, counts),
            _ => {
                self.put_back();
                self.last = Some((label, counts));
            }
        }
    }

    fn put_back(&mut self) {
        if let Some((label, counts)) = self.last.take() {
            add_counts(self.counts.entry(label).or_default(), counts);
        }
    }

    /// Sums over ranks, on the rendezvous ranks of the labels, ascending. Collective.
    fn totals(mut self, ranks: &dyn Communicator) -> Vec<(u64, Counts)> {
        self.put_back();
        let records = sorted_by_key(send_keyed(self.counts, ranks), |record| record.0);
        let of_label = |group: &[(u64, Counts)]| {
            let sum = |k: usize| group.iter().map(|(_, counts)| counts[k]).sum();
            (group[0].0, [sum(0), sum(1), sum(2)])
        };
        records.chunk_by(|a, b| a.0 == b.0).map(of_label).collect()
    }
}

#[inline]
fn add_counts(sums: &mut Counts, counts: Counts) {
    sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
}

impl Agglomerates {
    /// The agglomerate of each of this rank's particles, in their order; `None` for a particle whose set is too small.
    /// Collective.
    pub fn of_particles(&self, ranks: &dyn Communicator) -> Vec<Option<Agglomerate>> {
        let known = |label: u64| {
            let place = self.found.binary_search_by_key(&label, |found| found.label).ok();
            place.map_or_else(Agglomerate::zeroed, |place| self.found[place])
        };
        let known = ask(self.labels.iter().flatten().copied(), known, ranks);
        self.labels.iter().map(|label| label.and_then(|label| known.get(label))).collect()
    }

    /// Ids and unwrapped centres of the members of one agglomerate, ascending, on the rendezvous rank of its label;
    /// nothing on the others. This rank holds all of them: the function is for single agglomerates, not for a bed that
    /// is one. `particles` are those of the search. Collective.
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

/// The agglomerate of a particle, as sent between ranks.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LabelOfParticle {
    label: u64,
    in_agglomerate: u64,
}

impl LabelOfParticle {
    fn of(label: Option<u64>) -> Self {
        label.map_or_else(Self::zeroed, |label| Self { label, in_agglomerate: 1 })
    }

    fn label(self) -> Option<u64> {
        (self.in_agglomerate == 1).then_some(self.label)
    }
}
