//! A hash that distinguishes states, for comparisons over ranks, restarts and machines.

use std::fmt;
use std::ops::Range;

use bytemuck::Pod;
use xxhash_rust::xxh3::xxh3_128;

use talcum_engine::fields::{Field, Record, groups};
use talcum_engine::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, Records, WallContactRecord,
};
use talcum_engine::particle_sets::Pair;
use talcum_engine::particles::{ContactState, CustomFields};
use talcum_engine::state::Clock;

/// Hash of the physical state: clock, particles, and contact histories.
///
/// Each record is hashed by itself (XXH3, 128 bits as two integers), and the hashes are added, each integer modulo
/// 2^64. A sum does not depend on the order of the records, nor on their ranks, so nothing needs to be sorted or sent.
/// It is as good as one hash over the sorted records, because every record contains its id: two states with the same
/// records in another order *are* the same state, and two that differ in one bit of one record differ in one addend,
/// whose new value equals the old one with a probability of 2^-128. (Someone could construct states with equal sums on
/// purpose; a bug does not.) Unlike an exclusive or, a sum also detects a record that occurs twice. Finally the sums
/// are hashed together with the number of records, the step and the time.
///
/// A zero has no sign here: -0.0 and 0.0 are the same number and lead to the same future. Fields of optional features
/// are skipped while they are zero, from the end of a record; so are tables without rows, and custom fields. The
/// digests of older runs therefore remain valid when a program gains further fields.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Digest([u8; 16]);

/// One rank's records of a state, in any order.
pub struct StateRecords<'a, P: ?Sized> {
    /// Particles, positions wrapped into the box.
    pub particles: &'a P,
    /// Custom fields of these particles, in the same order.
    pub custom: &'a CustomFields,
    /// Touching pairs.
    pub contacts: &'a [ContactRecord],
    /// Particles that touch a wall.
    pub wall_contacts: &'a [WallContactRecord],
    /// Cells of a volume-averaged gas, or the plenum and intervals of a column gas; empty without these.
    pub cells: &'a [CellRecord],
    /// Pairs that touched at the last search for agglomerates, each on one rank; empty if drag does not depend on
    /// agglomerates.
    pub looked_at: &'a [Pair],
}

/// Bits of -0.0.
const NEGATIVE_ZERO: u64 = 1 << 63;

impl Digest {
    /// The digest of a state whose records are spread over the ranks in any way, each on one rank. Positions must be
    /// wrapped into the box. Collective.
    pub fn of(
        clock: &Clock,
        records: &StateRecords<'_, impl Records<ParticleRecord> + ?Sized>,
        ranks: &dyn Communicator,
    ) -> Self {
        let StateRecords { particles, custom, contacts, wall_contacts, cells, looked_at } =
            *records;
        let mut sums = [
            sum(b'p', (1, ParticleRecord::FIELDS), particles),
            sum(b'c', (2, ContactState::FIELDS), contacts),
            sum(b'w', (2, WallContactRecord::FIELDS), wall_contacts),
            sum(b'g', (1, CellRecord::FIELDS), cells),
            sum(b'l', (2, &[]), looked_at),
            sum_of_custom(particles, custom),
        ]
        .concat();
        ranks.sum_integers(&mut sums);
        // Parts that do not exist are left out: cells of a gas, pairs of a search, custom fields that are all zero.
        for first in [15, 12, 9] {
            if sums[first] == 0 {
                sums.drain(first..first + 3);
            }
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"talcum state 2");
        hasher.update(&clock.step.to_le_bytes());
        hasher.update(&clock.time().to_bits().to_le_bytes());
        for integer in sums {
            hasher.update(&integer.to_le_bytes());
        }
        Self(first_bytes(&hasher.finalize()))
    }
}

/// Number of records and sum of their hashes. The first `ids` words of a record are integers, the others doubles.
/// Groups of fields at the end that come together are left out until one of them is not zero.
fn sum<T: Pod>(
    kind: u8,
    (ids, fields): (usize, &[Field]),
    records: &(impl Records<T> + ?Sized),
) -> [i64; 3] {
    let optional = optional_widths(fields);
    let mut sum = [records.count() as i64, 0, 0];
    let mut bytes = vec![kind; 1 + size_of::<T>()];
    for index in 0..records.count() {
        let mut record = records.at(index);
        let words: &mut [u64] = bytemuck::cast_slice_mut(bytemuck::bytes_of_mut(&mut record));
        words[ids..].iter_mut().for_each(|word| *word = without_sign_of_zero(*word));
        let mut words = &*words;
        for &group in &optional {
            let (before, last) = words.split_at(words.len() - group);
            if last.iter().any(|&word| word != 0) {
                break;
            }
            words = before;
        }
        let end = 1 + size_of_val(words);
        put(&mut bytes[1..end], words);
        add_hash(&mut sum, &bytes[..end]);
    }
    sum
}

/// Widths of the groups of last fields that come together, from the end up to the last field that every run has.
fn optional_widths(fields: &[Field]) -> Vec<usize> {
    let last = fields.iter().rposition(|field| field.comes_with.is_none());
    let optional = &fields[last.map_or(0, |last| last + 1)..];
    let width = |group: Range<usize>| optional[group].iter().map(Field::width).sum();
    let mut widths: Vec<usize> = groups(optional).map(|(_, group)| width(group)).collect();
    widths.reverse();
    widths
}

/// Number of values of custom fields that are not zero, and sum of the hashes of each with its particle's id and the name of its
/// field: in whatever order the fields are.
fn sum_of_custom(
    particles: &(impl Records<ParticleRecord> + ?Sized),
    custom: &CustomFields,
) -> [i64; 3] {
    let mut sum = [0; 3];
    for (number, field) in custom.fields.iter().enumerate() {
        let numbers = custom.column(number);
        add_custom_field(&mut sum, particles, (field, &numbers));
    }
    sum
}

fn add_custom_field(
    sum: &mut [i64; 3],
    particles: &(impl Records<ParticleRecord> + ?Sized),
    (field, numbers): (&Field, &[f64]),
) {
    let mut bytes = Vec::new();
    for (index, numbers) in numbers.chunks_exact(field.width()).enumerate() {
        let mut words = vec![particles.at(index).id];
        words.extend(numbers.iter().map(|number| without_sign_of_zero(number.to_bits())));
        if words[1..].iter().any(|&word| word != 0) {
            let end = 1 + size_of_val(&words[..]);
            bytes.clear();
            bytes.resize(end, b'f');
            put(&mut bytes[1..], &words);
            bytes.extend_from_slice(field.name.as_bytes());
            sum[0] += 1;
            add_hash(sum, &bytes);
        }
    }
}

/// The bits of a number; a zero has no sign.
fn without_sign_of_zero(word: u64) -> u64 {
    if word == NEGATIVE_ZERO { 0 } else { word }
}

fn put(bytes: &mut [u8], words: &[u64]) {
    for (bytes, word) in bytes.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
}

fn add_hash(sum: &mut [i64; 3], bytes: &[u8]) {
    let hash = xxh3_128(bytes);
    sum[1] = sum[1].wrapping_add(hash as i64);
    sum[2] = sum[2].wrapping_add((hash >> 64) as i64);
}

fn first_bytes(hash: &blake3::Hash) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&hash.as_bytes()[..16]);
    bytes
}

impl fmt::Display for Digest {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(formatter, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Digest({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use talcum_engine::parallel::{OneRank, run_on_threads};

    fn particle(id: u64) -> ParticleRecord {
        let x = id as f64 * 0.7;
        ParticleRecord { id, position: [x, -x, 0.0], radius: 0.5, ..Zeroable::zeroed() }
    }

    fn contact(lower: u64) -> ContactRecord {
        ContactRecord {
            lower,
            higher: lower + 1,
            state: ContactState {
                tangential_spring: [0.1; 3],
                largest_overlap: 0.2,
                rolling_angle: [0.3; 3],
                twisting_angle: 0.4,
            },
        }
    }

    fn cell(cell: u64) -> CellRecord {
        CellRecord {
            cell,
            lower_velocity: [0.3; 3],
            upper_velocity: [0.3; 3],
            pressure: 0.3,
            voidage: 0.3,
        }
    }

    fn wall_contact(particle: u64) -> WallContactRecord {
        WallContactRecord { particle, ..Zeroable::zeroed() }
    }

    fn digest(particles: &[ParticleRecord], contacts: &[ContactRecord]) -> Digest {
        digest_at(&Clock::new(0.1), particles, contacts)
    }

    fn of_particles(particles: &[ParticleRecord]) -> StateRecords<'_, [ParticleRecord]> {
        static NONE: CustomFields = CustomFields { fields: Vec::new(), numbers: Vec::new() };
        let (contacts, wall_contacts, cells, looked_at) = (&[], &[], &[], &[]);
        StateRecords { particles, custom: &NONE, contacts, wall_contacts, cells, looked_at }
    }

    fn digest_at(
        clock: &Clock,
        particles: &[ParticleRecord],
        contacts: &[ContactRecord],
    ) -> Digest {
        let records = StateRecords { contacts, ..of_particles(particles) };
        Digest::of(clock, &records, &OneRank)
    }

    #[test]
    fn the_digest_is_the_same_on_any_number_of_ranks_and_in_any_order() {
        let clock = Clock { step: 7, ..Clock::new(0.1) };
        let particles: Vec<_> = (0..20).map(particle).collect();
        let contacts: Vec<_> = (0..9).map(contact).collect();
        let walls: Vec<_> = (0..3).map(wall_contact).collect();
        let cells: Vec<_> = (0..5).map(cell).collect();
        let looked_at: Vec<_> = (0..7).map(|lower| Pair { lower, higher: 9 }).collect();
        let whole = StateRecords {
            particles: &particles[..],
            custom: &CustomFields::default(),
            contacts: &contacts,
            wall_contacts: &walls,
            cells: &cells,
            looked_at: &looked_at,
        };
        let alone = Digest::of(&clock, &whole, &OneRank);
        assert_eq!(alone.to_string().len(), 32);
        for n in 1..=3 {
            let digests = run_on_threads(n, |ranks| {
                fn share<T: Copy>(all: &[T], ranks: &dyn Communicator) -> Vec<T> {
                    all.iter().rev().skip(ranks.rank()).step_by(ranks.size()).copied().collect()
                }
                let records = StateRecords {
                    particles: &share(&particles, ranks),
                    custom: &CustomFields::default(),
                    contacts: &share(&contacts, ranks),
                    wall_contacts: &share(&walls, ranks),
                    cells: &share(&cells, ranks),
                    looked_at: &share(&looked_at, ranks),
                };
                Digest::of(&clock, &records, ranks)
            });
            assert!(digests.iter().all(|&digest| digest == alone));
        }
    }

    #[test]
    fn the_digest_sees_every_number_of_the_state() {
        let particles: Vec<_> = (0..4).map(particle).collect();
        let contacts = [contact(0)];
        let original = digest(&particles, &contacts);
        for word in 0..size_of::<ParticleRecord>() / 8 {
            let mut changed = particles.clone();
            bytemuck::cast_slice_mut::<_, u64>(std::slice::from_mut(&mut changed[2]))[word] ^= 1;
            assert_ne!(digest(&changed, &contacts), original, "word {word} of a particle");
        }
        for word in 0..size_of::<ContactRecord>() / 8 {
            let mut changed = contacts;
            bytemuck::cast_slice_mut::<_, u64>(&mut changed)[word] ^= 1;
            assert_ne!(digest(&particles, &changed), original, "word {word} of a contact");
        }
        assert_ne!(digest(&particles[1..], &contacts), original);
        assert_ne!(digest(&particles, &[contacts[0], contacts[0], contacts[0]]), original);
        let with_pairs = |looked_at: &[Pair]| {
            let (particles, contacts) = (&particles[..], &contacts[..]);
            let records = StateRecords { contacts, looked_at, ..of_particles(particles) };
            Digest::of(&Clock::new(0.1), &records, &OneRank)
        };
        let looked_at = [Pair::of(0, 1), Pair::of(2, 3)].map(|pair| with_pairs(&[pair]));
        assert_eq!(with_pairs(&[]), original);
        assert!(looked_at[0] != original && looked_at[0] != looked_at[1]);
        let later = Clock { step: 1, ..Clock::new(0.1) };
        assert_ne!(digest_at(&later, &particles, &contacts), original);
    }

    #[test]
    fn the_digest_ignores_the_sign_of_zero() {
        let plus = particle(0);
        let mut minus = plus;
        minus.velocity[1] = -0.0;
        assert_eq!(digest(&[plus], &[]), digest(&[minus], &[]));
        let mut without_force = plus;
        without_force.gas_force = [0.0, -0.0, 0.0];
        assert_eq!(digest(&[plus], &[]), digest(&[without_force], &[]));
        // An id with the same bits is not a zero.
        let strange = ParticleRecord { id: NEGATIVE_ZERO, ..plus };
        assert_ne!(digest(&[plus], &[]), digest(&[strange], &[]));
    }
}
