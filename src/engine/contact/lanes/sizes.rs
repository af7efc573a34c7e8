//! Radii and masses of the pairs of a block.

use crate::numbers::{F64x4, four};
use crate::particles::{Body, Lanes};

/// Radii and masses of the pairs of a block.
pub(crate) trait Sizes: Copy {
    /// Whether the two bodies of every pair are of equal size.
    const EQUAL: bool;

    /// Radii of the two bodies of four pairs, from lane `from` on.
    fn four_radii<Q: F64x4>(&self, from: usize) -> [Q; 2];

    /// The sizes of a pair that the law needs.
    fn reduced(&self, lane: usize) -> ReducedSizes;
}

/// Sizes of pairs of particles.
pub(crate) trait SizesOfPairs: Sizes {
    /// Stores the sizes of a pair in a lane.
    fn gather(&mut self, lane: usize, pair: [&Body; 2]);

    /// Radii of the two bodies of a pair.
    fn radii(&self, lane: usize) -> [f64; 2];
}

/// Reduced mass, radius and moment of inertia of two bodies.
#[derive(Clone, Copy)]
pub(crate) struct ReducedSizes {
    pub(crate) mass: f64,
    pub(crate) radius: f64,
    pub(crate) inertia: f64,
}

impl ReducedSizes {
    /// The reduced sizes of two solid spheres.
    #[inline(always)]
    fn of_spheres([radius_i, radius_j]: [f64; 2], [mass_i, mass_j]: [f64; 2]) -> Self {
        let inertia_i = 0.4 * mass_i * radius_i * radius_i;
        let inertia_j = 0.4 * mass_j * radius_j * radius_j;
        Self {
            mass: mass_i * mass_j / (mass_i + mass_j),
            radius: radius_i * radius_j / (radius_i + radius_j),
            inertia: inertia_i * inertia_j / (inertia_i + inertia_j),
        }
    }
}

/// Sizes for particles that are all equal: derived quantities are computed once, before the loop.
#[derive(Clone, Copy)]
pub(crate) struct OneSize {
    radius: f64,
    reduced: ReducedSizes,
}

impl OneSize {
    /// The sizes of pairs of particles of this radius and mass.
    #[inline(always)]
    pub(crate) fn new([radius, mass]: [f64; 2]) -> Self {
        Self { radius, reduced: ReducedSizes::of_spheres([radius; 2], [mass; 2]) }
    }
}

impl Sizes for OneSize {
    const EQUAL: bool = true;

    #[inline(always)]
    fn four_radii<Q: F64x4>(&self, _from: usize) -> [Q; 2] {
        [Q::splat(self.radius); 2]
    }

    #[inline(always)]
    fn reduced(&self, _lane: usize) -> ReducedSizes {
        self.reduced
    }
}

impl SizesOfPairs for OneSize {
    #[inline(always)]
    fn gather(&mut self, _lane: usize, _pair: [&Body; 2]) {}

    #[inline(always)]
    fn radii(&self, _lane: usize) -> [f64; 2] {
        [self.radius; 2]
    }
}

/// Sizes for particles of different sizes.
#[derive(Clone, Copy, Default)]
#[repr(align(64))] // see `Lanes`
pub(crate) struct ManySizes {
    radii: [Lanes; 2],
    masses: [Lanes; 2],
}

impl Sizes for ManySizes {
    const EQUAL: bool = false;

    #[inline(always)]
    fn four_radii<Q: F64x4>(&self, from: usize) -> [Q; 2] {
        [Q::load(four(&self.radii[0], from)), Q::load(four(&self.radii[1], from))]
    }

    #[inline(always)]
    fn reduced(&self, lane: usize) -> ReducedSizes {
        let masses = [self.masses[0][lane], self.masses[1][lane]];
        ReducedSizes::of_spheres(self.radii(lane), masses)
    }
}

impl SizesOfPairs for ManySizes {
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
}

/// Sizes for particles at a wall, which has infinite mass and radius: m* = m, R* = r, I* = I.
#[derive(Clone, Copy, Default)]
#[repr(align(64))] // see `Lanes`
pub(crate) struct SizesAtWall {
    pub(crate) radius: Lanes,
    pub(crate) mass: Lanes,
}

impl Sizes for SizesAtWall {
    const EQUAL: bool = false;

    /// The radius of the particle twice, since that of the wall would be infinite.
    #[inline(always)]
    fn four_radii<Q: F64x4>(&self, from: usize) -> [Q; 2] {
        [Q::load(four(&self.radius, from)); 2]
    }

    #[inline(always)]
    fn reduced(&self, lane: usize) -> ReducedSizes {
        let (mass, radius) = (self.mass[lane], self.radius[lane]);
        ReducedSizes { mass, radius, inertia: 0.4 * mass * radius * radius }
    }
}
