//! `[gravity]`, `[vibration]` and `[cohesion]`.

use super::Chapter;
use crate::schema::{Allowed, Key, NOT_NEGATIVE_SCHEDULE, Word};

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

const EXPRESSIONS: &[Word] = &[
    Word::new("near_contact", "the limit of small separations"),
    Word::new("full", "Hamaker's expression for spheres at any separation"),
];

/// `[cohesion]`.
pub(in crate::case) const COHESION: &[Key] = &[
    Key::new(
        "bond_number",
        NOT_NEGATIVE_SCHEDULE,
        "Bo, the largest force over the weight at the reference diameter: A = 12 delta^2 Bo m g / r",
    )
    .or(&["hamaker_constant"]),
    Key::new("hamaker_constant", NOT_NEGATIVE_SCHEDULE, "Hamaker constant A")
        .unit("energy")
        .or(&["bond_number"]),
    Key::new(
        "wall_bond_number",
        NOT_NEGATIVE_SCHEDULE,
        "Bo_w of a particle and a wall: A_w = 6 delta^2 Bo_w m g / r",
    )
    .or(&["wall_hamaker_constant"]),
    Key::new(
        "wall_hamaker_constant",
        NOT_NEGATIVE_SCHEDULE,
        "Hamaker constant A_w of a particle and a wall",
    )
    .unit("energy")
    .or(&["wall_bond_number"]),
    Key::number("cut_off", Allowed::POSITIVE, "Separation delta below which the force is constant")
        .unit("length"),
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
    after: "",
};
