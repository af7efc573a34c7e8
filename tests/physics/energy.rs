//! The total energy never grows without work, in beds without vibration and gas flow.

use crate::beds::{Bench, PERIODIC, PLATE, Snapshot, attraction, branch, law};
use nalgebra::Vector3;
use talcum::contact::LinearSpringDashpot;
use talcum::domain::EffectiveGravity;
use talcum::time_step::StepError;

const STIFFNESS: f64 = 2.0e4;
const CUT_OFF: f64 = 0.02;
const RANGE: f64 = 0.2;

/// An unshaken bed that falls and comes to rest, in contacts of 57 steps.
fn falling_bed(restitution: f64, friction: f64, attraction_force: f64) -> Bench {
    let mut bench = Bench::new([4.2, 4.2, 20.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(STIFFNESS, restitution, friction);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 2.0e-4;
    if attraction_force > 0.0 {
        let forces = (attraction_force, 0.5 * attraction_force);
        bench.cohesion = Some(attraction(forces, 1.0, (CUT_OFF, RANGE)));
    }
    bench.add_layers(120, (1.03, 0.55), &[1.0], (0.012, 1.0));
    bench
}

/// Potential of the clipped attraction of largest force F: -F [max(delta - s, 0) + delta^2 (1/s' - 1/range)] with
/// s' = max(s, delta), zero from the range on.
fn attraction_energy(force: f64, separation: f64) -> f64 {
    let held = separation.clamp(CUT_OFF, RANGE);
    let tail = CUT_OFF * CUT_OFF * (1.0 / held - 1.0 / RANGE);
    -force * ((CUT_OFF - separation).max(0.0) + tail)
}

/// Kinetic, rotational, gravitational and attraction energy, and that of normal and tangential springs.
fn energies(bench: &Bench, attraction_force: f64, state: &Snapshot) -> [f64; 6] {
    let (mut kinetic, mut rotational, mut height) = (0.0, 0.0, 0.0);
    let (mut attractive, mut normal, mut tangential) = (0.0, 0.0, 0.0);
    let particles = &state.particles;
    for (index, one) in particles.iter().enumerate() {
        kinetic += 0.5 * one.mass * Vector3::from(one.velocity).norm_squared();
        let inertia = 0.4 * one.mass * one.radius.powi(2);
        rotational += 0.5 * inertia * Vector3::from(one.angular_velocity).norm_squared();
        height += one.mass * bench.gravity.magnitude * one.position[2];
        let plate = one.position[2] - one.radius;
        normal += 0.5 * STIFFNESS * plate.min(0.0).powi(2);
        attractive += attraction_energy(0.5 * attraction_force, plate);
        for other in &particles[index + 1..] {
            let separation =
                branch(&bench.domain.bounds, one, other).norm() - one.radius - other.radius;
            normal += 0.5 * STIFFNESS * separation.min(0.0).powi(2);
            attractive += attraction_energy(attraction_force, separation);
        }
    }
    let pairs = state.pairs.iter().map(|pair| pair.state.tangential_spring);
    let springs = pairs.chain(state.walls.iter().map(|contact| contact.state.tangential_spring));
    let kt = LinearSpringDashpot::tangential_stiffness_of(STIFFNESS, 0.3);
    springs.for_each(|spring| tangential += 0.5 * kt * Vector3::from(spring).norm_squared());
    [kinetic, rotational, height, attractive, normal, tangential]
}

/// What a run did to its energy; all over the kinetic energy at the start.
#[derive(Clone, Copy, Debug)]
struct Account {
    /// Largest total energy less the least before it.
    rise: f64,
    /// The same if the attraction's energy had the other sign.
    rise_of_wrong_sign: f64,
    /// The same without the energy of normal springs.
    rise_without_springs: f64,
    /// Total energy at the start less that at the end.
    lost: f64,
}

const SUMS: [[f64; 6]; 3] =
    [[1.0; 6], [1.0, 1.0, 1.0, -1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0, 0.0, 1.0]];

/// Runs for a time, looking every ten steps.
///
/// # Errors
/// If the run ends by an error of its own.
fn account(bench: &Bench, attraction_force: f64, duration: f64) -> Result<Account, StepError> {
    let mut run = bench.alone();
    let (mut least, mut rise, mut first) = ([f64::INFINITY; 3], [0.0_f64; 3], None);
    loop {
        let parts = energies(bench, attraction_force, &run.snapshot());
        let totals =
            SUMS.map(|factors| parts.iter().zip(factors).map(|(part, factor)| part * factor).sum());
        for kind in 0..3 {
            least[kind] = least[kind].min(totals[kind]);
            rise[kind] = rise[kind].max(totals[kind] - least[kind]);
        }
        let (start, scale): (f64, f64) = *first.get_or_insert((totals[0], parts[0]));
        if run.time() >= duration {
            let [rise, rise_of_wrong_sign, rise_without_springs] = rise.map(|rise| rise / scale);
            let lost = (start - totals[0]) / scale;
            return Ok(Account { rise, rise_of_wrong_sign, rise_without_springs, lost });
        }
        for _ in 0..10 {
            run.try_step()?;
        }
    }
}

/// omega dt of a contact of two spheres.
fn phase_per_step(bench: &Bench) -> f64 {
    bench.time_step * (STIFFNESS / (0.5 * bench.particles[0].mass)).sqrt()
}

#[test]
fn energy_never_grows_without_work() {
    for (restitution, friction, force) in
        [(0.9, 0.0, 0.0), (0.9, 0.3, 0.0), (1.0, 0.3, 0.0), (0.9, 0.3, 3.0), (0.6, 0.3, 3.0)]
    {
        let bench = falling_bed(restitution, friction, force);
        let account = account(&bench, force, 2.0).unwrap();
        println!("energy, e {restitution}, mu {friction}, F {force}: {account:?}");
        // What contacts take at each step is more than the integrator's error there, which is reversible;
        // what is left comes from the attraction beyond contact, (v dt / delta)^2 = 1e-4 of F delta = 0.06 for
        // few of 120 particles at a time.
        assert!(account.rise < 1.0e-5, "{account:?}");
        assert!(account.lost > 0.3, "dissipation is at work: {account:?}");
        // Negative controls: wrong sums of the same run grow.
        assert!(account.rise_without_springs > 1.0e-3, "{account:?}");
        assert!(force == 0.0 || account.rise_of_wrong_sign > 0.02, "{account:?}");
    }
}

#[test]
fn without_dissipation_the_error_falls_as_the_step_squared() {
    let mut bench = falling_bed(1.0, 0.0, 0.0);
    let rises = [1.0, 0.5].map(|part| {
        bench.time_step = part * 2.0e-4;
        let account = account(&bench, 0.0, 1.0).unwrap();
        // A contact that begins or ends within a step misses up to (omega dt)^2 / 8 of its energy, with
        // either sign.
        assert!(account.rise < phase_per_step(&bench).powi(2) / 8.0, "{account:?}");
        account.rise
    });
    println!("energy without dissipation: error {rises:?}");
    // 4, less exactly since the errors of many contacts add up by chance.
    assert!((2.5..6.0).contains(&(rises[0] / rises[1])), "{rises:?}");
}

/// Negative control: in steps of a third of a contact energy does grow.
#[test]
fn a_step_twenty_times_too_long_is_seen() {
    let mut bench = falling_bed(1.0, 0.0, 0.0);
    let most = phase_per_step(&bench).powi(2) / 8.0;
    bench.time_step *= 20.0;
    if let Ok(account) = account(&bench, 0.0, 1.0) {
        println!("energy in long steps: {account:?}");
        assert!(account.rise > 100.0 * most, "{account:?}");
    }
}
