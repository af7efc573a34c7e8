//! `[time]` and `[[stage]]`.

use super::{COHESION, CONTACT, Chapter, GAS, GRAVITY, VIBRATION, merged, switched};
use talcum_engine::schema::{Allowed, Key, Kind};

/// `[time]`.
pub(in crate::case) const TIME: &[Key] = &[
    Key::number(
        "step",
        Allowed::POSITIVE,
        "Length of a time step, below the duration of a contact; `check` warns below 12 steps per contact",
    )
    .unit("time"),
    Key::number("end", Allowed::POSITIVE, "End of the run, at least `step`; refused with stages")
        .unit("time")
        .required_when("there are no stages"),
];

/// `[[stage]]`.
pub(in crate::case) const STAGE: &[Key] = &[
    Key::new("name", Kind::Text, "Name of the stage in results, different for each stage"),
    Key::number("duration", Allowed::POSITIVE, "How long it lasts, at least `time.step`")
        .unit("time"),
    Key::new("gravity", merged("gravity", GRAVITY), "Changes `[gravity]`").optional(),
    Key::new("vibration", switched("vibration", VIBRATION), "Changes `[vibration]`").optional(),
    Key::new("contact", merged("contact", CONTACT), "Changes `[contact]` and `[contact.wall]`")
        .optional(),
    Key::new("cohesion", switched("cohesion", COHESION), "Changes `[cohesion]`").optional(),
    Key::new("gas", switched("gas", GAS), "Changes `[gas]`").optional(),
];

pub(super) const CHAPTER: Chapter =
    Chapter { path: "time", title: "", keys: TIME, before: "", after: "" };

pub(super) const STAGE_CHAPTER: Chapter = Chapter {
    path: "stage",
    title: "the stages of the run, one after another",
    keys: STAGE,
    before: "\
Sections `[stage.gravity]`, `[stage.vibration]`, `[stage.contact]` (with `[stage.contact.wall]`), `[stage.cohesion]` and
`[stage.gas]` take any of the keys of the section of that name. A value stays until a later stage changes it. A key takes
the place of the one that it excludes. A new `law`, `drag`, `rolling`, `twisting` or `kind` removes the keys that only the old one
has.",
    after: "\
`vibration = \"off\"`, `cohesion = \"off\"` or `gas = \"off\"` switches the section off; `\"on\"`, or a section with keys,
switches it on again with the keys as they stand.",
};
