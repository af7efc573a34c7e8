//! `[contact]` and `[contact.wall]`: the keys of every law.

use super::{Chapter, merged};
use crate::contact::{ContactLaw, FRICTION, RESTITUTION, ROLLING};
use crate::schema::{Key, Value};

const LAW: Key = Key::word("law", ContactLaw::WORDS, "Contact law");
const ROLLING_KIND: Key =
    Key::word("rolling", ROLLING, "Rolling friction").default(Value::Word("none"));

/// `[contact.wall]`, and `contact` of a `[[wall]]`.
pub(in crate::case) const AT_WALL: &[Key] = &[LAW, RESTITUTION, FRICTION, ROLLING_KIND];

/// `[contact]`.
pub(in crate::case) const CONTACT: &[Key] = &[
    LAW,
    RESTITUTION,
    FRICTION,
    ROLLING_KIND,
    Key::new("wall", merged("contact.wall", AT_WALL), "What differs at walls").optional(),
];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "contact",
    title: "",
    keys: CONTACT,
    before: "",
    after: "\
Sliding friction is limited by mu times a normal force: in `linear_spring_dashpot` the one that `friction_cap` names, in
`adhesive_elastic_plastic` |F_n + F0|, in `linear_hysteretic` |F_n + k_c delta|, in `hertz_mindlin` |F_n|, in `jkr`
|F_n + 2 F_c|.

`adhesive_elastic_plastic` and `jkr` bring their own adhesion and cannot stand beside `[cohesion]`. `check` prints the
duration of a contact and the number of time steps in it: pi sqrt(m*/k_unload) for the hysteretic laws; for the elastic
ones, whose contacts last longer the slower the impact is, that of an impact with an overlap of 1 % of the diameter.",
};

pub(super) const AT_WALL_CHAPTER: Chapter = Chapter {
    path: "contact.wall",
    title: "what differs at walls",
    keys: &[],
    before: "\
Walls take the keys of `[contact]`. Keys given here replace them at all walls, and those in `contact` of one `[[wall]]`
at that wall. If `law` is among them, no key is taken over, except that particles keep their own elastic constants. If
particles have adhesion (`adhesion` or `bond_number`, `adhesion_stiffness`, `surface_energy`), either the adhesion at
walls or a law for them must be given.",
    after: "",
};
