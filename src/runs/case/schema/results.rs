//! `[output]`, `[checkpoint]`, `[run]` and `[parallel]`: sections that do not change the physics.

use super::Chapter;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

const PARTICLE_FIELDS: &[Word] = &[
    Word::new("mass", ""),
    Word::new("class", "its size class, from 0; -1 where sizes are not in classes"),
    Word::new("species", "its species, from 0 in the order of `[[species]]`"),
    Word::new("force", "all that acts on it, at the end of the step"),
    Word::new(
        "gas_force",
        "force of the gas: drag, pressure gradient and, in a volume-averaged gas, buoyancy",
    ),
    Word::new("coordination", "how many particles it touches"),
    Word::new(
        "drag_factor",
        "xi, its drag over that of the law, with `gas.agglomerates`; 0 without",
    ),
];
const PRECISIONS: &[Word] = &[
    Word::new("double", "8 bytes, exactly the numbers of the run"),
    Word::new("single", "4 bytes, about 7 digits"),
];

/// `[output]`.
pub(in crate::case) const OUTPUT: &[Key] = &[
    Key::number(
        "series",
        Allowed::POSITIVE,
        "Interval of rows of `series.csv`, at least `time.step` as all intervals here",
    )
    .unit("time"),
    Key::number("walls", Allowed::POSITIVE, "Interval of the forces on walls")
        .unit("time")
        .optional(),
    Key::number(
        "energy",
        Allowed::POSITIVE,
        "Interval of the ledger of energies; its sums are kept at every step, which then takes about ten times as long",
    )
    .unit("time")
    .optional(),
    Key::number("profiles", Allowed::POSITIVE, "Interval of profiles").unit("time").optional(),
    Key::number("particles", Allowed::POSITIVE, "Interval of snapshots of the particles")
        .unit("time")
        .optional(),
    Key::new(
        "agglomerates",
        Kind::Text,
        "Name of an instrument of the kind `agglomerates`: snapshots of the particles show the agglomerate of each, as of \
         the instrument's last sample",
    )
    .with("particles")
    .optional(),
    Key::new(
        "particle_fields",
        Kind::Words(PARTICLE_FIELDS),
        "What snapshots show of each particle beside position, velocity, angular velocity, radius and id",
    )
    .with("particles")
    .optional(),
    Key::number("gas", Allowed::POSITIVE, "Interval of snapshots of a volume-averaged gas")
        .unit("time")
        .optional(),
    Key::word("precision", PRECISIONS, "How snapshots of particles and gas hold numbers")
        .default(Value::Word("double")),
    Key::new(
        "compression",
        Kind::Count(0, 9),
        "How hard snapshots are compressed (gzip): 0 not at all, 1 fast, 9 small; rank 0 then writes them alone",
    )
    .default(Value::Count(0)),
    Key::number(
        "bed_threshold",
        Allowed::positive_up_to(0.74),
        "Solids fraction that marks the bottom and the top of the bed",
    )
    .printed(
        Value::Number(0.3),
        "the solids fraction that marks the bottom and the top of the bed",
    ),
];

/// `[checkpoint]`.
pub(in crate::case) const CHECKPOINT: &[Key] = &[
    Key::number("every", Allowed::POSITIVE, "Interval in simulated time")
        .unit("time")
        .or(&["every_steps"])
        .optional(),
    Key::new("every_steps", Kind::Count(1, 1_000_000_000_000), "Interval in steps")
        .or(&["every"])
        .optional(),
    Key::new("every_wall_clock", Kind::WallTime, "Interval in wall-clock time").optional(),
    Key::new(
        "stage_ends",
        Kind::Boolean,
        "Whether the state at the end of each stage is kept as stage-NUMBER-NAME.h5, to branch from",
    )
    .default(Value::Boolean(false)),
    Key::new("keep", Kind::Count(1, 1000), "How many of the newest are kept")
        .default(Value::Count(3)),
];

/// `[run]`.
pub(in crate::case) const RUN: &[Key] = &[Key::new(
    "wall_clock",
    Kind::WallTime,
    "Wall-clock time after which the run ends with a checkpoint",
)
.optional()];

const AXES: &[Word] = &[Word::new("x", ""), Word::new("y", ""), Word::new("z", "")];
const OFF: &[Word] = &[Word::new("off", "cut planes stay where they are")];

const BALANCE: &[Key] = &[
    Key::new(
        "every",
        Kind::Count(1, 1_000_000_000),
        "Least number of steps between two checks; they take place when neighbour lists are rebuilt. Where lists stay, \
         the first comes after as many steps of a run or restart, and each further one after twice as many as the one \
         before, up to ten times this number",
    )
    .unit("steps")
    .default(Value::Count(100)),
    Key::number(
        "threshold",
        Allowed::at_least(1.0),
        "Cut planes move if the largest over the mean time that ranks spend on their particles is above this; where \
         lists stay, only if that saves more time than new lists take",
    )
    .optionally("1.01; 1.05 with a volume-averaged gas, whose cells they do not cut"),
];

/// `[parallel]`.
pub(in crate::case) const PARALLEL: &[Key] = &[
    Key::word("axis", AXES, "Slabs along this axis, one per rank")
        .or(&["ranks"])
        .optionally("the rank grid that shares the work best"),
    Key::new(
        "ranks",
        Kind::Counts(1, 65_536),
        "A grid of ranks along x, y and z, as in `[2, 2, 2]`",
    )
    .or(&["axis"])
    .optional(),
    Key::number("skin", Allowed::between(0.001, 2.0), "Skin of the neighbour lists")
        .unit("largest diameter")
        .optionally("what the speeds of the particles make cheapest"),
    Key::new(
        "balance",
        Kind::Either(&[Kind::Word(OFF), Kind::Table(BALANCE)]),
        "Balancing of the load of ranks: how, or `\"off\"`",
    )
    .optionally("on, with the defaults below"),
];

pub(super) const OUTPUT_CHAPTER: Chapter =
    Chapter { path: "output", title: "", keys: OUTPUT, before: "", after: "" };

pub(super) const CHECKPOINT_CHAPTER: Chapter = Chapter {
    path: "checkpoint",
    title: "",
    keys: CHECKPOINT,
    before: "\
A checkpoint is always written at the end, on a signal, and when `run.wall_clock` is over. At most one of `every` and
`every_steps` is given.",
    after: "",
};

pub(super) const RUN_CHAPTER: Chapter =
    Chapter { path: "run", title: "", keys: RUN, before: "", after: "" };

pub(super) const PARALLEL_CHAPTER: Chapter = Chapter {
    path: "parallel",
    title: "never changes results",
    keys: PARALLEL,
    before: "",
    after: "",
};
