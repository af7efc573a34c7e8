//! A single rank without MPI.

use super::{AxisNeighbours, Communicator, Exchange, FileAccess, Message, Pending};
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
        // Data sent down through a periodic face arrive from above.
        for (side, neighbour) in neighbours.iter().enumerate() {
            incoming[side].clear();
            if neighbour.is_some() {
                incoming[side].extend_from_slice(outgoing[1 - side]);
            }
        }
    }

    fn start_exchange(&self, exchange: Exchange) -> Pending<'_, Exchange> {
        Pending::new(move || exchange)
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        outgoing.iter().filter(|message| !message.bytes.is_empty()).cloned().collect()
    }

    fn sum_exact(&self, values: &mut [f64]) {
        // A zero has no sign, as on several ranks.
        values.iter_mut().for_each(|value| *value += 0.0);
    }

    fn start_sum_exact(&self, mut values: Vec<f64>) -> Pending<'_, Vec<f64>> {
        self.sum_exact(&mut values);
        Pending::new(move || values)
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
