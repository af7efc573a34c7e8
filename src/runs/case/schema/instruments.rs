//! `[measure.NAME]`: instruments of the run. The kinds are those of the registry in `src/results/instruments`.

use super::Chapter;
use talcum_engine::schema::{Allowed, Key, Value};
use talcum_results::instruments::InstrumentKind;

/// `[measure.NAME]`.
pub(in crate::case) const MEASURE: &[Key] = &[
    Key::word("kind", InstrumentKind::WORDS, "The kind of the instrument"),
    Key::number(
        "every",
        Allowed::POSITIVE,
        "Interval between samples of the bed, at least `time.step`",
    )
    .unit("time"),
    Key::number("start", Allowed::NOT_NEGATIVE, "Time of the first sample; none is taken before")
        .unit("time")
        .default(Value::Number(0.0)),
];

pub(super) const CHAPTER: Chapter = Chapter {
    path: "measure",
    title: "instruments of the run",
    keys: MEASURE,
    before: "\
Each `[measure.NAME]` is an instrument. It writes `measure-NAME.h5`, and some kinds also write `measure-NAME.vtkhdf`; NAME is yours, of characters
`A` to `Z`, `a` to `z`, `0` to `9`, `_` and `-`. Instruments never change the run. [instruments.md](instruments.md) describes each kind, with its
formulas and its files.",
    after: "",
};
