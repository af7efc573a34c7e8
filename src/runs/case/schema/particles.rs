//! `[particles]` and `[particles.start]`.

use super::Chapter;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

const SMALLEST: Key =
    Key::number("smallest", Allowed::POSITIVE, "Lower bound; diameters below are drawn again")
        .unit("length");
const LARGEST: Key = Key::number(
    "largest",
    Allowed::POSITIVE,
    "Upper bound, at least `smallest`; diameters above are drawn again",
)
.unit("length");

const SHAPES: &[Word] = &[
    Word::with("uniform", "equally likely between the bounds", &[SMALLEST, LARGEST]),
    Word::with(
        "normal",
        "the bounds must contain at least 0.05 of the distribution",
        &[
            Key::number("mean", Allowed::POSITIVE, "Mean before truncation").unit("length"),
            Key::number("deviation", Allowed::POSITIVE, "Standard deviation before truncation")
                .unit("length"),
            SMALLEST,
            LARGEST,
        ],
    ),
    Word::with(
        "log_normal",
        "ln d is normal; bounds as for `normal`",
        &[
            Key::number("median", Allowed::POSITIVE, "Median before truncation").unit("length"),
            Key::number(
                "deviation",
                Allowed::POSITIVE,
                "Standard deviation of ln d before truncation",
            ),
            SMALLEST,
            LARGEST,
        ],
    ),
];

/// A distribution of diameters.
const DISTRIBUTION: &[Key] = &[
    Key::new("values", Kind::List(Allowed::POSITIVE), "Diameters of classes")
        .unit("length")
        .or(&["distribution"]),
    Key::new(
        "fractions",
        Kind::List(Allowed::between(0.0, 1.0)),
        "Number fraction of each class; they add up to 1",
    )
    .with("values"),
    Key::new(
        "densities",
        Kind::List(Allowed::POSITIVE),
        "Solid density of each class; Bond and Stokes number still refer to `particles.density`",
    )
    .unit("mass/volume")
    .with("values")
    .optional(),
    Key::new("species", Kind::Texts, "Species of each class, by their names in `[[species]]`")
        .with("values")
        .required_when("there are several `[[species]]` and no file says the particles' species"),
    Key::word("distribution", SHAPES, "A continuous distribution").or(&["values"]),
];

/// `[particles]`.
pub(in crate::case) const PARTICLES: &[Key] = &[
    Key::new("count", Kind::Count(1, 1_000_000_000), "How many particles")
        .or(&["fill_height"])
        .required_when("`kind` of the start is `\"lattice\"` or `\"random\"`"),
    Key::number("fill_height", Allowed::POSITIVE, "As many particles as fit below this height")
        .unit("length")
        .or(&["count"])
        .required_when("`kind` of the start is `\"lattice\"` or `\"random\"`"),
    Key::new(
        "diameter",
        Kind::Either(&[Kind::Number(Allowed::POSITIVE), Kind::Table(DISTRIBUTION)]),
        "Diameter of all particles, or its distribution by number",
    )
    .unit("length")
    .required_when("no file and no other run gives the diameters"),
    Key::number(
        "reference_diameter",
        Allowed::POSITIVE,
        "Diameter d of Bond and Stokes number; 1 in dimensionless units, otherwise by default `diameter`",
    )
    .unit("length")
    .required_when("diameters differ or come from a file"),
    Key::number("density", Allowed::POSITIVE, "Solid density rho_s; 1 in dimensionless units")
        .unit("mass/volume"),
    Key::new(
        "seed",
        Kind::Count(0, u64::MAX - 1),
        "Seed of all random numbers; the same on any number of ranks",
    )
    .required_when("random numbers are drawn"),
    Key::new("start", Kind::Table(START), "Where the particles start"),
];

const BOTTOM: Key =
    Key::number("bottom", Allowed::NOT_NEGATIVE, "Height of the underside of the bed")
        .unit("length")
        .printed(Value::Number(0.0), "the bed starts on the floor of the box");
const PATH: Key = Key::new(
    "path",
    Kind::Text,
    "The file, relative to the case file; of another run a checkpoint",
);
const VELOCITY: Key = Key::new(
    "velocity",
    Kind::Table(&[Key::number(
        "granular_temperature",
        Allowed::NOT_NEGATIVE,
        "T: each component of the velocity is normal with variance T",
    )
    .unit("speed^2")]),
    "Random velocities",
)
.optionally("at rest, or as the file says");

const FORMATS: &[Word] = &[
    Word::new(
        "csv",
        "a table with the header `id,x,y,z[,vx,vy,vz][,wx,wy,wz][,d][,species]` in any order; `#` starts a comment",
    ),
    Word::new(
        "lammps",
        "a dump, of which the last frame is read: columns `id`, `x` or `xu` or `xs` (same for y, z), optionally `vx`, \
         `omegax`, `radius` or `diameter`, and `type` if there are `[[species]]`: their number, from 1; others are ignored",
    ),
];

const KINDS: &[Word] = &[
    Word::with(
        "lattice",
        "layers of a simple cubic lattice",
        &[
            Key::number(
                "spacing",
                Allowed::POSITIVE,
                "Least distance of sites, at least the largest diameter; stretched so that it divides the width",
            )
            .unit("length"),
            Key::number(
                "jitter",
                Allowed::from_to_below(0.0, 1.0),
                "Random displacement over the largest one without contact",
            )
            .printed(Value::Number(0.0), "an exact lattice"),
            BOTTOM,
            VELOCITY,
        ],
    ),
    Word::with(
        "random",
        "a loose random bed without contacts",
        &[
            Key::number("solids_fraction", Allowed::positive_up_to(0.3), "Solids fraction of the bed"),
            BOTTOM,
            VELOCITY,
        ],
    ),
    Word::with(
        "file",
        "the rows of a file",
        &[
            PATH,
            Key::word("format", FORMATS, "Format of the file"),
            Key::new("offset", Kind::Vector(Allowed::FINITE, 3), "Added to all positions")
                .unit("length")
                .optionally("0, 0, 0"),
            VELOCITY,
        ],
    ),
    Word::with("run", "the end of another run", &[PATH]),
];

/// `[particles.start]`.
const START: &[Key] = &[Key::word("kind", KINDS, "Where the particles start")];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "particles",
    title: "",
    keys: PARTICLES,
    before: "",
    after: "\
Forms of a distribution, by number: `{ values = [0.8, 1.2], fractions = [0.5, 0.5] }`, also with
`densities = [1.0, 2.5]`, where two classes may have the same diameter,
`{ distribution = \"uniform\", smallest = , largest = }`,
`{ distribution = \"normal\", mean = , deviation = , smallest = , largest = }` and
`{ distribution = \"log_normal\", median = , deviation = , smallest = , largest = }`. A start from a file or from
another run says how many particles there are: `count` and `fill_height` are refused.",
};

pub(super) const START_CHAPTER: Chapter = Chapter {
    path: "particles.start",
    title: "",
    keys: START,
    before: "",
    after: "\
No two bodies touch in a bed from `\"lattice\"` or `\"random\"`. In a file overlaps of up to 0.2 of the smaller diameter
are allowed, every id occurs once, and positions are inside the faces that are not periodic. A start from `\"run\"` takes
over positions, velocities, angular velocities and contact histories.",
};
