//! The drag laws: their names, and the keys of each.

use crate::schema::{Allowed, Key, Value, Word};

/// All drag laws.
pub(super) const LAWS: &[Word] = &[
    Word::with("wen_yu", "Wen and Yu", &[VOIDAGE_EXPONENT, DENSITY]),
    Word::with("wen_yu_creeping", "Wen and Yu for Re << 1", &[VOIDAGE_EXPONENT]),
    Word::with("ergun", "Ergun", &[DENSITY]),
    Word::with(
        "gidaspow",
        "Ergun in dense regions, Wen and Yu in dilute ones",
        &[
            Key::word(
                "drag_switch",
                SWITCHES,
                "From Ergun to Wen and Yu at a solids fraction of 0.2",
            ),
            DENSITY,
        ],
    ),
    Word::with("beetstra", "Beetstra, van der Hoef and Kuipers", &[DENSITY]),
    Word::with("tenneti", "Tenneti, Garg and Subramaniam", &[DENSITY]),
    Word::with(
        "di_felice",
        "Di Felice",
        &[Key::word("single_sphere", SPHERES, "Drag coefficient of a single sphere"), DENSITY],
    ),
];

const VOIDAGE_EXPONENT: Key = Key::number(
    "voidage_exponent",
    Allowed::between(0.0, 10.0),
    "n in beta = (3/4) C_D rho_g abs(u_g - v) phi / d eps^-n; Liu 2016 prints 2.7",
)
.default(Value::Number(1.65));

const DENSITY: Key =
    Key::number("density", Allowed::POSITIVE, "Density of the gas").unit("mass/volume");

const SWITCHES: &[Word] =
    &[Word::new("sharp", "with a jump"), Word::new("smooth", "by an arctangent")];

const SPHERES: &[Word] =
    &[Word::new("dallavalle", "4 % below Stokes at small Re"), Word::new("schiller_naumann", "")];

#[cfg(test)]
mod tests {
    use super::LAWS;
    use crate::gas::DragLaw;

    #[test]
    fn the_tables_are_those_of_the_registered_laws() {
        let names: Vec<&str> = LAWS.iter().map(|law| law.name).collect();
        assert_eq!(names, DragLaw::NAMES);
    }
}
