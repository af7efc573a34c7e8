//! Instruments of a run: two agglomerates that are glued and separated by hand across a rank border.

use crate::beds::{Bench, PERIODIC, Run, attraction, law};
use talcum::case::Case;
use talcum::domain::RankGrid;
use talcum::grid::ColumnGrid;
use talcum::instruments::{Instrument, InstrumentKind, Readings, Rows, Setting};
use talcum::parallel::run_on_threads;

/// The kind of an instrument of these keys, as a case would read it.
fn kind(keys: &str) -> InstrumentKind {
    let base = include_str!("../cases/good/plain.toml");
    let text = format!("{base}\n[measure.m]\nevery = 0.1\n{keys}");
    let case = Case::from_text(&text, "case.toml", std::path::Path::new(""), &[]);
    case.unwrap_or_else(|errors| panic!("{errors}")).instruments.swap_remove(0).kind
}

fn begin(kind: &InstrumentKind, run: &Run<'_>) -> Box<dyn Instrument> {
    let bounds = &run.domain.bounds;
    let column = ColumnGrid::new(bounds, 1.5, 1.0);
    let sizes = &run.state.sizes;
    let setting =
        Setting { bounds, sizes, column: &column, gas_grid: None, every: 0.1, start: 0.0 };
    kind.begin(&setting)
}

/// Two cubes of 27 touching particles, the upper one above the middle of the box; with `glued`, the corners of the two
/// touch.
fn two_cubes(glued: bool) -> Bench {
    let mut bench = Bench::new([12.0, 12.0, 12.0], [PERIODIC; 3]);
    bench.contact = law(1.0e4, 0.3, 0.0);
    bench.cohesion = Some(attraction((10.0, 0.0), 1.0, (1.0e-3, 0.01)));
    bench.time_step = 2.0e-4;
    // The overlap at which spring and attraction balance.
    let spacing = 0.999;
    let gap = if glued { 0.0 } else { 0.5 };
    for cube in [0.0, 1.0] {
        for k in 0..27_u32 {
            let place = [k % 3, k / 3 % 3, k / 9].map(|index| spacing * f64::from(index));
            let shift = cube * 2.0 * spacing;
            let [x, y, z] = place;
            let position =
                [2.0 + x + shift, 2.0 + y + shift, 4.0 + z + cube * (3.0 * spacing + gap)];
            bench.add(position, [0.0; 3], 0.5);
        }
    }
    bench
}

/// One number of a row on rank 0.
fn number(rows: &[&Rows], place: usize, column: usize) -> f64 {
    rows[place].values[column][0]
}

/// Lets cubes rest over a window, parts them by hand (or not), and lets them go on over two windows. What the instrument
/// found, on any ranks; at each look it is stored and restored.
fn glued_and_parted(grid: [usize; 3], parted: bool) -> Readings {
    let kind = kind("kind = \"agglomerates\"\nwindow = 0.2\nsmallest = 10\n");
    let found = run_on_threads(grid.iter().product(), |ranks| {
        let mut run = two_cubes(true).start(RankGrid(grid), ranks);
        let mut instrument = begin(&kind, &run);
        let mut all = Readings::default();
        for look in 0..7 {
            if look == 3 && parted {
                let owned = run.state.particles.owned_count();
                for index in 0..owned {
                    let upper = run.state.particles.id[index] >= 27;
                    run.state.particles.body[index].velocity.z += if upper { 0.5 } else { -0.5 };
                }
            }
            all.rows.extend(run.look(&mut *instrument).unwrap().rows);
            let stored = instrument.stored(ranks);
            instrument = begin(&kind, &run);
            instrument.restore(&stored, ranks).unwrap();
            run.steps(500);
        }
        all
    });
    found.into_iter().next().unwrap()
}

#[test]
fn agglomerates_glued_and_parted_across_a_rank_border() {
    let found = glued_and_parted([1, 1, 2], true);
    let of =
        |table: usize| found.rows.iter().filter(|rows| rows.table == table).collect::<Vec<_>>();
    let results = of(0);
    // Looks at 0.1 and 0.2 after t_0 = 0, at 0.3 and 0.4 after t_0 = 0.2, and two more. At 0.3 they were parted.
    assert_eq!(results.len(), 6);
    let (count, largest) = (1, 5);
    let counts: Vec<[f64; 2]> = (0..6)
        .map(|look| [number(&results, look, count), number(&results, look, largest)])
        .collect();
    assert_eq!(counts[..2], [[1.0, 54.0]; 2]);
    assert_eq!(counts[3..], [[2.0, 27.0]; 3]);
    // Each particle of a cube of 27 has 2 * 54 / 27 = 4 neighbours; one contact joins the two.
    assert!((number(&results, 0, 7) - 2.0 * 109.0 / 54.0).abs() < 1e-12);
    assert!((number(&results, 5, 7) - 4.0).abs() < 1e-12);
    // The windows' ends: the one of 54 has broken into two of 27.
    let events = of(4);
    assert_eq!(events.len(), 2);
    let event: Vec<f64> = events[0].values.iter().map(|column| column[0]).collect();
    assert_eq!(event, [0.0, 54.0, 27.0, 2.0, 0.0, 27.0, 0.0]);
    assert_eq!(events[1].count, 0);
    // With the label of the one of 54, that of each cube, its members, and how many are of the 54.
    let fragments = &of(5)[0].values;
    assert_eq!(fragments[..], [vec![0.0; 2], vec![0.0, 27.0], vec![27.0; 2], vec![27.0; 2]]);
    // Two agglomerates of the last look, by their smallest ids; they fly apart.
    let single = of(1);
    let last = single[single.len() - 1];
    assert_eq!(last.values[0], [0.0, 27.0]);
    let velocities = &last.values[12];
    assert!(velocities[2] < -0.3 && velocities[5] > 0.3, "{velocities:?}");
    for grid in [[1, 1, 1], [1, 1, 3], [2, 2, 1]] {
        let other = glued_and_parted(grid, true);
        let bits = |found: &Readings| -> Vec<u64> {
            let values = found.rows.iter().flat_map(|rows| rows.values.iter().flatten());
            values.map(|value| value.to_bits()).collect()
        };
        assert_eq!(bits(&other), bits(&found), "{grid:?}");
    }
}

#[test]
fn what_nobody_parts_stays_one() {
    // The control of the test above.
    let found = glued_and_parted([1, 1, 2], false);
    let of =
        |table: usize| found.rows.iter().filter(|rows| rows.table == table).collect::<Vec<_>>();
    assert!((0..6).all(|look| number(&of(0), look, 1) == 1.0));
    assert!(of(4).iter().all(|rows| rows.count == 0));
}

#[test]
fn a_contact_is_as_old_as_the_looks_at_which_it_touched() {
    let kind = kind("kind = \"contacts\"\n");
    let ages = |grid: [usize; 3]| {
        let found = run_on_threads(grid.iter().product(), |ranks| {
            let mut run = two_cubes(true).start(RankGrid(grid), ranks);
            let mut instrument = begin(&kind, &run);
            let mut lines = Vec::new();
            for look in 0..4 {
                let readings = run.look(&mut *instrument).unwrap();
                let stored = instrument.stored(ranks);
                instrument = begin(&kind, &run);
                instrument.restore(&stored, ranks).unwrap();
                if look == 3 {
                    lines = readings.lines.unwrap();
                }
                run.steps(500);
            }
            lines
        });
        let mut lines = found.concat();
        lines.sort_by_key(|line| (line.lower, line.higher));
        lines
    };
    let lines = ages([1, 1, 2]);
    assert_eq!(lines.len(), 109);
    assert!(lines.iter().all(|line| (line.age - 0.3).abs() < 1e-12 && line.overlap > 0.0));
    // Spring and attraction balance at 10; what moves is a hundredth of it.
    let between = lines.iter().find(|line| line.lower == 26 && line.higher == 27);
    let between = between.unwrap();
    assert!((between.normal_force - 10.0).abs() < 0.1, "{between:?}");
    assert!((between.cohesive_force - 10.0).abs() < 1e-9);
    for grid in [[1, 1, 1], [1, 1, 3], [2, 2, 1]] {
        assert_eq!(ages(grid), lines, "{grid:?}");
    }
}
