//! `[gravity]`, `[vibration]` and `[cohesion]`.

use super::Chapter;
use talcum_engine::schema::{Allowed, Key, Mixing, NOT_NEGATIVE_SCHEDULE, Word};

/// `[gravity]`.
pub(in crate::case) const GRAVITY: &[Key] = &[Key::number(
    "magnitude",
    Allowed::NOT_NEGATIVE,
    "g, along -z; in dimensionless units 1, or 0 for none",
)
.unit("acceleration")];

/// `[vibration]`.
pub(in crate::case) const VIBRATION: &[Key] = &[
    Key::number("gamma", Allowed::NOT_NEGATIVE, "Relative acceleration Gamma = A (2 pi f)^2 / g")
        .or(&["amplitude"]),
    Key::number("amplitude", Allowed::NOT_NEGATIVE, "Amplitude A of the plate")
        .unit("length")
        .or(&["gamma"]),
    Key::number("frequency", Allowed::POSITIVE, "Frequency f of the plate").unit("1/time"),
];

const HAMAKER_CONSTANT: Key =
    Key::new("hamaker_constant", NOT_NEGATIVE_SCHEDULE, "Hamaker constant A")
        .unit("energy")
        .or(&["bond_number"])
        .mixed(Mixing::Geometric);
const WALL_HAMAKER_CONSTANT: Key = Key::new(
    "wall_hamaker_constant",
    NOT_NEGATIVE_SCHEDULE,
    "Hamaker constant A_w of a particle and a wall",
)
.unit("energy")
.or(&["wall_bond_number"])
.mixed(Mixing::OfBody);
const CUT_OFF: Key =
    Key::number("cut_off", Allowed::POSITIVE, "Separation delta below which the force is constant")
        .unit("length");
const ASPERITY_RADIUS: Key =
    Key::number("asperity_radius", Allowed::POSITIVE, "Radius a of the asperities").unit("length");
const FORCE: Key =
    Key::new("force", NOT_NEGATIVE_SCHEDULE, "Force of two particles of the reference diameter")
        .unit("force")
        .or(&["bond_number"])
        .mixed(Mixing::Geometric);
const WALL_FORCE: Key =
    Key::new("wall_force", NOT_NEGATIVE_SCHEDULE, "Force of such a particle and a wall")
        .unit("force")
        .or(&["wall_bond_number"])
        .mixed(Mixing::OfBody);

const EXPRESSIONS: &[Word] = &[
    Word::with("near_contact", "the limit of small separations", SMOOTH),
    Word::with("full", "Hamaker's expression for spheres at any separation", SMOOTH),
    Word::with(
        "rough",
        "that limit for spheres with asperities (Rumpf)",
        &[HAMAKER_CONSTANT, WALL_HAMAKER_CONSTANT, CUT_OFF, ASPERITY_RADIUS],
    ),
    Word::with("square", "constant up to `range` (Liu et al. 2018)", &[FORCE, WALL_FORCE]),
];
const SMOOTH: &[Key] = &[HAMAKER_CONSTANT, WALL_HAMAKER_CONSTANT, CUT_OFF];

/// `[cohesion]`.
pub(in crate::case) const COHESION: &[Key] = &[
    Key::new(
        "bond_number",
        NOT_NEGATIVE_SCHEDULE,
        "Bo, the largest force over the weight at the reference diameter: A = 12 delta^2 Bo m g / r",
    )
    .or(&["hamaker_constant", "force"])
    .mixed(Mixing::Geometric),
    Key::new(
        "wall_bond_number",
        NOT_NEGATIVE_SCHEDULE,
        "Bo_w of a particle and a wall: A_w = 6 delta^2 Bo_w m g / r",
    )
    .or(&["wall_hamaker_constant", "wall_force"])
    .mixed(Mixing::OfBody),
    Key::number(
        "range",
        Allowed::POSITIVE,
        "Separation beyond which the force is left out, at least `cut_off`",
    )
    .unit("length"),
    Key::word("expression", EXPRESSIONS, "Force over separation"),
];

pub(super) const GRAVITY_CHAPTER: Chapter =
    Chapter { path: "gravity", title: "", keys: GRAVITY, before: "", after: "" };

pub(super) const VIBRATION_CHAPTER: Chapter = Chapter {
    path: "vibration",
    title: "",
    keys: VIBRATION,
    before: "\
The frame of reference moves with the plate: g_eff = g [1 + Gamma sin(2 pi f (t - t0))], where t0 is the start of the
stage that sets `frequency`.",
    after: "",
};

pub(super) const COHESION_CHAPTER: Chapter = Chapter {
    path: "cohesion",
    title: "van der Waals attraction",
    keys: COHESION,
    before: "",
    after: "\
With r = 2 r_1 r_2 / (r_1 + r_2) for two particles, and the radius of the particle at a wall, the force at a separation s is
A r / (12 s^2) and A_w r / (6 s^2) (`near_contact`), Hamaker's (`full`), or these times a / (a + r) + (s / (s + a))^2, where
an asperity of radius a stands between the surfaces (`rough`); from `cut_off` inwards, and in contact, it is that at
`cut_off`. A `square` force is the same at all separations up to `range`, in proportion to r. Bond numbers are those of the
force that acts: of the rough particles, if they are rough; but with `contact.softening = \"keeps_work\"` they are those of
the real particles, and those of the run are smaller.",
};
