//! The energy ledger over time: `energy.csv`.

use std::path::Path;

use super::text_table::{TableFormat, TextTable, shortest};
use super::{ColumnUnits, OpenedOutput, Opening, Output, OutputError, OutputKind, Sample};
use talcum_engine::fields::Unit;
use talcum_engine::parallel::Communicator;
use talcum_engine::state::{EnergyRow, Mechanism};

/// The open table: a row for each time.
#[derive(Debug)]
pub struct EnergyTable(TextTable);

impl EnergyTable {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "energy.csv", needs_momentum_before: false, open: Self::open };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let format = format(opening.head.units());
        Ok(Some(Box::new(Self(TextTable::open(path, opening, &format, ranks)?))))
    }
}

fn format(units: ColumnUnits) -> TableFormat {
    let of_mechanisms = Mechanism::ALL.map(|mechanism| mechanism.name());
    let names = ["kinetic", "attraction", "elastic"].iter().chain(&of_mechanisms);
    let names = names.chain(&["closure_error"]);
    let energies: String =
        names.map(|name| format!(",{name} [{}]", units.of(Unit::Energy))).collect();
    TableFormat { header: format!("time [{}]{energies}", units.of(Unit::Time)), texts: &[] }
}

impl Output for EnergyTable {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let Some(EnergyRow { stored, balance }) = sample.energy else { return Ok(()) };
        let of_state = [stored.kinetic, stored.potential, stored.elastic];
        let energies = of_state.iter().chain(&balance.work).chain([&balance.closure_error]);
        let time = shortest(sample.row.time);
        let energies: String = energies.map(|energy| format!(",{}", shortest(*energy))).collect();
        self.0.append(&format!("{time}{energies}\n"), ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.commit(ranks)
    }
}
