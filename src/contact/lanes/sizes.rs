//! Radii and masses of the pairs of a block.

use super::Lanes;
use crate::particles::Body;

/// Radii and masses of the pairs of a block.
pub(crate) trait Sizes: Copy {
    /// Whether the two bodies of every pair are equal.
    const EQUAL: bool;

    /// Stores the sizes of a pair in a lane.
    fn gather(&mut self, lane: usize, pair: [&Body; 2]);

    /// Radii of the two bodies of a pair.
    fn radii(&self, lane: usize) -> [f64; 2];

    /// Masses of the two bodies of a pair.
    fn masses(&self, lane: usize) -> [f64; 2];

    /// The same as a value, for laws that are called through a table of functions.
    fn as_any_sizes(&self) -> AnySizes<'_>;
}

/// Sizes of either kind.
#[derive(Clone, Copy)]
pub(crate) enum AnySizes<'a> {
    One(OneSize),
    Many(&'a ManySizes),
}

/// All particles have one size: what follows from it is computed once, before the loop.
#[derive(Clone, Copy)]
pub(crate) struct OneSize {
    pub(crate) radius: f64,
    pub(crate) mass: f64,
}

impl Sizes for OneSize {
    const EQUAL: bool = true;

    #[inline(always)]
    fn gather(&mut self, _lane: usize, _pair: [&Body; 2]) {}

    #[inline(always)]
    fn radii(&self, _lane: usize) -> [f64; 2] {
        [self.radius; 2]
    }

    #[inline(always)]
    fn masses(&self, _lane: usize) -> [f64; 2] {
        [self.mass; 2]
    }

    #[inline(always)]
    fn as_any_sizes(&self) -> AnySizes<'_> {
        AnySizes::One(*self)
    }
}

/// Particles of different sizes.
#[derive(Clone, Copy, Default)]
pub(crate) struct ManySizes {
    radii: [Lanes; 2],
    masses: [Lanes; 2],
}

impl Sizes for ManySizes {
    const EQUAL: bool = false;

    #[inline(always)]
    fn gather(&mut self, lane: usize, pair: [&Body; 2]) {
        for (side, body) in pair.into_iter().enumerate() {
            self.radii[side][lane] = body.radius;
            self.masses[side][lane] = body.mass;
        }
    }

    #[inline(always)]
    fn radii(&self, lane: usize) -> [f64; 2] {
        [self.radii[0][lane], self.radii[1][lane]]
    }

    #[inline(always)]
    fn masses(&self, lane: usize) -> [f64; 2] {
        [self.masses[0][lane], self.masses[1][lane]]
    }

    #[inline(always)]
    fn as_any_sizes(&self) -> AnySizes<'_> {
        AnySizes::Many(self)
    }
}
