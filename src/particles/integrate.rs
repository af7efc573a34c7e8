//! Velocity Verlet: half a kick and a drift, then, with the new forces, the other half.

use super::{Body, Load, Particles};
use crate::numbers::{Quad, QuadWork, Quantum, in_quads};

/// v += (dt/2) F/m, omega += (dt/2) T/I, for owned particles.
pub fn kick(particles: &mut Particles, dt: f64) {
    let owned = particles.owned_count();
    let (bodies, loads) = (&mut particles.body[..owned], &particles.load[..owned]);
    in_quads(Motion { bodies, loads, dt, drift: None });
}

/// Half a kick, then x += dt v, dt v being rounded to the lattice of positions. The velocities that remain
/// are those of the half step, which dashpots, sliders and the gas see. Returns a length that no particle has moved
/// farther than; infinite if a velocity is undefined.
///
/// The way is rounded, not the sum: a sum in doubles is rounded once more before, to digits that depend on
/// how far from the origin it is, so that a particle beyond a periodic face would move differently before
/// and after it is wrapped.
pub fn kick_and_drift(particles: &mut Particles, dt: f64, lattice: Quantum) -> f64 {
    let owned = particles.owned_count();
    let (bodies, loads) = (&mut particles.body[..owned], &particles.load[..owned]);
    in_quads(Motion { bodies, loads, dt, drift: Some(lattice) })
}

/// Half a kick, and a drift on the lattice of positions, if there is one. Gives a bound of the ways.
struct Motion<'a> {
    bodies: &'a mut [Body],
    loads: &'a [Load],
    dt: f64,
    drift: Option<Quantum>,
}

impl QuadWork for Motion<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<Q: Quad>(self) -> f64 {
        let half = 0.5 * self.dt;
        let dt = Q::load(&[self.dt, self.dt, self.dt, 0.0]); // the radius stays
        let mut size = [0.0; 2];
        let (mut per_mass, mut per_inertia) = (0.0, 0.0);
        let mut farthest = Farthest::new();
        for (bodies, loads) in self.bodies.chunks_mut(4).zip(self.loads.chunks(4)) {
            let mut ways = [Q::splat(0.0); 4];
            for ((body, load), way) in bodies.iter_mut().zip(loads).zip(&mut ways) {
                if size != [body.radius, body.mass] {
                    size = [body.radius, body.mass]; // often that of the last one: no division
                    (per_mass, per_inertia) = (half / body.mass, half / body.inertia());
                }
                let [place, motion, spin] = body.quads_mut();
                let [force, torque] = load.quads();
                let velocity = Q::load(motion).plus(Q::load(force).times(Q::splat(per_mass)));
                velocity.store(motion); // the mass stays: zero is added
                Q::load(spin).plus(Q::load(torque).times(Q::splat(per_inertia))).store(spin);
                if let Some(lattice) = self.drift {
                    *way = lattice.round_quad(velocity.times(dt));
                    Q::load(place).plus(*way).store(place);
                }
            }
            if self.drift.is_some() {
                farthest.see(ways);
            }
        }
        farthest.length()
    }
}

/// The longest of many ways.
struct Farthest<Q> {
    /// The largest square so far, in each lane.
    squared: Q,
    /// Undefined if any way is.
    flag: Q,
}

impl<Q: Quad> Farthest<Q> {
    #[inline(always)]
    fn new() -> Self {
        Self { squared: Q::splat(0.0), flag: Q::splat(0.0) }
    }

    #[inline(always)]
    fn see(&mut self, ways: [Q; 4]) {
        let [x, y, z, _] = Q::transposed(ways);
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

    /// Energy error after one collision-like half period of a unit oscillator with n steps.
    fn oscillator_error(steps: usize) -> f64 {
        let lattice = Quantum::spanning(2.0);
        let mut particles = Particles::default();
        particles.push(0, Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0), 0.5, 1.0);
        let dt = std::f64::consts::PI / steps as f64;
        for _ in 0..steps {
            kick_and_drift(&mut particles, dt, lattice);
            particles.load[0].force = -particles.body[0].position;
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
