//! `[gas]`: the keys of every gas, and those of each kind.

use super::Chapter;
use talcum_engine::gas::DragLaw;
use talcum_engine::schema::{Allowed, Key, Kind, SIGNED_SCHEDULE, Value, Word};

const KINDS: &[Word] = &[
    Word::with(
        "column",
        "one-dimensional, without inertia; needs a lower wall or periodicity along z",
        COLUMN,
    ),
    Word::with("volume_averaged", "three-dimensional", VOLUME_AVERAGED),
];

/// `[gas]`.
pub(in crate::case) const GAS: &[Key] = &[
    Key::word("kind", KINDS, "Which gas"),
    Key::number("viscosity", Allowed::POSITIVE, "Viscosity mu_g of the gas")
        .unit("stress time")
        .or(&["stokes_number"]),
    Key::number(
        "stokes_number",
        Allowed::POSITIVE,
        "St = rho_s g^1/2 d^3/2 / mu_g at the reference diameter",
    )
    .or(&["viscosity"]),
    Key::word("drag", DragLaw::WORDS, "Drag law"),
    Key::number("drag_factor", Allowed::POSITIVE, "xi, the drag over that of the law")
        .or(&["agglomerates"])
        .default(Value::Number(1.0)),
    Key::word(
        "drag_in_mixtures",
        MIXTURES,
        "The drag on particles of different sizes side by side",
    )
    .default(Value::Word("own_diameter")),
];

const MIXTURES: &[Word] = &[
    Word::new("own_diameter", "each has that of a bed of its own size"),
    Word::new(
        "sauter_diameter",
        "together they have that of a bed of the local Sauter mean diameter, shared by surface (Beetstra et al. 2007)",
    ),
];

const WEIGHTS: &[Word] = &[
    Word::new("particle_force", "by the force on the particles"),
    Word::new("grid_integral", "by the integral over the grid"),
];

const BASE_NODES: &[Word] =
    &[Word::new("full_cell", "a whole cell"), Word::new("half_cell", "half a cell")];

/// `plenum` of a column gas.
const PLENUM: &[Key] = &[
    Key::number("height", Allowed::POSITIVE, "Volume of the plenum over the cross-section of the bed").unit("length"),
    Key::number(
        "pressure",
        Allowed::POSITIVE,
        "Absolute pressure P above the bed; the plenum's gas is ideal and isothermal, flows are volumes at P",
    )
    .unit("stress"),
    Key::number(
        "linear_resistance",
        Allowed::NOT_NEGATIVE,
        "Pressure drop of the distributor over U_s",
    )
    .unit("stress/speed")
    .default(Value::Number(0.0)),
    Key::number(
        "quadratic_resistance",
        Allowed::NOT_NEGATIVE,
        "Pressure drop of the distributor over U_s squared",
    )
    .unit("stress/speed^2")
    .default(Value::Number(0.0)),
];

/// `compressible` of a column gas.
const COMPRESSIBLE: &[Key] = &[Key::number(
    "pressure",
    Allowed::POSITIVE,
    "Absolute pressure P above the bed, the same as that of a `plenum`; flows are volumes at P",
)
.unit("stress")];

/// Keys of the column gas.
const COLUMN: &[Key] = &[
    Key::number(
        "spacing",
        Allowed::POSITIVE,
        "Spacing dz of the grid, at least a millionth of the height; in a periodic box its divisor nearest to this \
         (printed), at most a third of the height",
    )
    .unit("length"),
    Key::new("superficial_velocity", SIGNED_SCHEDULE, "Superficial velocity U_s, upwards")
        .unit("speed")
        .or(&["weight"]),
    Key::new(
        "plenum",
        Kind::Table(PLENUM),
        "The gas comes out of a plenum below the plate, through a distributor: `superficial_velocity` is then the flow into \
         the plenum, and U_s follows the bed",
    )
    .with("superficial_velocity")
    .optional(),
    Key::new(
        "compressible",
        Kind::Table(COMPRESSIBLE),
        "The gas is compressible, isothermal and ideal: `superficial_velocity` is then what flows in at the plate, and the \
         velocity depends on the height; without it the gas is incompressible",
    )
    .with("superficial_velocity")
    .optional(),
    Key::word("weight", WEIGHTS, "The gas carries the weight of a fully periodic bed")
        .or(&["superficial_velocity"]),
    Key::new("lateral_drag", Kind::Boolean, "Whether the gas resists lateral motion")
        .printed(Value::Boolean(false), "the gas acts vertically only"),
    Key::word("base_node", BASE_NODES, "Volume of the grid node on the plate")
        .printed(Value::Word("full_cell"), "phi is halved in the node on the plate"),
];

/// Boundary conditions of the gas at a face of the box.
pub(in crate::case) const FACES: &[Word] = &[
    Word::new(
        "no_slip",
        "a wall to which the gas sticks; it moves as the `[[wall]]` of that face does",
    ),
    Word::new("free_slip", "a wall without friction"),
    Word::new("inlet", "gas enters at `inlet_velocity`"),
    Word::new("outlet", "gas leaves at `outlet_pressure`"),
];

const SIDES: &[Key] = &[
    Key::word("lower", FACES, "The face at the origin"),
    Key::word("upper", FACES, "The face opposite"),
];

const BOTH: Kind = Kind::Either(&[Kind::Word(FACES), Kind::Table(SIDES)]);
const FACES_MEANING: &str =
    "What the two faces across this axis do to the gas; refused where the box is periodic";
const ACROSS_MEANING: &str = "What the two faces across this axis do to the gas; refused where the box is periodic and in a round column";
const NOT_PERIODIC: &str = "the box is not periodic along this axis";
const NEITHER_PERIODIC_NOR_ROUND: &str =
    "the box is not periodic along this axis and the gas flows in no round column";

const PROFILES: &[Word] = &[
    Word::new("uniform", "the same everywhere"),
    Word::new(
        "parabolic",
        "between the faces across that are not periodic, or 2 (1 - r^2 / R^2) in a round column; its mean is the velocity",
    ),
];

/// `inlet_jet` of a volume-averaged gas.
const JET: &[Key] = &[
    Key::new(
        "centre",
        Kind::Vector(Allowed::FINITE, 2),
        "Where its middle is in the face of the inlet: x before y before z",
    )
    .unit("length"),
    Key::new("width", Kind::Vector(Allowed::POSITIVE, 2), "Its two edges, along the same axes")
        .unit("length"),
    Key::new("velocity", SIGNED_SCHEDULE, "Superficial velocity into the box in the jet")
        .unit("speed"),
];

/// `agglomerates` of a volume-averaged gas.
const AGGLOMERATES: &[Key] = &[
    Key::new(
        "every",
        Kind::Count(1, 1_000_000_000),
        "Steps of the gas from one search for agglomerates to the next; they are connected sets of pairs that touch now and \
         touched at the search before",
    ),
    Key::new(
        "smallest",
        Kind::Count(2, 1_000_000),
        "Sets of fewer particles are taken for single ones, whose drag is that of the law",
    )
    .default(Value::Count(2)),
];

/// Keys of the volume-averaged gas.
const VOLUME_AVERAGED: &[Key] = &[
    Key::number("density", Allowed::POSITIVE, "Density of the gas").unit("mass/volume"),
    Key::new(
        "cells",
        Kind::Counts(1, 100_000),
        "Cells along x, y, z that fill the box; between faces that are not periodic at least 3; the same in all stages",
    ),
    Key::new(
        "substeps",
        Kind::Count(1, 100_000),
        "Time steps of the particles in one of the gas; divides the number of steps before a stage that starts with gas",
    ),
    Key::new("x", BOTH, ACROSS_MEANING).required_when(NEITHER_PERIODIC_NOR_ROUND),
    Key::new("y", BOTH, ACROSS_MEANING).required_when(NEITHER_PERIODIC_NOR_ROUND),
    Key::new("z", BOTH, FACES_MEANING).required_when(NOT_PERIODIC),
    Key::new("inlet_velocity", SIGNED_SCHEDULE, "Superficial velocity into the box at inlets")
        .unit("speed")
        .required_when("there is an inlet"),
    Key::new(
        "inlet_profile",
        Kind::Either(&[Kind::Word(PROFILES), Kind::List(Allowed::NOT_NEGATIVE)]),
        "Velocity over the face of an inlet: a word, or a factor for each cell of the face, x before y before z",
    )
    .default(Value::Word("uniform")),
    Key::new(
        "inlet_jet",
        Kind::Table(JET),
        "A rectangle of the face of an inlet with a velocity of its own; of a cell that it covers in part, in that part",
    )
    .with("inlet_velocity")
    .optional(),
    Key::number(
        "outlet_pressure",
        Allowed::FINITE,
        "Pressure at outlets, less the hydrostatic head",
    )
    .unit("stress")
    .default(Value::Number(0.0)),
    Key::number(
        "filter_width",
        Allowed::NOT_NEGATIVE,
        "Full width at half maximum of the filter between particles and cells; 3 to 6 diameters are advised for cells \
         narrower than 3 diameters",
    )
    .unit("length")
    .default(Value::Number(0.0)),
    Key::new(
        "agglomerates",
        Kind::Table(AGGLOMERATES),
        "The drag on a particle follows from the agglomerate that it is in, taken for a permeable ball among others like it, in place \
         of one factor for all",
    )
    .or(&["drag_factor"])
    .optional(),
    Key::new(
        "undisturbed_velocity",
        Kind::Boolean,
        "Whether the drag on a particle is that of the gas without what the particle itself does to its cells: for dilute gases, in \
         cells of at least 3 diameters or with a filter of as much; in a packed bed it changes nothing",
    )
    .default(Value::Boolean(false)),
    Key::new(
        "local_voidage",
        Kind::Count(0, 16),
        "The voidage of drag laws is that of cells so many times finer along each axis, without the filter; 0 for that of the gas's own cells. For \
         the surfaces of beds: finer cells of 1.5 diameters are advised",
    )
    .default(Value::Count(0)),
    Key::number(
        "least_voidage",
        Allowed::between(0.01, 0.9),
        "Lower bound of the voidage of cells; clipped cells are counted in `series.csv` and reported",
    )
    .printed(Value::Number(0.2), "the lower bound of the voidage of cells (clipped cells are counted)"),
    Key::number(
        "tolerance",
        Allowed::between(1.0e-14, 0.1),
        "Residual of continuity over that at the start of the step",
    )
    .default(Value::Number(1.0e-6)),
    Key::new(
        "driving",
        Kind::Vector(Allowed::FINITE, 3),
        "Force per volume that drives the gas through a periodic box",
    )
    .unit("force/volume")
    .optionally("0, 0, 0"),
];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "gas",
    title: "",
    keys: GAS,
    before: "",
    after: "\
`\"volume_averaged\"` always needs `density`, whatever the drag law.

With `plenum`, (H / P) dp/dt = U_0 - U_s, where H is its `height`, P its `pressure`, p the pressure in it less P, and U_0 the
`superficial_velocity` that the case asks for; and p = R_1 U_s + R_2 U_s^2 + (gas force on the bed per cross-section), R_1 and R_2
the resistances of the distributor. The first gas flows at U_0. U_s follows the bed where H / P times the resistance of the bed
(its pressure drop over U_s) is not short beside the period of the plate, and the distributor's resistance not large beside
the bed's.

With `compressible`, the balances of mass and momentum of the gas are
d[(1 - phi) (P + p)]/dt + d[(P + p) (U - phi u_s)]/dz = 0 and -dp/dz = beta (U - u_s) / (1 - phi)^2, with p the pressure less P and
U(z, t) = (1 - phi) u_g + phi u_s; at the plate P U_s flows in, above the bed p = 0. A gas that is turned on, or whose grid has
another number of nodes than in the stage before, begins with the pressures of the incompressible gas. A bed of height H resonates where the
frequency of the plate is near c / (4 H), c^2 = P / (rho_s phi (1 - phi)), and follows as if the gas were incompressible where
it is far lower; `check` prints c for a voidage of 0.45. The gas's own inertia is left out.

The volume-averaged gas advances every `substeps` steps, with drag implicit in its own velocity; the force on each
particle is kept until its next step. The run stops with an error message if that step is too long: 2 C + V / 2 must not
exceed 1, where C is the Courant number and V the viscous number, and b dt / (m eps^2) of a particle must not exceed 1,
where b is its drag per velocity. `check` prints all three.

With `agglomerates`, xi is not one number but follows, for each particle and at each step of the gas, from size and packing of its
agglomerate and from the solids fraction around it, and is at most 1 (`docs/theory/drag.md`). A new bed begins with single
particles: the first agglomerates are found at the third look. Neither `undisturbed_velocity`, nor `local_voidage`, nor the drag of mixtures by the Sauter
diameter, nor `[coarse_graining]` can stand beside it. `series.csv` shows the mean of xi as `drag_factor`.

With a round column (`[[wall]]` with a `radius`) the volume-averaged gas flows in it, not in the rest of the box. It sticks to
the column's wall, at the wall's true distance; cells whose centres lie outside are closed, and those at the wall share
what the column has of them. Velocities and fluxes are per cross-section of the column, which stands still and is at least
4 cells wide. Snapshots show a voidage and a pressure of 0 in closed cells.",
};
