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

/// Keys of which each wall has one: its shape, or the face of the box in which it lies.
pub(in crate::case) const SHAPES: [&str; 10] =
    ["normal", "radius", "face", "rectangle", "disc", "cylinder", "cone", "sphere", "bend", "mesh"];

/// These keys without the one at a place.
const fn others(place: usize) -> [&'static str; 9] {
    let mut others = [""; 9];
    let mut k = 0;
    while k < 9 {
        others[k] = SHAPES[if k < place { k } else { k + 1 }];
        k += 1;
    }
    others
}

/// Keys that the wall of a face does not have.
const NOT_OF_FACES: &[&str] = &[
    "normal",
    "radius",
    "rectangle",
    "disc",
    "cylinder",
    "cone",
    "sphere",
    "bend",
    "mesh",
    "name",
];

/// Where an initial bed may lie.
const SIDE: Key = Key::word(
    "bed",
    &[
        Word::new("anywhere", "on both sides of the wall"),
        Word::new(
            "inside",
            "in the room that the wall surrounds, or in that of another wall with this word",
        ),
        Word::new("outside", "not in the room that the wall surrounds"),
    ],
    "Where the particles of an initial bed may lie",
)
.default(Value::Word("anywhere"));

const CENTRE: Key = point("centre", "Its middle");

/// A point in space.
const fn point(name: &'static str, meaning: &'static str) -> Key {
    Key::new(name, Kind::Vector(Allowed::FINITE, 3), meaning).unit("length")
}

/// A length above 0.
const fn length(name: &'static str, meaning: &'static str) -> Key {
    Key::number(name, Allowed::POSITIVE, meaning).unit("length")
}

const RECTANGLE: &[Key] = &[
    point("corner", "One corner"),
    point("first_edge", "Vector along one edge, from the corner to the next"),
    point("second_edge", "Vector along the other edge, perpendicular to the first"),
];

const DISC: &[Key] = &[
    CENTRE,
    Key::new("normal", Kind::Vector(Allowed::FINITE, 3), "Its normal, not all 0"),
    length("radius", "Its radius"),
    Key::number(
        "hole",
        Allowed::NOT_NEGATIVE,
        "Radius of a round hole in its middle, below `radius`",
    )
    .unit("length")
    .default(Value::Number(0.0)),
];

const CYLINDER: &[Key] = &[
    point("from", "Middle of one end"),
    point("to", "Middle of the other end"),
    length("radius", "Its radius"),
    SIDE,
];

const CONE: &[Key] = &[
    point("from", "Middle of one end"),
    point("to", "Middle of the other end"),
    Key::new(
        "radii",
        Kind::Vector(Allowed::NOT_NEGATIVE, 2),
        "Radii at `from` and at `to`; one of them may be 0, a tip",
    )
    .unit("length"),
    SIDE,
];

const SPHERE: &[Key] = &[CENTRE, length("radius", "Its radius"), SIDE];

const BEND: &[Key] = &[
    point("centre", "The point about which the pipe bends"),
    point("from", "Middle of the pipe where the bend begins"),
    Key::new(
        "onwards",
        Kind::Vector(Allowed::FINITE, 3),
        "Direction of the pipe where the bend begins, perpendicular to the line from `centre` to `from`",
    ),
    Key::number("angle", Allowed::POSITIVE, "Angle of the bend, at most 360").unit("degree"),
    length("radius", "Radius of the pipe, below the distance from `centre` to `from`"),
    SIDE,
];

const MESH: &[Key] = &[
    Key::new(
        "file",
        Kind::Text,
        "The file of its triangles, relative to the case file: `.stl`, of text or binary, or `.obj`",
    ),
    Key::number(
        "scale",
        Allowed::POSITIVE,
        "Factor from the lengths of the file to those of the case, such as 0.001 from millimetres to metres",
    )
    .default(Value::Number(1.0)),
    Key::new(
        "axis",
        Kind::Vector(Allowed::FINITE, 3),
        "Axis through the origin of the file about which the mesh is turned after it is scaled, not all 0",
    )
    .optionally("not turned"),
    Key::number("angle", Allowed::FINITE, "Angle by which it is turned, right-handed, in degrees")
        .unit("degree")
        .with("axis"),
    point("shift", "Where the origin of the file then lies").optionally("the origin of the box"),
    Key::number(
        "feature_angle",
        Allowed::NOT_NEGATIVE,
        "Bend of two triangles from which their edge counts as sharp, in degrees",
    )
    .unit("degree")
    .default(Value::Number(30.0)),
    Key::new(
        "checksum",
        Kind::Text,
        "BLAKE3 hash of the file, which the case in results and checkpoints has: a run does not continue with another mesh",
    )
    .optionally("that of the file"),
    SIDE,
];

const ROTATION: &[Key] = &[
    Key::number("speed", Allowed::FINITE, "Angular speed omega, in radians per time")
        .unit("1/time")
        .default(Value::Number(0.0)),
    Key::number(
        "ramp",
        Allowed::NOT_NEGATIVE,
        "Time T in which the speed rises linearly from 0 to `speed`",
    )
    .unit("time")
    .default(Value::Number(0.0)),
    Key::number(
        "amplitude",
        Allowed::FINITE,
        "Amplitude A of an oscillation of the angle, in degrees",
    )
    .unit("degree")
    .optionally("none"),
    Key::number("frequency", Allowed::POSITIVE, "Frequency f of the oscillation")
        .unit("1/time")
        .with("amplitude"),
    Key::new(
        "axis",
        Kind::Vector(Allowed::FINITE, 3),
        "Direction of the axis, not all 0; positive angles turn right-handed about it",
    )
    .optionally("the axis of a disc, cylinder or cone (from `from` to `to`)"),
    point("point", "A point of the axis").with("axis"),
    Key::number("start", Allowed::NOT_NEGATIVE, "When the rotation starts")
        .unit("time")
        .default(Value::Number(0.0)),
    Key::number("end", Allowed::POSITIVE, "When the rotation ends, after `start`")
        .unit("time")
        .optionally("never"),
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
    .or(const { &others(0) }),
    Key::new("point", Kind::Vector(Allowed::FINITE, 3), "A point on the plane")
        .unit("length")
        .with("normal"),
    Key::number(
        "radius",
        Allowed::POSITIVE,
        "Radius of a round column along z, with the particles inside",
    )
    .unit("length")
    .or(const { &others(1) }),
    Key::new("centre", Kind::Vector(Allowed::FINITE, 2), "x and y of the axis of a round column")
        .unit("length")
        .with("radius"),
    Key::word("face", FACE_NAMES, "The wall in this face of the box: the other keys are about it")
        .or(NOT_OF_FACES),
    Key::new("rectangle", Kind::Table(RECTANGLE), "A flat rectangle").or(const { &others(3) }),
    Key::new("disc", Kind::Table(DISC), "A disc, or a ring").or(const { &others(4) }),
    Key::new(
        "cylinder",
        Kind::Table(CYLINDER),
        "A cylinder of any axis between two ends, which are open",
    )
    .or(const { &others(5) }),
    Key::new("cone", Kind::Table(CONE), "A cone or a frustum between two ends, which are open")
        .or(const { &others(6) }),
    Key::new("sphere", Kind::Table(SPHERE), "A sphere").or(const { &others(7) }),
    Key::new("bend", Kind::Table(BEND), "The bend of a round pipe: a part of a torus")
        .or(const { &others(8) }),
    Key::new("mesh", Kind::Table(MESH), "Triangles from a file, in any shape")
        .or(const { &others(9) }),
    Key::new("rotation", Kind::Table(ROTATION), "Rotation about an axis").optionally("none"),
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
Each `[[wall]]` is a plane (`point` and `normal`), a round column (`centre` and `radius`), a surface of limited extent
(`rectangle`, `disc`, `cylinder`, `cone`, `sphere`, `bend`, `mesh`), or says more about the wall in a face of the box (`face`).",
    after: "\
A wall is displaced by v tau + A sin(2 pi f tau), where tau is the time since `start`: a function of time alone. Its
velocity acts on particles through dashpots and friction, in its plane too. The wall of a face moves in its plane or
inwards, never out of the box. One that moves to and fro along its normal is a `[[wall]]` of its own, with its point
inside the box. Walls are parallel to the axes along which the box is periodic. A round column needs faces along x and y
that are not periodic, `\"stop\"` for example. A volume-averaged gas flows in the round column alone, a gas of kind `\"column\"`
in no round column. With gas the walls of faces move in their planes only.

Surfaces of limited extent are thin: particles touch them from both sides and at their edges, and two of them make two
contacts where they meet. They lie where the box is not periodic, or reach through all of it. The angle of a rotation is
omega (tau - T / 2) + A sin(2 pi f tau); during the ramp, while tau < T, its first part is omega tau^2 / (2 T). A drum is a
`cylinder` with a `disc` at each end, which turn about their axis; nothing but the velocity of their surface changes then.
The axis of a rotation moves with the translation of the wall. Planes turn about their normals only. A volume-averaged gas
flows around none of them.

The triangles of a mesh that a particle touches make one contact, at the nearest point, if they are connected by edges
that bend by less than `feature_angle`; so a smooth surface acts as one wall, however fine its triangles. A convex edge
makes one contact, and a concave one that is sharper makes one contact on each side. `talcum check` reports whether the mesh is
closed, and its size.",
};

#[cfg(test)]
mod tests {
    use super::{FACE_NAMES, SHAPES, WALL};
    use talcum_engine::domain::BoxFace;

    #[test]
    fn each_shape_excludes_the_others() {
        for name in SHAPES {
            let key = WALL.iter().find(|key| key.name == name).unwrap();
            let all = SHAPES.into_iter().filter(|other| *other != name);
            assert!(all.clone().all(|other| key.partners.contains(&other)), "{name}");
            assert!(!key.partners.contains(&name), "{name}");
        }
    }

    #[test]
    fn faces_have_the_names_of_the_box() {
        let names: Vec<&str> = FACE_NAMES.iter().map(|face| face.name).collect();
        assert_eq!(names, BoxFace::NAMES);
    }
}
