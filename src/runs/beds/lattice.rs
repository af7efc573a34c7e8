//! A rectangular lattice, and random displacements from its sites.

use rand_chacha::ChaCha8Rng;
use talcum_engine::numbers::uniform;

/// Sites along an axis: number i is at `origin + (i + offset) * step / parts`.
///
/// With `parts` other than 1, `step` is the length that so many sites divide. `step / parts` beforehand would be the
/// same but for rounding, which the digests of beds depend on.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) origin: f64,
    pub(super) offset: f64,
    pub(super) step: f64,
    pub(super) parts: f64,
}

/// Sites numbered along x, then y, then z.
pub(super) struct Lattice {
    /// How many there are along x and y.
    pub(super) counts: [u64; 2],
    pub(super) rows: [Row; 3],
}

impl Lattice {
    /// Where the site of a number is.
    pub(super) fn site(&self, number: u64) -> [f64; 3] {
        let [nx, ny] = self.counts;
        let index = [number % nx, number / nx % ny, number / nx / ny];
        std::array::from_fn(|axis| {
            let Row { origin, offset, step, parts } = self.rows[axis];
            origin + (index[axis] as f64 + offset) * step / parts
        })
    }
}

/// Random numbers of up to a width along each axis, of either sign and all equally likely.
pub(super) fn displacement(generator: &mut ChaCha8Rng, widths: [f64; 3]) -> [f64; 3] {
    widths.map(|width| width * (2.0 * uniform(generator) - 1.0))
}

/// The sum of two vectors.
pub(super) fn displaced(site: [f64; 3], by: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| site[axis] + by[axis])
}
