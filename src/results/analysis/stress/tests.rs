//! A column of spheres carries the weight above; the divergence of the stress balances forces; results have the same
//! bits on any ranks.

use super::*;
use talcum_engine::numbers::{Quantum, normal, random_of, uniform};
use talcum_engine::parallel::run_on_threads;

fn bins(count: usize, height: f64, area: f64, periodic: bool) -> CellGrid {
    CellGrid {
        origin: Vector3::zeros(),
        spacing: Vector3::new(area, 1.0, height),
        counts: [1, 1, count],
        periodic: [true, true, periodic],
    }
}

fn run(
    measurement: &StressMeasurement,
    particles: &[MovingParticle],
    contacts: &[ContactForce],
    n: usize,
) -> (Vec<CellStress>, u64) {
    let made = run_on_threads(n, |ranks| {
        let mine = |place: usize| place * place % 11 % n == ranks.rank();
        let image = |place: usize| [(place + n) as i32 % 3 - 1, 1 - (place as i32 % 2), 0];
        let mut here = Vec::new();
        for (place, particle) in particles.iter().enumerate().filter(|(place, _)| mine(*place)) {
            let position = measurement.periodicity.shifted(particle.position, image(place));
            here.push(MovingParticle { position, ..*particle });
        }
        let mut forces = Vec::new();
        for (place, force) in contacts.iter().enumerate().filter(|(place, _)| mine(place + 1)) {
            let position = measurement.periodicity.shifted(force.position, image(place));
            forces.push(ContactForce { position, ..*force });
        }
        let field = measurement.run(&here, &ContactForces::of(forces), ranks);
        (field.gathered(ranks), field.outside)
    });
    let bits = |field: &(Vec<CellStress>, u64)| bytemuck::cast_slice::<_, u64>(&field.0).to_vec();
    assert!(made.iter().all(|field| bits(field) == bits(&made[0]) && field.1 == made[0].1));
    made.into_iter().next().unwrap()
}

/// 20 spheres of diameter 1 and weight 3 on a plate: each contact carries the weight above it.
fn column() -> (Vec<MovingParticle>, Vec<ContactForce>) {
    let particle = |k: usize| MovingParticle {
        mass: 3.0,
        volume: 0.5,
        position: Vector3::new(0.3, 0.4, k as f64 + 0.5),
        velocity: Vector3::zeros(),
    };
    let particles: Vec<_> = (0..20).map(particle).collect();
    let contact = |k: usize| ContactForce {
        position: particles[k].position,
        branch: Vector3::new(0.0, 0.0, if k == 0 { -0.5 } else { -1.0 }),
        contact: Vector3::new(0.0, 0.0, 3.0 * (20 - k) as f64 + 0.7),
        cohesive: Vector3::new(0.0, 0.0, -0.7),
    };
    let contacts = (0..20).map(contact).collect();
    (particles, contacts)
}

fn at_rest(grid: CellGrid) -> StressMeasurement {
    let lengths = [Some(grid.spacing.x), Some(1.0), None];
    StressMeasurement { grid, periodicity: Periodicity { lengths }, frame: Frame::default() }
}

#[test]
fn a_column_at_rest_carries_the_weight_above() {
    let (particles, contacts) = column();
    let area = 2.0;
    // For bins between contact points, the stress is exactly the weight above the middle of the bin.
    let measurement = at_rest(bins(20, 1.0, area, false));
    for n in 1..=4 {
        let (cells, outside) = run(&measurement, &particles, &contacts, n);
        assert_eq!(outside, 0);
        for (k, cell) in cells.iter().enumerate() {
            let weight = 3.0 * (20.0 - (k as f64 + 0.5));
            let stress = cell.total()[(2, 2)];
            assert!((stress * area / weight - 1.0).abs() < 1e-13, "{k} {stress}");
            // Cohesion pulls, and is carried by the springs.
            let part = if k == 19 { 0.5 } else { 1.0 };
            assert!((cell.cohesive[(2, 2)] * area + 0.7 * part).abs() < 1e-13);
            assert_eq!(cell.granular_temperature(), 0.0);
        }
    }
    // For any other bins, the largest error is the weight of half a particle, since a force passes from centre to
    // centre.
    let measurement = at_rest(bins(54, 0.37, area, false));
    let (cells, _) = run(&measurement, &particles, &contacts, 2);
    for cell in cells {
        let height = measurement.grid.centre_of(cell.cell).z;
        let error = cell.total()[(2, 2)] * area - 3.0 * (20.0 - height);
        assert!(error.abs() <= 1.5 + 1e-12, "{height} {error}");
    }
}

/// 300 particles at random in a periodic box with forces between random pairs: (particles, contacts, pairs).
fn gas() -> (Vec<MovingParticle>, Vec<ContactForce>, Vec<[usize; 2]>) {
    let mut generator = random_of(2, 0, "stress");
    let quantum = Quantum::spanning(32.0);
    let mut vector = |scale: [f64; 3]| {
        Vector3::from(scale.map(|scale| quantum.round(scale * uniform(&mut generator))))
    };
    let particles: Vec<_> = (0..300)
        .map(|k| MovingParticle {
            mass: 1.0 + f64::from(k % 7),
            volume: 0.1,
            position: vector([4.0, 1.0, 16.0]),
            velocity: vector([2.0; 3]) - Vector3::new(1.0, 0.7, 1.2),
        })
        .collect();
    let pairs: Vec<[usize; 2]> = (0..900).map(|k| [k % 300, (k * 7 + 13) % 300]).collect();
    let periodicity = Periodicity { lengths: [Some(4.0), Some(1.0), Some(16.0)] };
    let contact = |&[a, b]: &[usize; 2]| ContactForce {
        position: particles[a].position,
        branch: periodicity.displacement(&particles[a].position, &particles[b].position),
        contact: vector([3.0; 3]) - Vector3::new(1.0, 1.0, 2.0),
        cohesive: vector([1.0; 3]),
    };
    let contacts = pairs.iter().map(contact).collect();
    (particles, contacts, pairs)
}

/// A periodic box with bins of height 2 that move with a wave.
fn in_wave() -> StressMeasurement {
    StressMeasurement {
        grid: bins(8, 2.0, 4.0, true),
        periodicity: Periodicity { lengths: [Some(4.0), Some(1.0), Some(16.0)] },
        frame: Frame {
            displacement: Vector3::new(0.0, 0.0, 0.625),
            velocity: Vector3::new(0.0, 0.0, 0.3),
        },
    }
}

/// The hat function about the face between the bins k and k + 1 of `in_wave`.
fn hat(position: f64, k: usize) -> f64 {
    let distance = (position - 0.625 - 2.0 * (k as f64 + 1.0)).rem_euclid(16.0);
    (1.0 - distance.min(16.0 - distance) / 2.0).max(0.0)
}

#[test]
fn stress_has_the_same_bits_on_any_ranks() {
    let (particles, contacts, _) = gas();
    let grid = CellGrid {
        origin: Vector3::zeros(),
        spacing: Vector3::new(1.0, 0.5, 0.8),
        counts: [4, 2, 20],
        periodic: [true; 3],
    };
    for measurement in [in_wave(), StressMeasurement { grid, ..in_wave() }] {
        let expected = run(&measurement, &particles, &contacts, 1);
        assert_eq!(expected.1, 0);
        for n in 2..=4 {
            assert!(run(&measurement, &particles, &contacts, n) == expected, "{n} ranks");
        }
        // The sum over cells is the virial of the whole system, whatever the cells.
        let volume = measurement.grid.cell_volume();
        let sum: Matrix3<f64> = expected.0.iter().map(|cell| cell.contact * volume).sum();
        let whole: Matrix3<f64> = contacts.iter().map(|c| -c.contact * c.branch.transpose()).sum();
        assert!((sum - whole).norm() < 1e-11 * whole.norm(), "{}", (sum - whole).norm());
    }
}

#[test]
fn momentum_closes_about_every_face() {
    let (particles, contacts, pairs) = gas();
    let measurement = in_wave();
    let cells = run(&measurement, &particles, &contacts, 2).0;
    let area = 4.0;
    let c = measurement.frame.velocity;
    for k in 0..8 {
        let (below, above) = (&cells[k], &cells[(k + 1) % 8]);
        let mut forces = Vector3::zeros();
        let mut crude = Vector3::zeros();
        for (force, [a, b]) in contacts.iter().zip(&pairs) {
            let f = force.contact + force.cohesive;
            let weights = [a, b].map(|&i| hat(particles[i].position.z, k));
            forces += f * (weights[0] - weights[1]);
            // Control: the whole contact counts in the bin of its middle.
            let middle = force.position.z + 0.5 * force.branch.z - 0.625;
            let bin = (middle.rem_euclid(16.0) / 2.0) as usize;
            let sign = f64::from(bin == k) - f64::from(bin == (k + 1) % 8);
            crude += -f * force.branch.z * sign / 2.0;
        }
        let sum = |cell: &CellStress| (cell.contact + cell.cohesive) * Vector3::z() * area;
        let error = (sum(below) - sum(above) - forces).norm();
        assert!(error < 1e-12 * forces.norm(), "{k}: {error}");
        assert!((crude - forces).norm() > 1e-2 * forces.norm());
        // Motion: m v L(z) changes by m v (v_z - c_z) dL/dz; fluxes are those of velocities in the frame.
        let (mut change, dt) = (Vector3::zeros(), 1e-7);
        for particle in &particles {
            let velocity = particle.velocity - c;
            let z = particle.position.z;
            let later = z + velocity.z * dt;
            change += particle.mass * velocity * (hat(later, k) - hat(z, k)) / dt;
        }
        let flux = |cell: &CellStress| {
            (cell.momentum_flux() - cell.contact - cell.cohesive) * Vector3::z() * area
        };
        let error = (flux(below) - flux(above) - change).norm();
        // Differences of numbers near 1 over 1e-7.
        assert!(error < 1e-5 * change.norm(), "{k}: {error} {}", change.norm());
    }
}

#[test]
fn granular_temperature_is_about_the_local_mean() {
    // A mean velocity that rises by 1.5 per unit of height, and Gaussian velocities of variance 0.04 in one bin of
    // two.
    let mut generator = random_of(4, 0, "temperature");
    let particles: Vec<_> = (0..20_000)
        .map(|k| {
            let z = 4.0 * (f64::from(k) + 0.5) / 20_000.0;
            let hot = if z < 2.0 { 0.2 } else { 0.0 };
            let noise = Vector3::from_fn(|_, _| hot * normal(&mut generator));
            let velocity = Vector3::new(1.5 * z, 0.0, -3.0) + noise;
            MovingParticle {
                mass: 0.5,
                volume: 1e-4,
                position: Vector3::new(0.0, 0.0, z),
                velocity,
            }
        })
        .collect();
    let cells = run(&at_rest(bins(2, 2.0, 1.0, false)), &particles, &[], 3).0;
    let shear = (1.5_f64 * 2.0).powi(2) / 36.0;
    // The standard error of the mean of 30,000 squares.
    let error = 4.0 * 0.04 * (2.0 / 30_000.0_f64).sqrt();
    assert!((cells[0].granular_temperature() - 0.04 - shear).abs() < 2.0 * error);
    assert!((cells[1].granular_temperature() - shear).abs() < 1e-6);
    let finer = run(&at_rest(bins(20, 0.2, 1.0, false)), &particles, &[], 1).0;
    assert!((finer[15].granular_temperature() - shear / 100.0).abs() < 1e-6);
    assert!((cells[0].solids_fraction - 0.5).abs() < 1e-12);
    assert!((cells[1].velocity - Vector3::new(4.5, 0.0, -3.0)).norm() < 1e-12);
}

#[test]
fn what_lies_outside_is_counted_and_what_is_undefined_is_not_hidden() {
    let (particles, contacts) = column();
    let short = at_rest(bins(10, 1.0, 2.0, false));
    // Ten particles are outside; nine branches are wholly outside, and the tenth with its upper half.
    assert_eq!(run(&short, &particles, &contacts, 2).1, 10 + 10);
    let mut broken = contacts;
    broken[3].contact.x = f64::NAN;
    let cells = run(&short, &particles, &broken, 2).0;
    assert!(cells[0].contact[(0, 0)].is_nan());
    assert!(!cells[0].cohesive[(0, 0)].is_nan());
    assert!((rumpf_strength(0.6, 6.0, 2.0, 1.0) - 7.2 / std::f64::consts::PI).abs() < 1e-15);
}
