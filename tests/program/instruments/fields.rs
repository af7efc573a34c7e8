//! Lines of contacts and fields on cells are read by VTK's own reader, bit for bit.

use crate::snapshots::{check_by_vtk, head, time};
use std::path::Path;
use talcum::case::Case;
use talcum::fields::{Column, Unit};
use talcum::instruments::{
    CellValues, ContactLine, Image, InstrumentPlan, Layout, Readings, Table,
};
use talcum::output::{InstrumentOutput, Provenance};
use talcum::parallel::{Communicator, run_on_threads};

/// Lines at each of the times 0, 0.1, ...
const COUNTS: [u64; 5] = [3, 0, 700, 1, 5];
const COMMITTED: usize = 2;

fn plan() -> InstrumentPlan {
    let base = include_str!("../../cases/good/plain.toml");
    let text = format!("{base}\n[measure.m]\nkind = \"contacts\"\nevery = 0.1\n");
    let case = Case::from_text(&text, "case.toml", Path::new(""), &[]).unwrap();
    case.instruments.into_iter().next().unwrap()
}

fn lines(step: usize) -> Vec<ContactLine> {
    let line = |k: u64| {
        let x = (k as f64 + 0.1 * step as f64) / 3.0;
        ContactLine {
            lower: k / 2,
            higher: k + 10,
            start: [x, 2.0, -x],
            end: [x + 1.0, 2.0, 1.0e-9 * x],
            normal_force: -x,
            cohesive_force: 0.1,
            tangential_force: [0.0, x, 1.0],
            overlap: 1.0e-3 * x,
            age: time(step),
        }
    };
    (0..COUNTS[step]).map(line).collect()
}

fn table() -> Vec<Table> {
    let column = Column::scalar("number", Unit::One, "a number");
    vec![Table { name: "results", columns: vec![column] }]
}

/// Writes steps, from the beginning or after what was committed.
fn write(
    folder: &Path,
    layout: &Layout,
    (ranks, from): (usize, usize),
    found: impl Fn(usize, &dyn Communicator) -> Readings + Sync,
) {
    run_on_threads(ranks, |ranks| {
        let provenance = Provenance::here_and_now("A bed", "dimensionless", ranks);
        let continue_after = from.checked_sub(1).map(time);
        let head = head(&provenance);
        let mut files =
            InstrumentOutput::open(folder, &plan(), layout, head, continue_after, ranks).unwrap();
        for step in from..COUNTS.len() {
            files.write(time(step), found(step, ranks), ranks).unwrap();
            if step == COMMITTED {
                files.commit(ranks).unwrap();
            }
        }
    });
}

#[test]
fn vtk_reads_lines_of_contacts_written_on_any_ranks_and_continued() {
    let folder = tempfile::tempdir().unwrap();
    let layout = Layout { tables: table(), lines: true, ..Layout::default() };
    let found = |step: usize, ranks: &dyn Communicator| {
        let mine = lines(step).into_iter().rev().skip(ranks.rank()).step_by(ranks.size());
        Readings { lines: Some(mine.collect()), ..Readings::default() }
    };
    let row = |step: usize, line: ContactLine| {
        let ContactLine { lower, higher, start, end, normal_force, .. } = line;
        let ahead = [time(step), lower as f64, higher as f64];
        let rest = [line.overlap, line.age];
        let forces = [normal_force, line.cohesive_force];
        [&ahead[..], &start, &end, &forces, &line.tangential_force, &rest].concat()
    };
    let check = || {
        let rows = (0..COUNTS.len())
            .flat_map(|step| lines(step).into_iter().map(move |line| row(step, line)));
        let path = folder.path().join("measure-m.vtkhdf");
        check_by_vtk(&path, rows, "5 times, 1 of them without particles");
    };
    for ranks in 1..=3 {
        write(folder.path(), &layout, (ranks, 0), found);
        check();
        // What came after the last commit is written again, on other ranks.
        write(folder.path(), &layout, (4 - ranks, COMMITTED + 1), found);
        check();
    }
}

#[test]
fn vtk_reads_fields_of_instruments() {
    const COUNTS_OF_CELLS: [usize; 3] = [2, 3, 5];
    let folder = tempfile::tempdir().unwrap();
    let field = |name, components: usize| {
        Column::array(name, &[components], Unit::One, "a field of a test")
    };
    let image = Image {
        origin: [0.0; 3],
        spacing: [0.25, 0.5, 1.0],
        counts: COUNTS_OF_CELLS,
        fields: vec![
            field("pressure", 1),
            field("velocity", 3),
            field("voidage", 1),
            field("solids_velocity", 3),
        ],
    };
    let layout = Layout { tables: table(), image: Some(image), ..Layout::default() };
    let values = |step: usize, cell: u64| -> Vec<f64> {
        (0..8).map(|k| (cell as f64 + 0.1 * step as f64) / (f64::from(k) - 3.5)).collect()
    };
    let found = |step: usize, ranks: &dyn Communicator| {
        let mine = (0..30_u64).filter(|cell| cell % ranks.size() as u64 == ranks.rank() as u64);
        let cells = mine.map(|cell| CellValues { cell, values: values(step, cell) }).collect();
        Readings { cells: Some(cells), ..Readings::default() }
    };
    for ranks in 1..=3 {
        write(folder.path(), &layout, (ranks, 0), found);
        write(folder.path(), &layout, (4 - ranks, COMMITTED + 1), found);
        let row = |step: usize, cell: u64| [vec![time(step)], values(step, cell)].concat();
        let rows = (0..COUNTS.len()).flat_map(|step| (0..30).map(move |cell| row(step, cell)));
        let path = folder.path().join("measure-m.vtkhdf");
        check_by_vtk(&path, rows, "5 times, cells (3, 4, 6), spacing (0.25, 0.5, 1.0)");
    }
}
