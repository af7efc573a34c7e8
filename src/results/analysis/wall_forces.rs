//! The force of the particles on each wall.

use super::RunView;
use nalgebra::Vector3;
use talcum_engine::parallel::Communicator;

/// The force of the particles on a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct WallForce {
    /// Name of the wall.
    pub wall: String,
    /// Diameter of the particles counted; `None` for all.
    pub diameter: Option<f64>,
    /// Force of contact and attraction, F.
    pub force: Vector3<f64>,
}

/// The force on each wall by all particles and, if there are size classes, by those of each class. Sums over all ranks
/// of multiples of the force quantum are exact up to their conversion. Collective.
///
/// Forces are those of the last evaluation, at the velocities of the half step: before the first step after a restart
/// there are none. [`View::wall_pair_forces`](crate::instruments::View::wall_pair_forces) gives the force of each
/// particle, at the velocities of the whole step.
pub fn wall_forces(view: RunView<'_>, ranks: &dyn Communicator) -> Vec<WallForce> {
    let RunView { domain, models, work, .. } = view;
    let tallies = &work.on_walls;
    let walls = || 0..tallies.walls();
    let mut counts: Vec<i64> = walls()
        .flat_map(|wall| {
            std::iter::once(tallies.on_wall(wall)).chain(tallies.by_class(wall).to_vec())
        })
        .flatten()
        .collect();
    ranks.sum_integers(&mut counts);
    let spacing = models.force_quantum.spacing();
    let mut forces =
        counts.chunks_exact(3).map(|count| Vector3::from_fn(|a, _| count[a] as f64 * spacing));
    let mut found = Vec::new();
    for wall in walls() {
        let name = &domain.walls[wall].name;
        let of_all = forces.next().map(|force| (None, force));
        let of_classes = forces.by_ref().take(tallies.by_class(wall).len());
        // A single class contains all particles.
        let of_classes: Vec<_> = of_classes.collect();
        let of_classes = tallies.diameters().iter().copied().map(Some).zip(of_classes);
        found.extend(of_all.into_iter().chain(of_classes).map(|(diameter, force)| WallForce {
            wall: name.clone(),
            diameter,
            force,
        }));
    }
    found
}
