//! `[contact]` and `[contact.wall]`: the keys of every law.

use super::{Chapter, merged};
use talcum_engine::contact::{ContactLaw, FRICTION, RESTITUTION, ROLLING, SOFTENING, TWISTING};
use talcum_engine::schema::{Key, Value};

const LAW: Key = Key::word("law", ContactLaw::WORDS, "Contact law");
const ROLLING_KIND: Key =
    Key::word("rolling", ROLLING, "Rolling friction").default(Value::Word("none"));

const TWISTING_KIND: Key =
    Key::word("twisting", TWISTING, "Resistance to twisting, the relative spin about the normal")
        .default(Value::Word("none"));

/// `[contact.wall]`, and `contact` of a `[[wall]]`.
pub(in crate::case) const AT_WALL: &[Key] =
    &[LAW, RESTITUTION, FRICTION, ROLLING_KIND, TWISTING_KIND, SOFTENING];

/// `[contact]`.
pub(in crate::case) const CONTACT: &[Key] = &[
    LAW,
    RESTITUTION,
    FRICTION,
    ROLLING_KIND,
    TWISTING_KIND,
    SOFTENING,
    Key::new("wall", merged("contact.wall", AT_WALL), "What differs at walls").optional(),
];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "contact",
    title: "",
    keys: CONTACT,
    before: "",
    after: "\
Sliding friction is limited by mu times a normal force: in `linear_spring_dashpot` and `adhesive_elastic_plastic` the one that
`friction_cap` names (in the second |F_n + F0| or |F_n|), in `linear_hysteretic` |F_n + k_c delta|, in `hertz_mindlin` |F_n|, in `jkr`
|F_n + 2 F_c|.

`adhesive_elastic_plastic` and `jkr` bring their own adhesion and cannot stand beside `[cohesion]`. `check` prints the
duration of a contact and the number of time steps in it: pi sqrt(m*/k_unload) for the hysteretic laws; for the elastic
ones, whose contacts last longer the slower the impact is, that of an impact with an overlap of 1 % of the diameter.

**Softened particles.** Springs are mostly softer than the particles are, so that time steps can be longer. A soft spring
stores energy under an adhesive force F0, which parting the particles takes on top of the work of the attraction: F0^2 / (2
k_n) on top of 2 F0 `cut_off` in `linear_spring_dashpot` with `[cohesion]`. `check` prints this part, and warns above 0.1 of
the rest. `softening` states how much stiffer the real particles are (`stiffness_reduction`, Lambda). With `keeps_force` the
adhesion is the one given, and `check` compares the work of separation with that of the real particles. With `keeps_work` the
given adhesion is that of the real particles, and the run scales it so that the work stays: forces (F0, the attraction of
`[cohesion]`, the surface energy) by Lambda^(-1/2), in `hertz_mindlin` and `jkr` by Lambda^(-2/5); lengths over which they
act by the inverse, `cut_off` so that the work within `range` stays. Impacts of two particles then end as those of the real
ones do, at the same speed; but the largest force, and with it the Bond number, is smaller. A bed at rest feels the force,
an impact the work: no softened particle keeps both. Adhesion that is given as a stiffness (`adhesion_stiffness`) stays as
it is: it is that of the softened contact. `[cohesion]` follows the softening of `[contact]`, at walls too.",
};

pub(super) const AT_WALL_CHAPTER: Chapter = Chapter {
    path: "contact.wall",
    title: "what differs at walls",
    keys: &[],
    before: "\
Walls take the keys of `[contact]`. Keys given here replace them at all walls, and those in `contact` of one `[[wall]]`
at that wall. If `law` is among them, no key is taken over, except that particles keep their own elastic constants. If
particles have adhesion (`adhesion` or `adhesion_over_weight`, `adhesion_stiffness`, `surface_energy`), either the adhesion at
walls or a law for them must be given.",
    after: "",
};
