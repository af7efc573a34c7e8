//! Solids volume and momentum pass between particles and cells without loss, also at walls and with the filter, in any
//! decomposition.

use super::*;
use crate::domain::{Bounds, Decomposition, Face, RankGrid};
use crate::gas::{AgglomerateDrag, Beetstra, DragLaw, ParticleDrag};
use crate::numbers::{ExactSum, random_of, uniform};
use crate::parallel::{CollectiveError, FieldHalo, agree, run_on_threads};
use crate::particles::{AGGLOMERATE, AgglomerateOfParticle, GAS_FORCE};
use std::sync::Mutex;

const COUNTS: [usize; 3] = [7, 5, 12];
const DIAMETER: f64 = 0.6;
const MASS: f64 = 0.1;
/// Length of the step, so short that the drag of the densest finer cells takes less than the whole slip.
const STEP: f64 = 1.0e-4;
const GRAVITY: f64 = 9.81;
/// Range of the quantum of forces.
const FORCES: f64 = 16.0;

/// A periodic box, a box between walls, and one from a wall to an open end.
fn bounds() -> Bounds {
    let faces = [[Face::Periodic; 2], [Face::Wall; 2], [Face::Wall, Face::Open]];
    Bounds::new(Vector3::new(7.7, 5.0, 12.0), faces)
}

fn model(filter_width: f64) -> CouplingModel {
    let law = DragLaw::Beetstra(Beetstra);
    let drag = ParticleDrag {
        law,
        factor: 0.7,
        share: DragShare::Diameter,
        viscosity: 0.02,
        density: 0.05,
        parcel_size: 1.0,
    };
    CouplingModel {
        drag,
        filter_width,
        agglomerates: None,
        undisturbed: false,
        local_voidage: None,
        least_voidage: 0.2,
    }
}

/// Models without and with a filter, and with a filter and the voidage of finer cells for the drag. The drag is weak in
/// the last one: particles at random places overlap more than a packing could in a finer cell.
fn models() -> [CouplingModel; 3] {
    let mut filtered = model(2.0);
    (filtered.drag.factor, filtered.least_voidage) = (0.07, 0.4);
    let local = CouplingModel { local_voidage: Some(2), ..filtered.clone() };
    [model(0.0), filtered, local]
}

fn limits() -> ParticleLimits {
    let force_quantum = Quantum::spanning(FORCES);
    ParticleLimits { diameters: [DIAMETER; 2], force: 10.0, force_quantum, speed: 10.0, drift: 0.3 }
}

fn numbers<const N: usize>(id: u64, purpose: &str) -> [f64; N] {
    let mut generator = random_of(3, id, purpose);
    std::array::from_fn(|_| uniform(&mut generator))
}

/// A bed in the lower half that touches all walls. Some particles have drifted since they were sorted to their rank.
fn bed_of(decomposition: &Decomposition, rank: usize, count: u64) -> Particles {
    let (bounds, mut particles) = (bounds(), Particles::default());
    for id in 0..count {
        let [x, y, z, dx, dy, dz] = numbers(id, "place");
        let quantum = |v: Vector3<f64>| bounds.position_quantum().round_vector(v);
        let sorted = bounds.wrap(quantum(Vector3::new(7.7 * x, 5.0 * y, 6.0 * z)));
        let drift = 0.5 * (Vector3::new(dx, dy, dz) - Vector3::repeat(0.5));
        let [u, v, w] = numbers(id, "velocity").map(|part| part - 0.5);
        if decomposition.owner_of(&sorted) == rank {
            let position = sorted + quantum(drift);
            particles.push(id, position, Vector3::new(u, v, w), 0.5 * DIAMETER, MASS);
            // Each particle is in an agglomerate of its own; this has an effect only if drag depends on agglomerates.
            if let Some(of) = particles
                .columns
                .at_mut(AGGLOMERATE)
                .hold::<AgglomerateOfParticle>()
                .last_mut()
                .filter(|_| id % 5 > 0)
            {
                (of.diameter, of.packing) = (DIAMETER * (1.5 + x), 0.3 + 0.3 * y);
            }
        }
    }
    particles
}

/// A gas with non-zero values in all cells and filled halos; nothing moves through walls.
fn gas_on(part: &LocalCells, halo: &mut FieldHalo, ranks: &dyn Communicator) -> GasFields {
    let mut gas = GasFields::at_rest(part);
    let [nx, ny, nz] = part.count.map(|count| count as isize);
    for (k, j, i) in
        (0..=nz).flat_map(|k| (0..=ny).flat_map(move |j| (0..=nx).map(move |i| (k, j, i))))
    {
        let global = [0, 1, 2].map(|a| [i, j, k][a] + part.start[a] as isize);
        let number = |c: [isize; 3]| (c[0] + 100 * (c[1] + 100 * c[2])) as u64;
        let [u, v, w, p] = numbers(number(global), "gas");
        let at_wall = global[1] == 0 || global[1] == COUNTS[1] as isize;
        *gas.velocity[0].at_mut([i, j, k]) = 2.0 * u - 1.0;
        *gas.velocity[1].at_mut([i, j, k]) = if at_wall { 0.0 } else { 2.0 * v - 1.0 };
        *gas.velocity[2].at_mut([i, j, k]) = 2.0 * w + 1.0;
        *gas.pressure.at_mut([i, j, k]) = p;
    }
    let GasFields { velocity: [u, v, w], pressure, .. } = &mut gas;
    halo.refresh(&mut [u, v, w, pressure], ranks);
    gas
}

/// The results of all ranks, by global cell and by id.
#[derive(Debug, Default, PartialEq)]
struct Found {
    cells: Vec<[f64; 5]>,
    forces: Vec<[f64; 3]>,
    raised: u64,
    error: f64,
}

fn uneven(grid: [usize; 3]) -> Decomposition {
    let even = Decomposition::even(RankGrid(grid), &bounds());
    let lengths = bounds().lengths();
    let cut_planes = [0, 1, 2].map(|axis| {
        let n = grid[axis];
        let plane = |k: usize| lengths[axis] * (k as f64 / n as f64).powf(1.3);
        (0..=n).map(|k| if k == n { lengths[axis] } else { plane(k) }).collect()
    });
    BoxGrid::new(&bounds(), COUNTS).aligned(&even.with_cut_planes(cut_planes), [2; 3]).unwrap()
}

fn couple(
    grid: [usize; 3],
    model: &CouplingModel,
    (count, step): (u64, f64),
) -> Result<Found, CollectiveError> {
    let (cells, decomposition) = (BoxGrid::new(&bounds(), COUNTS), uneven(grid));
    let all = COUNTS.iter().product();
    let found = Mutex::new(Found {
        cells: vec![[0.0; 5]; all],
        forces: vec![[0.0; 3]; count as usize],
        raised: 0,
        error: 0.0,
    });
    let results = run_on_threads(grid.iter().product(), |ranks| {
        let bounds = bounds();
        let subdomain = decomposition.subdomain(&bounds, ranks.rank());
        let mut exchange =
            ParticleExchange::new(model, limits(), (&cells, None), subdomain).unwrap();
        let part = *exchange.part();
        let mut particles = bed_of(&decomposition, ranks.rank(), count);
        let mut halo = FieldHalo::new(subdomain);
        let gas = gas_on(&part, &mut halo, ranks);
        agree(exchange.deposit(&mut particles, &gas, step, ranks), ranks)?;
        agree(exchange.set_forces(&mut particles, &gas, GRAVITY, ranks), ranks)?;
        let error = exchange.momentum_error(ranks);
        let mut found = found.lock().unwrap();
        found.error = error;
        found.raised += exchange.raised_cells();
        let BedOnGrid { voidage, momentum_transfer, transferred_velocity } = exchange.bed();
        let [x, y, z] = transferred_velocity;
        let mut columns = [voidage, momentum_transfer, x, y, z].map(Field::owned);
        let [nx, ny, _] = part.count;
        for n in 0..part.cells() {
            let local = [n % nx, n / nx % ny, n / (nx * ny)];
            let [i, j, k] = [0, 1, 2].map(|a| local[a] + part.start[a]);
            found.cells[i + COUNTS[0] * (j + COUNTS[1] * k)] =
                columns.each_mut().map(|column| column.next().expect("a number for each cell"));
        }
        for i in 0..particles.owned_count() {
            found.forces[particles.id[i] as usize] = particles.columns.at(GAS_FORCE).get(i);
        }
        Ok(())
    });
    results.into_iter().collect::<Result<Vec<()>, _>>()?;
    Ok(found.into_inner().unwrap())
}

fn exact(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut sum = ExactSum::default();
    numbers.for_each(|number| sum.add(number));
    sum.value()
}

#[test]
fn volume_of_solids_is_conserved_at_walls_too() {
    let volume = 300.0 * PI / 6.0 * DIAMETER.powi(3);
    for model in models() {
        let found = couple([1; 3], &model, (300, STEP)).unwrap();
        let cell = BoxGrid::new(&bounds(), COUNTS).cell_volume();
        let solids = exact(found.cells.iter().map(|cell_of| (1.0 - cell_of[0]) * cell));
        // 420 cells whose voidage near 1 is rounded to 2^-53, and about 10 steps of the filter.
        assert!((solids / volume - 1.0).abs() < 1.0e-13, "{solids} {volume}");
        assert_eq!(found.raised, 0);
    }
}

/// The drag that the gas loses and its pressure gradient by faces, as the gas solves for them: half of the cell belongs
/// to a face at the end of the box.
fn lost_by_gas(found: &Found) -> [f64; 3] {
    let (bounds, grid) = (bounds(), BoxGrid::new(&bounds(), COUNTS));
    let whole = Decomposition::even(RankGrid([1; 3]), &bounds);
    let gas = run_on_threads(1, |ranks| {
        let mut halo = FieldHalo::new(whole.subdomain(&bounds, 0));
        gas_on(&LocalCells::whole(COUNTS), &mut halo, ranks)
    });
    let gas = &gas[0];
    [0, 1, 2].map(|axis| {
        let mut sum = ExactSum::default();
        let end = |a: usize| COUNTS[a] as isize + isize::from(a == axis && axis != 0);
        for (k, j, i) in (0..end(2))
            .flat_map(|k| (0..end(1)).flat_map(move |j| (0..end(0)).map(move |i| (k, j, i))))
        {
            let above = [i, j, k];
            let mut below = above;
            below[axis] -= 1;
            // Mean over the two cells of a face; beyond the end of the box there is no cell.
            let face = |column: usize| {
                let value = |mut cell: [isize; 3]| {
                    cell[0] = cell[0].rem_euclid(COUNTS[0] as isize);
                    let inside = (0..3).all(|a| (0..COUNTS[a] as isize).contains(&cell[a]));
                    let number = cell[0] + 7 * (cell[1] + 5 * cell[2]);
                    let value = |c: &[f64; 5]| if column == 0 { 1.0 - c[0] } else { c[column] };
                    if inside { value(&found.cells[number as usize]) } else { 0.0 }
                };
                0.5 * (value(below) + value(above))
            };
            let drag = face(1) * gas.velocity[axis].at(above) - face(2 + axis);
            let difference = gas.pressure.at(above) - gas.pressure.at(below);
            let gradient = difference / grid.spacing()[axis];
            let buoyancy = if axis == 2 { 0.05 * GRAVITY } else { 0.0 };
            let force = drag - face(0) * (gradient - buoyancy);
            sum.add(force * grid.cell_volume());
        }
        sum.value()
    })
}

/// Asserts that the gas loses what 300 particles gain, except for rounding, and that the run reports this.
#[track_caller]
fn assert_momentum_is_kept(found: &Found) {
    let lost = lost_by_gas(found);
    for axis in 0..3 {
        let gained = exact(found.forces.iter().map(|force| force[axis]));
        // 300 forces of order 1, each rounded by up to FORCES 2^-52, and 2400 shares of drag by about as much.
        let rounding = 2700.0 * FORCES * 2.0_f64.powi(-52);
        assert!((gained - lost[axis]).abs() < rounding, "{gained} {lost:?}");
        assert!(found.error < rounding, "as the run says: {}", found.error);
    }
}

#[test]
fn particles_gain_what_the_gas_loses() {
    for model in models() {
        let found = couple([1; 3], &model, (300, STEP)).unwrap();
        assert_momentum_is_kept(&found);
        assert!(found.forces.iter().any(|force| force[2].abs() > 0.1)); // a control
    }
}

#[test]
fn members_of_agglomerates_gain_what_the_gas_loses() {
    let mut model = model(2.0);
    let of_law = couple([1; 3], &model, (300, STEP)).unwrap();
    model.agglomerates = Some(AgglomerateDrag { every: 1, smallest: 2 });
    let found = couple([1; 3], &model, (300, STEP)).unwrap();
    assert_momentum_is_kept(&found);
    for grid in [[1, 1, 2], [2, 2, 2]] {
        assert!(couple(grid, &model, (300, STEP)).unwrap() == found, "{grid:?}");
    }
    // Control: otherwise the drag of the law would be lost.
    let [lost, of_law] = [&found, &of_law].map(lost_by_gas);
    assert!((lost[2] / of_law[2] - 1.0).abs() > 0.05, "{lost:?} {of_law:?}");
}

#[test]
fn another_interpolation_would_not_conserve_momentum() {
    // Negative control: with filtered drag but unfiltered velocities the sums differ.
    let (filtered, plain) = (model(2.0), model(0.0));
    let mut found = couple([1; 3], &filtered, (300, STEP)).unwrap();
    found.forces = couple([1; 3], &plain, (300, STEP)).unwrap().forces;
    let gained = exact(found.forces.iter().map(|force| force[2]));
    assert!((gained / lost_by_gas(&found)[2] - 1.0).abs() > 1.0e-4);
}

#[test]
fn the_bits_do_not_depend_on_the_cut() {
    let mut found = Vec::new();
    for model in models() {
        let alone = couple([1; 3], &model, (300, STEP)).unwrap();
        for grid in [[1, 1, 2], [1, 1, 3], [2, 2, 2], [3, 1, 1]] {
            assert!(couple(grid, &model, (300, STEP)).unwrap() == alone, "{grid:?} {model:?}");
        }
        found.push(alone);
    }
    assert!(found[1] != found[2]); // a control: the finer voidage acts
}

#[test]
fn a_gas_step_that_is_too_long_is_refused() {
    let error = couple([1, 1, 2], &model(0.0), (300, 1.0)).unwrap_err();
    assert!(error.0.contains("b dt / (m eps^2)"), "{error}");
}

#[test]
fn cells_that_are_too_full_are_counted() {
    let mut model = model(0.0);
    model.least_voidage = 0.7;
    let found = couple([2, 1, 1], &model, (600, STEP)).unwrap();
    let at_floor = found.cells.iter().filter(|cell| cell[0] == 0.7).count();
    assert!(found.raised > 0 && at_floor == found.raised as usize);
}

#[test]
fn cells_smaller_than_the_drift_of_particles_are_refused() {
    let bounds = bounds();
    let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
    let subdomain = decomposition.subdomain(&bounds, 0);
    let refused = |counts, local_voidage| {
        let model = CouplingModel { local_voidage, ..model(0.0) };
        let cells = BoxGrid::new(&bounds, counts);
        ParticleExchange::new(&model, limits(), (&cells, None), subdomain)
            .is_err_and(|message| message.contains("may drift"))
    };
    assert!(refused([40, 5, 12], None) && refused([20, 5, 12], Some(2)));
    assert!(!refused([20, 5, 12], None)); // a control
}
