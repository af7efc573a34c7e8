//! The message with which particles and their contact histories change owner.

use super::{ContactRecord, Message, ParticleRecord, WallContactRecord, records_of_bytes};
use bytemuck::{Pod, cast_slice};

/// The contents of a message to one rank, or from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MigrationMessage {
    pub(super) particles: Vec<ParticleRecord>,
    /// Numbers of these particles in custom fields.
    pub(super) custom: Vec<f64>,
    pub(super) pairs: Vec<ContactRecord>,
    pub(super) walls: Vec<WallContactRecord>,
}

impl MigrationMessage {
    /// The message: the numbers of records of each kind (3 x 8 bytes), then the records.
    pub(super) fn message_to(&self, rank: usize) -> Message {
        let Self { particles, custom, pairs, walls } = self;
        let counts = [particles.len(), pairs.len(), walls.len()].map(|count| count as u64);
        let parts = [
            cast_slice(&counts),
            cast_slice(particles),
            cast_slice(custom),
            cast_slice(pairs),
            cast_slice(walls),
        ];
        Message { rank, bytes: parts.concat() }
    }

    /// The contents of a message; `own_width` is the number of own numbers of a particle.
    pub(super) fn of(message: &Message, custom_width: usize) -> Self {
        let mut rest = &message.bytes[..];
        let counts: Vec<u64> = take_records(&mut rest, 3);
        Self {
            particles: take_records(&mut rest, counts[0]),
            custom: take_records(&mut rest, counts[0] * custom_width as u64),
            pairs: take_records(&mut rest, counts[1]),
            walls: take_records(&mut rest, counts[2]),
        }
    }
}

/// Takes records from the front of a slice.
fn take_records<T: Pod>(bytes: &mut &[u8], count: u64) -> Vec<T> {
    let (front, rest) = bytes.split_at(count as usize * size_of::<T>());
    *bytes = rest;
    records_of_bytes(front).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[test]
    fn a_packed_migration_message_is_unpacked_unchanged() {
        let particle = |id| ParticleRecord { id, mass: 0.5, ..Zeroable::zeroed() };
        let pair = |lower| ContactRecord { lower, higher: 9, ..Zeroable::zeroed() };
        let wall = |particle| WallContactRecord { particle, wall: 2, ..Zeroable::zeroed() };
        for (counts, width) in [([0, 0, 0], 0), ([3, 0, 1], 2), ([1, 4, 2], 0), ([2, 1, 0], 1)] {
            let packed = MigrationMessage {
                particles: (0..counts[0]).map(particle).collect(),
                custom: (0..counts[0] * width).map(|number| number as f64).collect(),
                pairs: (0..counts[1]).map(pair).collect(),
                walls: (0..counts[2]).map(wall).collect(),
            };
            let message = packed.message_to(7);
            assert_eq!(message.rank, 7);
            assert_eq!(MigrationMessage::of(&message, width as usize), packed);
        }
    }
}
