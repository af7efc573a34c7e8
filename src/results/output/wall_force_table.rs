//! The table of the forces on walls over time: `walls.csv`.

use std::path::Path;

use super::text_table::{TableFormat, TextTable, quoted, shortest};
use super::{ColumnUnits, OpenedOutput, Opening, Output, OutputError, OutputKind, Sample};
use talcum_engine::fields::Unit;
use talcum_engine::parallel::Communicator;

/// The open table: a row for each time, wall and size class.
#[derive(Debug)]
pub struct WallForceTable(TextTable);

impl WallForceTable {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "walls.csv", needs_momentum_before: false, open: Self::open };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let format = format(opening.head.units());
        Ok(Some(Box::new(Self(TextTable::open(path, opening, &format, ranks)?))))
    }
}

fn format(units: ColumnUnits) -> TableFormat {
    let [time, length, force] = [Unit::Time, Unit::Length, Unit::Force].map(|unit| units.of(unit));
    let forces = ["x", "y", "z"].map(|axis| format!("force_{axis} [{force}]")).join(",");
    let header = format!("time [{time}],wall,diameter [{length}],{forces}");
    TableFormat { header, texts: &[1, 2] }
}

impl Output for WallForceTable {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let time = shortest(sample.row.time);
        let mut lines = String::new();
        for row in sample.wall_forces {
            let diameter = row.diameter.map_or_else(String::new, shortest);
            let [x, y, z] = <[f64; 3]>::from(row.force).map(shortest);
            lines += &format!("{time},{},{diameter},{x},{y},{z}\n", quoted(&row.wall));
        }
        self.0.append(&lines, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.commit(ranks)
    }
}
