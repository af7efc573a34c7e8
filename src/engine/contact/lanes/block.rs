//! A block of pairs that may touch, component by component: it is filled from the particles, and its forces are added
//! to them.

use super::{ComingBlocks, FourVectors, Sizes, SizesOfPairs, overlaps_and_normals};
use crate::contact::force_laws::PairLaws;
use crate::contact::rolling::Rolling;
use crate::numbers::{F64x4, four, four_mut};
use crate::particles::{Body, ForceTorque, LANES, Lanes};
use nalgebra::Vector3;

/// The pairs of a block, component by component: particles i and j in each lane. Four pairs at a time are gathered from
/// the particles, and their forces are added to these, in registers: only the input and output of the law is stored.
#[derive(Default)]
#[repr(align(64))] // see `Lanes`
pub(crate) struct ContactBlock {
    pub(crate) overlap: Lanes,
    pub(crate) normal: [Lanes; 3],
    /// Relative velocity of the surfaces at the contact.
    pub(crate) relative_velocity: [Lanes; 3],
    /// omega_j - omega_i; set only if rolling is resisted.
    pub(crate) relative_spin: [Lanes; 3],
    pub(crate) cohesion: Lanes,
    pub(crate) normal_force: Lanes,
    pub(crate) tangential_force: [Lanes; 3],
    /// Normal force to which friction is proportional.
    pub(crate) friction_normal: Lanes,
    /// Torque on j; set only if rolling is resisted.
    pub(crate) rolling_torque: [Lanes; 3],
    /// 1 where the bodies are in contact.
    pub(crate) touching: [u64; LANES],
}

/// Forces and torques of four pairs, rounded to multiples of their quanta.
pub(crate) struct FourForces<Q> {
    pub(crate) force_on_j: FourVectors<Q>,
    /// The negatives of the torques on i and j.
    pub(crate) negative_torques: [FourVectors<Q>; 2],
}

/// A force that exceeds the limit or is undefined, with its pair.
pub(crate) struct ExcessForce {
    pub(crate) lane: usize,
    pub(crate) force_on_j: Vector3<f64>,
}

/// Requires the forces of four pairs, from lane `from` on, to be within a limit.
///
/// # Errors
/// The first force that is not within the limit.
#[inline(always)]
pub(crate) fn require_within<Q: F64x4>(
    forces: FourVectors<Q>,
    limit: f64,
    from: usize,
) -> Result<(), ExcessForce> {
    match forces.first_beyond(limit) {
        None => Ok(()),
        Some((row, force_on_j)) => Err(ExcessForce { lane: from + row, force_on_j }),
    }
}

impl ContactBlock {
    /// Gathers the kinematics of pairs of bodies, and their relative spin only on request. Prefetches bodies of the
    /// next block.
    #[inline(always)]
    pub(crate) fn gather<Q: F64x4, S: SizesOfPairs>(
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
            let [first, second] = [first, second].map(|particles| four(particles, from));
            coming.fetch_bodies(bodies, from);
            for row in 0..4 {
                let lane = from + row;
                let (i, j) = (&bodies[first[row] as usize], &bodies[second[row] as usize]);
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
            let surface_spin = FourVectors::of_rows(spin);
            let (overlap, normal) =
                overlaps_and_normals(FourVectors::of_rows(branch_vector), sizes.four_radii(from));
            let of_surfaces = FourVectors::of_rows(velocity).minus(surface_spin.cross(normal));
            overlap.store(four_mut(&mut self.overlap, from));
            normal.store(&mut self.normal, from);
            of_surfaces.store(&mut self.relative_velocity, from);
            if with_relative_spin {
                FourVectors::of_rows(relative_spin).store(&mut self.relative_spin, from);
            }
        }
    }

    /// The forces and torques of four pairs, from lane `from` on.
    #[inline(always)]
    pub(crate) fn forces_of_four<Q: F64x4, R: Rolling, S: Sizes>(
        &self,
        from: usize,
        sizes: &S,
        laws: &PairLaws,
    ) -> FourForces<Q> {
        let normal = FourVectors::<Q>::load(&self.normal, from);
        let tangential = FourVectors::load(&self.tangential_force, from);
        let [normal_force, cohesion] =
            [&self.normal_force, &self.cohesion].map(|numbers| four(numbers, from));
        let along = Q::load(normal_force).minus(Q::load(cohesion));
        let twist = normal.cross(tangential);
        let [radius_i, radius_j] = sizes.four_radii(from);
        let mut twists = [twist.times(radius_i), twist.times(radius_j)];
        if R::ACTS {
            let torque = FourVectors::load(&self.rolling_torque, from);
            twists = [twists[0].plus(torque), twists[1].minus(torque)];
        }
        let [of_i, of_j] = twists;
        let of_i = of_i.rounded(laws.torque_quantum);
        let equal = S::EQUAL && !R::ACTS;
        let of_j = if equal { of_i } else { of_j.rounded(laws.torque_quantum) };
        let force_on_j = normal.times(along).plus(tangential).rounded(laws.force_quantum);
        FourForces { force_on_j, negative_torques: [of_i, of_j] }
    }

    /// Adds forces and torques of the first `used` pairs to those of their bodies. Prefetches the forces of the next
    /// block, and the pairs of the one after it.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined; the forces of the pairs before it have then been added.
    #[inline(always)]
    pub(crate) fn scatter<Q: F64x4, R: Rolling, S: Sizes>(
        &self,
        (sizes, laws): (&S, &PairLaws),
        [first, second]: [&[u32; LANES]; 2],
        used: usize,
        (forces, coming): (&mut [ForceTorque], ComingBlocks),
    ) -> Result<(), ExcessForce> {
        for from in (0..used).step_by(4) {
            let [first, second] = [first, second].map(|particles| four(particles, from));
            coming.fetch_pairs(from / 4);
            coming.fetch_forces(forces, from);
            let FourForces { force_on_j, negative_torques } =
                self.forces_of_four::<Q, R, S>(from, sizes, laws);
            require_within(force_on_j, laws.limit, from)?;
            let force = force_on_j.rows();
            let [torque_i, torque_j] = [negative_torques[0].rows(), negative_torques[1].rows()];
            for row in 0..4 {
                if from + row >= used {
                    break;
                }
                let [force_i, of_i] = forces[first[row] as usize].vectors_mut();
                Q::load(force_i).minus(force[row]).store(force_i);
                Q::load(of_i).minus(torque_i[row]).store(of_i);
                let [force_j, of_j] = forces[second[row] as usize].vectors_mut();
                Q::load(force_j).plus(force[row]).store(force_j);
                Q::load(of_j).minus(torque_j[row]).store(of_j);
            }
        }
        Ok(())
    }

    /// Copies the flags of pairs that touch.
    #[inline(always)]
    pub(crate) fn copy_touching(&self, touching: &mut [bool; LANES]) {
        // All flags are read before one is written; otherwise the compiler would copy them one by one.
        *touching = self.touching.map(|flag| flag != 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CACHE_LINE: usize = 64;

    #[test]
    fn lanes_begin_with_a_cache_line() {
        let block = ContactBlock::default();
        let [x, y, z] = &block.normal;
        let force = &block.tangential_force[2];
        for lanes in [&block.overlap, x, y, z, &block.cohesion, &block.normal_force, force] {
            assert_eq!(lanes.as_ptr().addr() % CACHE_LINE, 0);
        }
        // Control: plain arrays may begin at any number.
        assert_eq!(align_of::<Lanes>(), align_of::<f64>());
    }
}
