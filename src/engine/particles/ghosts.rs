//! Motion of ghosts at a step: images follow their originals, copies of other ranks' particles move by the velocities
//! of theirs.

use super::{Body, DriftStep};
use crate::numbers::{F64x4, vectorised};

vectorised!(
    /// Updates periodic images from their originals, with a shift of the position along x, y and z, whose fourth number
    /// is zero. Each image is given by its own index and that of the original.
    pub(crate) fn follow_originals<Q: F64x4>(
        bodies: &mut [Body],
        images: &[[u32; 2]],
        shift: [f64; 4],
    ) {
        let shift = Q::load(&shift);
        for &[image, original] in images {
            let [position, velocity, spin] = bodies[original as usize].vectors();
            // This is exact: both are multiples of the quantum of positions. The fourth number, the radius, has no
            // shift.
            let position = Q::load(position).plus(shift);
            let [velocity, spin] = [Q::load(velocity), Q::load(spin)];
            let of_image = bodies[image as usize].vectors_mut();
            position.store(&mut of_image[0]);
            velocity.store(&mut of_image[1]);
            spin.store(&mut of_image[2]);
        }
    }
);

vectorised!(
    /// Gives copies of particles the half-step velocities of their originals, and moves them by these: x += dt v, with
    /// the same bits as [`kick_and_drift`](super::kick_and_drift) moved the originals. Each copy is given by the number
    /// under which `velocities` returns its velocity and angular velocity, and by its own index.
    pub(crate) fn drift_copies<Q: F64x4>(
        bodies: &mut [Body],
        copies: &[[u32; 2]],
        velocities: impl Fn(usize) -> [[f64; 3]; 2],
        step: DriftStep,
    ) {
        for &[place, copy] in copies {
            let [[u, v, w], [p, q, r]] = velocities(place as usize);
            let [position, velocity, spin] = bodies[copy as usize].vectors_mut();
            // The fourth numbers, mass and species, are kept.
            let new_velocity = Q::load(&[u, v, w, velocity[3]]);
            new_velocity.store(velocity);
            *spin = [p, q, r, spin[3]];
            Q::load(position).plus(step.displacement(new_velocity)).store(position);
        }
    }
);

#[cfg(test)]
mod tests {
    use super::super::{Particles, Weight, kick_and_drift};
    use super::*;
    use crate::numbers::{Quantum, random_of, uniform};
    use nalgebra::Vector3;

    const COUNT: u32 = 7;

    /// Particles that move and spin, at random.
    fn particles(quantum: Quantum) -> Particles {
        let mut random = random_of(1, 0, "drift");
        let mut particles = Particles::default();
        for number in 0..COUNT {
            let position = Vector3::from_fn(|_, _| quantum.round(90.0 * uniform(&mut random)));
            let velocity = Vector3::from_fn(|_, _| uniform(&mut random) - 0.5);
            particles.push(u64::from(number), position, velocity, 0.5, 1.0);
            let body = &mut particles.body[number as usize];
            *body = body.of_species(number as usize);
            body.angular_velocity = Vector3::from_fn(|_, _| uniform(&mut random));
        }
        particles
    }

    #[test]
    fn a_copy_drifts_as_its_original() {
        let quantum = Quantum::spanning(100.0);
        let step = DriftStep { dt: 0.013, quantum, weight: Weight { gravity: 0.0, quantum } };
        let mut particles = particles(quantum);
        let start = particles.body.clone();
        kick_and_drift(&mut particles, None, step);
        // The copies are in another order than the velocities, and have none before.
        let moved = |factor: f64| {
            let mut copies: Vec<Body> = start.iter().rev().copied().collect();
            for body in &mut copies {
                (body.velocity, body.angular_velocity) = (Vector3::zeros(), Vector3::zeros());
            }
            let places: Vec<[u32; 2]> =
                (0..COUNT).map(|place| [place, COUNT - 1 - place]).collect();
            let velocities = |place: usize| {
                let Body { velocity, angular_velocity, .. } = start[place];
                [(velocity * factor).into(), angular_velocity.into()]
            };
            drift_copies(&mut copies, &places, velocities, step);
            copies.reverse();
            copies
        };
        assert_eq!(moved(1.0), particles.body);
        // Control: with another velocity a copy goes elsewhere.
        let elsewhere = moved(1.0 + 1.0e-9);
        assert!(elsewhere.iter().zip(&particles.body).all(|(a, b)| a.position != b.position));
    }

    #[test]
    fn an_image_is_its_original_but_for_the_shift() {
        let quantum = Quantum::spanning(100.0);
        let length = quantum.round(90.0);
        let mut particles = particles(quantum);
        let originals = particles.body.clone();
        let nobody = Body::new(Vector3::zeros(), Vector3::zeros(), 2.0, 2.0);
        particles.body.extend([nobody; COUNT as usize]);
        let images: Vec<[u32; 2]> = (0..COUNT).map(|k| [2 * COUNT - 1 - k, k]).collect();
        follow_originals(&mut particles.body, &images, [0.0, -length, 0.0, 0.0]);
        let (owned, images) = particles.body.split_at(COUNT as usize);
        assert_eq!(owned, originals);
        for (image, original) in images.iter().rev().zip(owned) {
            assert_ne!(image, original); // the control
            let mut moved = *original;
            moved.position.y -= length;
            assert_eq!(*image, moved);
        }
    }
}
