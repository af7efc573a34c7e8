//! The particles of a rank: first the owned ones, then the ghosts.

use super::{Body, Columns, ForceTorque, kind_of_species, sphere_volume};
use bytemuck::Zeroable;
use nalgebra::Vector3;

/// The particles of a rank. Index i < `owned_count()` is an owned particle; the others are ghosts, which are copies of
/// other ranks' particles or periodic images. Ghosts carry the position of the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    owned: usize,
    /// For each ghost, the owned particle of which it is a periodic image, or [`REMOTE`].
    image_of: Vec<u32>,
    /// Global ids: unique, never reused.
    pub id: Vec<u64>,
    /// Size, position and velocities of each particle.
    pub body: Vec<Body>,
    /// Force and torque on each particle. On copies of other ranks' particles they are the sums over this rank's pairs
    /// until these are sent back, and zero between steps. They are zero on images, and not kept for images behind the
    /// last copy.
    pub forces: Vec<ForceTorque>,
    /// Quantities that most runs do not have, and custom fields: the force of a volume-averaged gas, which is part of
    /// the total force, and the data of a particle on its agglomerate.
    pub columns: Columns,
}

/// Marks a ghost whose owner is another rank.
const REMOTE: u32 = u32::MAX;

/// Size in bytes of bodies and forces above which few of them are in the core's own cache.
const CACHED: usize = 2 << 20;

impl Particles {
    /// Makes an empty store with room for `count` particles.
    pub fn with_room_for(count: usize) -> Self {
        let mut particles = Self::default();
        particles.id.reserve_exact(count);
        particles.body.reserve_exact(count);
        particles.forces.reserve_exact(count);
        particles
    }

    /// Number of owned particles.
    pub fn owned_count(&self) -> usize {
        self.owned
    }

    /// Number of owned particles and ghosts.
    pub fn count(&self) -> usize {
        self.id.len()
    }

    /// Index of the owned particle that this particle is, or whose periodic image it is; `None` if another rank owns
    /// it.
    #[inline(always)]
    pub fn owned_original(&self, index: usize) -> Option<usize> {
        if index < self.owned {
            return Some(index);
        }
        let original = self.image_of[index - self.owned];
        (original != REMOTE).then_some(original as usize)
    }

    /// Whether loops over particles and pairs become faster by prefetching bodies and forces.
    pub(crate) fn exceed_caches(&self) -> bool {
        size_of_val(&self.body[..]) + size_of_val(&self.forces[..]) > CACHED
    }

    /// Radius and mass of the particles, if they are the same for all.
    pub(super) fn one_size(&self) -> Option<[f64; 2]> {
        let size = |body: &Body| [body.radius, body.mass];
        let first = size(self.body.first()?);
        self.body.iter().all(|body| size(body) == first).then_some(first)
    }

    /// Number of kinds of pairs formed by the species of these particles, up to the last one that occurs.
    pub(super) fn kinds_of_pairs(&self) -> usize {
        let last = self.body.iter().map(Body::species).max().unwrap_or(0);
        kind_of_species(last, last) + 1
    }

    /// Moment of inertia of a solid sphere, (2/5) m r^2.
    #[inline(always)]
    pub fn inertia(&self, index: usize) -> f64 {
        self.body[index].inertia()
    }

    /// Volume of a sphere, 4/3 pi r^3.
    #[inline(always)]
    pub fn volume(&self, index: usize) -> f64 {
        sphere_volume(self.body[index].radius)
    }

    /// Adds an owned particle without spin and force. There must be no ghosts.
    pub fn push(
        &mut self,
        id: u64,
        position: Vector3<f64>,
        velocity: Vector3<f64>,
        radius: f64,
        mass: f64,
    ) {
        debug_assert_eq!(self.owned, self.count(), "owned particles come before ghosts");
        self.push_body(id, Body::new(position, velocity, radius, mass));
        self.forces.push(ForceTorque::zeroed());
        self.columns.push();
        self.owned += 1;
    }

    /// Makes room for this number of ghosts; if there is not enough, it adds an eighth more, so that the next ghosts
    /// need no new memory. A vector that grows by itself would double.
    pub(crate) fn make_room_for_ghosts(&mut self, count: usize) {
        if self.body.len() + count > self.body.capacity() {
            let count = count + count / 8;
            self.id.reserve_exact(count);
            self.body.reserve_exact(count);
            // Images that were added before have no forces.
            self.forces.reserve_exact(self.body.len() - self.forces.len() + count);
        }
    }

    /// Adds a ghost: the image of a particle of this rank, or a copy of another rank's.
    pub(crate) fn push_ghost(&mut self, id: u64, body: Body, image_of: Option<usize>) {
        let original = image_of.and_then(|index| self.owned_original(index));
        self.image_of.push(original.map_or(REMOTE, |index| index as u32));
        self.push_body(id, body);
        self.columns.push_ghost();
        if original.is_none() {
            self.forces.resize(self.count(), ForceTorque::zeroed());
        }
    }

    /// Keeps the ghosts with these ascending indices.
    pub(crate) fn keep_ghosts(&mut self, kept: &[u32]) {
        for (place, &ghost) in kept.iter().enumerate() {
            let (to, from) = (self.owned + place, ghost as usize);
            self.image_of[place] = self.image_of[from - self.owned];
            self.id[to] = self.id[from];
            self.body[to] = self.body[from];
            self.columns.copy_ghost(from, to);
        }
        self.truncate(self.owned + kept.len());
        let last_copy = self.image_of.iter().rposition(|&original| original == REMOTE);
        self.forces.truncate(self.owned + last_copy.map_or(0, |place| place + 1));
    }

    fn push_body(&mut self, id: u64, body: Body) {
        self.id.push(id);
        self.body.push(body);
    }

    /// Removes the ghosts.
    pub fn drop_ghosts(&mut self) {
        self.truncate(self.owned);
    }

    /// Removes all particles.
    pub fn clear(&mut self) {
        self.owned = 0;
        self.truncate(0);
    }

    /// Keeps the owned particles `order[0], order[1], ...`, in that order. There must be no ghosts.
    pub fn select(&mut self, order: &[u32]) {
        debug_assert_eq!(self.owned, self.count(), "ghosts are dropped before particles move");
        // The room for ghosts is kept: they are made next.
        fn reorder<T: Copy>(column: &mut Vec<T>, order: &[u32]) {
            let mut selected = Vec::with_capacity(column.capacity().max(order.len()));
            selected.extend(order.iter().map(|&index| column[index as usize]));
            *column = selected;
        }
        reorder(&mut self.id, order);
        reorder(&mut self.body, order);
        reorder(&mut self.forces, order);
        self.columns.select(order);
        self.owned = order.len();
    }

    /// Keeps the first `count` particles, which include all owned ones.
    fn truncate(&mut self, count: usize) {
        self.image_of.truncate(count - self.owned);
        self.id.truncate(count);
        self.body.truncate(count);
        self.columns.truncate(count);
        self.forces.truncate(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_kept_up_to_the_last_copy() {
        let mut particles = Particles::default();
        for id in 0..2 {
            particles.push(id, Vector3::zeros(), Vector3::zeros(), 0.5, 1.0);
        }
        let body = particles.body[0];
        let image_of = [Some(0), None, Some(1), None, Some(0)];
        for (id, original) in (2..).zip(image_of) {
            particles.push_ghost(id, body, original);
        }
        assert_eq!((particles.count(), particles.forces.len()), (7, 6));
        particles.keep_ghosts(&[2, 3, 4]);
        assert_eq!((particles.count(), particles.forces.len()), (5, 4));
        // Without a copy there are only the forces on owned particles.
        particles.keep_ghosts(&[2, 4]);
        assert_eq!((particles.count(), particles.forces.len()), (4, 2));
        assert_eq!([2, 3].map(|ghost| particles.owned_original(ghost)), [Some(0), Some(1)]);
    }

    #[test]
    fn copies_that_come_after_images_need_no_new_memory() {
        let mut particles = Particles::default();
        particles.push(0, Vector3::zeros(), Vector3::zeros(), 0.5, 1.0);
        let body = particles.body[0];
        for image_of in [Some(0), None] {
            particles.make_room_for_ghosts(100);
            let room = particles.forces.capacity();
            (0..100).for_each(|id| particles.push_ghost(id, body, image_of));
            assert_eq!(particles.forces.capacity(), room);
        }
    }
}
