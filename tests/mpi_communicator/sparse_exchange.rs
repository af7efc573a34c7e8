//! Messages in random, sparse patterns between ranks that are sometimes late: none is lost, none arrives twice or in
//! another exchange. This file runs on threads; `mpi_communicator` tests the same for processes.

use std::thread::sleep;
use std::time::Duration;

use talcum::numbers::{random_of, uniform};
use talcum::parallel::{Communicator, Message, share_with_all};

/// Every fourth exchange has no messages. There are so many that each rank is late often.
const EXCHANGES: u64 = 400;

/// The message of one rank to another, or to itself, in one exchange; mostly empty. Some lengths are multiples of the
/// 1000 bytes to which `mpi_communicator` limits the messages of MPI.
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

/// Delays some ranks before some exchanges by up to a millisecond.
fn be_late(exchange: u64, rank: usize) {
    let mut generator = random_of(exchange, rank as u64, "late");
    if uniform(&mut generator) < 0.1 {
        sleep(Duration::from_secs_f64(1e-3 * uniform(&mut generator)));
    }
}

/// Many exchanges, with other messages between some of them.
///
/// Negative controls, tried by hand on processes of MPI: with one tag instead of two the test fails on three and four
/// ranks after 13 to 37 exchanges (a message arrives one exchange too early); with sends that are not synchronous it
/// fails on two to four ranks (a message arrives too late).
pub(crate) fn messages_arrive_in_their_exchange(ranks: &dyn Communicator) {
    let (me, n) = (ranks.rank(), ranks.size());
    for exchange in 0..EXCHANGES {
        be_late(exchange, me);
        let message = |rank, bytes| Message { rank, bytes };
        // The highest rank first: the order of the outgoing messages does not matter.
        let outgoing: Vec<_> =
            (0..n).rev().map(|to| message(to, contents(exchange, me, to))).collect();
        let incoming = ranks.sparse_exchange(&outgoing);
        let sent = (0..n).map(|from| message(from, contents(exchange, from, me)));
        let expected: Vec<_> = sent.filter(|message| !message.bytes.is_empty()).collect();
        assert!(incoming == expected, "exchange {exchange}, rank {me} of {n}");
        match exchange % 7 {
            0 => assert_eq!(ranks.total(me), n * (n - 1) / 2),
            1 => assert_eq!(ranks.gather_to_root(&[1; 2000]).is_some(), ranks.is_root()),
            _ => {}
        }
    }
}

/// Every rank gets the records of all ranks, which have none or many, in the order of the ranks.
pub(crate) fn all_ranks_get_the_records_of_all(ranks: &dyn Communicator) {
    let records = |rank: usize| vec![rank as u64; (700 * rank) % 1100];
    let expected: Vec<u64> = (0..ranks.size()).flat_map(records).collect();
    assert_eq!(share_with_all(records(ranks.rank()), ranks), expected);
    assert_eq!(share_with_all::<u64>(Vec::new(), ranks), Vec::<u64>::new());
}

#[test]
fn messages_arrive_in_their_exchange_on_threads() {
    messages_arrive_in_their_exchange(&talcum::parallel::OneRank);
    for n in 1..=5 {
        talcum::parallel::run_on_threads(n, messages_arrive_in_their_exchange);
    }
}

#[test]
fn all_ranks_get_the_records_of_all_on_threads() {
    all_ranks_get_the_records_of_all(&talcum::parallel::OneRank);
    for n in 1..=9 {
        talcum::parallel::run_on_threads(n, all_ranks_get_the_records_of_all);
    }
}
