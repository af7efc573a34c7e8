//! `[[species]]` and `[[pair]]`.

use super::contact::AT_WALL;
use super::forces::COHESION;
use super::{Chapter, merged};
use talcum_engine::schema::{Allowed, Key, Kind};

/// `[[species]]`.
pub(in crate::case) const SPECIES: &[Key] = &[
    Key::new("name", Kind::Text, "What classes, files and pairs call the species"),
    Key::number("density", Allowed::POSITIVE, "Solid density")
        .unit("mass/volume")
        .optionally("that of `[particles]`"),
    Key::new(
        "contact",
        merged("contact.wall", AT_WALL),
        "Keys of `[contact]` that differ between two particles of this species",
    )
    .optional(),
    Key::new(
        "wall",
        merged("contact.wall", AT_WALL),
        "Keys of `[contact]` that differ between such a particle and walls",
    )
    .optional(),
    Key::new(
        "cohesion",
        merged("cohesion", COHESION),
        "Keys of `[cohesion]` that differ for two particles of this species, and for one at walls",
    )
    .optional(),
];

/// `[[pair]]`.
pub(in crate::case) const PAIR: &[Key] = &[
    Key::new("species", Kind::Texts, "Names of two different species"),
    Key::new(
        "contact",
        merged("contact.wall", AT_WALL),
        "Keys of `[contact]` between the two, in place of what mixing gives",
    )
    .optional(),
    Key::new(
        "cohesion",
        merged("cohesion", COHESION),
        "Keys of `[cohesion]` for the two, in place of what mixing gives",
    )
    .optional(),
];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "species",
    title: "several materials in one bed",
    keys: SPECIES,
    before: "\
A bed may be a mixture of species: particles of other materials, which differ in density and in what acts when they touch
or attract each other and walls.",
    after: "\
Without `[[species]]` all particles are of one. With it, `particles.diameter.species` says of which species each class of
size is, or the column `species` of a file of particles. `[contact]` and `[cohesion]` hold for all species, and stages may
change them; what a species or a pair says for itself stays in all stages. The law of contact, the kinds of rolling and
twisting friction and the expression of the attraction are the same for all.

What two different species do to each other follows from the values of each, unless a `[[pair]]` says otherwise:

| keys | value of the pair |
| --- | --- |
| `restitution`, `friction`, `rolling_friction`, `twisting_friction` | geometric mean, sqrt(a b): no theory, but 0 stays 0 (as in LAMMPS) |
| `adhesion`, `adhesion_over_weight`, `surface_energy`, `hamaker_constant`, `force` | geometric mean (Hamaker constants and works of adhesion: Israelachvili, Intermolecular and Surface Forces, 3rd ed. 2011, section 13.9; Good and Girifalco 1960) |
| `normal_stiffness`, `tangential_stiffness`, `loading_stiffness`, `unloading_stiffness`, `adhesion_stiffness` | 2 a b / (a + b), springs in series |
| `young_modulus`, `poisson_ratio` of the elastic laws | the law takes those of both bodies |
| all others, and values that change with time | must be equal, or be given in a `[[pair]]` |

`talcum check` prints what every pair comes to.",
};

pub(super) const PAIR_CHAPTER: Chapter = Chapter {
    path: "pair",
    title: "what two different species do to each other",
    keys: PAIR,
    before: "",
    after: "Every pair of species is named once at most; pairs that are not named follow from the rules above.",
};
