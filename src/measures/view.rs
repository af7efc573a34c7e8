//! A run as measures see it: read only, at one instant.

use crate::analysis::agglomerates::ParticleSample;
use crate::analysis::{BedProfile, Measures, Pair, Periodicity, RunView};
use crate::contact::{PairForce, WallForce, pair_forces, wall_forces};
use crate::domain::{Bounds, PosedWalls};
use crate::parallel::CellSample;
use nalgebra::Vector3;
use std::cell::OnceCell;

/// A run at the end of a step. What several measures want is computed once, when the first asks for it.
pub struct View<'a> {
    run: RunView<'a>,
    /// The bed over height, as of the last row of the series or, if a measure needs it, of now.
    pub profile: &'a BedProfile,
    /// The numbers of the series, if a measure needs them.
    pub series: Option<&'a Measures>,
    /// The volume-averaged gas on this rank's cells, if a measure needs it and the stage has such a gas.
    pub gas_cells: Option<&'a [CellSample]>,
    pair_forces: OnceCell<Vec<PairForce>>,
    wall_forces: OnceCell<Vec<WallForce>>,
    touching: OnceCell<Vec<Pair>>,
    samples: OnceCell<Vec<ParticleSample>>,
}

impl<'a> View<'a> {
    /// A view of a run and of what was made ready for the measures.
    pub fn new(
        run: RunView<'a>,
        profile: &'a BedProfile,
        series: Option<&'a Measures>,
        gas_cells: Option<&'a [CellSample]>,
    ) -> Self {
        Self {
            run,
            profile,
            series,
            gas_cells,
            pair_forces: OnceCell::new(),
            wall_forces: OnceCell::new(),
            touching: OnceCell::new(),
            samples: OnceCell::new(),
        }
    }

    /// State, domain, models, and what follows from them.
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

    /// Along which axes the box repeats.
    pub fn periodicity(&self) -> Periodicity {
        periodicity_of(self.bounds())
    }

    /// The particles that this rank owns, positions wrapped into the box.
    pub fn samples(&self) -> &[ParticleSample] {
        self.samples.get_or_init(|| {
            let particles = &self.run.state.particles;
            let sample = |i: usize| {
                let body = &particles.body[i];
                let position = self.bounds().wrap(body.position);
                let (mass, radius, velocity) = (body.mass, body.radius, body.velocity);
                ParticleSample { id: particles.id[i], mass, radius, position, velocity }
            };
            (0..particles.owned_count()).map(sample).collect()
        })
    }

    /// The touching pairs, each on one rank.
    pub fn touching(&self) -> &[Pair] {
        self.touching.get_or_init(|| {
            let state = self.run.state;
            let pairs = state.contacts.touching_pairs(&state.particles);
            pairs.map(|[lower, higher]| Pair { lower, higher }).collect()
        })
    }

    /// The forces of all pairs that touch or attract each other, each on one rank.
    pub fn pair_forces(&self) -> &[PairForce] {
        self.pair_forces.get_or_init(|| {
            let RunView { state, models, .. } = self.run;
            let cohesion = models.physics.cohesion.as_ref().map(|law| law.at(self.time()));
            pair_forces(&state.particles, &state.contacts, &models.physics.contact, cohesion)
        })
    }

    /// The forces of particles and walls that touch or attract each other.
    pub fn wall_forces(&self) -> &[WallForce] {
        self.wall_forces.get_or_init(|| {
            let RunView { state, domain, models, work } = self.run;
            let cohesion = models.physics.cohesion.as_ref().map(|law| law.at(self.time()));
            let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
            let models = (&models.physics.contact, &models.physics.at_walls[..]);
            wall_forces(&state.particles, &state.contacts, walls, models, cohesion)
        })
    }

    /// A sum over the particles that this rank owns is exact over ranks only if addends are; this is each particle's
    /// wrapped position.
    pub fn position(&self, index: usize) -> Vector3<f64> {
        self.bounds().wrap(self.run.state.particles.body[index].position)
    }
}

/// Along which axes a box repeats.
pub(super) fn periodicity_of(bounds: &Bounds) -> Periodicity {
    let length = |axis: usize| bounds.is_periodic(axis).then(|| bounds.lengths()[axis]);
    Periodicity { lengths: [length(0), length(1), length(2)] }
}
