//! Threads as ranks: messages, reductions, and the case that one rank ends before the others.

use super::*;
use crate::parallel::agree;

fn message(from: usize, direction: &str) -> Vec<u8> {
    format!("{from} {direction}").into_bytes()
}

#[test]
fn neighbours_exchange_messages_along_a_periodic_axis() {
    // With one rank, both neighbours are the rank itself; with two, both are the other rank.
    for n in 1..=4 {
        run_on_threads(n, |ranks| {
            let me = ranks.rank();
            let [below, above] = [(me + n - 1) % n, (me + 1) % n];
            let mut incoming = [b"old".to_vec(), b"old".to_vec()];
            let (down, up) = (message(me, "down"), message(me, "up"));
            ranks.exchange([Some(below), Some(above)], [&down, &up], &mut incoming);
            assert_eq!(incoming, [message(below, "up"), message(above, "down")]);
        });
    }
}

#[test]
fn nothing_is_received_where_there_is_no_neighbour() {
    for n in 1..=3 {
        run_on_threads(n, |ranks| {
            let me = ranks.rank();
            let neighbours = [me.checked_sub(1), Some(me + 1).filter(|&above| above < n)];
            let mut incoming = [b"old".to_vec(), b"old".to_vec()];
            ranks.exchange(neighbours, [b"", &message(me, "up")], &mut incoming);
            assert_eq!(incoming[0], neighbours[0].map_or(vec![], |below| message(below, "up")));
            assert_eq!(incoming[1], b"");
        });
    }
}

#[test]
fn sums_and_maxima_are_taken_over_all_ranks() {
    for n in 1..=4 {
        run_on_threads(n, |ranks| {
            let me = ranks.rank();
            let mut exact = [0.25 * (me + 1) as f64, -0.0];
            ranks.sum_exact(&mut exact);
            assert_eq!(exact[0], 0.125 * (n * (n + 1)) as f64);
            assert!(exact[1].is_sign_positive());
            let mut integers = [me as i64, i64::MAX, 1];
            ranks.sum_integers(&mut integers);
            let largest_times_n = i64::MAX.wrapping_mul(n as i64);
            assert_eq!(integers, [(n * (n - 1) / 2) as i64, largest_times_n, n as i64]);
            let mut values = [me as f64, -(me as f64)];
            ranks.maximum(&mut values);
            assert_eq!(values, [(n - 1) as f64, 0.0]);
            let mut undefined = [if me == 0 { f64::NAN } else { 1.0 }];
            ranks.maximum(&mut undefined);
            assert_eq!(undefined, [f64::INFINITY]);
        });
    }
}

#[test]
fn sums_are_taken_while_other_numbers_are() {
    for n in 1..=4 {
        run_on_threads(n, |ranks| {
            let me = ranks.rank();
            for round in 0..100 {
                let exact = ranks.start_sum_exact(vec![0.25 * (me + round) as f64, -0.0]);
                let total = ranks.total(me) + ranks.total(round);
                if round % 7 == 3 {
                    continue; // drop waits as well: the next sum has none of these numbers
                }
                let exact = exact.finish();
                let all = n * (n - 1) / 2 + n * round;
                assert_eq!((exact[0], total), (0.25 * all as f64, all));
                assert!(exact[1].is_sign_positive());
            }
        });
    }
}

#[test]
fn rank_0_gathers_and_broadcasts() {
    for n in 1..=4 {
        run_on_threads(n, |ranks| {
            let gathered = ranks.gather_to_root(&vec![7; ranks.rank()]);
            let expected: Vec<Vec<u8>> = (0..n).map(|from| vec![7; from]).collect();
            assert_eq!(gathered, ranks.is_root().then_some(expected));
            let mut bytes = if ranks.is_root() { b"message".to_vec() } else { vec![] };
            ranks.broadcast_from_root(&mut bytes);
            assert_eq!(bytes, b"message");
        });
    }
}

#[test]
fn an_error_on_one_rank_is_an_error_on_all() {
    for n in 1..=4 {
        run_on_threads(n, |ranks| {
            let fine: Result<usize, String> = Ok(ranks.rank());
            assert_eq!(agree(fine, ranks), Ok(ranks.rank()));
            let last = ranks.rank() == n - 1;
            let result = if last { Err(format!("rank {} failed", n - 1)) } else { Ok(()) };
            assert_eq!(agree(result, ranks).unwrap_err().0, format!("rank {} failed", n - 1));
        });
    }
}

#[test]
#[should_panic(expected = "only here")]
fn a_panic_on_one_rank_ends_all() {
    run_on_threads(3, |ranks| {
        assert!(ranks.rank() != 1, "only here");
        ranks.any(false)
    });
}
