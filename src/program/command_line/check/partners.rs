//! Contact partners in a stage: each pair of species, and each species at each wall.

use talcum_engine::contact::{AttractionInContact, ContactModel, VanDerWaals};
use talcum_engine::rules::ReducedBody;
use talcum_runs::case::{Case, Stage};

/// Two particles of the reference diameter, or one and a wall.
pub(super) struct Partners<'a> {
    /// Suffix of the names of lines: empty for two particles of a bed of one species.
    pub(super) name: String,
    pub(super) contact: &'a ContactModel,
    pub(super) bodies: ReducedBody,
    /// The species of the two particles; for a particle and a wall, twice that of the particle.
    pub(super) species: [usize; 2],
    /// Number of the wall, if one partner is a wall.
    pub(super) wall: Option<usize>,
    cohesion: Option<&'a VanDerWaals>,
    radius: f64,
}

impl<'a> Partners<'a> {
    /// All partners in a stage: the pairs of species, then walls.
    pub(super) fn of_stage(case: &'a Case, stage: &'a Stage) -> Vec<Self> {
        let count = case.particles.species_count();
        let pairs = (0..count).flat_map(|higher| (0..=higher).map(move |lower| [lower, higher]));
        let pairs = pairs.map(|pair| Self::pair(case, stage, pair));
        let walls = (0..stage.physics.at_walls.len())
            .flat_map(|wall| (0..count).map(move |species| (wall, species)))
            .map(|(wall, species)| Self::at_wall(case, stage, wall, species));
        pairs.chain(walls).collect()
    }

    /// Two particles of these species.
    pub(super) fn pair(case: &'a Case, stage: &'a Stage, pair: [usize; 2]) -> Self {
        let physics = &stage.physics;
        let radius = 0.5 * case.particles.reference_diameter;
        let masses = pair.map(|species| case.particles.reference_mass(species));
        let names = pair.map(|species| species_name(case, species));
        let name = match names {
            [Some(one), Some(other)] if one == other => format!(" of {one}"),
            [Some(one), Some(other)] => format!(" of {one} and {other}"),
            _ => String::new(),
        };
        Self {
            name,
            contact: physics.contact.of(pair),
            bodies: ReducedBody::of_spheres(masses, [radius; 2]),
            species: pair,
            wall: None,
            cohesion: physics.cohesion.as_ref().map(|cohesion| cohesion.of(pair)),
            radius,
        }
    }

    /// A particle of a species, and a wall of the case.
    pub(super) fn at_wall(case: &'a Case, stage: &'a Stage, wall: usize, species: usize) -> Self {
        let physics = &stage.physics;
        let radius = 0.5 * case.particles.reference_diameter;
        let of = species_name(case, species).map_or(String::new(), |name| format!(" of {name}"));
        let mass = case.particles.reference_mass(species);
        Self {
            name: format!("{of} at wall \"{}\"", case.domain.walls[wall].name),
            contact: physics.at_walls[wall].of(species),
            bodies: ReducedBody::of_sphere_and_wall(mass, radius),
            species: [species; 2],
            wall: Some(wall),
            cohesion: physics.cohesion.as_ref().map(|cohesion| cohesion.of([species; 2])),
            radius,
        }
    }

    /// The attraction in contact, at the largest values of its schedules.
    pub(super) fn attraction(&self) -> AttractionInContact {
        let Some(law) = self.cohesion.map(VanDerWaals::strongest) else {
            return AttractionInContact::default();
        };
        let radius = self.radius;
        let (force, energy) = match self.wall {
            None => (
                law.between_particles(radius, radius, 0.0),
                law.energy_of_particles(radius, radius, 0.0),
            ),
            Some(_) => (law.to_wall(radius, 0.0), law.energy_at_wall(radius, 0.0)),
        };
        AttractionInContact { force, work: -energy }
    }
}

/// The name of a species, if there are several.
fn species_name(case: &Case, species: usize) -> Option<&str> {
    case.particles.species.get(species).map(|species| species.name.as_str())
}
