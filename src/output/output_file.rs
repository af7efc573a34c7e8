//! What every file of results can do: begin or go on, write an instant, and be safe against a kill.

use std::path::Path;

use super::{ColumnUnits, MessageResult, OutputError, Provenance, set_aside};
use crate::analysis::{BedProfile, Measures};
use crate::grid::{BoxGrid, ColumnGrid};
use crate::parallel::{CellSample, Communicator, ParticleRecord, Records};

/// A file of results that grows while a run goes on.
///
/// A new kind is a file with such a type and its [`OutputKind`], and one line in the list of `simulation/outputs.rs`.
pub trait Output {
    /// Adds what it shows of an instant. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError>;

    /// Makes safe what was written so far: a run that is killed from now on, and resumed, finds all of it. Collective.
    ///
    /// # Errors
    /// If the file cannot be brought to the disk.
    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError>;
}

/// One instant of a run, as outputs see it.
pub struct Sample<'a> {
    /// Its numbers.
    pub measures: &'a Measures,
    /// The bed over the height.
    pub profile: &'a BedProfile,
    /// This rank's particles, positions wrapped into the box.
    pub particles: &'a dyn Records<ParticleRecord>,
    /// Samples the volume-averaged gas on this rank's cells; `None` if the stage has no such gas. Collective.
    pub gas_cells: &'a mut dyn FnMut() -> Option<Vec<CellSample>>,
}

/// What stands at the head of every file: what was run, and by whom.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// Text of the case in effect.
    pub case_text: &'a str,
    /// Who makes the file.
    pub provenance: &'a Provenance,
}

impl Head<'_> {
    /// Units of the case, for the columns.
    pub(super) fn units(&self) -> ColumnUnits {
        ColumnUnits::of_system(&self.provenance.units)
    }
}

/// How a file is opened.
pub struct Opening<'a> {
    /// Its head, where it begins.
    pub head: Head<'a>,
    /// The time up to which an earlier file is continued; `None` where all files begin.
    pub continue_after: Option<f64>,
    /// The grid of profiles.
    pub profile_grid: &'a ColumnGrid,
    /// The cells of a volume-averaged gas, if the case has one.
    pub gas_grid: Option<&'a BoxGrid>,
}

/// What a kind of output opens, or nothing if the case has nothing to show in it.
pub type OpenedOutput = Result<Option<Box<dyn Output>>, OutputError>;

/// A kind of output.
pub struct OutputKind {
    /// Name of its file in the folder of results.
    pub file_name: &'static str,
    /// Whether its rows compare the momentum before and after a step.
    pub needs_momentum_before: bool,
    /// Begins or continues the file at a path. Collective.
    pub open: fn(&Path, &Opening<'_>, &dyn Communicator) -> OpenedOutput,
}

/// Continues a file if there is one; a file that cannot be continued is set aside with a warning, and a new one begun.
pub(super) fn continue_or_create<T>(
    path: &Path,
    go_on: impl FnOnce() -> MessageResult<T>,
    create: impl FnOnce() -> MessageResult<T>,
) -> MessageResult<T> {
    if path.exists() {
        match go_on() {
            Ok(opened) => return Ok(opened),
            Err(reason) => set_aside(path, &reason)?,
        }
    }
    create()
}
