//! The particles at chosen times for ParaView: `particles.vtkhdf`, temporal PolyData of VTKHDF 2.0.
//!
//! One partition for each time, rows sorted by id, so that the file does not depend on the number of ranks.
//! Rows are written first, then what makes them a time step; the file is closed after each, so that it can
//! be read while the run goes on; at each checkpoint its rows are made safe against a kill.

use std::path::{Path, PathBuf};

use super::hdf5_file::{SerialFile, SharedFile};
use super::output_file::{Obstacle, continue_or_create, rows_up_to};
use super::table::{Rows, TableHead};
use super::{
    ColumnUnits, Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind,
    Sample, metadata_copy, on_root,
};
use crate::parallel::{Communicator, ParticleRecord, Records, sort_by_id};

/// The kinds of cells that PolyData may have. Each snapshot has one cell, a vertex of all its particles, so that it is drawn by
/// default; the groups of the other kinds must be there.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];
/// The points of that vertex, 0, 1, 2, ...: one list for all snapshots, as long as the largest.
const VERTEX_POINTS: &str = "/VTKHDF/Vertices/Connectivity";
/// Where the points of each vertex begin and end in that list: two rows for each snapshot.
const VERTEX_ENDS: &str = "/VTKHDF/Vertices/Offsets";
/// Datasets with a row for each particle at each time.
const POINT_DATA: [&str; 4] = ["id", "velocity", "angular_velocity", "radius"];
/// A further one, if it is asked for.
const AGGLOMERATE: &str = "agglomerate";
/// Datasets of /VTKHDF/Steps with one integer for each time.
const STEP_INTEGERS: [&str; 3] = ["PartOffsets", "NumberOfParts", "PointOffsets"];
/// Datasets of /VTKHDF/Steps with one integer for each time and kind of cells.
const CELL_OFFSETS: [&str; 2] = ["CellOffsets", "ConnectivityIdOffsets"];
/// Rows of particles that are stored as one piece.
const POINT_PIECE: usize = 4096;
/// Rows of steps that are stored as one piece.
const STEP_PIECE: usize = 256;

/// The file of snapshots.
#[derive(Clone, Debug)]
pub struct ParticleSnapshots {
    path: PathBuf,
    contents: Contents,
    steps: u64,
    points: u64,
}

/// What a file shows of a particle.
#[derive(Clone, Copy, Debug)]
struct Contents {
    /// Whether that includes its agglomerate.
    agglomerates: bool,
}

impl ParticleSnapshots {
    /// In the list of outputs.
    pub const KIND: OutputKind = OutputKind {
        file_name: "particles.vtkhdf",
        needs_momentum_before: false,
        open: Self::open,
    };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let contents = Contents { agglomerates: opening.agglomerates };
        let snapshots = match opening.continue_after {
            Some(time) => Self::go_on(path, time, opening.head, contents, ranks)?,
            None => Self::begin(path, opening.head, contents, ranks)?,
        };
        Ok(Some(Box::new(snapshots)))
    }

    /// Begins a file, in the place of one that is there. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        Self::begin(path, head, Contents { agglomerates: false }, ranks)
    }

    fn begin(
        path: &Path,
        head: Head<'_>,
        contents: Contents,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || create(path, head, contents))?;
        Ok(Self { path: path.to_owned(), contents, steps: 0, points: 0 })
    }

    /// Continues a file as it was last committed, after the snapshots up to and including `time`; later ones are
    /// dropped. A file that cannot be read is set aside with a warning, and a new one begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        Self::go_on(path, time, head, Contents { agglomerates: false }, ranks)
    }

    fn go_on(
        path: &Path,
        time: f64,
        head: Head<'_>,
        contents: Contents,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let found = on_root(path, ranks, || {
            let kept = continue_or_create(
                path,
                |found| cut_after(path, time, contents, found),
                || Ok([0, 0, 0]),
            )?;
            match kept {
                [0, ..] => create(path, head, contents)?,
                _ => metadata_copy::commit(path, &contents.tables())?,
            }
            Ok(kept)
        })?;
        // Rank 0 alone has counted: the sum is known to all ranks.
        let mut counts = found.unwrap_or_default().map(|count| count as i64);
        ranks.sum_integers(&mut counts);
        let [steps, points, _] = counts.map(|count| count as u64);
        Ok(Self { path: path.to_owned(), contents, steps, points })
    }

    /// Adds the particles at a time: all ranks' shares, in any order. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(
        &mut self,
        time: f64,
        particles: &(impl Records<ParticleRecord> + ?Sized),
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append_with(time, particles, None, ranks)
    }

    /// The same with the agglomerates of the particles, in their order.
    fn append_with(
        &mut self,
        time: f64,
        particles: &(impl Records<ParticleRecord> + ?Sized),
        agglomerates: Option<&[Option<u64>]>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let block = sort_by_id(particles, |particle| [particle.id, 0], ranks);
        let (before, after) = (self.points, self.points + block.total);
        let first = before + block.offset;
        let vectors = |get: fn(&ParticleRecord) -> &[f64; 3]| -> Vec<f64> {
            block.rows.iter().flat_map(get).copied().collect()
        };
        let ids: Vec<i64> = block.rows.iter().map(|particle| particle.id as i64).collect();
        let radii: Vec<f64> = block.rows.iter().map(|particle| particle.radius).collect();
        let file = SharedFile::open_to_write(&self.path, ranks)?;
        self.contents.point_tables().iter().try_for_each(|name| file.grow(name, after))?;
        file.write_rows("/VTKHDF/Points", first, &vectors(|particle| &particle.position))?;
        file.write_rows("/VTKHDF/PointData/id", first, &ids)?;
        let velocities = vectors(|particle| &particle.velocity);
        file.write_rows("/VTKHDF/PointData/velocity", first, &velocities)?;
        let spins = vectors(|particle| &particle.angular_velocity);
        file.write_rows("/VTKHDF/PointData/angular_velocity", first, &spins)?;
        file.write_rows("/VTKHDF/PointData/radius", first, &radii)?;
        if self.contents.agglomerates {
            let labels = sorted_labels(particles, agglomerates, ranks);
            file.write_rows(&point_data(AGGLOMERATE), first, &labels)?;
        }
        file.close()?;
        let (path, step) = (&self.path, [self.steps, before, after]);
        on_root(path, ranks, || append_step(path, time, step, self.contents))?;
        self.steps += 1;
        self.points = after;
        Ok(())
    }
}

impl Output for ParticleSnapshots {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append_with(sample.measures.time, sample.particles, sample.agglomerates, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &self.contents.tables(), ranks)
    }
}

fn point_data(name: &str) -> String {
    format!("/VTKHDF/PointData/{name}")
}

/// The labels of particles sorted by id as their rows are; -1 for none.
fn sorted_labels(
    particles: &(impl Records<ParticleRecord> + ?Sized),
    agglomerates: Option<&[Option<u64>]>,
    ranks: &dyn Communicator,
) -> Vec<i64> {
    let label = |index: usize| agglomerates.and_then(|labels| *labels.get(index)?);
    let record =
        |index: usize| [particles.at(index).id as i64, label(index).map_or(-1, |x| x as i64)];
    let records: Vec<[i64; 2]> = (0..particles.count()).map(record).collect();
    let sorted = sort_by_id(&records, |record| [record[0] as u64, 0], ranks);
    sorted.rows.into_iter().map(|[_, label]| label).collect()
}

impl Contents {
    /// Names of the datasets with a row for each particle at each time, but for the positions.
    fn names(self) -> impl Iterator<Item = &'static str> {
        POINT_DATA.into_iter().chain(self.agglomerates.then_some(AGGLOMERATE))
    }

    /// Paths of the datasets with a row for each particle at each time.
    fn point_tables(self) -> Vec<String> {
        std::iter::once("/VTKHDF/Points".to_owned()).chain(self.names().map(point_data)).collect()
    }

    /// Paths of the datasets with one row for each time, one integer wide.
    fn step_tables(self) -> Vec<String> {
        let steps = STEP_INTEGERS.iter().map(|name| format!("/VTKHDF/Steps/{name}"));
        let data = self.names().map(|name| format!("/VTKHDF/Steps/PointDataOffsets/{name}"));
        let cells = CELLS.iter().flat_map(|kind| {
            ["NumberOfCells", "NumberOfConnectivityIds", "Offsets"]
                .map(|name| format!("/VTKHDF/{kind}/{name}"))
        });
        let cells = cells.filter(|name| name != VERTEX_ENDS);
        let number = std::iter::once("/VTKHDF/NumberOfPoints".to_owned());
        steps.chain(data).chain(cells).chain(number).collect()
    }

    /// Paths of the datasets that grow.
    fn tables(self) -> Vec<String> {
        let wider = ["CellOffsets", "ConnectivityIdOffsets", "Values"];
        let wider = wider.map(|name| format!("/VTKHDF/Steps/{name}"));
        let vertices = [VERTEX_ENDS, VERTEX_POINTS].map(str::to_owned);
        [self.point_tables(), self.step_tables(), wider.to_vec(), vertices.to_vec()].concat()
    }
}

fn create(path: &Path, head: Head<'_>, contents: Contents) -> MessageResult<()> {
    metadata_copy::create(path, &contents.tables(), |path| make(path, head, contents))
}

fn make(path: &Path, head: Head<'_>, contents: Contents) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for group in ["/VTKHDF", "/VTKHDF/PointData", "/VTKHDF/Steps", "/VTKHDF/Steps/PointDataOffsets"]
    {
        file.make_group(group)?;
    }
    file.set_numbers("/VTKHDF", "Version", &[2_i64, 0])?;
    file.set_format_name("/VTKHDF", "Type", b"PolyData")?;
    file.set_number("/VTKHDF/Steps", "NSteps", 0_i64)?;
    file.make_group("/talcum")?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/talcum", name, &entry)?;
    }
    file.set_text("/talcum", "case", head.case_text)?;
    make_point_tables(&file, &head.units())?;
    if contents.agglomerates {
        let description = "smallest id of the particle's agglomerate as of the last look; -1: none";
        let name = &point_data(AGGLOMERATE);
        let head = TableHead { name, width: 1, unit: "1", description };
        file.make_table::<i64>(&head, Rows::Growing(POINT_PIECE))?;
    }
    make_step_tables(&file, &head.units(), contents)?;
    file.close()
}

fn make_point_tables(file: &SerialFile, units: &ColumnUnits) -> MessageResult<()> {
    let rows = Rows::Growing(POINT_PIECE);
    let numbers = [
        ("/VTKHDF/Points", 3, units.length, "centres, of one time after another, sorted by id"),
        ("/VTKHDF/PointData/velocity", 3, units.speed, "velocities of the centres"),
        ("/VTKHDF/PointData/angular_velocity", 3, units.angular_speed, "angular velocities"),
        ("/VTKHDF/PointData/radius", 1, units.length, "radii"),
    ];
    for (name, width, unit, description) in numbers {
        file.make_table::<f64>(&TableHead { name, width, unit, description }, rows)?;
    }
    let (name, description) = ("/VTKHDF/PointData/id", "global ids, ascending at each time");
    file.make_table::<i64>(&TableHead { name, width: 1, unit: "1", description }, rows)
}

fn make_step_tables(
    file: &SerialFile,
    units: &ColumnUnits,
    contents: Contents,
) -> MessageResult<()> {
    let rows = Rows::Growing(STEP_PIECE);
    let head = TableHead {
        name: "/VTKHDF/Steps/Values",
        width: 1,
        unit: units.time,
        description: "times of the snapshots",
    };
    file.make_table::<f64>(&head, rows)?;
    let integers = |name: &str, width, description: &str, rows| {
        file.make_table::<i64>(&TableHead { name, width, unit: "1", description }, rows)
    };
    CELLS.iter().try_for_each(|kind| file.make_group(&format!("/VTKHDF/{kind}")))?;
    for name in contents.step_tables() {
        integers(&name, 1, "index of VTKHDF, one for each time", rows)?;
    }
    for name in CELL_OFFSETS {
        let description = "index of VTKHDF, for each time and kind of cells";
        integers(&format!("/VTKHDF/Steps/{name}"), CELLS.len(), description, rows)?;
    }
    for kind in &CELLS[1..] {
        let name = format!("/VTKHDF/{kind}/Connectivity");
        integers(&name, 1, "points of cells: there are none", rows)?;
    }
    let description = "points of the vertex of each snapshot: 0, 1, 2, ...";
    integers(VERTEX_POINTS, 1, description, Rows::Growing(POINT_PIECE))?;
    integers(VERTEX_ENDS, 1, "for each snapshot 0 and the number of its points", rows)
}

/// Makes the rows from `before` to `after` the snapshot number `step`.
fn append_step(
    path: &Path,
    time: f64,
    [step, before, after]: [u64; 3],
    contents: Contents,
) -> MessageResult<()> {
    let count = after - before;
    let file = SerialFile::open_to_change(path)?;
    file.append("/VTKHDF/Steps/Values", &[time])?;
    for name in contents.step_tables() {
        let value = match name.rsplit('/').next() {
            Some("PartOffsets") => step,
            Some("NumberOfParts") => 1,
            Some("NumberOfPoints") => count,
            Some("PointOffsets") => before,
            Some("NumberOfCells") if name.contains(CELLS[0]) => 1,
            Some("NumberOfConnectivityIds") if name.contains(CELLS[0]) => count,
            _ if name.contains("PointDataOffsets") => before,
            _ => 0,
        };
        file.append(&name, &[value as i64])?;
    }
    file.append("/VTKHDF/Steps/CellOffsets", &[step as i64, 0, 0, 0])?;
    file.append("/VTKHDF/Steps/ConnectivityIdOffsets", &[0_i64; CELLS.len()])?;
    file.append(VERTEX_ENDS, &[0, count as i64])?;
    let (listed, _) = file.shape(VERTEX_POINTS)?;
    if listed < count {
        let further: Vec<i64> = (listed..count).map(|point| point as i64).collect();
        file.append(VERTEX_POINTS, &further)?;
    }
    file.set_number("/VTKHDF/Steps", "NSteps", step as i64 + 1)?;
    file.close()
}

/// Drops the snapshots after a time; returns the number of those kept, of their rows, and of those of the largest.
fn cut_after(
    path: &Path,
    time: f64,
    contents: Contents,
    found_length: u64,
) -> Result<[u64; 3], Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let kept = rows_to_keep(path, time, contents, found_length).map_err(Obstacle::Unusable)?;
    if kept[0] > 0 {
        cut(path, kept, contents).map_err(Obstacle::Failed)?;
    }
    Ok(kept)
}

fn rows_to_keep(
    path: &Path,
    time: f64,
    contents: Contents,
    found_length: u64,
) -> MessageResult<[u64; 3]> {
    let file = SerialFile::open(path)?;
    if !contents.agglomerates && file.shape(&point_data(AGGLOMERATE)).is_ok() {
        return Err("it shows agglomerates, which the case no longer asks for".to_owned());
    }
    let listed: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    let times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    let counts: Vec<i64> = file.read("/VTKHDF/NumberOfPoints")?;
    let listed = times.len().min(listed.max(0) as usize);
    let steps = rows_up_to(&times[..listed], time);
    let points = counts.iter().take(steps).try_fold(0_i64, |sum, &count| sum.checked_add(count));
    let points = points.ok_or("its numbers of particles are damaged")?;
    let most = counts.iter().take(steps).max().map_or(0, |&most| most.max(0));
    let kept = [steps, points as usize, most as usize].map(|count| count as u64);
    for (name, rows) in rows_of_tables(kept, contents) {
        metadata_copy::require_rows(&file, &name, rows, found_length)?;
    }
    file.close()?;
    Ok(kept)
}

/// Every table with its rows, for so many snapshots, particles in them, and particles in the largest.
fn rows_of_tables(
    [steps, points, most]: [u64; 3],
    contents: Contents,
) -> impl Iterator<Item = (String, u64)> {
    let of_points = contents.point_tables();
    contents.tables().into_iter().map(move |name| {
        let rows = match name.as_str() {
            VERTEX_ENDS => 2 * steps,
            VERTEX_POINTS => most,
            _ if of_points.contains(&name) => points,
            _ => steps,
        };
        (name, rows)
    })
}

fn cut(path: &Path, kept: [u64; 3], contents: Contents) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    for (name, rows) in rows_of_tables(kept, contents) {
        file.cut(&name, rows)?;
    }
    file.set_number("/VTKHDF/Steps", "NSteps", kept[0] as i64)?;
    file.close()
}
