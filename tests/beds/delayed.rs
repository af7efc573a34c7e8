//! Ranks whose messages take time, as between machines: a message arrives only after its travel time.

use std::path::Path;
use std::thread::yield_now;
use std::time::{SystemTime, UNIX_EPOCH};
use talcum::parallel::{AxisNeighbours, Communicator, Exchange, FileAccess, Message, Pending};

/// What is between two machines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Network {
    /// Time of the shortest message, in microseconds.
    pub(crate) latency: f64,
    /// Bytes per microsecond.
    pub(crate) bandwidth: f64,
}

/// Ranks of one machine, threads or processes, which speak to each other through a network.
#[derive(Clone, Copy)]
pub(crate) struct Delayed<'a> {
    pub(crate) ranks: &'a dyn Communicator,
    pub(crate) network: Network,
}

/// Length of the time of sending that each message carries at its end.
const STAMP: usize = size_of::<f64>();

/// Microseconds that all ranks of this machine count alike; whole quarters, so that a sum of one of them and zeros is exact.
fn now() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since.as_nanos() / 250) as f64 * 0.25
}

fn stamp(bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&now().to_le_bytes());
}

impl Delayed<'_> {
    /// Waits for the end of the way of a message that was sent at a time.
    fn wait(&self, sent: f64, bytes: usize, hops: u32) {
        let Network { latency, bandwidth } = self.network;
        let arrival = sent + f64::from(hops) * (latency + bytes as f64 / bandwidth);
        while now() < arrival {
            yield_now();
        }
    }

    /// Takes the time of sending off a message that has come, and waits for the end of its way.
    fn receive(&self, bytes: &mut Vec<u8>) {
        let length = bytes.len() - STAMP;
        let sent = f64::from_le_bytes(std::array::from_fn(|byte| bytes[length + byte]));
        bytes.truncate(length);
        self.wait(sent, length, 1);
    }

    /// Adds room for the time at which each rank begins a sum, and sets that of this rank.
    fn stamped(&self, values: &[f64]) -> Vec<f64> {
        let mut stamped = values.to_vec();
        stamped.resize(values.len() + self.size(), 0.0);
        stamped[values.len() + self.rank()] = now();
        stamped
    }

    /// The sums without these times, when a sum by recursive doubling would be there.
    fn summed(&self, mut stamped: Vec<f64>) -> Vec<f64> {
        let begun = stamped.split_off(stamped.len() - self.size());
        self.wait_for_all(begun.into_iter().fold(0.0, f64::max), size_of_val(&stamped[..]));
        stamped
    }

    fn wait_for_all(&self, last_begun: f64, bytes: usize) {
        self.wait(last_begun, bytes, self.size().next_power_of_two().ilog2());
    }
}

impl Communicator for Delayed<'_> {
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
        let stamped = outgoing.map(|bytes| {
            let mut bytes = bytes.to_vec();
            stamp(&mut bytes);
            bytes
        });
        self.ranks.exchange(neighbours, stamped.each_ref().map(|bytes| &bytes[..]), incoming);
        incoming.iter_mut().filter(|bytes| !bytes.is_empty()).for_each(|bytes| self.receive(bytes));
    }

    fn start_exchange(&self, mut exchange: Exchange) -> Pending<'_, Exchange> {
        exchange.outgoing.iter_mut().for_each(|message| stamp(&mut message.bytes));
        for Message { bytes, .. } in &mut exchange.incoming {
            bytes.resize(bytes.len() + STAMP, 0);
        }
        let pending = self.ranks.start_exchange(exchange);
        Pending::new(move || {
            let mut exchange = pending.finish();
            exchange.incoming.iter_mut().for_each(|message| self.receive(&mut message.bytes));
            for Message { bytes, .. } in &mut exchange.outgoing {
                bytes.truncate(bytes.len() - STAMP);
            }
            exchange
        })
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        let mut outgoing = outgoing.to_vec();
        outgoing.retain(|message| !message.bytes.is_empty());
        outgoing.iter_mut().for_each(|message| stamp(&mut message.bytes));
        let mut incoming = self.ranks.sparse_exchange(&outgoing);
        incoming.iter_mut().for_each(|message| self.receive(&mut message.bytes));
        incoming
    }

    fn sum_exact(&self, values: &mut [f64]) {
        let mut stamped = self.stamped(values);
        self.ranks.sum_exact(&mut stamped);
        values.copy_from_slice(&self.summed(stamped));
    }

    fn start_sum_exact(&self, values: Vec<f64>) -> Pending<'_, Vec<f64>> {
        let pending = self.ranks.start_sum_exact(self.stamped(&values));
        Pending::new(move || self.summed(pending.finish()))
    }

    fn sum_integers(&self, values: &mut [i64]) {
        let mut begun = [now()];
        self.ranks.maximum(&mut begun);
        self.ranks.sum_integers(values);
        self.wait_for_all(begun[0], size_of_val(values));
    }

    fn maximum(&self, values: &mut [f64]) {
        let mut stamped = values.to_vec();
        stamped.push(now());
        self.ranks.maximum(&mut stamped);
        let begun = stamped.pop().unwrap_or_default();
        values.copy_from_slice(&stamped);
        self.wait_for_all(begun, size_of_val(values));
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
}
