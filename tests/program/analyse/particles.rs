//! Measures of particles, contacts and bubbles.

use super::made::{CASE, Made, column, noise, number, reason};
use bytemuck::Zeroable;
use nalgebra::Vector3;
use talcum::domain::{Bounds, Face};
use talcum::grid::BoxGrid;
use talcum::output::checkpoint::{Checkpoint, file_name, write};
use talcum::output::{GasSnapshots, Head, Provenance, SnapshotStorage};
use talcum::parallel::{CellSample, ContactRecord, OneRank, ParticleRecord};
use talcum::particles::CustomFields;
use talcum::post_processing::TimeWindow;
use talcum::state::{Clock, Departed, GasReport, SizeRange};

fn particle(id: u64, position: [f64; 3]) -> ParticleRecord {
    let mass = std::f64::consts::PI / 6.0;
    ParticleRecord { id, position, radius: 0.5, mass, ..Zeroable::zeroed() }
}

/// A bed of 5 x 5 x 20 particles on a lattice with spacing 1.
fn lattice() -> Vec<[f64; 3]> {
    (0..500).map(|k| [k % 5, k / 5 % 5, k / 25].map(|i| f64::from(i as u32) + 0.5)).collect()
}

#[test]
fn flux_and_residence_time_of_rising_columns() {
    let made = Made::of(CASE);
    // Two of five columns along x rise by 0.1 per time, around and around in 20 heights.
    let height = |start: f64, column: usize, time: f64| {
        let speed = [0.1, 0.1, 0.0, 0.0, 0.0][column];
        (start + speed * time).rem_euclid(20.0)
    };
    let snapshots: Vec<(f64, Vec<ParticleRecord>)> = (0..401_u32)
        .map(|number| {
            let time = 2.0 * f64::from(number);
            let moved = |(id, x): (usize, [f64; 3])| {
                particle(id as u64, [x[0], x[1], height(x[2], x[0] as usize, time)])
            };
            (time, lattice().into_iter().enumerate().map(moved).collect())
        })
        .collect();
    made.snapshots(&snapshots);
    let found = made.find("flux", TimeWindow::WHOLE);
    // Ten particles at each height rise by 0.1 per time, each of mass pi / 6, through an area of 25. What goes from the
    // top back to the plate passes the planes downwards.
    let rising = 0.1 * 10.0 * std::f64::consts::PI / 6.0 / 25.0;
    let (up, net) = (number(&found, "flux.up").0, number(&found, "flux.net").0);
    assert!((up / rising - 1.0).abs() < 0.02, "{up} {rising}");
    assert!(net.abs() < 0.02 * rising, "around and around: {net}");
    // From the lowest plane to the highest at a speed of 0.1, 20 of 400 snapshots long.
    let planes = column(&found, "flux/planes", "height");
    assert!((planes[1] - 10.0).abs() < 0.5, "{planes:?}");
    let expected = (planes[2] - planes[0]) / 0.1;
    let (residence, _) = number(&found, "flux.residence_time");
    // Times of passage lie on straight lines: rounding alone.
    assert!((residence / expected - 1.0).abs() < 1e-9, "{residence} {expected}");
    // The control: at rest nothing passes.
    let still = Made::of(CASE);
    let rest = || lattice().into_iter().enumerate().map(|(id, x)| particle(id as u64, x)).collect();
    still.snapshots(&[(0.0, rest()), (1.0, rest()), (2.0, rest())]);
    let found = still.find("flux", TimeWindow::WHOLE);
    assert_eq!(number(&found, "flux.up").0, 0.0);
    assert!(reason(&found, "flux.residence_time").contains("0 particles passed"));
}

#[test]
fn a_random_walk_has_its_dispersion_and_a_stirred_bed_is_mixed() {
    let made = Made::of(CASE);
    let steps = [0.3, 0.1, 0.6];
    let mut walkers = lattice();
    let mut snapshots = Vec::new();
    for number in 0..201_u32 {
        let now: Vec<ParticleRecord> =
            walkers.iter().enumerate().map(|(id, x)| particle(id as u64, *x)).collect();
        snapshots.push((0.5 * f64::from(number), now));
        for (id, x) in walkers.iter_mut().enumerate() {
            for axis in 0..3 {
                // Uniform numbers of variance 1.
                let draw = noise(f64::from(number) + 1.0, (3 * id + axis) as f64) * 3.0_f64.sqrt();
                x[axis] += steps[axis] * draw;
            }
            let fold = |z: f64| {
                if z < 0.5 {
                    1.0 - z
                } else if z > 19.5 {
                    39.0 - z
                } else {
                    z
                }
            };
            *x = [x[0].rem_euclid(5.0), x[1].rem_euclid(5.0), fold(x[2])];
        }
    }
    made.snapshots(&snapshots);
    let found = made.find("mixing", TimeWindow::WHOLE);
    for (axis, name) in ["mixing.dispersion_x", "mixing.dispersion_y"].into_iter().enumerate() {
        // D = step^2 / (2 dt).
        let expected = steps[axis] * steps[axis] / (2.0 * 0.5);
        let (value, error) = number(&found, name);
        // Five windows: four errors are 98 % of Student's distribution.
        assert!((value - expected).abs() < 4.0 * error, "{name}: {value} +- {error}, {expected}");
        assert!(error < 0.3 * expected);
    }
    // The control: the axes are distinguished.
    let [x, y] = ["x", "y"].map(|axis| number(&found, &format!("mixing.dispersion_{axis}")).0);
    assert!(x > 4.0 * y, "{x} {y}");
    // Parted at the start, but for cells that the middle goes through; after 100 time units, of a mixing time
    // H^2 / (pi^2 D) = 110, mixed by more than half.
    let lacey = column(&found, "mixing/lacey", "lacey");
    assert!(lacey[0] < 0.2 && lacey[lacey.len() - 1] > 0.5, "{lacey:?}");
}

fn checkpoint(step: u64, pairs: &[[u64; 2]]) -> Checkpoint {
    let contact =
        |&[lower, higher]: &[u64; 2]| ContactRecord { lower, higher, ..Zeroable::zeroed() };
    Checkpoint {
        clock: Clock { step, origin_time: 0.0, origin_step: 0, time_step: 0.01 },
        departed: Departed { count: 0, volume: 0.0 },
        sizes: SizeRange { smallest_diameter: 1.0, largest_diameter: 1.0, largest_mass: 0.6 },
        case_text: CASE.to_owned(),
        case_folder: String::new(),
        particles: (0_u32..60).map(|k| particle(u64::from(k), [2.5, 2.5, f64::from(k)])).collect(),
        custom: CustomFields::default(),
        contacts: pairs.iter().map(contact).collect(),
        wall_contacts: Vec::new(),
        cells: Vec::new(),
        gas_report: GasReport::default(),
        looked_at: None,
        energy: None,
        instruments: Vec::new(),
    }
}

/// A chain of contacts from one particle to another.
fn chain(from: u64, to: u64) -> Vec<[u64; 2]> {
    (from..to).map(|id| [id, id + 1]).collect()
}

#[test]
fn agglomerates_are_what_holds_together_from_one_checkpoint_to_the_next() {
    let made = Made::of(CASE);
    let provenance = Provenance::here_and_now("Made by hand", "dimensionless", &OneRank);
    let put = |step: u64, pairs: &[[u64; 2]]| {
        let path = made.path().join(file_name(step));
        write(&path, &checkpoint(step, pairs), &provenance, &OneRank).unwrap();
    };
    // A rod of 20 that lasts; one of 20 that breaks in the middle; a chain of 15 that is new.
    put(100, &[chain(0, 19), chain(20, 39)].concat());
    let broken: Vec<[u64; 2]> =
        chain(20, 39).into_iter().filter(|pair| *pair != [29, 30]).collect();
    put(200, &[chain(0, 19), broken, chain(45, 59)].concat());
    let found = made.find("agglomerates", TimeWindow::WHOLE);
    assert_eq!(number(&found, "agglomerates.count").0, 1.0);
    assert_eq!(number(&found, "agglomerates.members").0, 20.0);
    assert!((number(&found, "agglomerates.mass_share").0 - 20.0 / 60.0).abs() < 1e-12);
    // R^2 of 20 points at distance 1 is (20^2 - 1) / 12.
    let diameter = 2.0 * (399.0_f64 / 12.0).sqrt();
    assert!((number(&found, "agglomerates.diameter").0 / diameter - 1.0).abs() < 1e-12);
    assert!((number(&found, "agglomerates.coordination_number").0 - 38.0 / 20.0).abs() < 1e-12);
    // 19 + 18 + 14 contacts now, persistent or not.
    let coordination = made.find("coordination", TimeWindow::WHOLE);
    assert!((number(&coordination, "coordination.mean").0 - 2.0 * 51.0 / 60.0).abs() < 1e-12);
    assert!((number(&coordination, "coordination.rattlers").0 - 5.0 / 60.0).abs() < 1e-12);
    // The control: of one checkpoint alone nothing persists.
    let alone = made.find("agglomerates", TimeWindow { from: 1.5, to: 3.0 });
    assert!(reason(&alone, "agglomerates.count").contains("two checkpoints"));
}

#[test]
fn bubbles_rise_as_they_were_drawn() {
    let made = Made::of(&CASE.replace("120.0", "60.0"));
    let provenance = Provenance::here_and_now("Made by hand", "dimensionless", &OneRank);
    let case = std::fs::read_to_string(made.path().join("case.toml")).unwrap();
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall; 2]];
    let grid = BoxGrid::new(&Bounds::new(Vector3::new(5.0, 5.0, 60.0), faces), [10, 10, 120]);
    let head = Head { case_text: &case, provenance: &provenance };
    let path = made.path().join("gas.vtkhdf");
    let fields = (&grid, SnapshotStorage::default());
    let mut file = GasSnapshots::open(&path, fields, head, None, &OneRank).unwrap();
    let (radius, speed) = (1.7, 0.8);
    for number in 0..30_u32 {
        let time = 0.5 * f64::from(number);
        let cell = |cell: u64| {
            let place = [cell % 10, cell / 10 % 10, cell / 100].map(|k| 0.5 * k as f64 + 0.25);
            let inside = |centre: f64| {
                let [x, y, z] = [place[0] - 2.5, place[1] - 2.5, place[2] - centre];
                x * x + y * y + z * z < radius * radius
            };
            let is_bubble = inside(5.0 + speed * time) || inside(20.0 + speed * time);
            let freeboard = place[2] > 50.0;
            let voidage = if is_bubble || freeboard { 0.95 } else { 0.45 };
            CellSample { cell, voidage, ..Zeroable::zeroed() }
        };
        let cells: Vec<CellSample> = (0..12_000).map(cell).collect();
        file.append(time, &cells, &OneRank).unwrap();
    }
    let found = made.find("bubbles", TimeWindow::WHOLE);
    assert_eq!(number(&found, "bubbles.count").0, 2.0);
    // A sphere of cells of half a unit: its volume is met within 3 %.
    let (diameter, _) = number(&found, "bubbles.diameter");
    assert!((diameter / (2.0 * radius) - 1.0).abs() < 0.03, "{diameter}");
    let (rise, _) = number(&found, "bubbles.rise_velocity");
    // The centroid follows within a fraction of a cell over 11.6 units of height.
    assert!((rise / speed - 1.0).abs() < 0.02, "{rise}");
    assert!((number(&found, "bubbles.aspect_ratio").0 - 1.0).abs() < 0.05);
}

#[test]
fn sizes_are_parted_where_most_particles_are_large() {
    let made = Made::of(CASE);
    // The lower 300 of 500 are large: parted.
    let snapshot = |is_small: fn(usize) -> bool| -> Vec<ParticleRecord> {
        let sized = |(id, x): (usize, [f64; 3])| {
            let radius = if is_small(id) { 0.4 } else { 0.5 };
            ParticleRecord { radius, ..particle(id as u64, x) }
        };
        lattice().into_iter().enumerate().map(sized).collect()
    };
    let parted = |id: usize| id >= 300;
    made.snapshots(&[(0.0, snapshot(parted)), (1.0, snapshot(parted)), (2.0, snapshot(parted))]);
    let found = made.find("mixing", TimeWindow::WHOLE);
    assert!(number(&found, "mixing.lacey_by_size").0 < 0.3);
    // The control: two of five, anywhere.
    let mixed = Made::of(CASE);
    let even = |id: usize| (id.wrapping_mul(2_654_435_761) >> 7) % 5 < 2;
    mixed.snapshots(&[(0.0, snapshot(even)), (1.0, snapshot(even)), (2.0, snapshot(even))]);
    let found = mixed.find("mixing", TimeWindow::WHOLE);
    assert!(number(&found, "mixing.lacey_by_size").0 > 0.9);
}

/// Stacks of spheres below two straight slopes that meet over the middle of a plate of 40 x 4.
fn heap(slope: f64) -> Vec<ParticleRecord> {
    let mut particles = Vec::new();
    for column in 0..160 {
        let (x, y) = (f64::from(column / 4) + 0.5, f64::from(column % 4) + 0.5);
        let layers = (1.0 + 19.0 * slope - slope * (x - 20.0).abs()).max(0.0) as u64;
        for layer in 0..layers {
            particles.push(particle(particles.len() as u64, [x, y, layer as f64 + 0.5]));
        }
    }
    particles
}

#[test]
fn a_heap_has_its_angle_of_repose() {
    let case = CASE
        .replace("[5.0, 5.0, 120.0]", "[40.0, 4.0, 40.0]")
        .replace("x = \"periodic\"", "x = \"open\"");
    for slope in [0.5_f64, 1.0] {
        let made = Made::of(&case);
        made.snapshots(&[(0.0, heap(2.0)), (1.0, heap(slope))]);
        let found = made.find("repose", TimeWindow::WHOLE);
        let (angle, error) = number(&found, "repose.angle");
        // The last snapshot. Heights are whole diameters, over a run of 0.6 of some 20 or 40 diameters: 2 degrees.
        assert!((angle - slope.atan().to_degrees()).abs() < 2.0, "{angle}");
        assert!(error < 1.0e-9, "the two sides are alike: {error}");
        let heights = column(&found, "repose/surface", "height");
        assert_eq!(heights.len(), 20);
        assert_eq!(number(&found, "repose.crest").0, heights.iter().copied().fold(0.0, f64::max));
    }
    // The controls: the first snapshot has another angle, and a box that repeats has no heap.
    let made = Made::of(&case);
    made.snapshots(&[(0.0, heap(2.0)), (1.0, heap(0.5))]);
    let first = TimeWindow { from: 0.0, to: 0.5 };
    assert!(number(&made.find("repose", first), "repose.angle").0 > 60.0);
    let periodic = Made::of(CASE);
    periodic.snapshots(&[(0.0, heap(0.5))]);
    let found = periodic.find("repose", TimeWindow::WHOLE);
    assert!(reason(&found, "repose.angle").contains("repeats along x"));
}
