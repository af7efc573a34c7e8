//! The tables of the case file: every section with its keys, and the text of the manual around them.

mod boxes;
mod coarse_graining;
mod contact;
mod forces;
mod gas;
mod instruments;
mod particles;
mod results;
mod species;
mod time;

pub(super) use boxes::{BOX, SHAPES, WALL};
pub(super) use contact::{AT_WALL, CONTACT};
pub(super) use forces::{COHESION, GRAVITY, VIBRATION};
#[cfg(test)]
pub(super) use gas::FACES;
pub(super) use gas::GAS;
pub(super) use instruments::MEASURE;
pub(super) use particles::PARTICLES;
pub(super) use results::{CHECKPOINT, OUTPUT, PARALLEL, RUN};
pub(super) use species::{PAIR, SPECIES};
pub(super) use time::{STAGE, TIME};

use crate::input::{Chapter, FileKeys};
use talcum_engine::contact::COARSE_GRAINING;
use talcum_engine::schema::{Key, Kind, Merged, SIGNED_SCHEDULE, Word};

/// The keys of a case file.
pub const FILE_KEYS: FileKeys =
    FileKeys { title: "Case file of talcum", root: ROOT, chapters: CHAPTERS, head: HEAD };

const HEAD: &str = "\
# The case file

<!-- Written by `talcum keys --markdown` from the tables in src/runs/case/schema: change those. -->

One TOML file describes a run. `talcum check CASE.toml` reads it and says what will run. Unknown keys are errors, and all
errors are reported at once, each with file, line, key, value and what is allowed:

    vibrated.toml:12: contact.restitution = 1.4: must be above 0 and at most 1

Keys without a default are required. No default hides physics: those few that touch it are printed by `check` and at the start of a run. All numbers are in
the coherent units that `units` names, and their magnitude is between 1e-30 and 1e30, or 0.

`talcum keys SECTION` prints the keys of a section in the terminal. Editors complete keys, show their meaning and mark
errors if the first line of the file gives the schema, by its path relative to the file or by its address (Taplo,
and Even Better TOML in VS Code):

    #:schema ../../docs/case.schema.json

Outside the repository, `talcum keys --json-schema > case.schema.json` writes it beside the case.

`--set key.path=value` on the command line changes a key before the file is read. Members of a list go by number, from 1,
or by name: `--set stage.2.duration=5`, `--set stage.ramp.gas.superficial_velocity=0.1`. Texts of one word, and durations
such as `3h50m`, need no quotes. A key takes the place of the one that it excludes (`viscosity` that of `stokes_number`),
and a new `law`, `drag`, `rolling`, `twisting` or `kind` removes the keys that only the old one has. The file with all changes is
kept in the results as `case.toml`.
";

/// All sections, in the order of the manual.
const CHAPTERS: &[Chapter] = &[
    Chapter { path: "", title: "Top level", keys: ROOT, before: "", after: "" },
    boxes::BOX_CHAPTER,
    boxes::WALL_CHAPTER,
    particles::CHAPTER,
    particles::START_CHAPTER,
    species::CHAPTER,
    species::PAIR_CHAPTER,
    coarse_graining::CHAPTER,
    forces::GRAVITY_CHAPTER,
    forces::VIBRATION_CHAPTER,
    contact::CHAPTER,
    contact::AT_WALL_CHAPTER,
    forces::COHESION_CHAPTER,
    gas::CHAPTER,
    Chapter {
        path: "",
        title: "Schedules",
        keys: SIGNED_SCHEDULE_KEYS,
        before: SCHEDULES,
        after: SCHEDULES_OF_STAGES,
    },
    time::CHAPTER,
    time::STAGE_CHAPTER,
    results::OUTPUT_CHAPTER,
    instruments::CHAPTER,
    results::CHECKPOINT_CHAPTER,
    results::RUN_CHAPTER,
    results::PARALLEL_CHAPTER,
];

const SIGNED_SCHEDULE_KEYS: &[Key] = match SIGNED_SCHEDULE {
    Kind::Schedule(_, keys) => keys,
    _ => &[],
};

const SCHEDULES: &str = "\
Keys that allow a schedule take a number, or a table in braces:

| form | meaning |
| --- | --- |
| `0.1` | constant |
| `{ from = 0.0, to = 0.1 }` | linear during the stage in which it is written, constant afterwards |
| `{ values = [0.1, 0.2], every = 25.0 }` | one value after another from the start of that stage; the last one stays |
| `{ mean = 0.1, amplitude = 0.02, frequency = 5.0 }` | mean + amplitude sin(2 pi frequency t), t since the start of that stage |";

const SCHEDULES_OF_STAGES: &str = "\
In the sections outside of stages a schedule belongs to the first stage. Its numbers obey the range of the key.";

/// The system of units.
const UNITS: &[Word] = &[
    Word::new("si", "metre, kilogram, second"),
    Word::new("dimensionless", "solid density, reference diameter and gravity are 1"),
];

/// The top level of the file.
pub(super) const ROOT: &[Key] = &[
    Key::new("title", Kind::Text, "Name of the run"),
    Key::word("units", UNITS, "System of units of all numbers"),
    Key::new("box", Kind::Table(BOX), "The box and its faces"),
    Key::new("wall", Kind::Tables(WALL), "Further walls, and faces of the box that move")
        .optional(),
    Key::new("particles", Kind::Table(PARTICLES), "How many particles, of which size and density"),
    Key::new("species", Kind::Tables(SPECIES), "Materials of a mixture").optional(),
    Key::new("pair", Kind::Tables(PAIR), "What two different species do to each other").optional(),
    Key::new("coarse_graining", Kind::Table(COARSE_GRAINING), "Parcels in place of particles")
        .optional(),
    Key::new("gravity", merged("gravity", GRAVITY), "Gravity").required_at_start(),
    Key::new("vibration", switched("vibration", VIBRATION), "Vibration of the plate").optional(),
    Key::new("contact", merged("contact", CONTACT), "Contacts between particles and with walls")
        .required_at_start(),
    Key::new("cohesion", switched("cohesion", COHESION), "Van der Waals attraction").optional(),
    Key::new("gas", switched("gas", GAS), "The gas").optional(),
    Key::new("time", Kind::Table(TIME), "Time step and end of the run"),
    Key::new("stage", Kind::Tables(STAGE), "Stages of the run, one after another").optional(),
    Key::new("output", Kind::Table(OUTPUT), "Intervals of results"),
    Key::new("measure", Kind::Named(MEASURE), "The instruments of the run").optional(),
    Key::new("checkpoint", Kind::Table(CHECKPOINT), "When checkpoints are written").optional(),
    Key::new("run", Kind::Table(RUN), "Limit of wall-clock time").optional(),
    Key::new("parallel", Kind::Table(PARALLEL), "How the run is spread over ranks").optional(),
];

/// The keys of a section at the top of the file.
pub(super) fn section_keys(name: &str) -> &'static [Key] {
    ROOT.iter().find(|key| key.name == name).map(|key| key.kind.keys()).unwrap_or_default()
}

/// A section that stages may change.
const fn merged(section: &'static str, keys: &'static [Key]) -> Kind {
    Kind::Merged(Merged { section, keys, switched: false })
}

/// A section that stages may change, switch off and switch on.
const fn switched(section: &'static str, keys: &'static [Key]) -> Kind {
    Kind::Merged(Merged { section, keys, switched: true })
}
