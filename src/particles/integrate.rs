//! Velocity Verlet: half a kick and a drift, then, with the new forces, the other half.

use super::{Body, ForceTorque, Particles};
use crate::numbers::{F64x4, Quantum, SimdKernel, with_simd};
use bytemuck::Zeroable;

/// v += (dt/2) F/m, omega += (dt/2) T/I, for owned particles.
pub fn kick(particles: &mut Particles, dt: f64) {
    move_on(particles, Motion { late: None, dt, drift: None });
}

/// Half a kick, then x += dt v, dt v being rounded to the lattice of positions. The velocities that remain
/// are those of the half step, which dashpots, sliders and the gas see. Forces are then those of the weight alone: all
/// others are still to be added. Returns a length that no particle has moved farther than; infinite if a velocity is
/// undefined. A kick of the step before, of length `late`, is done first if it is still due. These are the sums of
/// several functions, with one way through memory.
///
/// The way is rounded, not the sum: a sum in doubles is rounded once more before, to digits that depend on
/// how far from the origin it is, so that a particle beyond a periodic face would move differently before
/// and after it is wrapped.
pub fn kick_and_drift(particles: &mut Particles, late: Option<f64>, step: Step) -> f64 {
    move_on(particles, Motion { late, dt: step.dt, drift: Some(step) })
}

/// Sets the force on each owned particle to its weight.
pub fn begin_with_weight(particles: &mut Particles, weight: Weight) {
    let owned = particles.owned_count();
    for (body, load) in particles.body[..owned].iter().zip(&mut particles.forces[..owned]) {
        *load = ForceTorque::along_z(-weight.of(body.mass));
    }
}

/// A step's length and what is known of its end.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Length.
    pub dt: f64,
    /// Lattice of positions.
    pub quantum: Quantum,
    /// Weight at its end.
    pub weight: Weight,
}

/// m g, on the lattice of forces.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// g, downwards, in the frame of the plate.
    pub gravity: f64,
    /// Lattice of forces.
    pub quantum: Quantum,
}

impl Weight {
    /// Of a particle of this mass.
    #[inline(always)]
    pub fn of(&self, mass: f64) -> f64 {
        self.quantum.round(mass * self.gravity)
    }
}

fn move_on(particles: &mut Particles, motion: Motion) -> f64 {
    let owned = particles.owned_count();
    let (bodies, loads) = (&mut particles.body[..owned], &mut particles.forces[..owned]);
    with_simd(Moving { bodies, loads, motion })
}

/// The second half of a kick, if it is due; half of another; and a drift, if there is one.
#[derive(Clone, Copy)]
struct Motion {
    late: Option<f64>,
    dt: f64,
    drift: Option<Step>,
}

struct Moving<'a> {
    bodies: &'a mut [Body],
    loads: &'a mut [ForceTorque],
    motion: Motion,
}

/// Half a step over mass and over inertia of a body.
struct HalfKick {
    half: f64,
    per_mass: f64,
    per_inertia: f64,
}

impl HalfKick {
    #[inline(always)]
    fn new(dt: f64) -> Self {
        Self { half: 0.5 * dt, per_mass: 0.0, per_inertia: 0.0 }
    }

    #[inline(always)]
    fn of_size(&mut self, body: &Body) {
        (self.per_mass, self.per_inertia) = (self.half / body.mass, self.half / body.inertia());
    }

    /// The mass, which stands behind the velocity, stays: zero is added.
    #[inline(always)]
    fn change<Q: F64x4>(&self, [velocity, spin]: &mut [Q; 2], load: &ForceTorque) {
        let [force, torque] = load.vectors();
        *velocity = velocity.plus(Q::load(force).times(Q::splat(self.per_mass)));
        *spin = spin.plus(Q::load(torque).times(Q::splat(self.per_inertia)));
    }
}

impl SimdKernel for Moving<'_> {
    /// A bound of the ways.
    type Output = f64;

    #[inline(always)]
    fn run<Q: F64x4>(self) -> f64 {
        let Self { bodies, loads, motion } = self;
        let mut mover = Mover::<Q>::new(motion);
        let (fours_of_bodies, other_bodies) = bodies.as_chunks_mut::<4>();
        let (fours_of_loads, other_loads) = loads.as_chunks_mut::<4>();
        for (bodies, loads) in fours_of_bodies.iter_mut().zip(fours_of_loads) {
            mover.move_up_to_four(bodies, loads);
        }
        mover.move_up_to_four(other_bodies, other_loads);
        mover.farthest.length()
    }
}

/// What the loop over bodies carries along.
struct Mover<Q> {
    motion: Motion,
    /// Radius and mass that the rest is for.
    size: [f64; 2],
    late: HalfKick,
    kick: HalfKick,
    weight: ForceTorque,
    farthest: Farthest<Q>,
}

impl<Q: F64x4> Mover<Q> {
    #[inline(always)]
    fn new(motion: Motion) -> Self {
        let late = HalfKick::new(motion.late.unwrap_or(0.0));
        let (kick, weight) = (HalfKick::new(motion.dt), ForceTorque::zeroed());
        Self { motion, size: [0.0; 2], late, kick, weight, farthest: Farthest::new() }
    }

    #[inline(always)]
    fn of_size(&mut self, body: &Body) {
        let size = [body.radius, body.mass];
        if self.size != size {
            self.size = size; // often that of the last one: no division
            self.late.of_size(body);
            self.kick.of_size(body);
            if let Some(step) = self.motion.drift {
                self.weight = ForceTorque::along_z(-step.weight.of(body.mass));
            }
        }
    }

    #[inline(always)]
    fn move_up_to_four(&mut self, bodies: &mut [Body], loads: &mut [ForceTorque]) {
        let mut displacements = [Q::splat(0.0); 4];
        for ((body, load), displacement) in bodies.iter_mut().zip(loads).zip(&mut displacements) {
            self.of_size(body);
            *displacement = self.move_one(body, load);
        }
        if self.motion.drift.is_some() {
            self.farthest.see(displacements);
        }
    }

    /// Returns the body's way; zero without a drift.
    #[inline(always)]
    fn move_one(&self, body: &mut Body, load: &mut ForceTorque) -> Q {
        let [place, velocity, spin] = body.vectors_mut();
        let mut motion = [Q::load(velocity), Q::load(spin)];
        if self.motion.late.is_some() {
            self.late.change(&mut motion, load);
        }
        self.kick.change(&mut motion, load);
        motion[0].store(velocity);
        motion[1].store(spin);
        let Some(Step { dt, quantum, .. }) = self.motion.drift else { return Q::splat(0.0) };
        let displacement = quantum.round_four(motion[0].times(Q::load(&[dt, dt, dt, 0.0]))); // the radius stays
        Q::load(place).plus(displacement).store(place);
        *load = self.weight;
        displacement
    }
}

/// The longest of many ways.
struct Farthest<Q> {
    /// The largest square so far, in each lane.
    squared: Q,
    /// Undefined if any way is.
    flag: Q,
}

impl<Q: F64x4> Farthest<Q> {
    #[inline(always)]
    fn new() -> Self {
        Self { squared: Q::splat(0.0), flag: Q::splat(0.0) }
    }

    #[inline(always)]
    fn see(&mut self, displacements: [Q; 4]) {
        let [x, y, z, _] = Q::transposed(displacements);
        let squared = x.times(x).plus(y.times(y)).plus(z.times(z));
        self.squared = self.squared.larger(squared);
        self.flag = self.flag.plus(squared.times(Q::splat(0.0)));
    }

    #[inline(always)]
    fn length(self) -> f64 {
        let (mut squares, mut flags) = ([0.0; 4], [0.0; 4]);
        self.squared.store(&mut squares);
        self.flag.store(&mut flags);
        let defined = flags == [0.0; 4];
        if defined { squares.into_iter().fold(0.0, f64::max).sqrt() } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform};
    use nalgebra::Vector3;

    fn step(dt: f64, quantum: Quantum) -> Step {
        Step { dt, quantum, weight: Weight { gravity: 0.0, quantum } }
    }

    /// Energy error after one collision-like half period of a unit oscillator with n steps.
    fn oscillator_error(steps: usize) -> f64 {
        let quantum = Quantum::spanning(2.0);
        let mut particles = Particles::default();
        particles.push(0, Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0), 0.5, 1.0);
        let dt = std::f64::consts::PI / steps as f64;
        for _ in 0..steps {
            kick_and_drift(&mut particles, None, step(dt, quantum));
            particles.forces[0].force = -particles.body[0].position;
            kick(&mut particles, dt);
        }
        particles.body[0].position.z.abs()
    }

    #[test]
    fn the_integrator_is_of_second_order() {
        let ratio = oscillator_error(100) / oscillator_error(200);
        // Position error falls as dt^2: a ratio of 4, less terms of order dt.
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
    }

    /// A particle on its way out of a periodic box, and its image inside: not one of many may part from it.
    #[test]
    fn a_particle_moves_like_its_periodic_images() {
        let quantum = Quantum::spanning(60.0);
        let length = quantum.round(5.0);
        let mut generator = random_of(3, 0, "images");
        let mut particles = Particles::default();
        for id in 0..2000 {
            let x = quantum.round(0.1 * uniform(&mut generator));
            let velocity = Vector3::x() * uniform(&mut generator);
            for image in [x, x - length, x + length] {
                particles.push(id, Vector3::x() * image, velocity, 0.5, 1.0);
            }
        }
        kick_and_drift(&mut particles, None, step(2.5e-4, quantum));
        for images in particles.body.chunks(3) {
            let [inside, below, above] = [0, 1, 2].map(|image| images[image].position.x);
            assert_eq!(below, inside - length);
            assert_eq!(above, inside + length);
        }
    }

    #[test]
    fn without_the_second_kick_it_is_not() {
        // Negative control: a first-order scheme is told apart.
        let error = |steps: usize| {
            let (mut x, mut v) = (0.0_f64, 1.0_f64);
            let dt = std::f64::consts::PI / steps as f64;
            for _ in 0..steps {
                let force = -x;
                x += dt * v;
                v += dt * force;
            }
            (x * x + v * v - 1.0).abs()
        };
        let ratio = error(100) / error(200);
        assert!((ratio - 2.0).abs() < 0.2, "{ratio}");
    }
}
