//! Velocity Verlet: half a kick and a drift, then, with the new forces, the other half of the kick.

use super::{Body, ForceTorque, GAS_FORCE, Particles};
use crate::numbers::{F64x4, Quantum, fetch_ahead, vectorised};
use nalgebra::Vector3;

/// v += (dt/2) F/m, omega += (dt/2) T/I, for owned particles.
pub(crate) fn kick(particles: &mut Particles, dt: f64) {
    integrate(particles, KickDrift { pending: None, dt, drift: None });
}

/// Applies half a kick, then x += dt v, with dt v rounded to multiples of the position quantum. The velocities are then
/// those of the half step, which dashpots, sliders and the gas use. Forces are set to the weight and to the force of a
/// volume-averaged gas at its last step; all other forces are still to be added. The second half of the previous step's
/// kick, of length `pending`, is applied first if it is still due, so that one pass through memory suffices. Returns an
/// upper bound of the displacements of all particles; infinite if a velocity is undefined.
///
/// The displacement is rounded, not the sum. A sum of doubles would first be rounded to digits that depend on its
/// distance from the origin, so that a particle beyond a periodic face would move differently before and after it is
/// wrapped.
pub(crate) fn kick_and_drift(
    particles: &mut Particles,
    pending: Option<f64>,
    step: DriftStep,
) -> f64 {
    integrate(particles, KickDrift { pending, dt: step.dt, drift: Some(step) })
}

/// Sets the force on each owned particle as [`kick_and_drift`] does.
pub(crate) fn set_first_forces(particles: &mut Particles, weight: Weight) {
    let owned = particles.owned_count();
    for (body, load) in particles.body[..owned].iter().zip(&mut particles.forces[..owned]) {
        *load = weight.force(body.mass);
    }
    for (load, force) in
        particles.forces.iter_mut().zip(particles.columns.at(GAS_FORCE).held::<Vector3<f64>>())
    {
        load.force += force;
    }
}

/// A drift, and the weight after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DriftStep {
    /// Length of the time step.
    pub(crate) dt: f64,
    /// Quantum of positions.
    pub(crate) quantum: Quantum,
    /// Weight at the end of the step.
    pub(crate) weight: Weight,
}

impl DriftStep {
    /// The displacement dt v. The fourth number is zero, since the radius, which follows the position in memory, does
    /// not change.
    #[inline(always)]
    pub(super) fn displacement<Q: F64x4>(self, velocity: Q) -> Q {
        let Self { dt, quantum, .. } = self;
        quantum.round_four(velocity.times(Q::load(&[dt, dt, dt, 0.0])))
    }
}

/// Weight m g, rounded to multiples of the force quantum.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// Acceleration g, downwards, in the frame of the plate.
    pub(crate) gravity: f64,
    /// Quantum of forces.
    pub quantum: Quantum,
}

impl Weight {
    /// Weight of a particle of this mass.
    #[inline(always)]
    pub fn of(&self, mass: f64) -> f64 {
        self.quantum.round(mass * self.gravity)
    }

    /// The weight as a force. Without gravity it is zero, never minus zero: adding a pair's zero would turn minus zero
    /// into zero, so a bit would depend on which pairs are evaluated.
    #[inline(always)]
    fn force(&self, mass: f64) -> ForceTorque {
        ForceTorque::along_z(0.0 - self.of(mass))
    }
}

fn integrate(particles: &mut Particles, step: KickDrift) -> f64 {
    let (owned, fetches) = (particles.owned_count(), particles.exceed_caches());
    let (bodies, forces) = (&mut particles.body[..owned], &mut particles.forces[..owned]);
    match particles.columns.at(GAS_FORCE).held() {
        [] => integrate_without_gas(bodies, forces, fetches, step),
        gas_force => integrate_in_gas(bodies, forces, gas_force, fetches, step),
    }
}

/// The second half of the previous kick, if it is pending; half of the next kick; and a drift, if there is one.
#[derive(Clone, Copy)]
struct KickDrift {
    pending: Option<f64>,
    dt: f64,
    drift: Option<DriftStep>,
}

/// Number of places ahead at which particles are prefetched if they exceed the caches: the hardware prefetcher alone
/// does not load this many streams in time.
const FETCHED_AHEAD: usize = 32;

/// Half a time step over mass and over moment of inertia of a body.
struct HalfKick<Q> {
    half: f64,
    per_mass: Q,
    per_inertia: Q,
}

impl<Q: F64x4> HalfKick<Q> {
    #[inline(always)]
    fn new(dt: f64) -> Self {
        Self { half: 0.5 * dt, per_mass: Q::splat(0.0), per_inertia: Q::splat(0.0) }
    }

    #[inline(always)]
    fn set_size(&mut self, body: &Body) {
        self.per_mass = Q::splat(self.half / body.mass);
        self.per_inertia = Q::splat(self.half / body.inertia());
    }

    /// Applies the kick. The mass, which is stored behind the velocity, does not change: zero is added to it.
    #[inline(always)]
    fn apply(&self, [velocity, spin]: &mut [Q; 2], forces: &ForceTorque) {
        let [force, torque] = forces.vectors();
        *velocity = velocity.plus(Q::load(force).times(self.per_mass));
        *spin = spin.plus(Q::load(torque).times(self.per_inertia));
    }
}

vectorised!(
    fn integrate_without_gas<Q: F64x4>(
        bodies: &mut [Body],
        forces: &mut [ForceTorque],
        fetches: bool,
        step: KickDrift,
    ) -> f64 {
        integrate_bodies::<Q, false>(bodies, forces, &[], fetches, step)
    }
);

vectorised!(
    fn integrate_in_gas<Q: F64x4>(
        bodies: &mut [Body],
        forces: &mut [ForceTorque],
        gas_force: &[Vector3<f64>],
        fetches: bool,
        step: KickDrift,
    ) -> f64 {
        integrate_bodies::<Q, true>(bodies, forces, gas_force, fetches, step)
    }
);

/// Advances bodies, with prefetching if `fetches` is set; with `GAS`, there is a volume-averaged gas. Returns an upper
/// bound of the displacements. The two cases have loops of their own, since one loop for both takes a quarter more
/// instructions.
#[inline(always)]
fn integrate_bodies<Q: F64x4, const GAS: bool>(
    bodies: &mut [Body],
    forces: &mut [ForceTorque],
    gas_force: &[Vector3<f64>],
    fetches: bool,
    step: KickDrift,
) -> f64 {
    let adds_gas = GAS && step.drift.is_some();
    let mut integrator = Integrator::<Q>::new(step);
    let (fours_of_bodies, other_bodies) = bodies.as_chunks_mut::<4>();
    let (fours_of_forces, other_forces) = forces.as_chunks_mut::<4>();
    let mut gas_force = gas_force.iter();
    for (bodies, forces) in fours_of_bodies.iter_mut().zip(fours_of_forces) {
        if fetches {
            for place in FETCHED_AHEAD..FETCHED_AHEAD + 4 {
                fetch_ahead(&bodies[..], place);
                fetch_ahead(&forces[..], place);
            }
        }
        integrator.advance_up_to_four(bodies, forces);
        if adds_gas {
            add_gas(forces, &mut gas_force);
        }
    }
    integrator.advance_up_to_four(other_bodies, other_forces);
    if adds_gas {
        add_gas(other_forces, &mut gas_force);
    }
    integrator.largest_displacement.length()
}

/// Adds the next forces of the gas.
#[inline(always)]
fn add_gas<'a>(forces: &mut [ForceTorque], gas_force: &mut impl Iterator<Item = &'a Vector3<f64>>) {
    for (load, force) in forces.iter_mut().zip(gas_force) {
        load.force += force;
    }
}

/// Integrates bodies one by one, with position, velocity and spin in lanes.
struct Integrator<Q> {
    step: KickDrift,
    /// Radius and mass for which the kicks and the weight are computed.
    size: [f64; 2],
    pending: HalfKick<Q>,
    kick: HalfKick<Q>,
    /// Weight as force and torque.
    weight: [Q; 2],
    largest_displacement: MaxDisplacement<Q>,
}

impl<Q: F64x4> Integrator<Q> {
    #[inline(always)]
    fn new(step: KickDrift) -> Self {
        let pending = HalfKick::new(step.pending.unwrap_or(0.0));
        let (kick, weight) = (HalfKick::new(step.dt), [Q::splat(0.0); 2]);
        let largest_displacement = MaxDisplacement::new();
        Self { step, size: [0.0; 2], pending, kick, weight, largest_displacement }
    }

    #[inline(always)]
    fn set_size(&mut self, body: &Body) {
        let size = [body.radius, body.mass];
        if self.size != size {
            self.size = size; // often that of the last body: no division
            self.pending.set_size(body);
            self.kick.set_size(body);
            if let Some(step) = self.step.drift {
                let weight = step.weight.force(body.mass);
                let [force, torque] = weight.vectors();
                self.weight = [Q::load(force), Q::load(torque)];
            }
        }
    }

    #[inline(always)]
    fn advance_up_to_four(&mut self, bodies: &mut [Body], forces: &mut [ForceTorque]) {
        let mut displacements = [Q::splat(0.0); 4];
        let each = bodies.iter_mut().zip(forces).zip(&mut displacements);
        for ((body, forces), displacement) in each {
            self.set_size(body);
            *displacement = self.advance(body, forces);
        }
        if self.step.drift.is_some() {
            self.largest_displacement.include(displacements);
        }
    }

    /// Returns the body's displacement; zero without a drift.
    #[inline(always)]
    fn advance(&self, body: &mut Body, forces: &mut ForceTorque) -> Q {
        let [position, velocity, spin] = body.vectors_mut();
        let mut velocities = [Q::load(velocity), Q::load(spin)];
        if self.step.pending.is_some() {
            self.pending.apply(&mut velocities, forces);
        }
        self.kick.apply(&mut velocities, forces);
        velocities[0].store(velocity);
        velocities[1].store(spin);
        let Some(step) = self.step.drift else { return Q::splat(0.0) };
        let displacement = step.displacement(velocities[0]);
        Q::load(position).plus(displacement).store(position);
        let [force, torque] = forces.vectors_mut();
        self.weight[0].store(force);
        self.weight[1].store(torque);
        displacement
    }
}

/// The largest of many displacements.
struct MaxDisplacement<Q> {
    /// The largest squared length so far, in each lane.
    squared: Q,
    /// Undefined if any displacement is undefined.
    flag: Q,
}

impl<Q: F64x4> MaxDisplacement<Q> {
    #[inline(always)]
    fn new() -> Self {
        Self { squared: Q::splat(0.0), flag: Q::splat(0.0) }
    }

    #[inline(always)]
    fn include(&mut self, displacements: [Q; 4]) {
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

    fn step(dt: f64, quantum: Quantum) -> DriftStep {
        DriftStep { dt, quantum, weight: Weight { gravity: 0.0, quantum } }
    }

    #[test]
    fn forces_are_those_of_weight_and_gas_after_a_drift() {
        let quantum = Quantum::spanning(100.0);
        let weight = Weight { gravity: 2.0, quantum };
        let mut particles = Particles::default();
        for number in 0..7 {
            particles.push(number, Vector3::zeros(), Vector3::zeros(), 0.5, 1.0);
        }
        let forces = |particles: &Particles| -> Vec<[f64; 3]> {
            particles.forces.iter().map(|load| load.force.into()).collect()
        };
        kick_and_drift(&mut particles, None, DriftStep { weight, ..step(0.013, quantum) });
        assert_eq!(forces(&particles), [[0.0, 0.0, -2.0]; 7]);
        for (number, force) in
            particles.columns.at_mut(GAS_FORCE).hold::<Vector3<f64>>().iter_mut().enumerate()
        {
            *force = Vector3::new(number as f64, 0.5, 3.0);
        }
        let expected = [0, 1, 2, 3, 4, 5, 6].map(|number| [f64::from(number), 0.5, 1.0]);
        kick_and_drift(&mut particles, None, DriftStep { weight, ..step(0.013, quantum) });
        assert_eq!(forces(&particles), expected);
        set_first_forces(&mut particles, weight);
        assert_eq!(forces(&particles), expected);
        kick(&mut particles, 0.013); // without a drift they stay
        assert_eq!(forces(&particles), expected);
    }

    #[test]
    fn without_gravity_the_force_of_the_weight_is_not_minus_zero() {
        let quantum = Quantum::spanning(2.0);
        let force = |gravity: f64| Weight { gravity, quantum }.force(2.0).force.z;
        assert_eq!(force(0.0).to_bits(), 0.0_f64.to_bits());
        // Control: the force that acts downwards.
        assert!((force(0.5) + 1.0).abs() < 1.0e-9, "{}", force(0.5));
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
        // The position error falls as dt^2: the ratio is 4, up to terms of order dt.
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
    }

    /// Particles that leave a periodic box, and their images inside: no image may move differently from its particle.
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
    fn the_measure_of_order_detects_a_first_order_scheme() {
        // Negative control of the test above, with a scheme of its own.
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
