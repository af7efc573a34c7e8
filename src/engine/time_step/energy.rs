//! The energy balance: the work of forces at each step, and the stored energy. It changes no result.
//!
//! Work of contacts is taken over the step that ends, with the velocities at its middle. The power of gas, weight and
//! moving walls is taken at the evaluations of forces, with velocities at the same instants, and integrated by the
//! trapezoidal rule.

use super::laws::force_laws;
use crate::contact::{
    ContactWork, ForceLaws, WallWork, attraction_energy, elastic_energy, work_of_walls,
};
use crate::domain::{PosedWalls, WallPose};
use crate::particles::{GAS_FORCE, Particles};
use crate::state::{Domain, EnergyLedger, Mechanism, Models, State, StoredSums, Workspace};
use nalgebra::Vector3;

/// Adds the work of a contact.
pub(super) fn add_contact_work(ledger: &mut EnergyLedger, work: ContactWork) {
    let ContactWork { dashpot, friction, plasticity, adhesion } = work;
    for (mechanism, work) in [
        (Mechanism::Dashpot, dashpot),
        (Mechanism::Friction, friction),
        (Mechanism::Plasticity, plasticity),
        (Mechanism::Cohesion, adhesion),
    ] {
        if work != 0.0 {
            ledger.add(mechanism, work);
        }
    }
}

/// Begins an evaluation of forces in the ledger, if one is kept, before contacts are evaluated: adds the work of walls,
/// and the energy that a ramp of the attraction brings.
pub(super) fn before_forces(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &Workspace,
    laws: &ForceLaws,
) {
    let State { particles, contacts, clock, energy, .. } = state;
    let Some(ledger) = energy else { return };
    ledger.next_evaluation();
    let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
    let step = models.physics.time_step;
    let now: Vec<WallPose> = domain.walls.iter().map(|wall| wall.pose(clock.time(), 0.0)).collect();
    work_of_walls(particles, contacts, walls, laws, |of_contact| {
        let WallWork { wall, work, force, couple, point } = of_contact;
        if laws.dt > 0.0 {
            add_contact_work(ledger, work);
        }
        let pose = &now[wall];
        let turning = couple.dot(&pose.angular_velocity());
        let power = -(force.dot(&pose.velocity_at(&point)) + turning);
        if power != 0.0 {
            ledger.add_power(Mechanism::Walls, power * step);
        }
    });
    let ramped = models.physics.cohesion_at(clock.time() - laws.dt);
    if ramped != laws.cohesion {
        let (mut before, mut after) = (StoredSums::default(), StoredSums::default());
        let earlier = ForceLaws { cohesion: ramped, ..*laws };
        attraction_energy(particles, contacts, walls, &earlier, |energy| {
            before.potential.add(energy)
        });
        attraction_energy(particles, contacts, walls, laws, |energy| after.potential.add(energy));
        ledger.add_change(Mechanism::Models, &before, &after);
    }
}

/// Forces on owned particles without the force of the gas, before that of a column gas is added.
pub(super) fn forces_before_gas(particles: &Particles) -> Vec<Vector3<f64>> {
    let mut forces: Vec<Vector3<f64>> =
        particles.forces[..particles.owned_count()].iter().map(|load| load.force).collect();
    // Multiples of a quantum: exact.
    let of_gas = particles.columns.at(GAS_FORCE).held::<Vector3<f64>>();
    forces.iter_mut().zip(of_gas).for_each(|(force, of_gas)| *force -= of_gas);
    forces
}

/// Ends an evaluation of forces in the ledger, if one is kept: adds the power of the gas and of the weight.
/// `before_gas` are the forces without the gas; velocities are `behind` the forces by half of this time.
pub(super) fn after_forces(
    state: &mut State,
    models: &Models,
    before_gas: &[Vector3<f64>],
    behind: f64,
) {
    let State { particles, clock, energy, .. } = state;
    let Some(ledger) = energy else { return };
    let (weight, step) = (models.weight_at(clock.time()), models.physics.time_step);
    for (i, before_gas) in before_gas.iter().enumerate() {
        let (body, force) = (&particles.body[i], particles.forces[i].force);
        let velocity = body.velocity + force * (0.5 * behind / body.mass);
        // Forces are multiples of a quantum, so the difference is exactly the force of the gas.
        let by_gas = (force - before_gas).dot(&velocity);
        if by_gas != 0.0 {
            ledger.add_power(Mechanism::Gas, by_gas * step);
        }
        ledger.add_power(Mechanism::Gravity, -weight.of(body.mass) * velocity.z * step);
    }
}

/// Energy stored by this rank's particles, with velocities at the time of the clock.
pub fn stored_energy(
    state: &State,
    domain: &Domain,
    models: &Models,
    work: &Workspace,
) -> StoredSums {
    let State { particles, contacts, .. } = state;
    let mut sums = StoredSums::default();
    for body in &particles.body[..particles.owned_count()] {
        let translation = body.mass * body.velocity.norm_squared();
        let rotation = body.inertia() * body.angular_velocity.norm_squared();
        sums.kinetic.add(0.5 * translation);
        sums.kinetic.add(0.5 * rotation);
    }
    let laws = force_laws(state, models, work, 0.0);
    let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
    elastic_energy(particles, contacts, walls, &laws, |energy| sums.elastic.add(energy));
    attraction_energy(particles, contacts, walls, &laws, |energy| sums.potential.add(energy));
    sums
}

/// Kinetic energy of a particle that leaves.
pub(super) fn add_departure(ledger: &mut EnergyLedger, particles: &Particles, index: usize) {
    let body = &particles.body[index];
    ledger.add(Mechanism::Departed, -0.5 * body.mass * body.velocity.norm_squared());
    let rotation = body.inertia() * body.angular_velocity.norm_squared();
    ledger.add(Mechanism::Departed, -0.5 * rotation);
}
