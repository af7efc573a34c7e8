//! The contact laws: their names, and the keys of each.

use crate::schema::{Allowed, Key, Value, Word};

/// All contact laws.
pub(super) const LAWS: &[Word] = &[
    Word::with(
        "linear_spring_dashpot",
        "linear springs and dashpots (Moon 2006)",
        LINEAR_SPRING_DASHPOT,
    ),
    Word::with(
        "adhesive_elastic_plastic",
        "hysteretic springs with a constant adhesion (Liu 2016)",
        ADHESIVE_ELASTIC_PLASTIC,
    ),
    Word::with(
        "linear_hysteretic",
        "hysteretic springs whose adhesion grows with the overlap (Luding 2008)",
        LINEAR_HYSTERETIC,
    ),
    Word::with("hertz_mindlin", "elastic spheres", HERTZ_MINDLIN),
    Word::with("jkr", "elastic spheres with surface energy", JKR),
];

const LINEAR_SPRING_DASHPOT: &[Key] = &[
    Key::number("normal_stiffness", Allowed::POSITIVE, "Stiffness k_n of the normal spring")
        .unit("force/length"),
    Key::number(
        "tangential_stiffness",
        Allowed::NOT_NEGATIVE,
        "Stiffness k_t of the tangential spring",
    )
    .unit("force/length")
    .or(&["poisson_ratio"]),
    Key::number(
        "poisson_ratio",
        Allowed::between(0.0, 0.5),
        "Poisson's ratio nu, which gives k_t = 2 k_n (1 - nu) / (2 - nu)",
    )
    .or(&["tangential_stiffness"]),
    Key::word("friction_cap", CAPS, "Normal force that limits friction")
        .printed(Value::Word("contact"), "without cohesion the same as \"net\"")
        .required_when("[cohesion] is on"),
];

const CAPS: &[Word] = &[
    Word::new("contact", "that of spring and dashpot"),
    Word::new("net", "that of spring and dashpot, less cohesion"),
];

const UNLOADING_STIFFNESS: Key =
    Key::number("unloading_stiffness", Allowed::POSITIVE, "Stiffness k_unload (k_2) of unloading")
        .unit("force/length");
const LOADING_STIFFNESS: Key = Key::number(
    "loading_stiffness",
    Allowed::POSITIVE,
    "Stiffness k_load (k_1) of first loading, at most `unloading_stiffness`",
)
.unit("force/length")
.or(&["plasticity_index"]);
const PLASTICITY_INDEX: Key = Key::number(
    "plasticity_index",
    Allowed::from_to_below(0.0, 1.0),
    "Plasticity index psi_p = 1 - k_load / k_unload",
)
.or(&["loading_stiffness"]);
const TANGENTIAL_STIFFNESS: Key = Key::number(
    "tangential_stiffness",
    Allowed::NOT_NEGATIVE,
    "Stiffness k_t of the tangential spring",
)
.unit("force/length")
.printed(Value::Derived("2/7 of the loading stiffness"), "");

const ADHESIVE_ELASTIC_PLASTIC: &[Key] = &[
    UNLOADING_STIFFNESS,
    LOADING_STIFFNESS,
    PLASTICITY_INDEX,
    TANGENTIAL_STIFFNESS,
    Key::number("adhesion", Allowed::NOT_NEGATIVE, "Adhesion F0 in contact, for particles of all sizes")
        .unit("force")
        .or(&["bond_number"]),
    Key::number(
        "bond_number",
        Allowed::NOT_NEGATIVE,
        "F0 over the weight at the reference diameter",
    )
    .or(&["adhesion"]),
    Key::number(
        "primary_diameter",
        Allowed::NOT_NEGATIVE,
        "Diameter d_NP of the primary particles; up to F0 / k_unload (0, for example) adhesion has no limit",
    )
    .unit("length")
    .printed(Value::Derived("20 nm"), "")
    .required_when("units are dimensionless"),
];

const LINEAR_HYSTERETIC: &[Key] = &[
    UNLOADING_STIFFNESS,
    LOADING_STIFFNESS,
    PLASTICITY_INDEX,
    TANGENTIAL_STIFFNESS,
    Key::number("adhesion_stiffness", Allowed::NOT_NEGATIVE, "Stiffness k_c of adhesion")
        .unit("force/length"),
];

const YOUNG_MODULUS: Key = Key::number(
    "young_modulus",
    Allowed::POSITIVE,
    "Young's modulus E; at a wall that of the wall, 1e30 for a rigid one",
)
.unit("stress");
const POISSON_RATIO: Key = Key::number(
    "poisson_ratio",
    Allowed::between(0.0, 0.5),
    "Poisson's ratio nu; at a wall that of the wall",
);

const HERTZ_MINDLIN: &[Key] = &[YOUNG_MODULUS, POISSON_RATIO];

const JKR: &[Key] = &[
    YOUNG_MODULUS,
    POISSON_RATIO,
    Key::number(
        "surface_energy",
        Allowed::POSITIVE,
        "Surface energy gamma of each body, half the work of adhesion: the pull-off force is F_c = 3 pi gamma R*",
    )
    .unit("energy/area"),
];

#[cfg(test)]
mod tests {
    use super::LAWS;
    use crate::contact::ContactLaw;

    #[test]
    fn the_tables_are_those_of_the_registered_laws() {
        let names: Vec<&str> = LAWS.iter().map(|law| law.name).collect();
        assert_eq!(names, ContactLaw::NAMES);
    }
}
