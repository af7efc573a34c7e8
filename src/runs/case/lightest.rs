//! Contacts of the lightest particles, which have the shortest duration.

use super::{Case, Stage};
use talcum_engine::contact::{ContactForceLaw, ContactModel};
use talcum_engine::rules::ReducedBody;
use talcum_engine::state::SizeRange;

impl Case {
    /// Duration of the shortest contact in a stage of particles of these sizes: of two of the lightest of any species,
    /// or of one and a wall.
    pub fn shortest_contact(&self, stage: &Stage, sizes: &SizeRange) -> f64 {
        let duration = |interface: &ContactModel, bodies: ReducedBody| {
            interface.law.contact_duration(bodies.mass, bodies.radius)
        };
        let species = 0..self.particles.species_count();
        let pairs =
            species.clone().flat_map(|higher| (0..=higher).map(move |lower| [lower, higher]));
        let of_pairs = pairs
            .map(|pair| duration(stage.physics.contact.of(pair), self.lightest_pair(pair, sizes)));
        let at_walls = stage.physics.at_walls.iter();
        let of_walls = at_walls.flat_map(|models| {
            let of = |species| duration(models.of(species), self.lightest_at_wall(species, sizes));
            species.clone().map(of)
        });
        of_pairs.chain(of_walls).fold(f64::INFINITY, f64::min)
    }

    /// The lightest particles of two species in contact.
    pub fn lightest_pair(&self, pair: [usize; 2], sizes: &SizeRange) -> ReducedBody {
        let [one, other] = pair
            .map(|species| self.particles.lightest_of_species(species, sizes.smallest_diameter));
        ReducedBody::of_spheres([one.0, other.0], [one.1, other.1])
    }

    /// The lightest particle of a species in contact with a wall.
    pub fn lightest_at_wall(&self, species: usize, sizes: &SizeRange) -> ReducedBody {
        let (mass, radius) = self.particles.lightest_of_species(species, sizes.smallest_diameter);
        ReducedBody::of_sphere_and_wall(mass, radius)
    }
}
