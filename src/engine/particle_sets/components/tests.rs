//! Connected sets compared with a search on one rank, chains across ranks, and sets that wind around a periodic box.

use super::*;
use crate::numbers::{random_of, uniform};
use crate::parallel::run_on_threads;
use proptest::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// A distribution of ids and links over ranks.
#[derive(Clone, Copy, Debug)]
enum Spread {
    Scattered,
    Blocks,
    AllOnLast,
}

impl Spread {
    fn rank_of(self, place: usize, total: usize, n: usize) -> usize {
        match self {
            Self::Scattered => place * place % 13 % n,
            Self::Blocks => place * n / total,
            Self::AllOnLast => n - 1,
        }
    }

    fn part<T: Copy>(self, all: &[T], rank: usize, n: usize) -> Vec<T> {
        let places = all.iter().enumerate();
        let here = places.filter(|&(place, _)| self.rank_of(place, all.len(), n) == rank);
        here.map(|(_, &item)| item).collect()
    }
}

/// Memberships by id and number of rounds, for links spread over ranks.
fn on_ranks(
    n: usize,
    spread: Spread,
    ids: &[u64],
    links: &[Link],
) -> (BTreeMap<u64, Membership>, u32) {
    let made = run_on_threads(n, |ranks| {
        let ids = spread.part(ids, ranks.rank(), n);
        let links = spread.part(links, ranks.rank(), n);
        let (sets, rounds) = components_in_rounds(&ids, &links, ranks);
        (ids.into_iter().zip(sets).collect::<Vec<_>>(), rounds)
    });
    let rounds = made.iter().map(|(_, rounds)| *rounds).max().unwrap_or(0);
    (made.into_iter().flat_map(|(sets, _)| sets).collect(), rounds)
}

/// The smallest id of the set of each particle by breadth-first search, which shares nothing with the code under test.
fn labels_by_search(ids: &[u64], links: &[Link]) -> BTreeMap<u64, u64> {
    let mut neighbours: BTreeMap<u64, Vec<u64>> = ids.iter().map(|&id| (id, vec![])).collect();
    for &Link { ends: [a, b], .. } in links {
        neighbours.entry(a).or_default().push(b);
        neighbours.entry(b).or_default().push(a);
    }
    let mut labels = BTreeMap::new();
    for &start in neighbours.keys() {
        let mut queue = VecDeque::from([start]);
        while let Some(id) = queue.pop_front() {
            if labels.contains_key(&id) {
                continue;
            }
            labels.insert(id, start);
            queue.extend(&neighbours[&id]);
        }
    }
    labels
}

fn plain(ends: &[[u64; 2]]) -> Vec<Link> {
    ends.iter().map(|&ends| Link::new(ends, [0; 3])).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn random_graphs_on_any_ranks(
        seed in 0u64..1_000_000,
        particles in 1usize..300,
        mean_degree in 0.0..3.0f64,
        n in 1usize..=4,
        spread in prop::sample::select(vec![Spread::Scattered, Spread::Blocks, Spread::AllOnLast]),
    ) {
        let mut generator = random_of(seed, 0, "graph");
        let mut draw = || (uniform(&mut generator) * particles as f64) as u64 * 17 + 5;
        let ids: Vec<u64> = (0..particles as u64).map(|k| k * 17 + 5).collect();
        let ends: Vec<[u64; 2]> =
            (0..(particles as f64 * mean_degree / 2.0) as usize).map(|_| [draw(), draw()]).collect();
        let links = plain(&ends);
        let (sets, _) = on_ranks(n, spread, &ids, &links);
        let labels: BTreeMap<u64, u64> = sets.iter().map(|(&id, set)| (id, set.label)).collect();
        prop_assert_eq!(labels, labels_by_search(&ids, &links));
    }
}

/// A chain of 10,000 particles whose neighbours all lie on different ranks, with ids in an unfavourable order.
#[test]
fn long_chains_across_ranks_take_few_rounds() {
    const LENGTH: u64 = 10_000;
    let id = |place: u64| place * 7919 % 10_007; // a permutation
    let ids: Vec<u64> = (0..LENGTH).map(id).collect();
    let ends: Vec<[u64; 2]> = (1..LENGTH).map(|k| [id(k - 1), id(k)]).collect();
    for (n, ids, ends) in [
        (4, &ids, &ends),
        (2, &ids, &ends),
        // Ids along the chain, every link on another rank than the next.
        (4, &(0..LENGTH).collect(), &(1..LENGTH).map(|k| [k - 1, k]).collect()),
    ] {
        let links = plain(ends);
        let made = run_on_threads(n, |ranks| {
            let mine = |place: usize| place % n == ranks.rank();
            let links = links.iter().enumerate().filter(|(place, _)| mine(*place));
            let links: Vec<Link> = links.map(|(_, &link)| link).collect();
            let ids: Vec<u64> = ids.iter().skip(ranks.rank()).step_by(n).copied().collect();
            components_in_rounds(&ids, &links, ranks)
        });
        for (sets, rounds) in made {
            assert!(sets.iter().all(|set| set.label == 0));
            // log2(10,000) = 13.3; about log3 = 8.4 are expected for a chain.
            assert!(rounds <= 14, "{rounds} rounds");
        }
    }
}

#[test]
fn a_star_takes_few_rounds() {
    // With fixed priorities a star around its highest id is slow to contract.
    let links = plain(&(0..5000).map(|k| [k, 9999]).collect::<Vec<_>>());
    let ids: Vec<u64> = (0..5000).chain([9999]).collect();
    let (sets, rounds) = on_ranks(4, Spread::Scattered, &ids, &links);
    assert_eq!(sets[&9999].label, 0);
    assert_eq!(sets[&77].label, 0);
    assert!(rounds <= 6, "{rounds}");
}

/// Two clusters whose particles lie on two ranks each, glued by one link across the border, and separated again.
#[test]
fn two_agglomerates_are_glued_and_parted_across_a_rank_border() {
    let left: Vec<[u64; 2]> = (10..20).map(|k| [k, k + 1]).collect();
    let right: Vec<[u64; 2]> = (40..55).map(|k| [k + 1, k]).collect();
    let ids: Vec<u64> = (10..=20).chain(40..=55).collect();
    let apart = plain(&[left, right].concat());
    let glued = [apart.clone(), plain(&[[55, 13]])].concat();
    for n in 1..=4 {
        let labels = |links: &[Link]| -> Vec<u64> {
            let (sets, _) = on_ranks(n, Spread::Blocks, &ids, links);
            sets.values().map(|set| set.label).collect()
        };
        assert_eq!(labels(&glued), vec![10; 27]);
        let parted = [vec![10; 11], vec![40; 16]].concat();
        assert_eq!(labels(&apart), parted);
        assert_ne!(labels(&glued), parted); // the control: one link makes the difference
    }
}

/// A helix that passes the periodic border along x three times and the one along y once backwards.
#[test]
fn images_add_up_along_a_chain() {
    let mut links = Vec::new();
    for k in 0..40_u64 {
        let image = [i32::from(k % 12 == 11), -i32::from(k == 20), 0];
        links.push(Link::new([k, k + 1], image));
        links.push(Link::new([k + 1, k], image.map(|n| -n))); // the same, seen from the other side
    }
    let ids: Vec<u64> = (0..=40).collect();
    for n in 1..=4 {
        for spread in [Spread::Scattered, Spread::Blocks] {
            let (sets, _) = on_ranks(n, spread, &ids, &links);
            for (&id, set) in &sets {
                let expected = [(id / 12) as i32, -i32::from(id > 20), 0];
                assert_eq!((set.label, set.image, set.winds), (0, expected, [false; 3]));
            }
        }
    }
}

#[test]
fn a_set_that_winds_around_the_box_says_along_which_axes() {
    // A ring around x with a side chain across the border of y, and a set that only crosses the border of x.
    let mut links: Vec<Link> =
        (0..10).map(|k| Link::new([k, (k + 1) % 10], [i32::from(k == 9), 0, 0])).collect();
    links.push(Link::new([3, 50], [0, -1, 0]));
    links.push(Link::new([60, 61], [1, 0, 0]));
    let ids: Vec<u64> = (0..10).chain([50, 60, 61]).collect();
    let expected = on_ranks(1, Spread::Blocks, &ids, &links).0;
    assert_eq!(expected[&50].winds, [true, false, false]);
    assert_eq!(expected[&50].image, [0, -1, 0]);
    assert_eq!(expected[&61].winds, [false; 3]);
    assert_eq!(expected[&61].image, [1, 0, 0]);
    for n in 2..=4 {
        for spread in [Spread::Scattered, Spread::Blocks, Spread::AllOnLast] {
            assert_eq!(on_ranks(n, spread, &ids, &links).0, expected);
        }
    }
}

#[test]
fn a_set_that_is_joined_to_another_after_it_was_found_to_wind_still_winds() {
    // The ring is closed first; then a lower id replaces its root.
    let mut links: Vec<Link> =
        (10..20).map(|k| Link::new([k, (k - 9) % 10 + 10], [i32::from(k == 19), 0, 0])).collect();
    links.push(Link::new([15, 1], [0; 3]));
    let ids: Vec<u64> = (10..20).chain([1]).collect();
    for n in 1..=4 {
        for spread in [Spread::Scattered, Spread::Blocks, Spread::AllOnLast] {
            let (sets, _) = on_ranks(n, spread, &ids, &links);
            let winds = sets.values().all(|set| set.winds == [true, false, false]);
            assert!(winds && sets.values().all(|set| set.label == 1), "{n} {spread:?} {sets:?}");
        }
    }
}

#[test]
fn nothing_is_connected_to_nothing() {
    run_on_threads(3, |ranks| assert!(components(&[], &[], ranks).is_empty()));
    let (sets, rounds) = on_ranks(2, Spread::Blocks, &[4, 2], &[Link::new([4, 4], [0; 3])]);
    assert_eq!(sets[&4].label, 4);
    assert_eq!(sets[&2].label, 2);
    assert_eq!(rounds, 0);
}
