//! Letters in random, sparse patterns between ranks that come early and late: none is lost, none comes twice, none in
//! another exchange. Here on threads; `mpi_communicator` asks the same of processes.

use std::thread::sleep;
use std::time::Duration;

use talcum::numbers::{random_of, uniform};
use talcum::parallel::{Communicator, Message, share_with_all};

/// Every fourth exchange is without messages; the others are enough for each rank to be early and late often.
const EXCHANGES: u64 = 400;

/// What one rank writes to another, or to itself, in one exchange: mostly nothing. Some lengths are multiples of the
/// 1000 bytes that `mpi_communicator` allows in one message.
fn contents(exchange: u64, from: usize, to: usize) -> Vec<u8> {
    const LENGTHS: [usize; 6] = [1, 999, 1000, 1001, 3000, 70_000];
    let mut generator = random_of(exchange, (100 * from + to) as u64, "messages");
    let mut draw = |count: usize| (count as f64 * uniform(&mut generator)) as usize;
    if exchange.is_multiple_of(4) || draw(3) > 0 {
        return Vec::new();
    }
    let (length, first) = (LENGTHS[draw(LENGTHS.len())], draw(256));
    (first..first + length).map(|byte| byte as u8).collect()
}

/// Some ranks come to some exchanges up to a millisecond late.
fn come_late(exchange: u64, rank: usize) {
    let mut generator = random_of(exchange, rank as u64, "late");
    if uniform(&mut generator) < 0.1 {
        sleep(Duration::from_secs_f64(1e-3 * uniform(&mut generator)));
    }
}

/// Many exchanges, with other messages between some of them.
///
/// Tried by hand on processes of MPI: with one tag in the place of two that take turns this fails on three and four,
/// after 13 to 37 exchanges (a message comes one too early); with sends that are not synchronous on two to four (a
/// message comes too late).
pub(crate) fn messages_find_their_exchange(ranks: &dyn Communicator) {
    let (me, n) = (ranks.rank(), ranks.size());
    for exchange in 0..EXCHANGES {
        come_late(exchange, me);
        let message = |rank, bytes| Message { rank, bytes };
        // From the highest: the order in which messages are given does not matter.
        let outgoing: Vec<_> =
            (0..n).rev().map(|to| message(to, contents(exchange, me, to))).collect();
        let incoming = ranks.sparse_exchange(&outgoing);
        let written = (0..n).map(|from| message(from, contents(exchange, from, me)));
        let expected: Vec<_> = written.filter(|message| !message.bytes.is_empty()).collect();
        assert!(incoming == expected, "exchange {exchange}, rank {me} of {n}");
        match exchange % 7 {
            0 => assert_eq!(ranks.total(me), n * (n - 1) / 2),
            1 => assert_eq!(ranks.gather_to_root(&[1; 2000]).is_some(), ranks.is_root()),
            _ => {}
        }
    }
}

/// What every rank has, from nothing to much, is known to all, in the order of ranks.
pub(crate) fn all_know_what_each_has(ranks: &dyn Communicator) {
    let records = |rank: usize| vec![rank as u64; (700 * rank) % 1100];
    let expected: Vec<u64> = (0..ranks.size()).flat_map(records).collect();
    assert_eq!(share_with_all(records(ranks.rank()), ranks), expected);
    assert_eq!(share_with_all::<u64>(Vec::new(), ranks), Vec::<u64>::new());
}

#[test]
fn messages_find_their_exchange_on_threads() {
    messages_find_their_exchange(&talcum::parallel::OneRank);
    for n in 1..=5 {
        talcum::parallel::run_on_threads(n, messages_find_their_exchange);
    }
}

#[test]
fn all_know_what_each_has_on_threads() {
    all_know_what_each_has(&talcum::parallel::OneRank);
    for n in 1..=9 {
        talcum::parallel::run_on_threads(n, all_know_what_each_has);
    }
}
