//! Coordination number: the number of particles that a particle touches.

use talcum_engine::parallel::Communicator;

/// The distribution of the coordination number over particles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordination {
    /// Number of particles with 0, 1, 2 ... neighbours; the last entry includes those with more.
    pub particles: Vec<u64>,
    /// Sum of the neighbours of all particles.
    pub neighbours: u64,
}

impl Coordination {
    /// The distribution of these numbers of neighbours; numbers of `most` or more are counted together.
    pub fn of(numbers: impl IntoIterator<Item = u32>, most: usize) -> Self {
        let mut found = Self { particles: vec![0; most + 1], neighbours: 0 };
        for number in numbers {
            found.particles[(number as usize).min(most)] += 1;
            found.neighbours += u64::from(number);
        }
        found
    }

    /// The distribution over the particles of all ranks; this one is the part of one rank. Collective.
    #[must_use]
    pub fn total(&self, ranks: &dyn Communicator) -> Self {
        let counts = self.particles.iter().chain([&self.neighbours]);
        let mut counts: Vec<i64> = counts.map(|&count| count as i64).collect();
        ranks.sum_integers(&mut counts);
        let mut counts = counts.into_iter().map(|count| count as u64);
        let particles = counts.by_ref().take(self.particles.len()).collect();
        Self { particles, neighbours: counts.sum() }
    }

    /// Number of particles.
    pub fn count(&self) -> u64 {
        self.particles.iter().sum()
    }

    /// Mean number of neighbours; zero without particles.
    pub fn mean(&self) -> f64 {
        self.neighbours as f64 / self.count().max(1) as f64
    }

    /// Fractions of the particles with 0, 1, 2 ... neighbours.
    pub fn fractions(&self) -> Vec<f64> {
        let count = self.count().max(1) as f64;
        self.particles.iter().map(|&particles| particles as f64 / count).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::parallel::run_on_threads;

    /// Numbers of neighbours in a simple cubic crystal of 4 x 4 x 4 particles, and of a single particle.
    fn crystal() -> Vec<u32> {
        let neighbours = |k: u32| if k == 0 || k == 3 { 1 } else { 2 };
        let of = |place: u32| {
            [place % 4, place / 4 % 4, place / 16].map(neighbours).into_iter().sum::<u32>()
        };
        (0..64).map(of).chain([0]).collect()
    }

    #[test]
    fn a_crystal_has_corners_edges_faces_and_an_inside_on_any_ranks() {
        for n in 1..=4 {
            let made = run_on_threads(n, |ranks| {
                let mine = crystal().into_iter().skip(ranks.rank()).step_by(n);
                Coordination::of(mine, 5).total(ranks)
            });
            for whole in made {
                // 8 corners with 3, 24 on edges with 4, 24 on faces with 5, 8 inside with 6 (counted with 5).
                assert_eq!(whole.particles, [1, 0, 0, 8, 24, 32]);
                assert_eq!(whole.neighbours, 2 * 3 * 48);
                assert!((whole.mean() - 288.0 / 65.0).abs() < 1e-15);
                assert!((whole.fractions()[4] - 24.0 / 65.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn without_contacts_nobody_has_neighbours() {
        // The control.
        let alone = Coordination::of([0, 0], 7);
        assert_eq!((alone.particles[0], alone.neighbours, alone.mean()), (2, 0, 0.0));
        assert_eq!(Coordination::of([], 7).mean(), 0.0);
    }
}
