//! Particles at one wall: those that may touch it are gathered into lanes, as pairs of particles are, and evaluated.

use crate::contact::force_laws::{ForceOutOfRange, PairLaws, out_of_range};
use crate::contact::lanes::{
    BlockHistories, ContactBlock, ExcessForce, FourForces, FourVectors, Lanes, LawOnBlock,
    LoopOverBlocks, PairsOfBlock, Sizes, SizesAtWall, WithRegisters, require_within, vector,
};
use crate::contact::rolling::{NoRolling, Rolling, RollingAndTwisting};
use crate::contact::{ContactModel, WallTallies};
use crate::domain::{Wall, WallPose};
use crate::numbers::{F64x4, SimdKernel, four_mut};
use crate::particles::{AngleLanes, ContactHistory, Contacts, LANES, Particles, SpringLanes};
use nalgebra::Vector3;
use std::ops::Range;

/// Adds the forces and torques of one wall on particles for which one law holds.
pub(super) struct WallLoop<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) contacts: &'a mut Contacts,
    /// Slots of these particles among those near walls.
    pub(super) slots: Range<usize>,
    pub(super) wall: WallNow<'a>,
    pub(super) laws: PairLaws<'a>,
    /// Separation up to which any force acts.
    pub(super) range: f64,
    pub(super) on_walls: &'a mut WallTallies,
}

/// A wall at one instant.
#[derive(Clone, Copy)]
pub(super) struct WallNow<'a> {
    pub(super) number: usize,
    pub(super) wall: &'a Wall,
    pub(super) pose: &'a WallPose,
}

impl SimdKernel for WallLoop<'_> {
    type Output = Result<(), ForceOutOfRange>;

    #[inline(always)]
    fn run<Q: F64x4>(self) -> Self::Output {
        let law = &self.laws.contact.law;
        law.dispatch(WithRegisters::<_, Q>::new(self))
    }
}

impl LoopOverBlocks for WallLoop<'_> {
    type Output = Result<(), ForceOutOfRange>;

    #[inline(always)]
    fn run<Q: F64x4, L: LawOnBlock>(self, law: &L) -> Self::Output {
        let ContactModel { rolling, twisting, .. } = *self.laws.contact;
        match (rolling, twisting) {
            (None, None) => self.evaluate::<Q, _, _>(law, NoRolling),
            (Some(rolling), None) => self.evaluate::<Q, _, _>(law, rolling),
            (rolling, Some(twisting)) => {
                self.evaluate::<Q, _, _>(law, RollingAndTwisting { rolling, twisting })
            }
        }
    }
}

impl WallLoop<'_> {
    #[inline(always)]
    fn evaluate<Q: F64x4, L: LawOnBlock, R: Rolling>(
        mut self,
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        let mut block = WallBlock::default();
        let (mut near, mut count) = ([0; LANES], 0);
        for slot in self.slots.clone() {
            if self.may_act(slot) {
                near[count] = slot;
                count += 1;
            }
            if count == LANES || (count > 0 && slot + 1 == self.slots.end) {
                self.add::<Q, _, _>(&mut block, &near[..count], law, rolling)?;
                count = 0;
            }
        }
        Ok(())
    }

    /// Whether a force may act between the wall and the particle of a slot, or their contact still has to end.
    #[inline(always)]
    fn may_act(&self, slot: usize) -> bool {
        let particle = self.contacts.wall_pairs[slot].particle as usize;
        let body = &self.particles.body[particle];
        let separation = self.wall.wall.height_at(&body.position, self.wall.pose) - body.radius;
        let is_beyond = separation > self.range; // not so if it is undefined: the force then ends the run
        !is_beyond || self.contacts.wall_touching[slot]
    }

    /// Adds the forces of a block.
    #[inline(always)]
    fn add<Q: F64x4, L: LawOnBlock, R: Rolling>(
        &mut self,
        block: &mut WallBlock,
        slots: &[usize],
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, contacts, wall, laws, on_walls, .. } = self;
        block.gather::<Q>(particles, contacts, slots);
        block.set_geometry(*wall, laws);
        let histories = BlockHistories {
            tangential_springs: &mut block.springs,
            largest_overlaps: &mut block.largest_overlaps,
            rolling_angles: &mut block.rolling_angles,
            twisting_angles: &mut block.twisting_angles,
        };
        let (sizes, dt) = (&block.sizes, laws.dt);
        law.evaluate(PairsOfBlock { rolling, sizes, dt, block: &mut block.contacts, histories });
        block.keep_histories(contacts, slots, laws.contact);
        let on_wall = |radius: f64, force: [f64; 3]| {
            let counts = force.map(|component| laws.force_quantum.count(component));
            on_walls.add(wall.number, radius, counts);
        };
        let scattered = block.scatter::<Q, R>(particles, slots.len(), laws, on_wall);
        scattered.map_err(|ExcessForce { lane, force_on_j }| {
            let id = particles.id[block.particle[lane] as usize];
            let overlap = block.contacts.overlap[lane];
            let other = format!("wall \"{}\"", wall.wall.name);
            out_of_range(id, other, force_on_j, overlap, laws.limit)
        })
    }
}

/// Particles near one wall, component by component: the wall is the second body of each contact. Lanes beyond the last
/// particle repeat it.
#[derive(Default)]
struct WallBlock {
    particle: [u32; LANES],
    position: [Lanes; 3],
    sizes: SizesAtWall,
    contacts: ContactBlock,
    springs: SpringLanes,
    largest_overlaps: Lanes,
    rolling_angles: AngleLanes,
    twisting_angles: Lanes,
}

impl WallBlock {
    /// Gathers particles and histories of slots.
    #[inline(always)]
    fn gather<Q: F64x4>(&mut self, particles: &Particles, contacts: &Contacts, slots: &[usize]) {
        let last = slots.len() - 1;
        let zero = [Q::splat(0.0); 4];
        for from in (0..LANES).step_by(4) {
            let (mut positions, mut velocities, mut spins, mut histories) =
                (zero, zero, zero, zero);
            for row in 0..4 {
                let (lane, slot) = (from + row, slots[last.min(from + row)]);
                self.particle[lane] = contacts.wall_pairs[slot].particle;
                let body = &particles.body[self.particle[lane] as usize];
                let [position, velocity, spin] = body.vectors();
                self.sizes.gather(lane, [body; 2]);
                (positions[row], velocities[row]) = (Q::load(position), Q::load(velocity));
                spins[row] = Q::load(spin);
                histories[row] = Q::load(contacts.wall_history[slot].numbers());
                for axis in 0..3 {
                    self.rolling_angles[axis][lane] = contacts.wall_rolling_angle[slot][axis];
                }
                self.twisting_angles[lane] = contacts.wall_twisting_angle[slot];
            }
            FourVectors::of_rows(positions).store(&mut self.position, from);
            FourVectors::of_rows(velocities).store(&mut self.contacts.relative_velocity, from);
            FourVectors::of_rows(spins).store(&mut self.contacts.relative_spin, from);
            let [x, y, z, largest_overlaps] = Q::transposed(histories);
            FourVectors([x, y, z]).store(&mut self.springs, from);
            largest_overlaps.store(four_mut(&mut self.largest_overlaps, from));
        }
    }

    /// Sets overlap, normal, motion of the wall's surface relative to the particle's, and attraction.
    #[inline(always)]
    fn set_geometry(&mut self, WallNow { wall, pose, .. }: WallNow, laws: &PairLaws) {
        let Self { position, sizes, contacts, .. } = self;
        for lane in 0..LANES {
            let (position, radius) = (vector(position, lane), sizes.radius[lane]);
            let spin = vector(&contacts.relative_spin, lane);
            let normal = -wall.normal_at(&position, pose);
            let velocity = pose.velocity
                - vector(&contacts.relative_velocity, lane)
                - (spin * radius).cross(&normal);
            contacts.overlap[lane] = radius - wall.height_at(&position, pose);
            for axis in 0..3 {
                contacts.normal[axis][lane] = normal[axis];
                contacts.relative_velocity[axis][lane] = velocity[axis];
                contacts.relative_spin[axis][lane] = -spin[axis];
            }
        }
        let Some(cohesion) = laws.cohesion else { return };
        for lane in 0..LANES {
            contacts.cohesion[lane] = cohesion.to_wall(sizes.radius[lane], -contacts.overlap[lane]);
        }
    }

    /// Adds forces and torques to those of the first `used` particles; radius and force on the wall of each go to `on_wall`.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[inline(always)]
    fn scatter<Q: F64x4, R: Rolling>(
        &self,
        particles: &mut Particles,
        used: usize,
        laws: &PairLaws,
        mut on_wall: impl FnMut(f64, [f64; 3]),
    ) -> Result<(), ExcessForce> {
        for from in (0..used).step_by(4) {
            let FourForces { force_on_j, negative_torques } =
                self.contacts.forces_of_four::<Q, R, _>(from, &self.sizes, laws);
            require_within(force_on_j, laws.limit, from)?;
            let (force, torque) = (force_on_j.rows(), negative_torques[0].rows());
            for row in 0..4.min(used - from) {
                let particle = self.particle[from + row] as usize;
                let [of_force, of_torque] = particles.forces[particle].vectors_mut();
                Q::load(of_force).minus(force[row]).store(of_force);
                Q::load(of_torque).minus(torque[row]).store(of_torque);
                let mut numbers = [0.0; 4];
                force[row].store(&mut numbers);
                let [x, y, z, _] = numbers;
                on_wall(self.sizes.radius[from + row], [x, y, z]);
            }
        }
        Ok(())
    }

    /// Keeps the histories of the contacts; springs that the model does not have are not deflected.
    #[inline(always)]
    fn keep_histories(&self, contacts: &mut Contacts, slots: &[usize], model: &ContactModel) {
        let (rolls, twists) = (model.rolling.is_some(), model.twisting.is_some());
        for (lane, &slot) in slots.iter().enumerate() {
            contacts.wall_touching[slot] = self.contacts.touching[lane] != 0;
            contacts.wall_history[slot] = ContactHistory {
                tangential_spring: vector(&self.springs, lane),
                largest_overlap: self.largest_overlaps[lane],
            };
            contacts.wall_rolling_angle[slot] =
                if rolls { vector(&self.rolling_angles, lane) } else { Vector3::zeros() };
            contacts.wall_twisting_angle[slot] =
                if twists { self.twisting_angles[lane] } else { 0.0 };
        }
    }
}
