//! A block of near pairs, component by component: filled from records of bodies, emptied into loads.

use crate::numbers::{F64x4, four, four_mut};
use crate::particles::{Body, ForceTorque, LANES};
use nalgebra::Vector3;

pub(super) type Lanes = [f64; LANES];

/// Radii and masses of the pairs of a block.
pub(super) trait Sizes: Copy {
    /// Whether the two bodies of every pair are equal.
    const EQUAL: bool;

    fn gather(&mut self, lane: usize, pair: [&Body; 2]);
    fn radii(&self, lane: usize) -> [f64; 2];
    fn masses(&self, lane: usize) -> [f64; 2];
}

/// All particles are alike: what follows from sizes is found once, before the loop.
#[derive(Clone, Copy)]
pub(super) struct OneSize {
    pub(super) radius: f64,
    pub(super) mass: f64,
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
}

/// Sizes differ.
#[derive(Clone, Copy, Default)]
pub(super) struct ManySizes {
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
}

/// The pairs of a block, component by component.
#[derive(Default)]
pub(super) struct Block {
    pub(super) branch: [Lanes; 3],
    /// Of the centres; then of the surfaces where they meet.
    pub(super) relative_velocity: [Lanes; 3],
    /// omega_i r_i + omega_j r_j.
    pub(super) surface_spin: [Lanes; 3],
    /// Only if rolling is resisted.
    pub(super) relative_spin: [Lanes; 3],
    pub(super) overlap: Lanes,
    pub(super) normal: [Lanes; 3],
    pub(super) cohesion: Lanes,
    pub(super) normal_force: Lanes,
    pub(super) tangential_force: [Lanes; 3],
    /// On j; only if rolling is resisted.
    pub(super) rolling_torque: [Lanes; 3],
    pub(super) force_on_j: [Lanes; 3],
    /// Less the torques.
    pub(super) torque_off_i: [Lanes; 3],
    pub(super) torque_off_j: [Lanes; 3],
    /// 1 where the bodies touch.
    pub(super) touching: [u64; LANES],
    /// 1 where the force exceeds the limit or is undefined.
    pub(super) out_of_range: [u64; LANES],
}

impl Block {
    /// Brings bodies into lanes; their relative spin only if it is asked for.
    #[inline(always)]
    pub(super) fn gather<Q: F64x4, S: Sizes>(
        &mut self,
        sizes: &mut S,
        [first, second]: [&[u32; LANES]; 2],
        bodies: &[Body],
        with_relative_spin: bool,
    ) {
        let zero = [Q::splat(0.0); 4];
        let (mut branch, mut velocity, mut spin, mut relative_spin) = (zero, zero, zero, zero);
        for from in (0..LANES).step_by(4) {
            for row in 0..4 {
                let lane = from + row;
                let (i, j) = (&bodies[first[lane] as usize], &bodies[second[lane] as usize]);
                sizes.gather(lane, [i, j]);
                let [radius_i, radius_j] = sizes.radii(lane);
                let ([place_i, motion_i, spin_i], [place_j, motion_j, spin_j]) =
                    (i.vectors(), j.vectors());
                branch[row] = Q::load(place_j).minus(Q::load(place_i));
                velocity[row] = Q::load(motion_j).minus(Q::load(motion_i));
                let (spin_i, spin_j) = (Q::load(spin_i), Q::load(spin_j));
                let surface_i = spin_i.times(Q::splat(radius_i));
                spin[row] = surface_i.plus(spin_j.times(Q::splat(radius_j)));
                relative_spin[row] = spin_j.minus(spin_i);
            }
            store(&mut self.branch, from, branch);
            store(&mut self.relative_velocity, from, velocity);
            store(&mut self.surface_spin, from, spin);
            if with_relative_spin {
                store(&mut self.relative_spin, from, relative_spin);
            }
        }
    }

    /// Puts forces and torques of the first `used` pairs on their bodies.
    #[inline(always)]
    pub(super) fn scatter<Q: F64x4, S: Sizes>(
        &self,
        [first, second]: [&[u32; LANES]; 2],
        used: usize,
        loads: &mut [ForceTorque],
    ) {
        for from in (0..used).step_by(4) {
            let force = load::<Q>(&self.force_on_j, from);
            let torque_off_i = load::<Q>(&self.torque_off_i, from);
            let torque_off_j = if S::EQUAL { torque_off_i } else { load(&self.torque_off_j, from) };
            for row in 0..4 {
                if from + row >= used {
                    break;
                }
                let [force_i, torque_i] = loads[first[from + row] as usize].vectors_mut();
                Q::load(force_i).minus(force[row]).store(force_i);
                Q::load(torque_i).minus(torque_off_i[row]).store(torque_i);
                let [force_j, torque_j] = loads[second[from + row] as usize].vectors_mut();
                Q::load(force_j).plus(force[row]).store(force_j);
                Q::load(torque_j).minus(torque_off_j[row]).store(torque_j);
            }
        }
    }

    /// Which pairs touch.
    #[inline(always)]
    pub(super) fn note_touching(&self, touching: &mut [bool; LANES]) {
        for (touching, &flag) in touching.iter_mut().zip(&self.touching) {
            *touching = flag != 0;
        }
    }
}

/// Overlap of two spheres, and the unit vector from the first to the second. A pair has the same bits in the loop over
/// contacts and in that over pairs apart.
#[inline(always)]
pub(super) fn overlap_and_normal(
    branch: Vector3<f64>,
    [radius_i, radius_j]: [f64; 2],
) -> (f64, Vector3<f64>) {
    let distance = branch.dot(&branch).sqrt();
    (radius_i + radius_j - distance, branch * (1.0 / distance))
}

/// Vectors of four pairs to components in lanes.
#[inline(always)]
pub(super) fn store<Q: F64x4>(components: &mut [Lanes; 3], from: usize, vectors: [Q; 4]) {
    let columns = Q::transposed(vectors);
    for axis in 0..3 {
        columns[axis].store(four_mut(&mut components[axis], from));
    }
}

/// Components in lanes to vectors of four pairs.
#[inline(always)]
pub(super) fn load<Q: F64x4>(components: &[Lanes; 3], from: usize) -> [Q; 4] {
    let [x, y, z] = components;
    Q::transposed([
        Q::load(four(x, from)),
        Q::load(four(y, from)),
        Q::load(four(z, from)),
        Q::splat(0.0),
    ])
}

#[inline(always)]
pub(super) fn vector(components: &[Lanes; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(components[0][lane], components[1][lane], components[2][lane])
}
