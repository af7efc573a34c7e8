//! Breakage and growth of agglomerates between two samples.
//!
//! Two samples label every particle with its agglomerate, or with none. The number of particles shared by an
//! agglomerate X of the first sample and an agglomerate Y of the second is the number of particles that belong to both.
//!
//! * The **successor** of X is the Y that shares most particles with X; the **origin** of Y is the X that shares most
//!   with it; among equal ones, the one with the smallest label.
//! * X **survives** if it is the origin of its successor and has at least half of its members there.
//! * X **breaks** if at least `threshold` of its members are not in the successor; it **grows** if its successor has
//!   at least `threshold` other members. It may do both: an exchange.
//!
//! For tables of this kind (size before, sizes after, per time) and the size at which growth and breakage are equal,
//! see Zhou et al., Chin. J. Chem. Eng. 26 (2018) 914, doi:10.1016/j.cjche.2017.05.018. The rules above are our own.

mod rates;
mod survival;
#[cfg(test)]
mod tests;

pub use rates::{Crossing, Rate, RateCounts, RatesOfSize, crossing};
pub use survival::{AtLag, CriticalTimes};

use bytemuck::{Pod, Zeroable};
use rustc_hash::FxHashMap;
use talcum_engine::numbers::sorted_by_key;
use talcum_engine::parallel::Communicator;
use talcum_engine::particle_sets::rendezvous::{ask, send_to_rendezvous};

/// Marks the absence of an agglomerate in labels that are sent.
const NONE: u64 = u64::MAX;

/// The agglomerates of all particles at one sample, on the ranks that owned the particles at that time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// [id, label].
    labels: Vec<[u64; 2]>,
}

impl Look {
    /// Takes the labels of the particles that this rank owns, in the order of `ids`.
    pub fn take(ids: &[u64], labels: &[Option<u64>]) -> Self {
        let records = ids.iter().zip(labels).map(|(&id, label)| [id, label.unwrap_or(NONE)]);
        Self { labels: records.collect() }
    }

    /// The agglomerates of these particles; `None` for particles that were not in the sample. Collective.
    pub fn of(&self, ids: &[u64], ranks: &dyn Communicator) -> Vec<Option<u64>> {
        let here = self.at_rendezvous(ranks);
        let labels = ask(ids.iter().copied(), |id| label(&here, id), ranks);
        ids.iter().map(|&id| labels.get(id).filter(|&label| label != NONE)).collect()
    }

    /// Records that must be stored to resume later; [`Look::of_records`] reads them on any ranks.
    pub fn records(&self) -> &[[u64; 2]] {
        &self.labels
    }

    /// Continues from records that were stored by any ranks.
    pub fn of_records(records: Vec<[u64; 2]>) -> Self {
        Self { labels: records }
    }

    /// The records on the rendezvous ranks of the particles, by ascending id, each once. Collective.
    fn at_rendezvous(&self, ranks: &dyn Communicator) -> Vec<[u64; 2]> {
        let labels = send_to_rendezvous(self.labels.iter().copied(), |record| record[0], ranks);
        let mut labels = sorted_by_key(labels, |record| record[0]);
        labels.dedup_by_key(|record| record[0]);
        labels
    }
}

/// The label of a particle among records by ascending id.
fn label(records: &[[u64; 2]], id: u64) -> u64 {
    let place = records.binary_search_by_key(&id, |record| record[0]);
    place.map_or(NONE, |place| records[place][1])
}

/// A number of particles that moved from one agglomerate to another, or stayed in one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
struct Share {
    before: u64,
    after: u64,
    /// Number of particles that belong to both.
    particles: u64,
}

impl Share {
    /// The agglomerate of the second sample; `None` for particles that are in no agglomerate, or have left.
    fn after(&self) -> Option<u64> {
        (self.after != NONE).then_some(self.after)
    }
}

/// Fate of one agglomerate of the first sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fate {
    /// Its label at the first sample.
    pub label: u64,
    /// Number of its members at that sample.
    pub size: u64,
    /// The agglomerates of the second sample that contain members of it, by ascending label.
    pub fragments: Vec<Fragment>,
    /// Number of members that are now in no agglomerate.
    pub released: u64,
    /// Index in `fragments` of the fragment that shares most with it; `None` if all members were released.
    pub successor: Option<usize>,
}

/// An agglomerate of the second sample that contains members of one of the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragment {
    /// Its label at the second sample.
    pub label: u64,
    /// Number of members that both share.
    pub shared: u64,
    /// Number of its members.
    pub size: u64,
    /// Number of agglomerates of the first sample from which it has members.
    pub sources: u64,
    /// The agglomerate of the first sample with which it shares most.
    pub origin: u64,
}

impl Fate {
    /// The agglomerate that shares most with this one.
    pub fn successor(&self) -> Option<&Fragment> {
        self.fragments.get(self.successor?)
    }

    /// Number of members that are not in the successor.
    pub fn lost(&self) -> u64 {
        self.size - self.successor().map_or(0, |successor| successor.shared)
    }

    /// Number of members of the successor that were not in this one.
    pub fn gained(&self) -> u64 {
        self.successor().map_or(0, |successor| successor.size - successor.shared)
    }

    /// Whether it is the origin of its successor, and at least half of its members are there.
    pub fn survives(&self) -> bool {
        let is_it = |next: &Fragment| next.origin == self.label && 2 * next.shared >= self.size;
        self.successor().is_some_and(is_it)
    }
}

/// Data of an agglomerate of the second sample that all ranks know.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct After {
    label: u64,
    size: u64,
    sources: u64,
    origin: u64,
}

/// Events between two samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Fates of the agglomerates of the first sample whose label has its rendezvous on this rank, by ascending label.
    pub fates: Vec<Fate>,
    /// Agglomerates of the second sample on this rank without members of any of the first: [label, size].
    pub new: Vec<[u64; 2]>,
}

impl Changes {
    /// Compares two samples. Collective.
    pub fn between(before: &Look, after: &Look, ranks: &dyn Communicator) -> Self {
        let shares = shares(&before.at_rendezvous(ranks), &after.at_rendezvous(ranks));
        let to_after = shares.iter().copied().filter(|share| share.after != NONE);
        let at_after = merged(send_to_rendezvous(to_after, |share| share.after, ranks), |s| {
            (s.after, s.before)
        });
        let of_after: Vec<After> =
            at_after.chunk_by(|a, b| a.after == b.after).map(summary).collect();
        let from_before = shares.iter().copied().filter(|share| share.before != NONE);
        let at_before = merged(send_to_rendezvous(from_before, |share| share.before, ranks), |s| {
            (s.before, s.after)
        });
        let answer = |label: u64| {
            let place = of_after.binary_search_by_key(&label, |after| after.label);
            place.map_or_else(|_| After::zeroed(), |place| of_after[place])
        };
        let known = ask(at_before.iter().filter_map(Share::after), answer, ranks);
        let groups = at_before.chunk_by(|a, b| a.before == b.before);
        let fates = groups.map(|group| fate(group, |label| known.get(label))).collect();
        let new = of_after.iter().filter(|after| after.sources == 0);
        Self { fates, new: new.map(|after| [after.label, after.size]).collect() }
    }
}

/// Numbers of particles, among those whose rendezvous is this rank, by agglomerate before and after, from records by
/// ascending id. A particle that has left is in no agglomerate.
fn shares(before: &[[u64; 2]], after: &[[u64; 2]]) -> Vec<Share> {
    let (mut before, mut after) = (before.iter().peekable(), after.iter().peekable());
    let mut counted = FxHashMap::<[u64; 2], u64>::default();
    while let Some(id) = [before.peek(), after.peek()].into_iter().flatten().map(|it| it[0]).min() {
        let of = |record: Option<&[u64; 2]>| record.map_or(NONE, |record| record[1]);
        let from = of(before.next_if(|record| record[0] == id));
        let to = of(after.next_if(|record| record[0] == id));
        *counted.entry([from, to]).or_default() += 1;
    }
    let share = |([before, after], particles): ([u64; 2], u64)| Share { before, after, particles };
    merged(counted.into_iter().map(share).collect(), |share| (share.before, share.after))
}

/// One share for each pair of agglomerates, ascending by `key`.
fn merged(mut shares: Vec<Share>, key: impl Fn(&Share) -> (u64, u64)) -> Vec<Share> {
    shares.sort_unstable_by_key(&key);
    let of_pair = shares.chunk_by(|a, b| key(a) == key(b));
    let sum = |group: &[Share]| group.iter().map(|share| share.particles).sum();
    of_pair.map(|group| Share { particles: sum(group), ..group[0] }).collect()
}

/// Sums up the shares of one agglomerate of the second sample.
fn summary(shares: &[Share]) -> After {
    let sources = || shares.iter().filter(|share| share.before != NONE);
    After {
        label: shares[0].after,
        size: shares.iter().map(|share| share.particles).sum(),
        sources: sources().count() as u64,
        origin: largest(sources().map(|share| (share.before, share.particles)))
            .map_or(NONE, |x| x.0),
    }
}

/// Determines the fate of one agglomerate of the first sample, from its shares.
fn fate(shares: &[Share], known: impl Fn(u64) -> Option<After>) -> Fate {
    let fragment = |share: &Share| {
        let After { label, size, sources, origin } = known(share.after()?)?;
        Some(Fragment { label, shared: share.particles, size, sources, origin })
    };
    let fragments: Vec<Fragment> = shares.iter().filter_map(fragment).collect();
    let largest = largest(fragments.iter().map(|fragment| (fragment.label, fragment.shared)));
    let successor = |(label, _)| fragments.iter().position(|fragment| fragment.label == label);
    Fate {
        label: shares[0].before,
        size: shares.iter().map(|share| share.particles).sum(),
        released: shares.iter().filter(|s| s.after == NONE).map(|s| s.particles).sum(),
        successor: largest.and_then(successor),
        fragments,
    }
}

/// The label with the largest number; among equal numbers, the smallest label.
fn largest(labels: impl Iterator<Item = (u64, u64)>) -> Option<(u64, u64)> {
    labels.max_by_key(|&(label, number)| (number, std::cmp::Reverse(label)))
}
