//! Agglomerates glued and separated by hand, across periodic faces and borders of ranks.

use super::*;
use crate::numbers::{Quantum, normal, random_of, uniform};
use crate::parallel::run_on_threads;
use std::f64::consts::PI;

/// Spheres of diameter 1 and mass 2.
fn particle(id: u64, position: [f64; 3]) -> ParticleSample {
    let [x, y, z] = position;
    ParticleSample {
        id,
        mass: 2.0,
        radius: 0.5,
        position: Vector3::new(x, y, z),
        velocity: Vector3::new(id as f64, 0.25, -1.0),
    }
}

struct Bed {
    particles: Vec<ParticleSample>,
    bonds: Vec<Pair>,
    touching: Vec<Pair>,
    periodicity: Periodicity,
    smallest: u64,
}

impl Bed {
    /// Labels by place and agglomerates by label, on n ranks; `salt` selects the distribution. The images held by the
    /// ranks differ.
    fn search(&self, n: usize, salt: usize) -> (Vec<Option<u64>>, Vec<Agglomerate>) {
        let made = run_on_threads(n, |ranks| {
            let mine = |place: usize| (place * place * salt + place) % 17 % n == ranks.rank();
            fn part<T: Copy>(all: &[T], mine: impl Fn(usize) -> bool) -> Vec<T> {
                let here = all.iter().enumerate().filter(|(place, _)| mine(*place));
                here.map(|(_, &item)| item).collect()
            }
            let mut particles = part(&self.particles, mine);
            particles.sort_by_key(|particle| particle.id);
            for particle in &mut particles {
                let image = [(particle.id as usize % n) as i32 - 1, 0, 2];
                particle.position = self.periodicity.shifted(particle.position, image);
            }
            let search = Search {
                particles: &particles,
                bonds: &part(&self.bonds, mine),
                touching: &part(&self.touching, |place| mine(place + 1)),
                periodicity: self.periodicity,
                smallest: self.smallest,
            };
            let agglomerates = search.run(ranks);
            self.check_members(&agglomerates, &particles, ranks);
            let ids = particles.iter().map(|particle| particle.id);
            (ids.zip(agglomerates.labels).collect::<Vec<_>>(), agglomerates.found)
        });
        let mut labels: Vec<_> = made.iter().flat_map(|(labels, _)| labels.clone()).collect();
        labels.sort_unstable();
        let mut found: Vec<_> = made.into_iter().flat_map(|(_, found)| found).collect();
        found.sort_by_key(|agglomerate| agglomerate.label);
        (labels.into_iter().map(|(_, label)| label).collect(), found)
    }
    /// Checks that gathered members are those of the agglomerate, and lie where it lies.
    fn check_members(
        &self,
        agglomerates: &Agglomerates,
        particles: &[ParticleSample],
        ranks: &dyn Communicator,
    ) {
        for label in [0, 5, 10, 100] {
            let members = agglomerates.members(label, particles, ranks);
            let found = agglomerates.found.iter().find(|found| found.label == label);
            let expected = found.filter(|_| !members.is_empty()).map_or(0, |found| found.members);
            assert_eq!(members.len() as u64, expected);
            if let Some(found) = found.filter(|found| found.winds == [0; 3]) {
                let first = members[0];
                assert_eq!(first.0, label);
                let centre = self.periodicity.displacement(&first.1, &found.centre) + first.1;
                let square: f64 = members.iter().map(|m| (m.1 - centre).norm_squared()).sum();
                let gyration = (square / members.len() as f64).sqrt();
                // Masses differ by a factor of 1.7 at most.
                assert!((gyration / found.radius_of_gyration - 1.0).abs() < 0.1);
            }
        }
    }
}

/// A straight rod of `n` across the border of x, ids from `first` upwards.
fn rod(first: u64, n: u64, from: [f64; 3]) -> (Vec<ParticleSample>, Vec<Pair>) {
    let place = |k: u64| [from[0] + k as f64, from[1], from[2]];
    let particles = (0..n).map(|k| particle(first + k, place(k))).collect();
    (particles, (1..n).map(|k| Pair::of(first + k - 1, first + k)).collect())
}

const COLUMN: Periodicity = Periodicity { lengths: [Some(32.0), Some(8.0), None] };

#[test]
fn a_rod_across_the_border_has_the_size_of_a_rod() {
    let (mut particles, bonds) = rod(100, 20, [20.0, 0.0, 3.0]);
    let (others, other_bonds) = rod(10, 4, [1.0, 4.0, 0.5]);
    particles.extend(others);
    let mut touching = [bonds.clone(), other_bonds.clone()].concat();
    touching.push(Pair::of(119, 10)); // touches, but not since t_0
    let bonds = [bonds, other_bonds].concat();
    let bed = Bed { particles, bonds, touching, periodicity: COLUMN, smallest: 15 };
    for n in 1..=4 {
        let (labels, found) = bed.search(n, 3);
        assert_eq!(labels[..4], [None; 4]);
        assert_eq!(labels[4..], [Some(100); 20]);
        let [rod] = found[..] else { panic!("{found:?}") };
        assert_eq!((rod.members, rod.mass, rod.winds), (20, 40.0, [0; 3]));
        assert_eq!(rod.centre, Vector3::new(29.5, 0.0, 3.0));
        assert_eq!(rod.velocity, Vector3::new(109.5, 0.25, -1.0));
        // R^2 = (n^2 - 1) / 12 for unit spacing.
        assert!((rod.radius_of_gyration - (399.0_f64 / 12.0).sqrt()).abs() < 1e-14);
        assert_eq!((rod.bonds, rod.contacts_within, rod.contacts), (38, 38, 39));
        assert!((rod.member_radius() - 0.5).abs() < 1e-15);
        // A rod has dimension 1 in a fit; with a prefactor of 1 the value for a single rod is ln 20 / ln(2 R).
        let single = libm::log(20.0) / libm::log(2.0 * rod.radius_of_gyration);
        assert!((rod.fractal_dimension().unwrap() - single).abs() < 1e-14);
    }
}

#[test]
fn without_unwrapping_a_rod_across_the_border_would_be_longer() {
    // Control of the test above: the same positions without periodicity.
    let (mut particles, bonds) = rod(100, 20, [20.0, 0.0, 3.0]);
    particles.iter_mut().for_each(|particle| particle.position.x %= 32.0);
    let touching = bonds.clone();
    let open = Periodicity::default();
    let bed = Bed { particles, bonds, touching, periodicity: open, smallest: 15 };
    assert!(bed.search(2, 1).1[0].radius_of_gyration > 1.5 * (399.0_f64 / 12.0).sqrt());
}

#[test]
fn a_ring_around_the_box_has_its_centre_where_it_is_thickest() {
    // A rod that closes on itself through the border, and a short rod transverse to it around x = 30.
    let (mut particles, mut bonds) = rod(5, 32, [0.0, 2.0, 3.0]);
    bonds.push(Pair::of(5, 36));
    let (side, side_bonds) = rod(50, 5, [28.0, 3.0, 3.0]);
    particles.extend(side);
    bonds.extend(side_bonds);
    bonds.push(Pair::of(5 + 30, 52));
    let bed = Bed { particles, touching: bonds.clone(), bonds, periodicity: COLUMN, smallest: 2 };
    let expected = bed.search(1, 1).1;
    assert_eq!(expected[0].winds, [1, 0, 0]);
    assert!((expected[0].centre.x - 30.0).abs() < 1e-12, "{}", expected[0].centre.x);
    assert!((expected[0].centre.y - (2.0 + 5.0 / 37.0)).abs() < 1e-14);
    for n in 1..=4 {
        assert_eq!(bed.search(n, 5).1, expected);
    }
}

/// 40 blobs of 30 to 60 particles, bonded in random trees with some more bonds, over the borders of the box.
fn blobs() -> Bed {
    let (mut particles, mut bonds) = (Vec::new(), Vec::new());
    let mut generator = random_of(9, 0, "blobs");
    // As in a run: shifting a position by a box length is exact.
    let quantum = Quantum::spanning(128.0);
    for blob in 0..40_u64 {
        let first = particles.len() as u64;
        let scale = [32.0, 8.0, 20.0];
        let seed: [f64; 3] = scale.map(|length| quantum.round(length * uniform(&mut generator)));
        for k in 0..30 + blob * 30 / 39 {
            let id = (first + k) * 7919 % 100_003;
            let parent = (uniform(&mut generator) * k as f64) as u64;
            let mut position = seed;
            if k > 0 {
                let of_parent: ParticleSample = particles[(first + parent) as usize];
                position = of_parent.position.into();
                bonds.push(Pair::of(id, of_parent.id));
            }
            let step = [(); 3].map(|()| 0.4 * normal(&mut generator));
            let position = [0, 1, 2].map(|axis| position[axis] + step[axis]);
            let mut new = particle(id, position.map(|x| quantum.round(x)));
            new.radius = 0.5 + 0.1 * uniform(&mut generator);
            new.mass = new.radius.powi(3);
            particles.push(new);
        }
    }
    let touching = bonds.iter().copied().skip(3).collect();
    Bed { particles, bonds, touching, periodicity: COLUMN, smallest: 15 }
}

#[test]
fn agglomerates_have_the_same_bits_on_any_ranks_and_agree_with_plain_sums() {
    let bed = blobs();
    let (labels, expected) = bed.search(1, 1);
    assert_eq!(expected.len(), 40);
    for (n, salt) in [(1, 4), (2, 1), (3, 1), (3, 2), (4, 3)] {
        assert!(bed.search(n, salt) == (labels.clone(), expected.clone()), "{n} ranks, {salt}");
    }
    // Each blob was made in an unwrapped frame, where plain sums apply.
    let mut first = 0;
    for blob in 0..40_u64 {
        let n = (30 + blob * 30 / 39) as usize;
        let members = &bed.particles[first..first + n];
        first += n;
        let label = members.iter().map(|member| member.id).min().unwrap();
        let found = expected.iter().find(|agglomerate| agglomerate.label == label).unwrap();
        let mass: f64 = members.iter().map(|member| member.mass).sum();
        let centre = members.iter().map(|m| m.mass * m.position).sum::<Vector3<f64>>() / mass;
        let second: f64 =
            members.iter().map(|m| m.mass * (m.position - centre).norm_squared()).sum();
        assert!((found.radius_of_gyration / (second / mass).sqrt() - 1.0).abs() < 1e-12);
        assert!(COLUMN.displacement(&found.centre, &centre).norm() < 1e-12);
        assert_eq!(found.members, n as u64);
        assert_eq!(found.bonds, 2 * (n as u64 - 1));
    }
}

#[test]
fn distributions_and_means_have_the_same_bits_on_any_ranks() {
    let all = blobs().search(1, 1).1;
    let on = |n: usize| {
        let made = run_on_threads(n, |ranks| {
            let here: Vec<_> = all.iter().skip(ranks.rank()).step_by(n).copied().collect();
            let sizes = |a: &Agglomerate| a.members as f64;
            let distribution = SizeDistribution::of(&here, sizes, &[30.0, 40.0, 60.0], ranks);
            (distribution, MassWeightedMeans::of(&here, ranks).unwrap())
        });
        made[n - 1].clone()
    };
    let (distribution, means) = on(1);
    assert_eq!((&distribution.number[..], distribution.outside), (&[13, 26][..], 1));
    assert_eq!(means.count, 40);
    let weighted: f64 = all.iter().map(|a| a.mass * a.diameter()).sum::<f64>() / means.mass;
    assert!((means.diameter / weighted - 1.0).abs() < 1e-14);
    for n in 2..=4 {
        assert_eq!(on(n), (distribution.clone(), means));
    }
    run_on_threads(2, |ranks| assert_eq!(MassWeightedMeans::of(&[], ranks), None));
}

#[test]
fn bonds_to_particles_that_have_left_are_dropped() {
    let (particles, mut bonds) = rod(0, 3, [0.0; 3]);
    bonds.push(Pair::of(2, 77));
    let bed = Bed { particles, touching: bonds.clone(), bonds, periodicity: COLUMN, smallest: 1 };
    let found = bed.search(2, 1).1;
    assert_eq!((found.len(), found[0].members, found[0].bonds), (1, 3, 4));
}

#[test]
fn packing_of_a_ball_is_that_of_its_material() {
    // A simple cubic ball of many spheres: pi / 6.
    let mut particles = Vec::new();
    for (x, y, z) in (0..9261).map(|k| (k % 21, k / 21 % 21, k / 441)) {
        let place = [x, y, z].map(|k| f64::from(k) - 10.0);
        if place.iter().map(|x| x * x).sum::<f64>() <= 100.0 {
            particles.push(particle(particles.len() as u64, place));
        }
    }
    let bonds: Vec<_> = (1..particles.len() as u64).map(|k| Pair::of(k - 1, k)).collect();
    let n = particles.len() as f64;
    let bed = Bed {
        particles,
        bonds,
        touching: vec![],
        periodicity: Periodicity::default(),
        smallest: 15,
    };
    let ball = bed.search(2, 1).1[0];
    // The surface of 4169 lattice points is rough: 2 %.
    assert!((ball.packing_fraction_of_ball() / (PI / 6.0) - 1.0).abs() < 0.02, "{ball:?} {n}");
    let ratio = ball.packing_fraction() / ball.packing_fraction_of_ball();
    assert!((ratio - (5.0_f64 / 3.0).powf(1.5)).abs() < 1e-12);
}
