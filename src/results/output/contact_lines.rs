//! Contacts at chosen times for ParaView, as lines from centre to centre, sorted by the ids of their ends: a contact through
//! a periodic face is drawn to the image that is touched.

use std::path::Path;
use std::slice::from_ref;

use super::hdf5_file::SharedFile;
use super::vtkhdf::{
    Added, Dataset, Drawn, FileTable, FileType, Fill, Numbers, PolyData, RecordColumn, Term,
    Writer, numbers_in,
};
use super::{ColumnUnits, Head, OutputError, SnapshotStorage};
use crate::instruments::ContactLine;
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::{Communicator, SortedRows, sort_by_id};

static NUMBERS: [RecordColumn<ContactLine>; 5] = [
    Column::with(
        "CellData/normal_force",
        Unit::Force,
        &[],
        "normal force without van der Waals attraction, positive if it pushes the two apart",
        |line| from_ref(&line.normal_force),
    ),
    Column::with(
        "CellData/cohesive_force",
        Unit::Force,
        &[],
        "magnitude of the van der Waals attraction",
        |line| from_ref(&line.cohesive_force),
    ),
    Column::with(
        "CellData/tangential_force",
        Unit::Force,
        &[3],
        "tangential force on the higher id",
        |line| &line.tangential_force,
    ),
    Column::with("CellData/overlap", Unit::Length, &[], "overlap of the surfaces", |line| {
        from_ref(&line.overlap)
    }),
    Column::with(
        "CellData/age",
        Unit::Time,
        &[],
        "time since the first of the samples at all of which the two have touched",
        |line| from_ref(&line.age),
    ),
];

/// The file of lines.
#[derive(Clone, Debug)]
pub(super) struct ContactLines(Writer);

impl ContactLines {
    /// Begins the file, or continues it after the lines up to and including a time. Collective.
    pub(super) fn open(
        path: &Path,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        Writer::open(path, table(head.units()), head, continue_after, ranks).map(Self)
    }

    /// Adds the lines of a time: all ranks' shares, in any order. Collective.
    pub(super) fn append(
        &mut self,
        time: f64,
        lines: &[ContactLine],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let block = sort_by_id(lines, |line| [line.lower, line.higher], ranks);
        let write = |file: &SharedFile<'_>, added| write_lines(file, added, &block, ranks);
        self.0.append(time, block.total, ranks, write)
    }

    /// Secures the written data. Collective.
    pub(super) fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.commit(ranks)
    }
}

/// Writes this rank's lines.
fn write_lines(
    file: &SharedFile<'_>,
    Added { step, first, .. }: Added,
    block: &SortedRows<ContactLine>,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let (rows, first) = (&block.rows, first + block.offset);
    let points = rows.iter().flat_map(|line| line.start.into_iter().chain(line.end));
    file.write_rows("/VTKHDF/Points", 2 * first, &points.collect::<Vec<f64>>())?;
    let ends = 2 * block.offset..2 * (block.offset + rows.len() as u64);
    let ends: Vec<i64> = ends.map(|end| end as i64).collect();
    file.write_rows("/VTKHDF/Lines/Connectivity", 2 * first, &ends)?;
    let is_last = ranks.rank() + 1 == ranks.size();
    let offsets = ends.iter().copied().step_by(2).chain(is_last.then_some(2 * block.total as i64));
    file.write_rows("/VTKHDF/Lines/Offsets", first + step, &offsets.collect::<Vec<i64>>())?;
    let lower: Vec<i64> = rows.iter().map(|line| line.lower as i64).collect();
    file.write_rows("/VTKHDF/CellData/lower", first, &lower)?;
    let higher: Vec<i64> = rows.iter().map(|line| line.higher as i64).collect();
    file.write_rows("/VTKHDF/CellData/higher", first, &higher)?;
    NUMBERS.iter().try_for_each(|column| {
        file.write_rows(&format!("/VTKHDF/{}", column.name), first, &numbers_in(column, rows))
    })
}

/// The file: two points for each line.
fn table(units: ColumnUnits) -> FileTable {
    let whole = |name, description| Dataset::of_items(name, Numbers::Whole, 1, "1", description);
    let rows = |per_item, per_time, dataset| Dataset {
        fill: Fill::Rows { per_item, per_time },
        ..dataset
    };
    let (data, description) = ("CellData", "index of VTKHDF, for each time");
    let id = "global id of a particle of the pair";
    let mut datasets = vec![whole("CellData/lower", id), whole("CellData/higher", id)];
    let numbers = |column| Dataset::of_column("", column, Numbers::Real, units);
    datasets.extend(NUMBERS.iter().map(numbers));
    let index = PolyData {
        drawn: Drawn {
            kind: "Lines",
            points: 2,
            counts: [Term::Count(1), Term::Count(2)],
            firsts: [Term::First(1), Term::First(2)],
        },
        data,
        descriptions: [description; 2],
    };
    datasets.extend(index.index(&datasets));
    let centres = "centres: of the lower id, then of the higher";
    let points = Dataset::of_items("Points", Numbers::Real, 3, units.of(Unit::Length), centres);
    datasets.extend([
        rows(2, 0, points),
        rows(2, 0, whole("Lines/Connectivity", "index of VTKHDF")),
        rows(1, 1, whole("Lines/Offsets", "index of VTKHDF")),
        Dataset::times(units.of(Unit::Time), "times"),
    ]);
    FileTable {
        file_type: FileType::PolyData,
        data,
        counts: Some("Lines/NumberOfCells"),
        piece: 4096,
        storage: SnapshotStorage::default(),
        datasets,
    }
}
