//! The Lacey index of mixing.
//!
//! Source: Lacey, J. Appl. Chem. 4 (1954) 257, doi:10.1002/jctb.5010040504.

use talcum_engine::parallel::Communicator;

/// A particle of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Number of the sample cell in which it lies; it is left out beyond the last cell.
    pub cell: u64,
    /// Whether it belongs to the class whose mixing is measured: a class of size, or particles that were in a region at
    /// a reference time.
    pub tracer: bool,
}

/// The degree of mixing of a class with the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaceyIndex {
    /// M = (S_0^2 - S^2) / (S_0^2 - S_R^2): 0 if every cell contains only one class, 1 on average if classes are
    /// random.
    pub index: f64,
    /// Standard deviation of M about 1 for random classes, in cells with many particles.
    pub error: f64,
    /// p, fraction of tracers among the particles in the cells used.
    pub fraction: f64,
    /// S^2, variance of the fraction of tracers in cells, each cell weighted by its number of particles.
    pub variance: f64,
    /// Number of cells used.
    pub cells: u64,
    /// Number of particles in them.
    pub particles: u64,
}

/// M over the cells that contain at least `least` particles on all ranks.
///
/// With n_k particles and a fraction p_k of tracers in cell k of K, N = sum n_k: S^2 = sum n_k (p_k - p)^2 / N,
/// S_0^2 = p (1 - p), and S_R^2 = p (1 - p) (K - 1) / (N - 1), exactly the mean of S^2 if the tracers are drawn at
/// random from the N particles (Lacey's p (1 - p) / n is its limit for many cells of n particles). Particles count by
/// number. `None` if the cells contain only one class, or there is only one cell. Collective.
pub fn lacey_index(
    samples: &[Sample],
    cells: usize,
    least: u64,
    ranks: &dyn Communicator,
) -> Option<LaceyIndex> {
    let mut counts = vec![0_i64; 2 * cells];
    for sample in samples {
        let place = (sample.cell as usize).saturating_mul(2);
        if let Some(counts) = counts.get_mut(place..place.saturating_add(2)) {
            counts[0] += 1;
            counts[1] += i64::from(sample.tracer);
        }
    }
    ranks.sum_integers(&mut counts);
    let used = || counts.chunks_exact(2).filter(|cell| cell[0] > 0 && cell[0] as u64 >= least);
    let total = |k: usize| used().map(|cell| cell[k]).sum::<i64>() as f64;
    let (cells, particles, tracers) = (used().count() as f64, total(0), total(1));
    let fraction = tracers / particles;
    let squares = used().map(|cell| {
        let deviation = cell[1] as f64 / cell[0] as f64 - fraction;
        cell[0] as f64 * deviation * deviation
    });
    let variance = squares.sum::<f64>() / particles;
    let segregated = fraction * (1.0 - fraction);
    let mixed = segregated * (cells - 1.0) / (particles - 1.0);
    // The variance of a sum of K squares of normal numbers is 2 K.
    let scatter = segregated * (2.0 * (cells - 1.0)).sqrt() / particles;
    (segregated > mixed && cells > 1.0).then(|| LaceyIndex {
        index: (segregated - variance) / (segregated - mixed),
        error: scatter / (segregated - mixed),
        fraction,
        variance,
        cells: cells as u64,
        particles: particles as u64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::numbers::{random_of, uniform};
    use talcum_engine::parallel::run_on_threads;

    const CELLS: usize = 200;

    /// 6000 particles, about 30 per cell; part of them have a random class, the others have that of their cell.
    fn samples(mixed: f64, seed: u64) -> Vec<Sample> {
        let mut generator = random_of(seed, 0, "mixing");
        let mut draw = || uniform(&mut generator);
        (0..6000)
            .map(|_| {
                let cell = (CELLS as f64 * draw()) as u64;
                let of_cell = cell < 80;
                let (is_mixed, class) = (draw() < mixed, draw() < 0.4);
                Sample { cell, tracer: if is_mixed { class } else { of_cell } }
            })
            .collect()
    }

    fn index(samples: &[Sample], n: usize) -> Option<LaceyIndex> {
        let made = run_on_threads(n, |ranks| {
            let here: Vec<_> = samples.iter().skip(ranks.rank()).step_by(n).copied().collect();
            lacey_index(&here, CELLS, 5, ranks)
        });
        assert!(made.iter().all(|found| *found == made[0]));
        made[0]
    }

    #[test]
    fn segregated_is_0_and_mixed_is_1_within_its_error() {
        assert!(index(&samples(0.0, 1), 2).unwrap().index.abs() < 1e-12);
        let trials = 40;
        let found: Vec<LaceyIndex> =
            (0..trials).map(|seed| index(&samples(1.0, seed), 1).unwrap()).collect();
        let mean = found.iter().map(|m| m.index).sum::<f64>() / trials as f64;
        let error = found[0].error;
        assert!((mean - 1.0).abs() < 4.0 * error / (trials as f64).sqrt(), "{mean} {error}");
        let squares: f64 = found.iter().map(|m| (m.index - 1.0).powi(2)).sum();
        let ratio = (squares / trials as f64).sqrt() / error;
        assert!((0.6..1.5).contains(&ratio), "{ratio}");
        // Control: without the variance of finite samples M would remain below 1, by seven errors and more.
        let naive = 1.0 - found[0].variance / (found[0].fraction * (1.0 - found[0].fraction));
        assert!(1.0 - naive > 7.0 * error, "{naive}");
    }

    #[test]
    fn half_mixed_has_the_variance_of_half_mixed() {
        for mixed in [0.3, 0.5, 0.8] {
            // Fractions of cells differ by (1 - mixed) times the difference of pure cells.
            let expected = 1.0 - (1.0 - mixed) * (1.0 - mixed);
            let found = index(&samples(mixed, 3), 1).unwrap();
            assert!((found.index - expected).abs() < 0.02, "{mixed} {found:?}");
            (2..=4).for_each(|n| assert_eq!(index(&samples(mixed, 3), n), Some(found)));
        }
    }

    #[test]
    fn one_class_or_one_cell_has_no_index() {
        let all = vec![Sample { cell: 3, tracer: true }; 100];
        assert_eq!(index(&all, 2), None);
        let outside =
            [Sample { cell: u64::MAX, tracer: true }, Sample { cell: 999, tracer: false }];
        assert_eq!(index(&outside, 1), None);
        let one_cell: Vec<_> = (0..50).map(|k| Sample { cell: 1, tracer: k % 2 == 0 }).collect();
        assert_eq!(index(&one_cell, 1), None);
    }
}
