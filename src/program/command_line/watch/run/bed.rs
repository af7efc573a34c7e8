//! Side view of the bed: particles of the newest snapshot, or else of the newest checkpoint.

use std::path::Path;
use talcum_engine::parallel::OneRank;
use talcum_results::output::OutputError;
use talcum_results::output::checkpoint;
use talcum_results::output::readers::ParticleSnapshotReader;

/// Number of particles that are kept: those in front, which hide the others.
const KEPT: usize = 20_000;
/// Largest number of particles that are read: more would need gigabytes.
const MOST_READ: u64 = 20_000_000;
/// Largest size of a checkpoint that is read; bytes.
const MOST_BYTES: u64 = 8 << 30;

/// A particle in the side view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct SeenParticle {
    pub(in super::super) position: [f64; 3],
    pub(in super::super) radius: f64,
    pub(in super::super) speed: f64,
}

/// The bed at one instant.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Bed {
    pub(in super::super) time: f64,
    /// Number of particles in the file.
    pub(in super::super) count: usize,
    /// Particles in front, from back to front; the view is along y.
    pub(in super::super) seen: Vec<SeenParticle>,
}

impl Bed {
    fn new(time: f64, mut seen: Vec<SeenParticle>) -> Self {
        let count = seen.len();
        let depth = |particle: &SeenParticle| particle.position[1];
        if count > KEPT {
            seen.select_nth_unstable_by(KEPT, |a, b| depth(a).total_cmp(&depth(b)));
            seen.truncate(KEPT);
        }
        seen.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        Self { time, count, seen }
    }

    /// The newest snapshot of a file.
    ///
    /// # Errors
    /// If it cannot be read, or contains too many particles.
    pub(super) fn of_snapshots(path: &Path) -> Result<Self, OutputError> {
        let wrong = |message: String| OutputError { path: path.to_owned(), message };
        let snapshots = ParticleSnapshotReader::open(path)?;
        let Some(newest) = snapshots.times.len().checked_sub(1) else {
            return Err(wrong("holds no snapshot yet".to_owned()));
        };
        let count = snapshots.particles(newest);
        if count > MOST_READ {
            return Err(wrong(format!(
                "{count} particles are too many to draw, at most {MOST_READ}"
            )));
        }
        let snapshot = snapshots.snapshot(newest)?;
        let moving = snapshot.positions.iter().zip(&snapshot.velocities).zip(&snapshot.radii);
        let seen = moving.map(|((&position, velocity), &radius)| seen(position, velocity, radius));
        Ok(Self::new(snapshots.times[newest], seen.collect()))
    }

    /// The particles of a checkpoint.
    ///
    /// # Errors
    /// If it cannot be read, or is too large.
    pub(super) fn of_checkpoint(path: &Path) -> Result<Self, OutputError> {
        let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        if bytes > MOST_BYTES {
            let message = format!("{bytes} bytes are too many to draw, at most {MOST_BYTES}");
            return Err(OutputError { path: path.to_owned(), message });
        }
        let (checkpoint, _, _) = checkpoint::read(path, &OneRank)?;
        let all = checkpoint.particles.iter();
        let seen = all.map(|one| seen(one.position, &one.velocity, one.radius));
        Ok(Self::new(checkpoint.clock.time(), seen.collect()))
    }
}

fn seen(position: [f64; 3], velocity: &[f64; 3], radius: f64) -> SeenParticle {
    let speed = velocity.iter().map(|component| component * component).sum::<f64>().sqrt();
    SeenParticle { position, radius, speed }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row_of(count: usize) -> Bed {
        // The depths are scattered by a step that does not divide the count.
        let depths = (0..count).map(|n| ((n * 7_919) % count) as f64);
        Bed::new(1.0, depths.map(|y| seen([0.0, y, 0.0], &[3.0, 0.0, 4.0], 0.5)).collect())
    }

    #[test]
    fn particles_are_drawn_from_the_back_to_the_front() {
        let bed = row_of(5);
        let depths: Vec<f64> = bed.seen.iter().map(|particle| particle.position[1]).collect();
        assert_eq!(depths, [4.0, 3.0, 2.0, 1.0, 0.0]);
        assert_eq!((bed.count, bed.seen[0].speed), (5, 5.0));
    }

    #[test]
    fn of_many_particles_those_in_front_are_kept() {
        let bed = row_of(KEPT + 10);
        assert_eq!((bed.count, bed.seen.len()), (KEPT + 10, KEPT));
        assert_eq!(bed.seen[0].position[1], (KEPT - 1) as f64);
        assert_eq!(bed.seen[KEPT - 1].position[1], 0.0);
    }
}
