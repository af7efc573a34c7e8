//! Read-only view of a run at one instant, for instruments.

use crate::analysis::stress::{ContactForce, ContactForces, MovingParticle};
use crate::analysis::{BedProfile, RunView, SeriesRow};
use nalgebra::Vector3;
use std::cell::OnceCell;
use talcum_engine::contact::{
    PairForce, WallLaws, WallPairForce, for_each_pair_force, wall_pair_forces,
};
use talcum_engine::domain::{Bounds, PosedWalls};
use talcum_engine::parallel::{CellSample, Communicator};
use talcum_engine::particle_sets::agglomerates::ParticleSample;
use talcum_engine::particle_sets::{Ownership, Pair, Periodicity, samples, touching_pairs};
use talcum_engine::particles::sphere_volume;

/// A run at the end of a step. Data that several instruments need are computed once, at the first request.
pub struct View<'a> {
    run: RunView<'a>,
    /// The bed over height, at the last row of the series or, if an instrument needs it, at present.
    pub profile: &'a BedProfile,
    /// The numbers of the series, if an instrument needs them.
    pub series: Option<&'a SeriesRow>,
    /// The volume-averaged gas on this rank's cells, if an instrument needs it and the stage has such a gas.
    pub gas_cells: Option<&'a [CellSample]>,
    wall_pair_forces: OnceCell<Vec<WallPairForce>>,
    touching: OnceCell<Vec<Pair>>,
    samples: OnceCell<Vec<ParticleSample>>,
    ownership: OnceCell<Ownership>,
    contact_forces: OnceCell<ContactForces>,
    moving: OnceCell<Vec<MovingParticle>>,
}

impl<'a> View<'a> {
    /// A view of a run and of the data prepared for the instruments.
    pub fn new(
        run: RunView<'a>,
        profile: &'a BedProfile,
        series: Option<&'a SeriesRow>,
        gas_cells: Option<&'a [CellSample]>,
    ) -> Self {
        Self {
            run,
            profile,
            series,
            gas_cells,
            wall_pair_forces: OnceCell::new(),
            touching: OnceCell::new(),
            samples: OnceCell::new(),
            ownership: OnceCell::new(),
            contact_forces: OnceCell::new(),
            moving: OnceCell::new(),
        }
    }

    /// State, domain, models, and data that follow from them.
    pub fn run(&self) -> RunView<'a> {
        self.run
    }

    /// The time.
    pub fn time(&self) -> f64 {
        self.run.state.clock.time()
    }

    /// The box.
    pub fn bounds(&self) -> &'a Bounds {
        &self.run.domain.bounds
    }

    /// Periodicity of the box.
    pub fn periodicity(&self) -> Periodicity {
        Periodicity::of(self.bounds())
    }

    /// The particles that this rank owns, by ascending id, positions wrapped into the box.
    pub fn samples(&self) -> &[ParticleSample] {
        self.samples.get_or_init(|| samples(&self.run.state.particles, self.bounds()).0)
    }

    /// The ids of the particles that this rank owns, at the places that they have in [`View::samples`].
    pub fn ownership(&self) -> &Ownership {
        self.ownership.get_or_init(|| {
            Ownership::of(self.samples().iter().map(|particle| particle.id).collect())
        })
    }

    /// The touching pairs of different particles, each once, on the rank that owns the lower id, in ascending order.
    /// Collective.
    pub fn touching(&self, ranks: &dyn Communicator) -> &[Pair] {
        self.touching.get_or_init(|| {
            let state = self.run.state;
            touching_pairs(&state.contacts, &state.particles, self.ownership(), ranks)
        })
    }

    /// The particles that this rank owns, in the form used for stress.
    pub fn moving_particles(&self) -> &[MovingParticle] {
        self.moving.get_or_init(|| {
            let moving = |particle: &ParticleSample| MovingParticle {
                mass: particle.mass,
                volume: sphere_volume(particle.radius),
                position: particle.position,
                velocity: particle.velocity,
            };
            self.samples().iter().map(moving).collect()
        })
    }

    /// The forces of pairs and walls, each on one rank.
    pub fn contact_forces(&self) -> &ContactForces {
        self.contact_forces.get_or_init(|| {
            let mut forces = Vec::with_capacity(4 * self.run.state.particles.owned_count());
            self.for_each_pair_force(|pair| {
                let PairForce { position, branch, .. } = pair;
                let [contact, cohesive] = pair.on_lower();
                forces.push(ContactForce { position, branch, contact, cohesive });
            });
            let walls = self.wall_pair_forces().iter().map(|wall| ContactForce {
                position: self.position(wall.particle as usize),
                branch: wall.branch,
                contact: wall.contact,
                cohesive: wall.cohesive,
            });
            forces.extend(walls);
            ContactForces::of(forces)
        })
    }

    /// Passes the forces of all pairs that touch or attract each other, each on one rank, to a function.
    pub fn for_each_pair_force(&self, take: impl FnMut(PairForce)) {
        let RunView { state, models, .. } = self.run;
        let cohesion = models.physics.cohesion_at(self.time());
        let laws = &models.physics.contact;
        for_each_pair_force(&state.particles, &state.contacts, laws, cohesion.as_ref(), take);
    }

    /// The forces of particles and walls that touch or attract each other, one for each such particle and wall.
    pub fn wall_pair_forces(&self) -> &[WallPairForce] {
        self.wall_pair_forces.get_or_init(|| {
            let RunView { state, domain, models, work } = self.run;
            let physics = &models.physics;
            let cohesion = physics.cohesion_at(self.time());
            let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
            let at_wall = |wall: usize, species: usize| {
                let models = (&physics.contact, &physics.at_walls[..]);
                WallLaws::of(wall, species, models, cohesion.as_ref())
            };
            wall_pair_forces(&state.particles, &state.contacts, walls, at_wall)
        })
    }

    /// Wrapped position of a particle: a sum over the particles that this rank owns is exact over ranks only if the
    /// addends do not depend on the image.
    pub fn position(&self, index: usize) -> Vector3<f64> {
        self.bounds().wrap(self.run.state.particles.body[index].position)
    }
}
