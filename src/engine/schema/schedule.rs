//! The keys of a number that changes with time.

use super::{Allowed, Key, Kind};

/// A number of any sign that may change with time.
pub const SIGNED_SCHEDULE: Kind = Kind::Schedule(Allowed::FINITE, &keys(Allowed::FINITE));

/// A number of at least 0 that may change with time.
pub const NOT_NEGATIVE_SCHEDULE: Kind =
    Kind::Schedule(Allowed::NOT_NEGATIVE, &keys(Allowed::NOT_NEGATIVE));

const fn keys(allowed: Allowed) -> [Key; 7] {
    [
        Key::number("from", allowed, "Value when the stage begins").or(&["values", "mean"]),
        Key::number("to", allowed, "Value when the stage ends; linear between").with("from"),
        Key::new("values", Kind::List(allowed), "Values, one after another; the last one stays")
            .or(&["from", "mean"]),
        Key::number("every", Allowed::POSITIVE, "How long each value lasts")
            .unit("time")
            .with("values"),
        Key::number("mean", allowed, "Mean of a sine").or(&["from", "values"]),
        Key::number("amplitude", Allowed::FINITE, "Amplitude of the sine").with("mean"),
        Key::number("frequency", Allowed::POSITIVE, "Frequency of the sine")
            .unit("1/time")
            .with("mean"),
    ]
}
