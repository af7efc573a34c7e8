//! `[box]` and `[[wall]]`.

use super::contact::AT_WALL;
use super::{Chapter, merged};
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

/// Effect of a face of the box on particles.
const FACES: &[Word] = &[
    Word::new(
        "periodic",
        "what leaves here enters at the opposite face; of both faces, or of neither",
    ),
    Word::new("wall", "a plane wall"),
    Word::new("open", "particles leave and are counted"),
    Word::new("stop", "the run stops with an error message if a particle leaves"),
];

const SIDES: &[Key] = &[
    Key::word("lower", FACES, "The face at the origin"),
    Key::word("upper", FACES, "The face opposite"),
];

const BOTH: Kind = Kind::Either(&[Kind::Word(FACES), Kind::Table(SIDES)]);

/// `[box]`.
pub(in crate::case) const BOX: &[Key] = &[
    Key::new("lengths", Kind::Vector(Allowed::POSITIVE, 3), "Lengths of the edges").unit("length"),
    Key::new("x", BOTH, FACES_MEANING),
    Key::new("y", BOTH, FACES_MEANING),
    Key::new("z", BOTH, FACES_MEANING),
];

const FACES_MEANING: &str = "What the two faces across this axis do to particles";

/// Names of the faces.
const FACE_NAMES: &[Word] = &[
    Word::new("x lower", ""),
    Word::new("x upper", ""),
    Word::new("y lower", ""),
    Word::new("y upper", ""),
    Word::new("z lower", ""),
    Word::new("z upper", ""),
];

/// `[[wall]]`.
pub(in crate::case) const WALL: &[Key] = &[
    Key::new("name", Kind::Text, "Name of the wall in results, different for each wall")
        .or(&["face"]),
    Key::new(
        "normal",
        Kind::Vector(Allowed::FINITE, 3),
        "Normal of a plane, into the bed, not all 0; it is scaled to a unit vector",
    )
    .or(&["radius", "face"]),
    Key::new("point", Kind::Vector(Allowed::FINITE, 3), "A point on the plane")
        .unit("length")
        .with("normal"),
    Key::number(
        "radius",
        Allowed::POSITIVE,
        "Radius of a round column along z, with the particles inside",
    )
    .unit("length")
    .or(&["normal", "face"]),
    Key::new("centre", Kind::Vector(Allowed::FINITE, 2), "x and y of the axis of a round column")
        .unit("length")
        .with("radius"),
    Key::word("face", FACE_NAMES, "The wall in this face of the box: the other keys are about it")
        .or(&["normal", "radius", "name"]),
    Key::new("velocity", Kind::Vector(Allowed::FINITE, 3), "Velocity v of the motion")
        .unit("speed")
        .optionally("at rest"),
    Key::new(
        "amplitude",
        Kind::Vector(Allowed::FINITE, 3),
        "Amplitude A of the motion, along each axis",
    )
    .unit("length")
    .optionally("none"),
    Key::number("frequency", Allowed::POSITIVE, "Frequency f of the motion")
        .unit("1/time")
        .with("amplitude"),
    Key::number("start", Allowed::NOT_NEGATIVE, "When the motion starts")
        .unit("time")
        .default(Value::Number(0.0)),
    Key::number(
        "end",
        Allowed::POSITIVE,
        "When the motion ends, after `start`; from then on the wall stays where it is",
    )
    .unit("time")
    .optionally("never"),
    Key::new(
        "contact",
        merged("contact.wall", AT_WALL),
        "Keys of `[contact]` that differ at this wall, as in `{ friction = 0.5 }`",
    )
    .optional(),
];

pub(super) const BOX_CHAPTER: Chapter = Chapter {
    path: "box",
    title: "",
    keys: BOX,
    before: "\
The box reaches from the origin to `lengths`. Gravity points along -z.",
    after: "\
A periodic length must be at least twice the largest diameter with skin (0.08 if it is left out) and range of cohesion (or the reach of JKR
necks). The lower wall along z is the `base plate`; the others are called `x lower`, `x upper` and so on.",
};

pub(super) const WALL_CHAPTER: Chapter = Chapter {
    path: "wall",
    title: "further walls, and faces of the box that move or are of another material",
    keys: WALL,
    before: "\
Each `[[wall]]` is a plane (`point` and `normal`), a round column (`centre` and `radius`), or says more about the wall
in a face of the box (`face`).",
    after: "\
A wall is displaced by v tau + A sin(2 pi f tau), where tau is the time since `start`: a function of time alone. Its
velocity acts on particles through dashpots and friction, in its plane too. The wall of a face moves in its plane or
inwards, never out of the box. One that moves to and fro along its normal is a `[[wall]]` of its own, with its point
inside the box. Walls are parallel to the axes along which the box is periodic. A round column needs faces along x and y
that are not periodic, `\"stop\"` for example. A volume-averaged gas flows in the round column alone, a gas of kind `\"column\"`
in no round column. With gas the walls of faces move in their planes only.",
};

#[cfg(test)]
mod tests {
    use super::FACE_NAMES;
    use talcum_engine::domain::BoxFace;

    #[test]
    fn faces_have_the_names_of_the_box() {
        let names: Vec<&str> = FACE_NAMES.iter().map(|face| face.name).collect();
        assert_eq!(names, BoxFace::NAMES);
    }
}
