//! Messages that travel while ranks reduce numbers, on threads; `mpi_communicator` tests the same for processes.

use talcum::parallel::{Communicator, Exchange, Message};

/// Lengths of messages; some are multiples of the 1000 bytes to which `mpi_communicator` limits the messages of MPI.
const LENGTHS: [usize; 5] = [1, 999, 2000, 1001, 70_000];

/// The message of one rank to another in one exchange, if there is one.
fn contents(exchange: usize, from: usize, to: usize) -> Option<Vec<u8>> {
    let number = 31 * exchange + 7 * from + 3 * to;
    let length = LENGTHS[number % LENGTHS.len()];
    let bytes = (number..number + length).map(|byte| byte as u8).collect();
    (from != to && !number.is_multiple_of(4)).then_some(bytes)
}

/// All messages arrive whole while ranks reduce numbers, as a step does; an exchange that is dropped ends too.
pub(crate) fn messages_arrive_while_ranks_reduce_numbers(ranks: &dyn Communicator) {
    let (me, n) = (ranks.rank(), ranks.size());
    for exchange in 0..100 {
        let message = |rank, bytes| Message { rank, bytes };
        let sent = |from, to| contents(exchange, from, to);
        let outgoing: Vec<_> = (0..n).filter_map(|to| Some(message(to, sent(me, to)?))).collect();
        let expected: Vec<_> =
            (0..n).filter_map(|from| Some(message(from, sent(from, me)?))).collect();
        let empty = |expected: &Message| message(expected.rank, vec![0; expected.bytes.len()]);
        let incoming = expected.iter().map(empty).collect();
        let pending = ranks.start_exchange(Exchange { outgoing, incoming });
        assert_eq!(ranks.total(me + exchange), n * (n - 1) / 2 + n * exchange);
        if exchange % 7 == 3 {
            continue; // the next exchange would receive what this one left behind
        }
        assert!(pending.finish().incoming == expected, "exchange {exchange}, rank {me} of {n}");
    }
}

#[test]
fn messages_arrive_while_ranks_reduce_numbers_on_threads() {
    messages_arrive_while_ranks_reduce_numbers(&talcum::parallel::OneRank);
    for n in 1..=5 {
        talcum::parallel::run_on_threads(n, messages_arrive_while_ranks_reduce_numbers);
    }
}
