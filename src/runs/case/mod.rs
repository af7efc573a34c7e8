//! The case file: it has a schema of its own, is read strictly, and is converted once into the data of the other
//! modules.
//!
//! `schema` holds a table of keys for every section. Reading (`input`), `--set`, the merging of stages, error messages,
//! `docs/input.md`, `talcum keys` and the schema for editors follow from it.

mod bed;
mod boxes;
mod changes;
mod coarse_graining;
mod column;
mod contact;
mod contact_laws;
mod context;
mod custom_laws;
mod drag;
mod fluidisation;
mod forces;
mod gas;
mod instruments;
mod lightest;
mod merging;
mod mesh_file;
mod meshes;
mod mixing;
mod overrides;
mod particles;
mod plans;
mod renamed;
mod schedules;
mod schema;
mod sizes;
mod species;
mod stage;
mod stages;
mod surfaces;
mod units;
mod volume_averaged;
mod walls;

pub use crate::beds::{
    Amount, BedFormat, BedPart, BedStart, InitialBed, ParticleSetup, SizeClass, SizeDistribution,
    Species,
};
pub use bed::BedError;
pub use changes::for_each_value;
pub use changes::{Change, changes};
pub use meshes::MeshFile;
pub(crate) use meshes::is_mesh_in_results;
pub use plans::{CheckpointPlan, OutputPlan, ParallelPlan, ParticleField, RankLayout};
pub use renamed::use_first_names;
pub use schema::FILE_KEYS;
pub use stage::Stage;
pub use units::Units;

use crate::input::{InputErrors, Node, Places, Problems, Section, read_text, rounded};
use context::ReadContext;
use meshes::with_checksums;
use particles::Scales;
use renamed::FormerNames;
use species::SpeciesSections;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;
use talcum_engine::contact::CoarseGraining;
use talcum_engine::domain::Bounds;
use talcum_engine::gas::GasModel;
use talcum_engine::gas::volume_averaged::VolumeAveragedModel;
use talcum_engine::particles::{ListRange, Skin};
use talcum_engine::state::{Domain, SizeRange};
use talcum_results::instruments::InstrumentPlan;

/// A run as described by its case file.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Title given by the user.
    pub title: String,
    /// The system of units of all numbers.
    pub units: Units,
    /// The file's text with all overrides applied, and the checksums of its meshes: reading it gives the same case.
    pub text: String,
    /// Box and walls.
    pub domain: Domain,
    /// The files of meshes.
    pub mesh_files: Vec<MeshFile>,
    /// Stages, one after another; at least one.
    pub stages: Vec<Stage>,
    /// Particles; the parcels of a run that is coarse-grained.
    pub particles: ParticleSetup,
    /// Number of particles in a parcel and the property that is kept, in a run of parcels. Particles and physics here
    /// are those of the parcels.
    pub coarse_graining: Option<CoarseGraining>,
    /// Results.
    pub output: OutputPlan,
    /// Instruments of the run.
    pub instruments: Vec<InstrumentPlan>,
    /// Checkpoints.
    pub checkpoint: CheckpointPlan,
    /// Wall-clock time after which the run ends itself with a checkpoint.
    pub wall_clock: Option<Duration>,
    /// Ranks.
    pub parallel: ParallelPlan,
    /// Choices of physics that the file leaves to a default, as messages.
    pub notes: Vec<String>,
    /// Places of the values in the file.
    pub places: Places,
}

impl Case {
    /// Reads a case file; each override is a text `key.path=value`.
    ///
    /// # Errors
    /// All that is wrong with the file, not only the first.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, InputErrors> {
        let name = path.display().to_string();
        let text = read_text(path)?;
        Self::from_text(&text, &name, path.parent().unwrap_or(Path::new("")), overrides)
    }

    /// Reads the text of a case, which is called `file_name` in errors; paths in it are relative to `folder`.
    ///
    /// # Errors
    /// All errors of the text, not only the first.
    pub fn from_text(
        text: &str,
        file_name: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, InputErrors> {
        Self::with_names((text, FormerNames::Reported), file_name, folder, overrides)
    }

    /// Reads the text of the case that a run has stored, like [`Case::from_text`]. Keys that have been renamed since
    /// are also read by their former names.
    ///
    /// # Errors
    /// All errors of the text, not only the first.
    pub fn of_earlier_run(
        text: &str,
        file_name: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, InputErrors> {
        Self::with_names((text, FormerNames::Read), file_name, folder, overrides)
    }

    fn with_names(
        (text, former): (&str, FormerNames),
        file_name: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, InputErrors> {
        let problems = Problems::default();
        let case = overrides::apply(text, overrides, &problems)
            .map(|(text, tree)| (text, renamed::by_present_names(tree, former, &problems)))
            .and_then(|(text, tree)| read_tree(&tree, text, folder, &problems));
        let mut case = problems.result(file_name, case)?;
        case.places.set_file_name(file_name);
        if !case.mesh_files.is_empty() {
            case.text = with_checksums(case.text, &case.mesh_files);
        }
        Ok(case)
    }

    /// The text of a case with overrides applied. Its values are not checked.
    ///
    /// # Errors
    /// If the text is not TOML, or the path of an override does not exist.
    pub fn text_with(
        text: &str,
        file_name: &str,
        overrides: &[String],
    ) -> Result<String, InputErrors> {
        let problems = Problems::default();
        let applied = overrides::apply(text, overrides, &problems);
        problems.result(file_name, applied.map(|(text, _)| text))
    }

    /// Time at which the run ends.
    pub fn end_time(&self) -> f64 {
        self.stages.last().map_or(0.0, |stage| stage.end)
    }

    /// Number of the stage to which the step that starts at a time belongs; the last stage never ends.
    ///
    /// The middle of the step is decisive: times that are sums of steps differ by rounding from the start of a stage.
    pub fn stage_number_at(&self, time: f64) -> usize {
        let middle = time + self.stages.first().map_or(0.0, |stage| 0.5 * stage.physics.time_step);
        self.stages.partition_point(|stage| stage.start <= middle).saturating_sub(1)
    }

    /// The stage to which the step that starts at a time belongs.
    pub fn stage_at(&self, time: f64) -> &Stage {
        &self.stages[self.stage_number_at(time)]
    }

    /// The possible range of the sizes of particles; `None` if a file or another run determines it.
    pub fn size_range(&self) -> Option<SizeRange> {
        self.particles.size_range()
    }

    /// The volume-averaged gas of the first stage that has one; its cells are those of all stages.
    pub fn volume_averaged(&self) -> Option<&VolumeAveragedModel> {
        self.gas_on_cells().volume_averaged()
    }

    /// Each instrument with the names of the numbers that it gives at each of its times.
    pub fn scalars_of_instruments(&self) -> BTreeMap<String, Vec<String>> {
        let gas_grid = self.volume_averaged().map(|gas| &gas.grid);
        let scalars = |plan: &InstrumentPlan| {
            (plan.name.clone(), plan.scalar_names(&self.domain.bounds, gas_grid))
        };
        self.instruments.iter().map(scalars).collect()
    }

    /// The volume-averaged gas as the gas of a stage; no gas if there is no such stage.
    pub fn gas_on_cells(&self) -> &GasModel {
        let mut gases = self.stages.iter().map(|stage| &stage.physics.gas);
        gases.find(|gas| gas.volume_averaged().is_some()).unwrap_or(&GasModel::None)
    }

    /// Least width of the ghost layer, with the narrowest skin, in the stage that needs the widest. Subdomains must not
    /// be narrower, and periodic boxes not narrower than twice this width.
    pub fn ghost_width(&self, sizes: &SizeRange) -> f64 {
        let ranges = self.stages.iter().map(|stage| stage.physics.range(sizes));
        let interaction = ranges.fold(0.0, f64::max);
        let skin = self.skin(sizes).narrowest();
        ListRange { interaction, skin }.ghost_width(sizes.largest_diameter)
    }

    /// Rule for the skin of the neighbour lists of these particles.
    pub fn skin(&self, sizes: &SizeRange) -> Skin {
        let diameter = sizes.largest_diameter;
        let given = self.parallel.skin.map(|skin| Skin::Fixed(skin * diameter));
        given.unwrap_or(Skin::FromSpeeds { diameter })
    }

    /// Errors of box and time step for particles of these sizes: (key, message).
    pub fn check_sizes(&self, sizes: &SizeRange) -> Vec<(&'static str, String)> {
        let mut wrong = check_box(&self.domain.bounds, self, sizes);
        wrong.extend(walls::check_walls(self, sizes.smallest_diameter));
        for stage in &self.stages {
            let duration = self.shortest_contact(stage, sizes);
            if stage.physics.time_step > duration {
                let name = &stage.name;
                let message = format!(
                    "must be below {duration:.3e}, the duration of a contact in stage {name:?}; a \
                     twelfth of it or less is advised"
                );
                wrong.push(("time.step", message));
            }
            wrong.extend(check_flow(self, stage, sizes));
            let limits = stage.physics.limits(sizes);
            let torque = limits.force * sizes.largest_diameter;
            if !(limits.force * torque).is_finite() || limits.force * torque <= 0.0 {
                let message = "gives forces beyond the range of numbers".to_owned();
                wrong.push(("contact", message));
            }
        }
        wrong
    }

    /// Like [`Case::check_sizes`], with the place of each key.
    ///
    /// # Errors
    /// All that is wrong.
    pub fn require_sizes(&self, sizes: &SizeRange) -> Result<(), InputErrors> {
        match self.check_sizes(sizes) {
            wrong if wrong.is_empty() => Ok(()),
            wrong => Err(self.places.errors(wrong)),
        }
    }
}

/// Checks that the volume-averaged gas moves at whole multiples of its step, on cells that are equal for all stages and
/// not too small for the particles.
fn check_flow(case: &Case, stage: &Stage, sizes: &SizeRange) -> Option<(&'static str, String)> {
    let (model, first) = (stage.physics.gas.volume_averaged()?, case.volume_averaged()?);
    let (name, step) = (&stage.name, (stage.start / stage.physics.time_step).round() as u64);
    if !step.is_multiple_of(model.substeps) {
        let message = format!(
            "must divide the number of steps before stage {name:?}, {step}: the gas begins there"
        );
        return Some(("gas.substeps", message));
    }
    if model.grid != first.grid {
        let message = format!("must be {:?} in all stages", first.grid.counts());
        return Some(("gas.cells", message));
    }
    let drift = 0.5 * case.skin(sizes).narrowest();
    let smallest = model.grid.spacing().min();
    (drift > smallest).then(|| {
        let message = format!(
            "are {:.3} of the largest diameter wide: must be at least half of parallel.skin",
            smallest / sizes.largest_diameter
        );
        ("gas.cells", message)
    })
}

/// Checks that the box can contain a particle, and is wide enough for its ghosts where it is periodic.
fn check_box(bounds: &Bounds, case: &Case, sizes: &SizeRange) -> Vec<(&'static str, String)> {
    let largest = sizes.largest_diameter;
    let width = case.ghost_width(sizes);
    let mut wrong = Vec::new();
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let length = bounds.lengths()[axis];
        if bounds.is_periodic(axis) && length < 2.0 * width {
            let least = rounded(2.0 * width);
            let message = format!(
                "is too narrow along {name} for its ghosts: must be at least {least}, twice the largest \
                 diameter with skin and range of cohesion"
            );
            wrong.push(("box.lengths", message));
        } else if length < largest {
            let message = format!("is smaller along {name} than the largest particle, {largest:?}");
            wrong.push(("box.lengths", message));
        } else if length > 1.0e9 * sizes.smallest_diameter {
            let message = format!("must be at most 1e9 of the smallest diameter along {name}");
            wrong.push(("box.lengths", message));
        }
    }
    wrong
}

fn read_tree(tree: &Node, text: String, folder: &Path, problems: &Problems) -> Option<Case> {
    let root = Section::open(tree, schema::ROOT, problems)?;
    let units = root.choice("units", &Units::ALL);
    let (domain, mesh_files) = walls::read_domain(&root, folder).unzip();
    let species = SpeciesSections::read(&root);
    let (particles, scales) = match root.table("particles") {
        Some(section) => particles::read_particles(&section, units, &species, folder),
        None => (None, Scales { density: None, diameter: None }),
    };
    let context = ReadContext {
        units,
        scales,
        species: &species,
        domain: domain.as_ref(),
        gravity: None,
        times: &[],
    };
    let (stages, step) = stages::read_stages(&root, context);
    let output = root.table("output").and_then(|section| plans::read_output(&section, step));
    let or_defaults = |name| root.table_or_defaults(name);
    let on_cells =
        stages.iter().flatten().any(|stage| stage.physics.gas.volume_averaged().is_some());
    let mut case = Case {
        title: root.text("title")?,
        units: units?,
        text,
        domain: domain?,
        mesh_files: mesh_files.unwrap_or_default(),
        stages: stages?,
        particles: particles?,
        coarse_graining: None,
        output: output?,
        instruments: Vec::new(),
        checkpoint: or_defaults("checkpoint").and_then(|s| plans::read_checkpoint(&s))?,
        wall_clock: or_defaults("run")?.wall_time("wall_clock"),
        parallel: or_defaults("parallel").and_then(|s| plans::read_parallel(&s, on_cells))?,
        notes: problems.notes(),
        places: Places::of(tree),
    };
    if let Some(section) = root.table("coarse_graining") {
        case = coarse_graining::read_coarse_graining(&section, case)?;
    }
    case.instruments = instruments::read_instruments(&root, &case)?;
    if let Some(output) = root.table("output") {
        instruments::check_agglomerates(&output, &case);
    }
    case.notes = problems.notes();
    if let Some(sizes) = case.size_range() {
        for (key, message) in case.check_sizes(&sizes) {
            let node = key.split('.').try_fold(tree, |node, key| node.get(key)).unwrap_or(tree);
            problems.add(node.error(message));
        }
    }
    Some(case)
}
