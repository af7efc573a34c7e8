//! Particles as the loops over pairs want them: all that a pair needs of a particle in one place of memory.

use super::Particles;
use bytemuck::Zeroable;

/// What a pair needs of a particle: three quads.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C, align(32))]
pub struct Body {
    /// Centre; radius.
    pub place: [f64; 4],
    /// Velocity; mass.
    pub motion: [f64; 4],
    /// Angular velocity; nothing.
    pub spin: [f64; 4],
}

/// What pairs put on a particle: two quads.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C, align(64))]
pub struct Load {
    /// Force; nothing.
    pub force: [f64; 4],
    /// Torque about the centre; nothing.
    pub torque: [f64; 4],
}

/// Bodies without a particle.
pub(super) const FILLERS: usize = 2;

/// Places of the fillers, far from each other: no law acts between them.
const FAR_AWAY: [[f64; 4]; FILLERS] = [[0.0; 4], [0.0, 0.0, 1.0e100, 0.0]];

/// All particles that a rank knows, and two more that never touch each other: pairs come in blocks of
/// [`LANES`](super::LANES), and these two fill up the last one.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    /// Body i is particle i.
    pub body: Vec<Body>,
    /// What has been put on each body.
    pub load: Vec<Load>,
}

impl Bodies {
    /// Takes the particles as they are now; loads are zero.
    pub fn take(&mut self, particles: &Particles) {
        let n = particles.count();
        self.body.resize(n + FILLERS, Body::zeroed());
        let (position, velocity) = (&particles.position[..n], &particles.velocity[..n]);
        let (spin, radius) = (&particles.angular_velocity[..n], &particles.radius[..n]);
        let mass = &particles.mass[..n];
        for (i, body) in self.body[..n].iter_mut().enumerate() {
            let (x, v, w) = (position[i], velocity[i], spin[i]);
            body.place = [x.x, x.y, x.z, radius[i]];
            body.motion = [v.x, v.y, v.z, mass[i]];
            body.spin = [w.x, w.y, w.z, 0.0];
        }
        for (body, place) in self.body[n..].iter_mut().zip(FAR_AWAY) {
            *body = Body { place, motion: [0.0, 0.0, 0.0, 1.0], spin: [0.0; 4] };
        }
        self.load.clear();
        self.load.resize(n + FILLERS, Load::zeroed());
    }

    /// The bodies that are particles.
    pub fn of_particles(&self) -> &[Body] {
        &self.body[..self.body.len().saturating_sub(FILLERS)]
    }

    /// Adds what was put on bodies to the owned particles, what was put on their images too.
    pub fn give(&self, particles: &mut Particles) {
        for (index, load) in self.load[..particles.count()].iter().enumerate() {
            if let Some(original) = particles.owned_original(index) {
                for axis in 0..3 {
                    particles.force[original][axis] += load.force[axis];
                    particles.torque[original][axis] += load.torque[axis];
                }
            }
        }
    }

    /// Radius and mass of the particles, if all have the same.
    pub fn one_size(&self) -> Option<[f64; 2]> {
        let size = |body: &Body| [body.place[3], body.motion[3]];
        let bodies = self.of_particles();
        let first = size(bodies.first()?);
        bodies.iter().all(|body| size(body) == first).then_some(first)
    }
}
