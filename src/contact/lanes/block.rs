//! A block of pairs that may touch, component by component: filled from the particles, and its forces added to them.

use super::{ComingBlocks, Lanes, Sizes, load_vectors, store_vectors, vector};
use crate::contact::force_laws::PairLaws;
use crate::contact::rolling::Rolling;
use crate::numbers::{F64x4, within};
use crate::particles::{Body, ForceTorque, LANES};

/// The pairs of a block, component by component: particles i and j in each lane.
#[derive(Default)]
pub(crate) struct ContactBlock {
    /// From the centre of i to that of j.
    pub(crate) branch_vector: [Lanes; 3],
    /// First that of the centres, then that of the surfaces at the contact.
    pub(crate) relative_velocity: [Lanes; 3],
    /// omega_i r_i + omega_j r_j.
    pub(crate) surface_spin: [Lanes; 3],
    /// omega_j - omega_i; only if rolling is resisted.
    pub(crate) relative_spin: [Lanes; 3],
    pub(crate) overlap: Lanes,
    pub(crate) normal: [Lanes; 3],
    pub(crate) cohesion: Lanes,
    pub(crate) normal_force: Lanes,
    pub(crate) tangential_force: [Lanes; 3],
    /// Torque on j; only if rolling is resisted.
    pub(crate) rolling_torque: [Lanes; 3],
    pub(crate) force_on_j: [Lanes; 3],
    /// The negative of the torque on i.
    pub(crate) negative_torque_i: [Lanes; 3],
    /// The negative of the torque on j; if the two are equal, only that on i is set.
    pub(crate) negative_torque_j: [Lanes; 3],
    /// 1 where the bodies are in contact.
    pub(crate) touching: [u64; LANES],
    /// 1 where the force exceeds the limit or is undefined.
    pub(crate) out_of_range: [u64; LANES],
}

impl ContactBlock {
    /// Gathers the kinematics of pairs of bodies; their relative spin only if it is asked for. Fetches bodies of the next block.
    #[inline(always)]
    pub(crate) fn gather<Q: F64x4, S: Sizes>(
        &mut self,
        sizes: &mut S,
        [first, second]: [&[u32; LANES]; 2],
        (bodies, coming): (&[Body], ComingBlocks),
        with_relative_spin: bool,
    ) {
        let zero = [Q::splat(0.0); 4];
        let (mut branch_vector, mut velocity, mut spin, mut relative_spin) =
            (zero, zero, zero, zero);
        for from in (0..LANES).step_by(4) {
            for row in 0..4 {
                let lane = from + row;
                coming.fetch_body(bodies, lane);
                let (i, j) = (&bodies[first[lane] as usize], &bodies[second[lane] as usize]);
                sizes.gather(lane, [i, j]);
                let [radius_i, radius_j] = sizes.radii(lane);
                let ([position_i, velocity_i, spin_i], [position_j, velocity_j, spin_j]) =
                    (i.vectors(), j.vectors());
                branch_vector[row] = Q::load(position_j).minus(Q::load(position_i));
                velocity[row] = Q::load(velocity_j).minus(Q::load(velocity_i));
                let (spin_i, spin_j) = (Q::load(spin_i), Q::load(spin_j));
                let surface_i = spin_i.times(Q::splat(radius_i));
                spin[row] = surface_i.plus(spin_j.times(Q::splat(radius_j)));
                relative_spin[row] = spin_j.minus(spin_i);
            }
            store_vectors(&mut self.branch_vector, from, branch_vector);
            store_vectors(&mut self.relative_velocity, from, velocity);
            store_vectors(&mut self.surface_spin, from, spin);
            if with_relative_spin {
                store_vectors(&mut self.relative_spin, from, relative_spin);
            }
        }
    }

    /// Sets the forces and torques of all pairs, rounded to multiples of their quanta.
    #[inline(always)]
    pub(crate) fn round_forces<R: Rolling, S: Sizes>(&mut self, sizes: &S, laws: &PairLaws) {
        for lane in 0..LANES {
            let [radius_i, radius_j] = sizes.radii(lane);
            let normal = vector(&self.normal, lane);
            let tangential = vector(&self.tangential_force, lane);
            let along = self.normal_force[lane] - self.cohesion[lane];
            let force_on_j = laws.force_quantum.round_vector(normal * along + tangential);
            let twist = normal.cross(&tangential);
            let mut twists = [twist * radius_i, twist * radius_j];
            if R::ACTS {
                let torque = vector(&self.rolling_torque, lane);
                twists = [twists[0] + torque, twists[1] - torque];
            }
            for axis in 0..3 {
                self.force_on_j[axis][lane] = force_on_j[axis];
                self.negative_torque_i[axis][lane] = laws.torque_quantum.round(twists[0][axis]);
                if !S::EQUAL {
                    self.negative_torque_j[axis][lane] = laws.torque_quantum.round(twists[1][axis]);
                }
            }
            self.out_of_range[lane] = u64::from(!within(&force_on_j, laws.limit));
        }
    }

    /// Adds forces and torques of the first `used` pairs to those of their bodies. Fetches those of the next block, and the pairs of
    /// the one after it.
    #[inline(always)]
    pub(crate) fn scatter<Q: F64x4, S: Sizes>(
        &self,
        [first, second]: [&[u32; LANES]; 2],
        used: usize,
        (forces, coming): (&mut [ForceTorque], ComingBlocks),
    ) {
        for from in (0..used).step_by(4) {
            coming.fetch_pairs(from / 4);
            let force = load_vectors::<Q>(&self.force_on_j, from);
            let negative_torque_i = load_vectors::<Q>(&self.negative_torque_i, from);
            let negative_torque_j = if S::EQUAL {
                negative_torque_i
            } else {
                load_vectors(&self.negative_torque_j, from)
            };
            for row in 0..4 {
                if from + row >= used {
                    break;
                }
                coming.fetch_force(forces, from + row);
                let [force_i, torque_i] = forces[first[from + row] as usize].vectors_mut();
                Q::load(force_i).minus(force[row]).store(force_i);
                Q::load(torque_i).minus(negative_torque_i[row]).store(torque_i);
                let [force_j, torque_j] = forces[second[from + row] as usize].vectors_mut();
                Q::load(force_j).plus(force[row]).store(force_j);
                Q::load(torque_j).minus(negative_torque_j[row]).store(torque_j);
            }
        }
    }

    /// Copies the flags of pairs that touch.
    #[inline(always)]
    pub(crate) fn copy_touching(&self, touching: &mut [bool; LANES]) {
        for (touching, &flag) in touching.iter_mut().zip(&self.touching) {
            *touching = flag != 0;
        }
    }
}
