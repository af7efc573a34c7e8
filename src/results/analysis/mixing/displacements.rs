//! Displacements of particles since a reference time, through periodic faces.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;
use talcum_engine::parallel::Communicator;
use talcum_engine::particle_sets::exact_sums::totals;
use talcum_engine::particle_sets::{Ownership, Periodicity};

/// Position of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Positioned {
    /// Global id.
    pub id: u64,
    /// Centre, in any periodic image.
    pub position: Vector3<f64>,
}

/// The stored data of a particle's displacement since the reference time.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Track {
    id: u64,
    /// Position at the last sample, inside the box.
    last: Vector3<f64>,
    displacement: Vector3<f64>,
}

/// Displacements of all particles since a reference time, on the ranks that owned the particles at the last sample.
///
/// The displacement between two samples is that to the nearest image, so samples must be frequent enough that no
/// particle moves by half a periodic length in between. Particles that leave are dropped, new ones ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacements {
    periodicity: Periodicity,
    /// Ascending ids from the first sample on.
    tracks: Vec<Track>,
}

/// Moments of the displacements of all particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDisplacement {
    /// Number of particles that have been present since the reference time.
    pub particles: u64,
    /// Mean displacement.
    pub mean: Vector3<f64>,
    /// Mean of the square of each component.
    pub square: Vector3<f64>,
}

impl MeanDisplacement {
    /// S^2, half of the mean square displacement by axis (Liu et al. 2016, eq. (2)).
    pub fn half_square(&self) -> Vector3<f64> {
        0.5 * self.square
    }

    /// Half the variance about the mean displacement, for particles in a bed that moves as a whole.
    pub fn half_variance(&self) -> Vector3<f64> {
        0.5 * (self.square - self.mean.component_mul(&self.mean))
    }
}

impl Displacements {
    /// Begins with the particles that this rank owns at the reference time.
    pub fn begin(particles: &[Positioned], periodicity: Periodicity) -> Self {
        let track = |particle: &Positioned| Track {
            id: particle.id,
            last: periodicity.wrapped(particle.position),
            displacement: Vector3::zeros(),
        };
        Self { periodicity, tracks: particles.iter().map(track).collect() }
    }

    /// Updates the displacements with the particles that this rank owns now: `owned` has their ids, at the same places.
    /// Collective.
    pub fn look(&mut self, particles: &[Positioned], owned: &Ownership, ranks: &dyn Communicator) {
        owned.align(&mut self.tracks, |track| [track.id, 0], ranks);
        let mut now = particles.iter();
        for track in &mut self.tracks {
            let Some(particle) = now.find(|particle| particle.id == track.id) else { return };
            let position = self.periodicity.wrapped(particle.position);
            track.displacement += self.periodicity.displacement(&track.last, &position);
            track.last = position;
        }
    }

    /// Makes the last sample the reference time: the next window begins.
    pub fn restart(&mut self) {
        self.tracks.iter_mut().for_each(|track| track.displacement = Vector3::zeros());
    }

    /// Moments over the particles of all ranks. `None` without particles. Collective.
    pub fn mean(&self, ranks: &dyn Communicator) -> Option<MeanDisplacement> {
        let moments = self.tracks.iter().map(|track| {
            let d = track.displacement;
            [1.0, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z]
        });
        let [n, x, y, z, xx, yy, zz] = totals(moments, ranks);
        (n > 0.0).then(|| MeanDisplacement {
            particles: n as u64,
            mean: Vector3::new(x, y, z) / n,
            square: Vector3::new(xx, yy, zz) / n,
        })
    }

    /// Data that must be stored to resume later, as bytes of whole records.
    pub fn stored(&self) -> Vec<u8> {
        bytemuck::cast_slice(&self.tracks).to_vec()
    }

    /// Continues from data that were stored by any ranks.
    pub fn restore(stored: &[u8], periodicity: Periodicity) -> Self {
        Self { periodicity, tracks: talcum_engine::parallel::records_of_bytes(stored).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Dispersion;
    use super::*;
    use crate::analysis::statistics::SampleMean;
    use talcum_engine::numbers::{Quantum, normal, random_of};
    use talcum_engine::parallel::run_on_threads;

    const BOX: Periodicity = Periodicity { lengths: [Some(8.0), Some(4.0), None] };
    const STEP: [f64; 3] = [0.3, 0.1, 0.6];

    /// Positions of 60 random walkers after 0, 1, 2 ... steps, on a quantum as in a run.
    fn walks(seed: u64, steps: usize) -> Vec<Vec<Vector3<f64>>> {
        let quantum = Quantum::spanning(1024.0);
        let mut generator = random_of(seed, 0, "walk");
        let mut positions = vec![Vector3::new(1.0, 1.0, 1.0); 60];
        let mut all = vec![positions.clone()];
        for _ in 0..steps {
            for x in &mut positions {
                *x += Vector3::from_fn(|k, _| quantum.round(STEP[k] * normal(&mut generator)));
            }
            all.push(positions.clone());
        }
        all
    }

    fn owned(particles: &[Positioned]) -> Ownership {
        Ownership::of(particles.iter().map(|particle| particle.id).collect())
    }

    /// Dispersion over windows of 10 steps of unit time, for walkers that are observed in the box on n ranks.
    fn dispersion(walks: &[Vec<Vector3<f64>>], n: usize) -> (Dispersion, MeanDisplacement) {
        let made = run_on_threads(n, |ranks| {
            let part = |step: usize| -> Vec<Positioned> {
                let mine = |id: usize| (id * id + step) % 7 % n == ranks.rank();
                let here = (0..60).filter(|&id| mine(id));
                here.map(|id| {
                    let position = BOX.wrapped(walks[step][id]);
                    Positioned { id: id as u64, position }
                })
                .collect()
            };
            let mut displacements = Displacements::begin(&part(0), BOX);
            let mut dispersion = Dispersion::default();
            let mut last = None;
            for step in 1..walks.len() {
                displacements.look(&part(step), &owned(&part(step)), ranks);
                last = displacements.mean(ranks);
                let half_square = last.unwrap().half_square();
                dispersion.add((step - 1) as f64 % 10.0 + 1.0, half_square.into());
                if step % 10 == 0 {
                    dispersion.end_window();
                    if step + 1 < walks.len() {
                        displacements.restart();
                    }
                }
                if step == 13 {
                    displacements = Displacements::restore(&displacements.stored(), BOX);
                }
            }
            (dispersion, last.unwrap())
        });
        assert!(made.iter().all(|of_rank| *of_rank == made[0]));
        made.into_iter().next().unwrap()
    }

    #[test]
    fn the_dispersion_of_a_random_walk_lies_in_its_interval() {
        let mut inside = [0; 3];
        for trial in 0..60 {
            let (dispersion, _) = dispersion(&walks(trial, 120), 1);
            for axis in 0..3 {
                // D = step^2 / (2 dt).
                let expected = 0.5 * STEP[axis] * STEP[axis];
                let found: SampleMean = dispersion.fitted(axis, 0.0).unwrap();
                let interval = found.interval(0.95).unwrap();
                inside[axis] += u32::from((interval.mean - expected).abs() < interval.half_width);
                assert!((found.mean.value / expected - 1.0).abs() < 0.35);
            }
        }
        // 57 of 60 expected, standard deviation 1.7.
        assert!(inside.iter().all(|&count| (51..=60).contains(&count)), "{inside:?}");
    }

    #[test]
    fn displacements_have_the_same_bits_on_any_ranks_and_are_unwrapped() {
        let walks = walks(77, 40);
        let (expected, last) = dispersion(&walks, 1);
        let plain: f64 =
            (0..60).map(|id| (walks[40][id].x - walks[30][id].x).powi(2)).sum::<f64>() / 60.0;
        assert!((last.square.x / plain - 1.0).abs() < 1e-13);
        assert!(last.half_variance().x < last.half_square().x);
        for n in 2..=4 {
            assert_eq!(dispersion(&walks, n), (expected.clone(), last));
        }
        // Control: wrapped positions do not spread like this.
        let wrapped = |step: usize, id: usize| BOX.wrapped(walks[step][id]).x;
        let square: f64 =
            (0..60).map(|id| (wrapped(40, id) - wrapped(30, id)).powi(2)).sum::<f64>() / 60.0;
        assert!((square / plain - 1.0).abs() > 0.1);
    }

    #[test]
    fn particles_that_leave_are_forgotten_and_new_ones_ignored() {
        run_on_threads(2, |ranks| {
            let of = |ids: &[u64]| -> Vec<Positioned> {
                let here = ids.iter().filter(|&&id| id as usize % 2 == ranks.rank());
                let position = Vector3::zeros();
                here.map(|&id| Positioned { id, position }).collect()
            };
            let mut displacements = Displacements::begin(&of(&[1, 2, 3]), BOX);
            let now = of(&[2, 3, 4]);
            displacements.look(&now, &owned(&now), ranks);
            assert_eq!(displacements.mean(ranks).unwrap().particles, 2);
            displacements.look(&of(&[]), &owned(&of(&[])), ranks);
            assert_eq!(displacements.mean(ranks), None);
        });
    }
}
