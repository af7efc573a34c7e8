//! Velocity Verlet: half a kick and a drift, then, with the new forces, the other half.

use super::Particles;
use crate::numbers::Quantum;

/// v += (dt/2) F/m, omega += (dt/2) T/I, for owned particles.
pub fn kick(particles: &mut Particles, dt: f64) {
    let half = 0.5 * dt;
    for i in 0..particles.owned_count() {
        let inertia = particles.inertia(i);
        particles.velocity[i] += particles.force[i] * (half / particles.mass[i]);
        particles.angular_velocity[i] += particles.torque[i] * (half / inertia);
    }
}

/// Half a kick, then x += dt v, dt v being rounded to the lattice of positions. The velocities that remain
/// are those of the half step, which dashpots, sliders and the gas see.
///
/// The way is rounded, not the sum: a sum in doubles is rounded once more before, to digits that depend on
/// how far from the origin it is, so that a particle beyond a periodic face would move differently before
/// and after it is wrapped.
pub fn kick_and_drift(particles: &mut Particles, dt: f64, lattice: Quantum) {
    kick(particles, dt);
    for i in 0..particles.owned_count() {
        particles.position[i] += lattice.round_vector(particles.velocity[i] * dt);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform};
    use nalgebra::Vector3;

    /// Energy error after one collision-like half period of a unit oscillator with n steps.
    fn oscillator_error(steps: usize) -> f64 {
        let lattice = Quantum::spanning(2.0);
        let mut particles = Particles::default();
        particles.push(0, Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0), 0.5, 1.0);
        let dt = std::f64::consts::PI / steps as f64;
        for _ in 0..steps {
            kick_and_drift(&mut particles, dt, lattice);
            particles.force[0] = -particles.position[0];
            kick(&mut particles, dt);
        }
        particles.position[0].z.abs()
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
        let lattice = Quantum::spanning(60.0);
        let length = lattice.round(5.0);
        let mut generator = random_of(3, 0, "images");
        let mut particles = Particles::default();
        for id in 0..2000 {
            let x = lattice.round(0.1 * uniform(&mut generator));
            let velocity = Vector3::x() * uniform(&mut generator);
            for image in [x, x - length, x + length] {
                particles.push(id, Vector3::x() * image, velocity, 0.5, 1.0);
            }
        }
        kick_and_drift(&mut particles, 2.5e-4, lattice);
        for images in particles.position.chunks(3) {
            assert_eq!(images[1].x, images[0].x - length);
            assert_eq!(images[2].x, images[0].x + length);
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
