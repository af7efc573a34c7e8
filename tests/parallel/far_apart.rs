//! Ranks, threads or processes, that say they are on machines of their own.

use std::cell::Cell;
use std::path::Path;
use talcum::parallel::{AxisNeighbours, Communicator, FileAccess, Message};

/// Ranks none of which is near another.
pub(crate) struct FarApart<'a> {
    pub(crate) ranks: &'a dyn Communicator,
    /// How often it was asked whether one is near.
    pub(crate) asked: Cell<usize>,
}

impl Communicator for FarApart<'_> {
    fn rank(&self) -> usize {
        self.ranks.rank()
    }

    fn size(&self) -> usize {
        self.ranks.size()
    }

    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    ) {
        self.ranks.exchange(neighbours, outgoing, incoming);
    }

    fn exchange_during(
        &self,
        outgoing: &[Message],
        incoming: &mut [Message],
        meanwhile: &mut dyn FnMut(),
    ) {
        self.ranks.exchange_during(outgoing, incoming, meanwhile);
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        self.ranks.sparse_exchange(outgoing)
    }

    fn sum_exact(&self, values: &mut [f64]) {
        self.ranks.sum_exact(values);
    }

    fn sum_exact_during(&self, values: &mut [f64], meanwhile: &mut dyn FnMut()) {
        self.ranks.sum_exact_during(values, meanwhile);
    }

    fn sum_integers(&self, values: &mut [i64]) {
        self.ranks.sum_integers(values);
    }

    fn maximum(&self, values: &mut [f64]) {
        self.ranks.maximum(values);
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        self.ranks.gather_to_root(bytes)
    }

    fn broadcast_from_root(&self, bytes: &mut Vec<u8>) {
        self.ranks.broadcast_from_root(bytes);
    }

    fn file_access(&self, path: &Path) -> FileAccess {
        self.ranks.file_access(path)
    }

    fn kind(&self) -> &'static str {
        self.ranks.kind()
    }

    fn is_near(&self, _rank: usize) -> bool {
        self.asked.set(self.asked.get() + 1);
        false
    }
}
