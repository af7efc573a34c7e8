//! Fates of agglomerates between two samples, for constructed sets whose fate is known.

use super::*;
use talcum_engine::numbers::{random_of, uniform};
use talcum_engine::parallel::run_on_threads;
use talcum_engine::particle_sets::rendezvous::mixed;

/// A digest of fates that does not depend on the ranks that hold them: the sum of the hashes of all fates. Collective.
fn digest(changes: &Changes, ranks: &dyn Communicator) -> i64 {
    let of = |fate: &Fate| {
        let next = fate.successor();
        let parts = [fate.label, fate.size, fate.released, fate.fragments.len() as u64];
        let next = next.map_or([0; 5], |n| [n.label, n.shared, n.size, n.sources, n.origin]);
        parts.iter().chain(&next).fold(7, |hash, &part| mixed(hash ^ part)) as i64
    };
    let mut sum = [changes.fates.iter().map(of).fold(0, i64::wrapping_add)];
    sum[0] =
        changes.new.iter().fold(sum[0], |s, n| s.wrapping_add(mixed(n[0] ^ mixed(n[1])) as i64));
    ranks.sum_integers(&mut sum);
    sum[0]
}

/// Fates by label, and new agglomerates, on n ranks, from the labels of particles 0, 1, 2 ... at two samples.
fn changes(n: usize, before: &[Option<u64>], after: &[Option<u64>]) -> (Vec<Fate>, Vec<[u64; 2]>) {
    let made = run_on_threads(n, |ranks| {
        let look = |labels: &[Option<u64>], salt: usize| {
            let mine = |id: usize| id * salt % 7 % n == ranks.rank();
            let ids: Vec<usize> = (0..labels.len()).filter(|&id| mine(id)).collect();
            let labels: Vec<_> = ids.iter().map(|&id| labels[id]).collect();
            let ids: Vec<u64> = ids.iter().map(|&id| id as u64).collect();
            let look = Look::take(&ids, &labels);
            let records = look.records().to_vec();
            assert_eq!(Look::of_records(records), look);
            look
        };
        let changes = Changes::between(&look(before, 3), &look(after, 5), ranks);
        let digest = digest(&changes, ranks);
        (changes, digest)
    });
    assert!(made.iter().all(|(_, digest)| *digest == made[0].1));
    let mut fates: Vec<_> = made.iter().flat_map(|(changes, _)| changes.fates.clone()).collect();
    fates.sort_by_key(|fate| fate.label);
    let mut new: Vec<_> = made.iter().flat_map(|(changes, _)| changes.new.clone()).collect();
    new.sort_unstable();
    (fates, new)
}

fn labels(parts: &[(Option<u64>, usize)]) -> Vec<Option<u64>> {
    parts.iter().flat_map(|&(label, count)| vec![label; count]).collect()
}

#[test]
fn an_agglomerate_splits_another_is_absorbed_and_a_third_exchanges() {
    // 100 -> 60 in one, 30 in another, 10 released; 20 -> absorbed by the 60; 50 -> 40 and 12 that were free.
    let before = labels(&[(Some(0), 100), (Some(100), 20), (Some(120), 50), (None, 30)]);
    let after = labels(&[
        (Some(0), 60),
        (Some(60), 30),
        (None, 10),
        (Some(0), 20),
        (Some(120), 40),
        (None, 10),
        (Some(120), 12),
        (Some(182), 18),
    ]);
    for n in 1..=4 {
        let (fates, new) = changes(n, &before, &after);
        let [large, small, third] = &fates[..] else { panic!("{fates:?}") };
        assert_eq!((large.size, large.released, large.fragments.len()), (100, 10, 2));
        assert_eq!((large.lost(), large.gained(), large.survives()), (40, 20, true));
        assert_eq!((small.lost(), small.gained(), small.survives()), (0, 60, false));
        let into = small.successor().unwrap();
        assert_eq!((into.size, into.sources, into.origin), (80, 2, 0));
        assert_eq!((third.lost(), third.gained(), third.survives()), (10, 12, true));
        assert_eq!(new, [[182, 18]]);
    }
}

#[test]
fn nothing_happens_where_labels_stay() {
    // Control: the same sample twice.
    let same = labels(&[(Some(0), 40), (None, 5), (Some(45), 16)]);
    let (fates, new) = changes(3, &same, &same);
    assert!(fates.iter().all(|fate| fate.lost() + fate.gained() == 0 && fate.survives()));
    assert!(new.is_empty());
}

#[test]
fn departed_particles_are_released_and_equal_halves_follow_the_smaller_label() {
    let before = labels(&[(Some(0), 30)]);
    let after = labels(&[(Some(10), 10), (Some(0), 10)]); // ten have left
    let (fates, _) = changes(2, &before, &after);
    assert_eq!((fates[0].released, fates[0].successor().unwrap().label), (10, 0));
    assert!(!fates[0].survives()); // a third
}

#[test]
fn random_looks_give_the_same_fates_on_any_ranks() {
    let mut generator = random_of(8, 0, "looks");
    let mut draw = || -> Vec<Option<u64>> {
        let label = |x: f64| (x < 40.0).then_some(x as u64);
        (0..3000).map(|_| label(45.0 * uniform(&mut generator))).collect()
    };
    let (before, after) = (draw(), draw());
    let expected = changes(1, &before, &after);
    assert_eq!(expected.0.len(), 40);
    for fate in &expected.0 {
        let members = (0..3000).filter(|&id| before[id] == Some(fate.label));
        assert_eq!(fate.size, members.clone().count() as u64);
        let next = fate.successor().unwrap();
        let shared = members.filter(|&id| after[id] == Some(next.label)).count() as u64;
        assert_eq!(next.shared, shared);
        assert!(fate.fragments.iter().all(|fragment| fragment.shared <= shared));
    }
    for n in 2..=4 {
        assert!(changes(n, &before, &after) == expected, "{n} ranks");
    }
}

/// Agglomerates of sizes from 16 to 1023 that lose 5 members with a probability of 0.1 size / 200 in an interval, and
/// gain 7 with a probability of 0.1.
fn breaking_and_growing() -> Vec<Fate> {
    let mut generator = random_of(6, 0, "rates");
    let mut draw = || uniform(&mut generator);
    let fate = |label: u64| {
        let size = (16.0 * libm::exp2(6.0 * draw())) as u64;
        let lost = if draw() < 0.1 * size as f64 / 200.0 { 5 } else { 0 };
        let gained = if draw() < 0.1 { 7 } else { 0 };
        let shared = size - lost;
        let next = Fragment { label, shared, size: shared + gained, sources: 1, origin: label };
        Fate { label, size, fragments: vec![next], released: lost, successor: Some(0) }
    };
    (0..40_000).map(fate).collect()
}

/// Rates for bins of powers of two, with half a unit of time between samples.
fn rates_on(n: usize, fates: &[Fate]) -> Vec<RatesOfSize> {
    let limits: Vec<u64> = (4..11).map(|k| 1 << k).collect();
    let made = run_on_threads(n, |ranks| {
        let mut counts = RateCounts::new(&limits, 2);
        counts.add(fates.iter().skip(ranks.rank()).step_by(n));
        let mut again = RateCounts::new(&limits, 2);
        again.add_stored(&counts.stored());
        again.rates(0.5, ranks)
    });
    made.into_iter().next_back().unwrap()
}

#[test]
fn rates_are_found_within_their_counting_errors() {
    let fates = breaking_and_growing();
    let rates = rates_on(1, &fates);
    (2..=4).for_each(|n| assert!(rates_on(n, &fates) == rates));
    for of_size in &rates {
        let [low, high] = of_size.sizes.map(|size| size as f64);
        // Mean of sizes that are equally likely on a logarithmic scale; sizes are rounded down.
        let mean = (high - low) / libm::log(high / low) - 0.5;
        let expected = 0.1 * mean / 200.0 / 0.5;
        assert!((of_size.breakage.value - expected).abs() < 4.0 * of_size.breakage.error);
        assert!((of_size.growth.value - 0.1 / 0.5).abs() < 4.0 * of_size.growth.error);
        assert!((of_size.gained.value - 7.0 * of_size.growth.value).abs() < 1e-12);
        assert!((of_size.lost.error - 5.0 * of_size.breakage.error).abs() < 1e-12);
    }
}

#[test]
fn growth_and_breakage_cross_where_they_should() {
    let rates = rates_on(1, &breaking_and_growing());
    let found = crossing(&rates, |rate| (rate.growth, rate.breakage)).unwrap();
    assert!((found.size - 200.0).abs() < 3.0 * found.error, "{found:?}");
    assert!(found.error < 20.0);
    // Control: half of the growth crosses at half of the size, a difference that the errors resolve.
    let halved = |rate: Rate| Rate { value: 0.5 * rate.value, error: 0.5 * rate.error };
    let lower = crossing(&rates, |rate| (halved(rate.growth), rate.breakage)).unwrap();
    assert!((lower.size - 100.0).abs() < 3.0 * lower.error && lower.size < 150.0, "{lower:?}");
    // In members: 7 are gained at once, and 5 lost.
    let members = crossing(&rates, |rate| (rate.gained, rate.lost)).unwrap();
    assert!((members.size - 280.0).abs() < 3.0 * members.error, "{members:?}");
    assert_eq!(crossing(&rates, |rate| (rate.breakage, Rate::default())), None);
}
