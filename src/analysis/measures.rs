//! The numbers of one row of the series: balances, pressure drops, and how the bed moves.

use super::BedProfile;
use crate::domain::BASE_PLATE;
use crate::numbers::ExactSum;
use crate::parallel::Communicator;
use crate::particles::Particles;
use crate::state::{Domain, Models, State, Tallies, Workspace};

/// What the bed does at one instant. "Over weight" is over the bed's weight at rest, M g.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Time.
    pub time: f64,
    /// U_s, for a gas in three dimensions its mean over the bottom; 0 without gas.
    pub superficial_velocity: f64,
    /// Integral of beta (U_s - u_s) / (1 - phi)^2 over the height, times the cross-section, over weight; for a gas in three
    /// dimensions its mean pressure at the bottom less that at the top, hydrostatic head left out.
    pub grid_pressure_drop: f64,
    /// Vertical gas force on all particles, over weight.
    pub gas_force: f64,
    /// Force on the base plate, downwards, over weight.
    pub plate_stress: f64,
    /// g_eff / g.
    pub effective_gravity: f64,
    /// Height of the centre of mass.
    pub centre_height: f64,
    /// Its vertical velocity.
    pub centre_velocity: f64,
    /// Lowest height of the bed.
    pub bed_bottom: f64,
    /// Highest.
    pub bed_top: f64,
    /// Kinetic energy of the mean motion, M V^2 / 2.
    pub mean_kinetic_energy: f64,
    /// Kinetic energy of translation about the mean motion.
    pub fluctuating_kinetic_energy: f64,
    /// Mean number of touching particles per particle.
    pub coordination_number: f64,
    /// Largest component of d(momentum)/dt less the external forces, over the last step, over weight.
    pub momentum_error: f64,
    /// Volume of solids on the grid over that of the particles, less 1.
    pub mass_error: f64,
    /// Number of particles.
    pub particles: f64,
    /// Number of particles that have left.
    pub departed: f64,
    /// Iterations of the pressure equation in the last step of a gas in three dimensions.
    pub gas_iterations: f64,
    /// Its Courant number.
    pub gas_courant: f64,
    /// Cells whose voidage was below the least one in that step and was raised to it.
    pub raised_cells: f64,
    /// Largest component of what particles gained in that step less what the gas lost, over weight.
    pub exchange_error: f64,
}

/// Momentum and total force before a step, to be held against those after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumProbe {
    momentum: [f64; 3],
    force: [f64; 3],
}

/// Sums over all ranks' owned particles, exact.
fn sums<const N: usize>(
    particles: &Particles,
    ranks: &dyn Communicator,
    of: impl Fn(usize) -> [f64; N],
) -> [f64; N] {
    let mut local = [(); N].map(|()| ExactSum::default());
    for i in 0..particles.owned_count() {
        for (sum, value) in local.iter_mut().zip(of(i)) {
            sum.add(value);
        }
    }
    let mut integers: Vec<i64> = local.iter().flat_map(ExactSum::to_integers).collect();
    ranks.sum_integers(&mut integers);
    let mut totals = integers.chunks(ExactSum::INTEGERS).map(ExactSum::from_integers);
    [(); N].map(|()| totals.next().map_or(0.0, |sum| sum.value()))
}

impl MomentumProbe {
    /// Momentum and total force now. Collective.
    pub fn take(particles: &Particles, ranks: &dyn Communicator) -> Self {
        let [px, py, pz, fx, fy, fz] = sums(particles, ranks, |i| {
            let (p, f) =
                (particles.body[i].velocity * particles.body[i].mass, particles.forces[i].force);
            [p.x, p.y, p.z, f.x, f.y, f.z]
        });
        Self { momentum: [px, py, pz], force: [fx, fy, fz] }
    }

    /// (P_after - P_before) / dt - (F_before + F_after) / 2, where F_after is not the sum over particles but
    /// what walls, gas and weight are said to do: contact forces cancel, or this is not zero.
    fn imbalance(&self, after: &Self, external: [f64; 3], dt: f64) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let change = (after.momentum[axis] - self.momentum[axis]) / dt;
            change - 0.5 * (self.force[axis] + external[axis])
        })
    }
}

/// Forces of walls (on the particles), gas and weight over all ranks, and that on the base plate. Collective.
fn external_forces(
    state: &State,
    domain: &Domain,
    models: &Models,
    work: &Workspace,
    ranks: &dyn Communicator,
) -> ([f64; 3], f64, f64) {
    let Tallies { on_walls, by_gas } = &work.tallies;
    let particles = &state.particles;
    let weight = models.weight_at(state.clock.time());
    let owned = particles.body[..particles.owned_count()].iter();
    let weight: i64 = owned.map(|body| weight.quantum.count(weight.of(body.mass))).sum();
    let on_all_walls = |axis: usize| on_walls.iter().map(|force| force[axis]).sum::<i64>();
    let external = [0, 1, 2].map(|axis| by_gas[axis] - on_all_walls(axis));
    let on_plate = domain.walls.iter().zip(on_walls).filter(|(wall, _)| wall.name == BASE_PLATE);
    let plate = on_plate.map(|(_, force)| -force[2]).sum();
    let mut counts = [external[0], external[1], external[2] - weight, by_gas[2], plate];
    ranks.sum_integers(&mut counts);
    let spacing = models.force_quantum.spacing();
    let force = |index: usize| counts[index] as f64 * spacing;
    ([force(0), force(1), force(2)], force(3), force(4))
}

/// Reads off everything. Collective.
///
/// Before: `state` is at the end of a step; `probe` was taken before that step, if there was one.
pub fn measure(
    state: &State,
    domain: &Domain,
    models: &Models,
    work: &Workspace,
    profile: &mut BedProfile,
    probe: Option<MomentumProbe>,
    ranks: &dyn Communicator,
) -> Measures {
    let particles = &state.particles;
    profile.update(particles, ranks);
    let wrapped = |i: usize| domain.bounds.wrap_coordinate(2, particles.body[i].position.z);
    let [count, mass, moment, momentum, energy, volume, neighbours] = sums(particles, ranks, |i| {
        let (m, v) = (particles.body[i].mass, particles.body[i].velocity);
        let contacts = if i == 0 { state.contacts.touching_neighbours(particles) } else { 0 };
        let energy = 0.5 * m * v.norm_squared();
        [1.0, m, m * wrapped(i), m * v.z, energy, particles.volume(i), contacts as f64]
    });
    let (external, gas_force, plate_force) = external_forces(state, domain, models, work, ranks);
    let weight = mass * models.gravity.magnitude;
    let over_weight = |force: f64| if weight > 0.0 { force / weight } else { force };
    let after = MomentumProbe::take(particles, ranks);
    let momentum_error = probe.map_or(0.0, |before| {
        let errors = before.imbalance(&after, external, models.time_step);
        over_weight(errors.iter().fold(0.0, |largest: f64, error| largest.max(error.abs())))
    });
    let mean_energy = if mass > 0.0 {
        0.5 * after.momentum.iter().map(|p| p * p).sum::<f64>() / mass
    } else {
        0.0
    };
    let per = |value: f64, total: f64| if total > 0.0 { value / total } else { 0.0 };
    let (bed_bottom, bed_top) = profile.bottom_and_top();
    let gas = work.gas.observables(&state.gas, ranks);
    let pressure_force = gas.pressure_drop * domain.bounds.cross_section();
    Measures {
        time: state.clock.time(),
        superficial_velocity: gas.superficial_velocity,
        grid_pressure_drop: over_weight(pressure_force),
        gas_force: over_weight(gas_force),
        plate_stress: over_weight(plate_force),
        effective_gravity: per(models.gravity.at(state.clock.time()), models.gravity.magnitude),
        centre_height: per(moment, mass),
        centre_velocity: per(momentum, mass),
        bed_bottom,
        bed_top,
        mean_kinetic_energy: mean_energy,
        fluctuating_kinetic_energy: energy - mean_energy,
        coordination_number: per(neighbours, count),
        momentum_error,
        mass_error: if volume > 0.0 { profile.solids_volume() / volume - 1.0 } else { 0.0 },
        particles: count,
        departed: state.departed.count as f64,
        gas_iterations: gas.report.iterations as f64,
        gas_courant: gas.report.courant,
        raised_cells: gas.report.raised_cells as f64,
        exchange_error: over_weight(gas.report.momentum_error),
    }
}
