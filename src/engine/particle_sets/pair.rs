//! Pairs of particles.

use crate::fields::{Field, Id, Record};
use crate::numbers::sorted_by_key;
use bytemuck::{Pod, Zeroable};

/// Two particles, by their ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
pub struct Pair {
    /// The lower id.
    pub lower: u64,
    /// The higher id.
    pub higher: u64,
}

impl Pair {
    /// The pair of two particles, in any order.
    pub fn of(a: u64, b: u64) -> Self {
        Self { lower: a.min(b), higher: a.max(b) }
    }

    /// Both ids.
    pub fn ends(&self) -> [u64; 2] {
        [self.lower, self.higher]
    }
}

/// Records sorted by the two ids of a pair, the lower first.
pub fn ascending<T: Copy>(records: Vec<T>, ids: impl Fn(&T) -> [u64; 2]) -> Vec<T> {
    let mut records = sorted_by_key(records, |record| ids(record)[0]);
    // A particle has only few partners.
    let of_lower = records.chunk_by_mut(|a, b| ids(a)[0] == ids(b)[0]);
    of_lower.for_each(|group| group.sort_by_key(|record| ids(record)[1]));
    records
}

impl Record for Pair {
    const GROUP: &'static str = "/looked_at";
    const IDS: &'static [Id] = &[
        Id {
            name: "lower",
            meaning: "lower id of a pair that touched when agglomerates were last found",
        },
        Id { name: "higher", meaning: "higher id of the pair" },
    ];
    const FIELDS: &'static [Field] = &[];
}
