//! Particles that may touch one wall: they are gathered into lanes, like pairs of particles, and evaluated.

use super::geometry::WallNow;
use crate::contact::force_laws::{ForceOutOfRange, PairLaws, out_of_range};
use crate::contact::lanes::{
    BlockHistories, ContactBlock, ExcessForce, FourForces, FourVectors, PairsOfBlock, SizesAtWall,
    evaluate_lanes, require_within, vector,
};
use crate::contact::rolling::{NoRolling, Rolling, RollingAndTwisting};
use crate::contact::{ContactForceLaw, ContactModel, WallTallies};
use crate::numbers::{F64x4, four_mut, vectorised};
use crate::particles::{AngleLanes, Contacts, LANES, Lanes, Particles, SpringLanes, WallPair};

/// Particles near one wall for which one law holds.
pub struct WallLoop<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) contacts: &'a mut Contacts,
    /// Slots of these particles among those near walls.
    pub(super) acting: &'a [u32],
    pub(super) wall: WallNow<'a>,
    pub(super) laws: PairLaws<'a>,
    pub(super) on_walls: &'a mut WallTallies,
}

vectorised!(
    /// Adds the forces and torques of one wall on these particles. Selects the loop for the kind of resistance to
    /// rolling and twisting.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub(crate) fn add_wall<Q: F64x4, L: ContactForceLaw>(
        law: &L,
        at_wall: WallLoop<'_>,
    ) -> Result<(), ForceOutOfRange> {
        let ContactModel { rolling, twisting, .. } = *at_wall.laws.contact;
        match (rolling, twisting) {
            (None, None) => at_wall.evaluate::<Q, _, _>(law, NoRolling),
            (Some(rolling), None) => at_wall.evaluate::<Q, _, _>(law, rolling),
            (rolling, Some(twisting)) => {
                at_wall.evaluate::<Q, _, _>(law, RollingAndTwisting { rolling, twisting })
            }
        }
    }
);

impl WallLoop<'_> {
    #[inline(always)]
    fn evaluate<Q: F64x4, L: ContactForceLaw, R: Rolling>(
        mut self,
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        let mut block = WallBlock::default();
        for slots in self.acting.chunks(LANES) {
            self.add::<Q, _, _>(&mut block, slots, law, rolling)?;
        }
        Ok(())
    }

    /// Adds the forces of a block.
    #[inline(always)]
    fn add<Q: F64x4, L: ContactForceLaw, R: Rolling>(
        &mut self,
        block: &mut WallBlock,
        slots: &[u32],
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, contacts, wall, laws, on_walls, .. } = self;
        block.gather::<Q, R>(particles, contacts, (wall, slots));
        block.set_attraction(laws);
        let histories = BlockHistories {
            tangential_springs: &mut block.springs,
            largest_overlaps: &mut block.largest_overlaps,
            rolling_angles: &mut block.rolling_angles,
            twisting_angles: &mut block.twisting_angles,
        };
        let (sizes, dt) = (&block.sizes, laws.dt);
        let of_block = PairsOfBlock { rolling, sizes, dt, block: &mut block.contacts, histories };
        evaluate_lanes(law, of_block);
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
    fn gather<Q: F64x4, R: Rolling>(
        &mut self,
        particles: &Particles,
        contacts: &Contacts,
        (wall, slots): (&WallNow, &[u32]),
    ) {
        let last = slots.len() - 1;
        let zero = [Q::splat(0.0); 4];
        for from in (0..LANES).step_by(4) {
            let (mut places, mut motions, mut spins, mut histories) = (zero, zero, zero, zero);
            let mut facets = [0; 4];
            for row in 0..4 {
                let (lane, slot) = (from + row, slots[last.min(from + row)] as usize);
                let WallPair { particle, facet, .. } = contacts.wall_pairs[slot];
                (self.particle[lane], facets[row]) = (particle, facet);
                let [place, motion, spin] = particles.body[particle as usize].vectors();
                (places[row], motions[row]) = (Q::load(place), Q::load(motion));
                spins[row] = Q::load(spin);
                histories[row] = Q::load(contacts.wall_state[slot].history().numbers());
                if R::ACTS {
                    self.gather_angles(contacts, lane, slot);
                }
            }
            self.set_kinematics::<Q, R>(from, (wall, facets), [places, motions, spins]);
            let [x, y, z, largest_overlap] = Q::transposed(histories);
            FourVectors([x, y, z]).store(&mut self.springs, from);
            largest_overlap.store(four_mut(&mut self.largest_overlaps, from));
        }
    }

    /// Takes the rows of four particles' bodies and sets sizes, overlap, normal, and the motion of the wall's surface
    /// relative to their surfaces.
    #[inline(always)]
    fn set_kinematics<Q: F64x4, R: Rolling>(
        &mut self,
        from: usize,
        (wall, facets): (&WallNow, [u32; 4]),
        [places, motions, spins]: [[Q; 4]; 3],
    ) {
        let Self { sizes, contacts, .. } = self;
        let [x, y, z, radius] = Q::transposed(places);
        let [u, v, w, mass] = Q::transposed(motions);
        let (position, spin) = (FourVectors([x, y, z]), FourVectors::of_rows(spins));
        let (height, normal) = wall.heights_and_normals(position, facets);
        let overlap = radius.minus(height);
        let of_wall = wall.velocities(position, height, normal);
        let of_surfaces =
            of_wall.minus(FourVectors([u, v, w])).minus(spin.times(radius).cross(normal));
        radius.store(four_mut(&mut sizes.radius, from));
        mass.store(four_mut(&mut sizes.mass, from));
        overlap.store(four_mut(&mut contacts.overlap, from));
        normal.store(&mut contacts.normal, from);
        of_surfaces.store(&mut contacts.relative_velocity, from);
        if R::ACTS {
            wall.spins_relative_to(spin).store(&mut contacts.relative_spin, from);
        }
    }

    /// Gathers the angles of the springs that resist spin.
    #[inline(always)]
    fn gather_angles(&mut self, contacts: &Contacts, lane: usize, slot: usize) {
        let state = &contacts.wall_state[slot];
        for (angles, angle) in self.rolling_angles.iter_mut().zip(&state.rolling_angle) {
            angles[lane] = *angle;
        }
        self.twisting_angles[lane] = state.twisting_angle;
    }

    /// Sets the attraction, if there is any.
    #[inline(always)]
    fn set_attraction(&mut self, laws: &PairLaws) {
        let Self { sizes, contacts, .. } = self;
        let Some(cohesion) = laws.cohesion else { return };
        for lane in 0..LANES {
            contacts.cohesion[lane] = cohesion.to_wall(sizes.radius[lane], -contacts.overlap[lane]);
        }
    }

    /// Adds forces and torques to those of the first `used` particles; radius and force on the wall of each are passed
    /// to `on_wall`.
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

    /// Stores the histories of the contacts; springs that the model does not have are not deflected.
    #[inline(always)]
    fn keep_histories(&self, contacts: &mut Contacts, slots: &[u32], model: &ContactModel) {
        let (rolls, twists) = (model.rolling.is_some(), model.twisting.is_some());
        for (lane, slot) in slots.iter().map(|&slot| slot as usize).enumerate() {
            contacts.wall_touching[slot] = self.contacts.touching[lane] != 0;
            let state = &mut contacts.wall_state[slot];
            state.tangential_spring = vector(&self.springs, lane).into();
            state.largest_overlap = self.largest_overlaps[lane];
            state.rolling_angle =
                if rolls { vector(&self.rolling_angles, lane).into() } else { [0.0; 3] };
            state.twisting_angle = if twists { self.twisting_angles[lane] } else { 0.0 };
        }
    }
}
