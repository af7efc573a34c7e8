//! Messages that travel while ranks do other work, on threads; `mpi_communicator` tests the same on processes.

use talcum::parallel::{Communicator, Message};

/// Lengths of messages; some are multiples of the 1000 bytes to which `mpi_communicator` limits the messages of MPI.
const LENGTHS: [usize; 5] = [1, 999, 2000, 1001, 70_000];

/// The message of one rank to another in one exchange, if there is one.
fn contents(exchange: usize, from: usize, to: usize) -> Option<Vec<u8>> {
    let number = 31 * exchange + 7 * from + 3 * to;
    let length = LENGTHS[number % LENGTHS.len()];
    let bytes = (number..number + length).map(|byte| byte as u8).collect();
    (from != to && !number.is_multiple_of(4)).then_some(bytes)
}

/// All messages arrive whole, some after the other work, in which ranks reduce numbers as a step does.
pub(crate) fn messages_arrive_after_other_work(ranks: &dyn Communicator) {
    let (me, n) = (ranks.rank(), ranks.size());
    for exchange in 0..100 {
        let message = |rank, bytes| Message { rank, bytes };
        let sent = |from, to| contents(exchange, from, to);
        let outgoing: Vec<_> = (0..n).filter_map(|to| Some(message(to, sent(me, to)?))).collect();
        let expected: Vec<_> =
            (0..n).filter_map(|from| Some(message(from, sent(from, me)?))).collect();
        let empty = |expected: &Message| message(expected.rank, vec![0; expected.bytes.len()]);
        let mut incoming: Vec<_> = expected.iter().map(empty).collect();
        let mut total = 0;
        ranks.exchange_during(&outgoing, &mut incoming, &mut || total = ranks.total(me + exchange));
        assert_eq!(total, n * (n - 1) / 2 + n * exchange);
        assert!(incoming == expected, "exchange {exchange}, rank {me} of {n}");
    }
}

#[test]
fn messages_arrive_after_other_work_on_threads() {
    messages_arrive_after_other_work(&talcum::parallel::OneRank);
    for n in 1..=5 {
        talcum::parallel::run_on_threads(n, messages_arrive_after_other_work);
    }
}
