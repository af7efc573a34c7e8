//! Coordination number: how many particles a particle touches.

use crate::parallel::Communicator;
use crate::particle_sets::pair::{Pair, at_rendezvous};
use crate::particle_sets::rendezvous::send_to_rendezvous;

/// The distribution of the coordination number over the particles of a region.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordination {
    /// Number of particles with 0, 1, 2 ... neighbours; the last holds those with as many or more.
    pub particles: Vec<u64>,
    /// Sum of the neighbours of all particles.
    pub neighbours: u64,
}

impl Coordination {
    /// Number of particles.
    pub fn count(&self) -> u64 {
        self.particles.iter().sum()
    }

    /// Mean number of neighbours; zero without particles.
    pub fn mean(&self) -> f64 {
        match self.count() {
            0 => 0.0,
            count => self.neighbours as f64 / count as f64,
        }
    }

    /// Part of the particles with 0, 1, 2 ... neighbours.
    pub fn fractions(&self) -> Vec<f64> {
        let count = self.count().max(1) as f64;
        self.particles.iter().map(|&particles| particles as f64 / count).collect()
    }
}

/// A particle and the region that it lies in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InRegion {
    /// Global id.
    pub id: u64,
    /// Number of the region; a particle in none, beyond the last, counts for the whole only.
    pub region: u64,
}

/// Coordination of the whole, then of each region.
///
/// `particles` are those that this rank owns; `touching` are pairs held by any rank, or by several. Numbers of
/// neighbours of `most` or more are counted together (7 in Liu et al. 2016). Neighbours are counted wherever they
/// lie. Collective.
pub fn coordination(
    particles: &[InRegion],
    touching: &[Pair],
    regions: usize,
    most: usize,
    ranks: &dyn Communicator,
) -> Vec<Coordination> {
    let touching = at_rendezvous(touching, ranks);
    let mut ends = send_to_rendezvous(touching.iter().flat_map(Pair::ends), |&id| id, ranks);
    ends.sort_unstable();
    let records = particles.iter().map(|particle| [particle.id, particle.region]);
    let mut here = send_to_rendezvous(records, |record| record[0], ranks);
    here.sort_unstable();
    let columns = most + 2; // and the sum of neighbours
    let mut counts = vec![0; (regions + 1) * columns];
    let mut rest = &ends[..];
    for [id, region] in here {
        rest = &rest[rest.partition_point(|&end| end < id)..];
        let neighbours = rest.partition_point(|&end| end == id);
        let rows = [0, (region as usize).saturating_add(1)];
        for row in rows.into_iter().filter(|&row| row <= regions) {
            counts[row * columns + neighbours.min(most)] += 1;
            counts[row * columns + most + 1] += neighbours as i64;
        }
    }
    ranks.sum_integers(&mut counts);
    let row = |row: &[i64]| Coordination {
        particles: row[..=most].iter().map(|&count| count as u64).collect(),
        neighbours: row[most + 1] as u64,
    };
    counts.chunks_exact(columns).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    /// A simple cubic crystal of 4 x 4 x 4 particles and one that is alone; the lower half is a region.
    fn crystal(n: usize) -> Vec<Coordination> {
        let id = |x: u64, y: u64, z: u64| 3 * (x + 4 * y + 16 * z);
        let mut particles = vec![InRegion { id: 1, region: 9 }];
        let mut pairs = Vec::new();
        for (x, y, z) in (0..64).map(|k| (k % 4, k / 4 % 4, k / 16)) {
            particles.push(InRegion { id: id(x, y, z), region: u64::from(z >= 2) });
            let neighbours = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
            let inside = neighbours.into_iter().filter(|&(x, y, z)| x.max(y).max(z) < 4);
            pairs.extend(inside.map(|(p, q, r)| Pair::of(id(p, q, r), id(x, y, z))));
        }
        let made = run_on_threads(n, |ranks| {
            let mine = |place: usize| place * place % 5 % n == ranks.rank();
            let particles = particles.iter().enumerate().filter(|(place, _)| mine(*place));
            let particles: Vec<_> = particles.map(|(_, &particle)| particle).collect();
            // Some are known to two ranks.
            let known = |place: usize| mine(place) || mine(place + 1);
            let pairs = pairs.iter().enumerate().filter(|(place, _)| known(*place));
            let pairs: Vec<_> = pairs.map(|(_, &pair)| pair).collect();
            coordination(&particles, &pairs, 2, 5, ranks)
        });
        assert!(made.iter().all(|all| *all == made[0]));
        made.into_iter().next().unwrap()
    }

    #[test]
    fn a_crystal_has_corners_edges_faces_and_an_inside() {
        for n in 1..=4 {
            let [whole, lower, upper] = &crystal(n)[..] else { panic!("three rows") };
            // 8 corners with 3, 24 on edges with 4, 24 on faces with 5, 8 inside with 6 (counted with 5).
            assert_eq!(whole.particles, [1, 0, 0, 8, 24, 32]);
            assert_eq!(whole.neighbours, 2 * 3 * 48);
            assert!((whole.mean() - 288.0 / 65.0).abs() < 1e-15);
            assert_eq!(lower.particles, [0, 0, 0, 4, 12, 16]);
            assert_eq!(lower, upper);
            assert!((upper.fractions()[4] - 12.0 / 32.0).abs() < 1e-15);
        }
    }

    #[test]
    fn without_contacts_nobody_has_neighbours() {
        // The control.
        run_on_threads(2, |ranks| {
            let particles = [InRegion { id: ranks.rank() as u64, region: 0 }];
            let all = coordination(&particles, &[], 1, 7, ranks);
            assert_eq!((all[0].particles[0], all[0].neighbours, all[0].mean()), (2, 0, 0.0));
            assert_eq!(coordination(&[], &[], 0, 7, ranks)[0].mean(), 0.0);
        });
    }
}
