//! The data for the numbers of the series: sums over particles, external forces, and the gas.

use super::sums::sums;
use super::{BedProfile, MomentumProbe};
use talcum_engine::gas::GasObservables;
use talcum_engine::parallel::Communicator;
use talcum_engine::particles::{AGGLOMERATE, AgglomerateOfParticle};
use talcum_engine::state::{Domain, Models, State, Workspace};

/// Read-only view of a run at the end of a step.
#[derive(Clone, Copy)]
pub struct RunView<'a> {
    /// The state.
    pub state: &'a State,
    /// Box and walls.
    pub domain: &'a Domain,
    /// The models that act on the particles.
    pub models: &'a Models,
    /// Lists, forces on walls, and the gas on its grid.
    pub work: &'a Workspace,
}

impl RunView<'_> {
    /// Number of touching neighbours of each particle that this rank owns. Collective.
    pub fn coordination_numbers(&self, ranks: &dyn Communicator) -> Vec<u32> {
        let particles = &self.state.particles;
        let mut numbers = self.state.contacts.touching_by_particle(particles);
        self.work.halo.return_counts(&mut numbers, ranks);
        numbers.truncate(particles.owned_count());
        numbers
    }
}

/// Sums over all particles.
pub(super) struct ParticleSums {
    pub(super) count: f64,
    pub(super) mass: f64,
    /// Sum of mass times height.
    pub(super) moment: f64,
    /// Sum of vertical momentum.
    pub(super) vertical_momentum: f64,
    /// Sum of the kinetic energy of translation.
    pub(super) energy: f64,
    pub(super) volume: f64,
    /// Sum of touching neighbours: twice the number of touching pairs.
    pub(super) neighbours: f64,
    /// Sum of the drag factors that depend on agglomerates.
    pub(super) drag_factors: f64,
}

/// Forces that do not come from other particles, over all ranks.
struct ExternalForces {
    /// Force of walls, gas and weight on the bed.
    total: [f64; 3],
    /// Vertical force of the gas on the bed.
    gas: f64,
    /// Downward force of the bed on the base plate.
    plate: f64,
}

/// A run at one instant, as sums that are equal on all ranks and for any number of ranks.
pub(super) struct Observation {
    pub(super) time: f64,
    pub(super) particles: ParticleSums,
    pub(super) departed: u64,
    /// M g, the weight at rest.
    pub(super) weight: f64,
    /// g.
    pub(super) gravity: f64,
    /// g_eff.
    pub(super) effective_gravity: f64,
    pub(super) gas_force: f64,
    pub(super) plate_force: f64,
    /// Largest component of d(momentum)/dt less the external forces; 0 without a probe before the step.
    pub(super) momentum_imbalance: f64,
    /// M V^2 / 2.
    pub(super) mean_energy: f64,
    pub(super) gas: GasObservables,
    /// Pressure drop times cross-section.
    pub(super) pressure_force: f64,
    pub(super) bed_bottom: f64,
    pub(super) bed_top: f64,
    /// Volume of solids on the grid of the profile.
    pub(super) volume_on_grid: f64,
}

impl Observation {
    /// Computes the sums for a run. Collective.
    ///
    /// Before: the view is of the end of a step; `probe` was taken before that step, if there was one.
    pub(super) fn of(
        view: RunView<'_>,
        profile: &mut BedProfile,
        probe: Option<MomentumProbe>,
        ranks: &dyn Communicator,
    ) -> Self {
        let RunView { state, domain, models, work } = view;
        profile.update(&state.particles, ranks);
        let particles = ParticleSums::of(state, domain, ranks);
        let external = ExternalForces::of(view, ranks);
        let after = MomentumProbe::take(&state.particles, ranks);
        let imbalance = |before: MomentumProbe| {
            before.largest_imbalance(&after, external.total, models.physics.time_step)
        };
        let momentum = after.momentum();
        let mean_energy = if particles.mass > 0.0 {
            0.5 * momentum.iter().map(|p| p * p).sum::<f64>() / particles.mass
        } else {
            0.0
        };
        let gas = work.gas.observables(&state.gas, ranks);
        let (bed_bottom, bed_top) = profile.bottom_and_top();
        let time = state.clock.time();
        Self {
            time,
            departed: state.departed.count,
            weight: particles.mass * models.physics.gravity.magnitude,
            particles,
            gravity: models.physics.gravity.magnitude,
            effective_gravity: models.physics.gravity.at(time),
            gas_force: external.gas,
            plate_force: external.plate,
            momentum_imbalance: probe.map_or(0.0, imbalance),
            mean_energy,
            gas,
            pressure_force: gas.pressure_drop * domain.cross_section(),
            bed_bottom,
            bed_top,
            volume_on_grid: profile.solids_volume(),
        }
    }

    /// A force divided by the weight of the bed at rest; unchanged if there is no weight.
    pub(super) fn over_weight(&self, force: f64) -> f64 {
        if self.weight > 0.0 { force / self.weight } else { force }
    }
}

impl ParticleSums {
    fn of(state: &State, domain: &Domain, ranks: &dyn Communicator) -> Self {
        let particles = &state.particles;
        let height = |i: usize| domain.bounds.wrap_coordinate(2, particles.body[i].position.z);
        let of_particle = |i: usize| {
            let (m, v) = (particles.body[i].mass, particles.body[i].velocity);
            // The neighbours of all particles of the rank, counted once.
            let neighbours = if i == 0 { 2 * state.contacts.touching_count() } else { 0 };
            let energy = 0.5 * m * v.norm_squared();
            let (volume, xi) = (
                particles.volume(i),
                particles.columns.at(AGGLOMERATE).get::<AgglomerateOfParticle>(i).drag_factor,
            );
            [1.0, m, m * height(i), m * v.z, energy, volume, neighbours as f64, xi]
        };
        let [count, mass, moment, vertical_momentum, energy, volume, neighbours, drag_factors] =
            sums(particles, ranks, of_particle);
        Self { count, mass, moment, vertical_momentum, energy, volume, neighbours, drag_factors }
    }
}

impl ExternalForces {
    /// Forces at the last evaluation, including those of the particles on walls. Collective.
    fn of(view: RunView<'_>, ranks: &dyn Communicator) -> Self {
        let RunView { state, domain, models, work } = view;
        let on_walls = &work.on_walls;
        let particles = &state.particles;
        let by_gas = work.gas.total_force(particles, models.force_quantum);
        let weight = models.weight_at(state.clock.time());
        let owned = particles.body[..particles.owned_count()].iter();
        let weight: i64 = owned.map(|body| weight.quantum.count(weight.of(body.mass))).sum();
        let walls = || 0..on_walls.walls();
        let on_all_walls =
            |axis: usize| walls().map(|wall| on_walls.on_wall(wall)[axis]).sum::<i64>();
        let external = [0, 1, 2].map(|axis| by_gas[axis] - on_all_walls(axis));
        let on_plate = walls().filter(|&wall| domain.walls[wall].is_base_plate());
        let plate = on_plate.map(|wall| -on_walls.on_wall(wall)[2]).sum();
        let mut counts = [external[0], external[1], external[2] - weight, by_gas[2], plate];
        ranks.sum_integers(&mut counts);
        let spacing = models.force_quantum.spacing();
        let [x, y, z, gas, plate] = counts.map(|count| count as f64 * spacing);
        Self { total: [x, y, z], gas, plate }
    }
}
