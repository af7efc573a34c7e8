//! A single rank without MPI.

use super::{AxisNeighbours, Communicator, FileAccess, Message};
use std::path::Path;

/// The only rank, for unit tests and for tools that read files.
#[derive(Clone, Copy, Debug, Default)]
pub struct OneRank;

impl Communicator for OneRank {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    ) {
        // What is sent down through a periodic face arrives from above.
        for (side, neighbour) in neighbours.iter().enumerate() {
            incoming[side].clear();
            if neighbour.is_some() {
                incoming[side].extend_from_slice(outgoing[1 - side]);
            }
        }
    }

    fn exchange_during(&self, _: &[Message], _: &mut [Message], meanwhile: &mut dyn FnMut()) {
        meanwhile();
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        outgoing.iter().filter(|message| !message.bytes.is_empty()).cloned().collect()
    }

    fn sum_exact(&self, values: &mut [f64]) {
        // As on several ranks, a zero has no sign.
        values.iter_mut().for_each(|value| *value += 0.0);
    }

    fn sum_exact_during(&self, values: &mut [f64], meanwhile: &mut dyn FnMut()) {
        meanwhile();
        self.sum_exact(values);
    }

    fn sum_integers(&self, _values: &mut [i64]) {}

    fn maximum(&self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| *value = super::comparable(*value));
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        Some(vec![bytes.to_vec()])
    }

    fn broadcast_from_root(&self, _bytes: &mut Vec<u8>) {}

    fn file_access(&self, _path: &Path) -> FileAccess {
        FileAccess::Root
    }

    fn kind(&self) -> &'static str {
        "one alone"
    }
}
