//! The particles at chosen times for ParaView: `particles.vtkhdf`, points sorted by id, so that the file does not depend on
//! the number of ranks.

use std::path::Path;
use std::slice::from_ref;

use super::vtkhdf::{
    Dataset, Drawn, FileTable, FileType, Fill, Numbers, PolyData, RecordColumn, Term, Writer,
    numbers_in,
};
use super::{
    ColumnUnits, Head, Output, OutputError, OutputKind, PointColumn, Sample, SnapshotFormat,
};
use talcum_engine::fields::{Column, Kind, Unit};
use talcum_engine::parallel::{
    Communicator, ParticleRecord, Records, sort_by_id, sort_numbers_by_id,
};

/// The positions, and what is always shown of each particle.
static NUMBERS: [RecordColumn<ParticleRecord>; 4] = [
    Column::with(
        "Points",
        Unit::Length,
        &[3],
        "centres, of one time after another, sorted by id",
        |particle| &particle.position,
    ),
    Column::with(
        "PointData/velocity",
        Unit::Speed,
        &[3],
        "velocities of the centres",
        |particle| &particle.velocity,
    ),
    Column::with(
        "PointData/angular_velocity",
        Unit::AngularSpeed,
        &[3],
        "angular velocities",
        |particle| &particle.angular_velocity,
    ),
    Column::with("PointData/radius", Unit::Length, &[], "radii", |particle| {
        from_ref(&particle.radius)
    }),
];

/// The file of snapshots.
#[derive(Clone, Debug)]
pub struct ParticleSnapshots {
    format: SnapshotFormat,
    writer: Writer,
}

impl ParticleSnapshots {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind = OutputKind {
        file_name: "particles.vtkhdf",
        needs_momentum_before: false,
        open: |path, opening, ranks| {
            let (head, format) = (opening.head, opening.snapshots);
            let snapshots = Self::open(path, format, head, opening.continue_after, ranks)?;
            Ok(Some(Box::new(snapshots)))
        },
    };

    /// Begins a file, replacing any existing one; or continues a file in its last committed state, after the snapshots up to
    /// and including a time; later ones are dropped. A file that cannot be read is set aside with a warning, and a new one is
    /// begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn open(
        path: &Path,
        format: &SnapshotFormat,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let writer = Writer::open(path, table(format, head.units()), head, continue_after, ranks)?;
        Ok(Self { format: format.clone(), writer })
    }

    /// Contents and format of the snapshots.
    pub fn format(&self) -> &SnapshotFormat {
        &self.format
    }

    /// Adds the particles at a time: the shares of all ranks, in any order, with the values of each further column in
    /// the same order. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(
        &mut self,
        time: f64,
        particles: &(impl Records<ParticleRecord> + ?Sized),
        columns: &[Vec<f64>],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let block = sort_by_id(particles, |particle| [particle.id, 0], ranks);
        self.writer.append(time, block.total, ranks, |file, added| {
            let first = added.first + block.offset;
            let ids: Vec<i64> = block.rows.iter().map(|particle| particle.id as i64).collect();
            file.write_rows("/VTKHDF/PointData/id", first, &ids)?;
            for column in &NUMBERS {
                let path = format!("/VTKHDF/{}", column.name);
                file.write_rows(&path, first, &numbers_in(column, &block.rows))?;
            }
            for (column, values) in self.format.columns.iter().zip(columns) {
                let ids = (0..particles.count()).map(|index| particles.at(index).id);
                let sorted = sort_numbers_by_id(ids, values, column.width(), ranks);
                file.write_rows(
                    &format!("/VTKHDF/PointData/{}", column.name),
                    first,
                    &sorted.rows,
                )?;
            }
            Ok(())
        })
    }
}

impl Output for ParticleSnapshots {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append(sample.row.time, sample.particles, sample.columns, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.writer.commit(ranks)
    }
}

/// The file. Each snapshot has one cell, a vertex of all its particles, so that it is drawn by default.
fn table(format: &SnapshotFormat, units: ColumnUnits) -> FileTable {
    let meaning = "global ids, ascending at each time";
    let ids = Dataset::of_items("PointData/id", Numbers::Whole, 1, "1", meaning);
    let further = |column: &PointColumn| {
        let is_whole = column.values == Kind::Integer;
        let numbers = if is_whole { Numbers::Whole } else { Numbers::Real };
        Dataset::of_column("PointData/", column, numbers, units)
    };
    let always = |column| Dataset::of_column("", column, Numbers::Real, units);
    let mut datasets: Vec<Dataset> = NUMBERS.iter().map(always).collect();
    datasets.push(ids);
    datasets.extend(format.columns.iter().map(further));
    let (data, description) = ("PointData", "index of VTKHDF, one for each time");
    let index = PolyData {
        drawn: Drawn {
            kind: "Vertices",
            points: 1,
            counts: [Term::One, Term::Count(1)],
            firsts: [Term::Step, Term::Zero],
        },
        data,
        descriptions: [description, "index of VTKHDF, for each time and kind of cells"],
    };
    datasets.extend(index.index(&datasets));
    let ends = [Term::Zero, Term::Count(1)];
    let meaning = "for each snapshot 0 and the number of its points";
    datasets.push(Dataset::index("Vertices/Offsets", &ends, meaning));
    // One list for all snapshots, as long as the largest.
    let meaning = "points of the vertex of each snapshot: 0, 1, 2, ...";
    let points = Dataset::index("Vertices/Connectivity", &[], meaning);
    datasets.push(Dataset { fill: Fill::Counting, ..points });
    datasets.push(Dataset::times(units.of(Unit::Time), "times of the snapshots"));
    FileTable {
        file_type: FileType::PolyData,
        data,
        counts: Some("NumberOfPoints"),
        piece: 4096,
        storage: format.storage,
        datasets,
    }
}
