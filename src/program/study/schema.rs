//! The tables of the study file: every section with its keys, and the text of the manual around them.

use crate::study::quantity;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};
use talcum_runs::input::{Chapter, FileKeys};

/// The keys of a study file.
pub const FILE_KEYS: FileKeys =
    FileKeys { title: "Study file of talcum", root: ROOT, chapters: CHAPTERS, head: HEAD };

const HEAD: &str = "\
# The study file

<!-- Written by `talcum keys study --markdown` from the tables in src/program/study: change those. -->

One TOML file describes a study; [Studies](study.md) explains it by examples. Unknown keys are errors, and all errors are
reported at once, before anything runs, each with file, line, key, value and what is allowed:

    study.toml:4: run.ranks = 0: must be between 1 and 65536

Keys without a default are required. `talcum keys study SECTION` prints the keys of a section in the terminal. Editors complete
keys, show their meaning and mark errors if the first line of the file gives the schema, by its path relative to the file or by
its address (Taplo, and Even Better TOML in VS Code):

    #:schema ../../../docs/study.schema.json

Outside the repository, `talcum keys study --json-schema > study.schema.json` writes it beside the study. The keys of the case are
those of [the case file](input.md).
";

/// All sections, in the order of the manual.
const CHAPTERS: &[Chapter] = &[
    Chapter { path: "", title: "Top level", keys: ROOT, before: "", after: "" },
    Chapter {
        path: "set",
        title: "keys of the case that all runs share",
        keys: &[],
        before: "\
Any keys of the case with their values, as `--set` takes them. Sections and dotted keys are paths, inline tables are values. Stages
go by number or by name: `stage.2.duration`, `stage.ramp.duration`.",
        after: "",
    },
    Chapter {
        path: "axis",
        title: "one direction of the grid",
        keys: AXIS,
        before: "The study runs all combinations of the values of its axes; the last axis varies fastest.",
        after: "No value may stand twice on an axis, except along a continuation.",
    },
    Chapter {
        path: "start",
        title: "runs begin with the ends of another study",
        keys: START,
        before: "Each run begins with the end of the run of the same seed.",
        after: "",
    },
    Chapter {
        path: "continuation",
        title: "runs begin with the ends of each other",
        keys: CONTINUATION,
        before: "",
        after: "",
    },
    Chapter {
        path: "bisection",
        title: "the critical value of a key",
        keys: BISECTION,
        before: "A search cannot be combined with `[continuation]`.",
        after: "",
    },
    Chapter {
        path: "measure",
        title: "the quantities of the study",
        keys: quantity::KEYS,
        before: "\
Each `[measure.NAME]` is a quantity that is taken from every run; NAME is yours, of characters, digits, `_` and `-`. A study has at least one
quantity, here, in `measures` or in `[bisection]`. [files.md](files.md) lists the columns of `series.csv`, [instruments.md](instruments.md)
the numbers of instruments, and [analyse.md](analyse.md) those of `talcum analyse`.",
        after: "",
    },
    Chapter {
        path: "run",
        title: "how runs are started",
        keys: RUN,
        before: "These keys change no result.",
        after: "",
    },
];

/// The top level of the file.
pub(crate) const ROOT: &[Key] = &[
    Key::new("title", Kind::Text, "What you call the study"),
    Key::new("case", Kind::Text, "Path of the case file, relative to the study file"),
    Key::new(
        "seeds",
        Kind::Either(&[Kind::Count(1, 10_000), Kind::CountList(0, u64::MAX - 1)]),
        "Replicates of each point: how many, or which seeds (`particles.seed`)",
    )
    .optionally("the seed of the case alone"),
    Key::number("confidence", Allowed::between(0.5, 0.999), "Level of confidence of the intervals")
        .default(Value::Number(0.95)),
    Key::new(
        "measures",
        Kind::Texts,
        "Quantities of the whole run, as `talcum analyse --list` names them",
    )
    .optional(),
    Key::new("set", Kind::Settings, "Keys of the case that all runs share").optional(),
    Key::new("axis", Kind::Tables(AXIS), "The axes of the grid").optionally("one point"),
    Key::new("start", Kind::Table(START), "The study with whose ends runs begin").optional(),
    Key::new("continuation", Kind::Table(CONTINUATION), "Runs that follow each other").optional(),
    Key::new("bisection", Kind::Table(BISECTION), "A search for a critical value").optional(),
    Key::new("measure", Kind::Named(quantity::KEYS), "The quantities of the study")
        .required_when("neither `measures` nor `bisection.measure` names a quantity"),
    Key::new("run", Kind::Table(RUN), "How runs are started").optional(),
];

/// More values than these in a range are a slip of the keyboard.
pub(crate) const MOST_VALUES: u64 = 100_000;

const AXIS: &[Key] = &[
    Key::new("key", Kind::Text, "The key of the case that varies").or(&["keys"]),
    Key::new("keys", Kind::Texts, "Keys of the case that vary together").or(&["key"]),
    Key::new("values", Kind::Values, "The values; with `keys` a list for each position")
        .or(&["range"]),
    Key::new("range", Kind::Table(RANGE), "Equal steps; for one key, not for `keys`")
        .or(&["values"]),
    Key::new("name", Kind::Text, "What `[continuation]` and `bracket_along` call the axis")
        .optionally("its first key"),
    Key::new(
        "replicate",
        Kind::Boolean,
        "Whether the axis holds replicates of each point, as seeds do: one axis at most, instead of `seeds`",
    )
    .default(Value::Boolean(false)),
];

const RANGE: &[Key] = &[
    Key::number("from", Allowed::FINITE, "The first value"),
    Key::number("to", Allowed::FINITE, "The last value, if steps lead there"),
    Key::number("step", Allowed::FINITE, "From one value to the next; rounded to 12 digits")
        .or(&["count"]),
    Key::new("count", Kind::Count(2, MOST_VALUES), "How many values there are, with both ends")
        .or(&["step"]),
    Key::word("scale", SCALES, "The scale on which steps are equal; with `step` it is linear")
        .default(Value::Word("linear")),
];

const SCALES: &[Word] = &[Word::new("linear", ""), Word::new("logarithmic", "")];

const START: &[Key] = &[
    Key::new("study", Kind::Text, "Path of the other study file, relative to this one"),
    Key::new(
        "results",
        Kind::Text,
        "The folder of its results, relative to where `talcum` is called",
    )
    .optionally("`results/NAME` of its file"),
];

const CONTINUATION: &[Key] = &[
    Key::new("axis", Kind::Text, "The axis along which runs follow each other, by its name"),
    Key::new(
        "from_stage",
        Kind::Text,
        "Name of the stage with which continued runs begin; the stages before it are left out",
    )
    .optionally("all stages"),
    Key::new("set", Kind::Settings, "Keys of the case that only continued runs take").optional(),
];

const BISECTION: &[Key] = &[
    Key::new("key", Kind::Text, "The key of the case whose critical value is sought"),
    Key::new(
        "bracket",
        Kind::Either(&[Kind::Vector(Allowed::FINITE, 2), Kind::Vectors(Allowed::FINITE, 2)]),
        "Where it is sought, the smaller number first; with `bracket_along` one for each value of the axis",
    ),
    Key::new("bracket_along", Kind::Text, "Name of an axis with a bracket for each of its values")
        .optionally("one bracket"),
    Key::number(
        "tolerance",
        Allowed::POSITIVE,
        "The search ends when the bracket is no wider; below the width of the bracket",
    ),
    Key::new(
        "measure",
        Kind::Text,
        "The quantity that decides, by its name here or in `talcum analyse`",
    ),
    Key::new(
        "threshold",
        Kind::Either(&[Kind::Number(Allowed::FINITE), Kind::Text]),
        "The value that it crosses; of a text one of its texts",
    ),
    Key::word("direction", DIRECTIONS, "What the quantity does as the key grows"),
    Key::word(
        "scale",
        SCALES,
        "Whether the bracket is halved at its arithmetic or its geometric mean",
    )
    .default(Value::Word("linear")),
];

const DIRECTIONS: &[Word] = &[Word::new("rises", ""), Word::new("falls", "")];

/// More ranks or runs than these are a slip of the keyboard.
const MOST: u64 = 65_536;

const RUN: &[Key] = &[
    Key::new("ranks", Kind::Count(1, MOST), "Ranks of each run").default(Value::Count(1)),
    Key::new("at_a_time", Kind::Count(1, MOST), "How many runs work at the same time")
        .default(Value::Count(1)),
    Key::new(
        "launcher",
        Kind::Text,
        "The command that starts a program on several ranks, with `{ranks}` for their number; or `threads`: ranks are threads of each run",
    )
    .optionally("`mpirun -n {ranks}`; in a program without MPI `threads`"),
];
