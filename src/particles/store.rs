//! Columns of particles: first the owned ones, then the ghosts.

use nalgebra::Vector3;

/// The particles that a rank knows. Index i < `owned_count()` is an owned particle, the others are
/// ghosts: copies of other ranks' particles or periodic images. Ghosts carry the position of the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    owned: usize,
    /// For each ghost the owned particle that it is a periodic image of, or [`REMOTE`].
    image_of: Vec<u32>,
    /// Global ids: unique, never reused.
    pub id: Vec<u64>,
    /// Centres, on the position lattice of the box.
    pub position: Vec<Vector3<f64>>,
    /// Velocities of the centres.
    pub velocity: Vec<Vector3<f64>>,
    /// Angular velocities.
    pub angular_velocity: Vec<Vector3<f64>>,
    /// Radii.
    pub radius: Vec<f64>,
    /// Masses.
    pub mass: Vec<f64>,
    /// Total forces, on the force lattice. Those of ghosts are scratch.
    pub force: Vec<Vector3<f64>>,
    /// Total torques about the centres, on the force lattice. Those of ghosts are scratch.
    pub torque: Vec<Vector3<f64>>,
    /// Of owned particles: force of a gas in three dimensions, on the force lattice, as of its last step; it is
    /// held until the next. Zero without such a gas.
    pub gas_force: Vec<Vector3<f64>>,
}

/// Marks a ghost whose owner is another rank.
const REMOTE: u32 = u32::MAX;

/// Solid sphere: I = (2/5) m r^2.
const INERTIA_FACTOR: f64 = 0.4;

impl Particles {
    /// Number of owned particles.
    pub fn owned_count(&self) -> usize {
        self.owned
    }

    /// Number of owned particles and ghosts.
    pub fn count(&self) -> usize {
        self.id.len()
    }

    /// The owned particle that a particle is, or is a periodic image of; nothing if another rank owns it.
    #[inline(always)]
    pub fn owned_original(&self, index: usize) -> Option<usize> {
        if index < self.owned {
            return Some(index);
        }
        let original = self.image_of[index - self.owned];
        (original != REMOTE).then_some(original as usize)
    }

    /// Moment of inertia of a solid sphere, (2/5) m r^2.
    #[inline(always)]
    pub fn inertia(&self, index: usize) -> f64 {
        INERTIA_FACTOR * self.mass[index] * self.radius[index] * self.radius[index]
    }

    /// Volume of a sphere, 4/3 pi r^3.
    #[inline(always)]
    pub fn volume(&self, index: usize) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius[index].powi(3)
    }

    /// Adds an owned particle at rest spin, without force. There must be no ghosts.
    pub fn push(
        &mut self,
        id: u64,
        position: Vector3<f64>,
        velocity: Vector3<f64>,
        radius: f64,
        mass: f64,
    ) {
        debug_assert_eq!(self.owned, self.count(), "owned particles come before ghosts");
        self.push_columns(id, position, velocity, (radius, mass));
        self.gas_force.push(Vector3::zeros());
        self.owned += 1;
    }

    /// Adds a ghost: the image of a particle known here, or another rank's.
    pub fn push_ghost(
        &mut self,
        id: u64,
        position: Vector3<f64>,
        velocity: Vector3<f64>,
        size: (f64, f64),
        image_of: Option<usize>,
    ) {
        let original = image_of.and_then(|index| self.owned_original(index));
        self.image_of.push(original.map_or(REMOTE, |index| index as u32));
        self.push_columns(id, position, velocity, size);
    }

    fn push_columns(
        &mut self,
        id: u64,
        position: Vector3<f64>,
        velocity: Vector3<f64>,
        (radius, mass): (f64, f64),
    ) {
        self.id.push(id);
        self.position.push(position);
        self.velocity.push(velocity);
        self.angular_velocity.push(Vector3::zeros());
        self.radius.push(radius);
        self.mass.push(mass);
        self.force.push(Vector3::zeros());
        self.torque.push(Vector3::zeros());
    }

    /// Forgets the ghosts.
    pub fn drop_ghosts(&mut self) {
        self.truncate(self.owned);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.owned = 0;
        self.gas_force.clear();
        self.truncate(0);
    }

    /// Keeps the owned particles `order[0], order[1], ...`, in that order. There must be no ghosts.
    pub fn select(&mut self, order: &[u32]) {
        debug_assert_eq!(self.owned, self.count(), "ghosts are dropped before particles move");
        fn reorder<T: Copy>(column: &mut Vec<T>, order: &[u32]) {
            *column = order.iter().map(|&index| column[index as usize]).collect();
        }
        reorder(&mut self.id, order);
        reorder(&mut self.position, order);
        reorder(&mut self.velocity, order);
        reorder(&mut self.angular_velocity, order);
        reorder(&mut self.radius, order);
        reorder(&mut self.mass, order);
        reorder(&mut self.force, order);
        reorder(&mut self.torque, order);
        reorder(&mut self.gas_force, order);
        self.owned = order.len();
    }

    /// Sets forces and torques to zero, those of ghosts too.
    pub fn clear_forces(&mut self) {
        self.force.fill(Vector3::zeros());
        self.torque.fill(Vector3::zeros());
    }

    fn truncate(&mut self, count: usize) {
        self.image_of.clear();
        self.id.truncate(count);
        self.position.truncate(count);
        self.velocity.truncate(count);
        self.angular_velocity.truncate(count);
        self.radius.truncate(count);
        self.mass.truncate(count);
        self.force.truncate(count);
        self.torque.truncate(count);
    }
}
