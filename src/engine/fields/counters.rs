//! Counters: numbers of a run that are known to all ranks.

/// The type of a counter.
macro_rules! counter_type {
    (Integer) => {
        u64
    };
    (Number) => {
        f64
    };
}
pub(crate) use counter_type;

/// Declares counters, one per line: `name: Integer or Number, Unit, "meaning";`. It makes the struct and its list
/// `COUNTERS`, by which checkpoints store them and `talcum info` prints them.
macro_rules! counters {
    (
        $(#[$outer:meta])*
        $visibility:vis struct $Counters:ident in $group:literal {
            $($counter:ident: $kind:ident, $unit:ident, $meaning:literal;)*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $visibility struct $Counters {
            $(#[doc = $meaning] pub $counter: $crate::fields::counter_type!($kind),)*
        }

        impl $Counters {
            /// All counters.
            pub const COUNTERS: &'static [$crate::fields::Counter<Self>] = &[$(
                $crate::fields::Counter {
                    place: [$group, stringify!($counter)],
                    unit: $crate::fields::Unit::$unit,
                    meaning: $meaning,
                    get: |counters| $crate::fields::CounterValue::$kind(counters.$counter),
                    set: |counters, value| {
                        if let $crate::fields::CounterValue::$kind(value) = value {
                            counters.$counter = value;
                        }
                    },
                }
            ),*];

            /// The bits of all counters.
            pub fn bits(&self) -> impl Iterator<Item = u64> + '_ {
                Self::COUNTERS.iter().map(|counter| match (counter.get)(self) {
                    $crate::fields::CounterValue::Integer(count) => count,
                    $crate::fields::CounterValue::Number(number) => number.to_bits(),
                })
            }
        }
    };
}
pub(crate) use counters;
