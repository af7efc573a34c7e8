//! Quantities that particles, contacts, cells and a run carry from one step to the next, as plain data: each is
//! declared once.
//!
//! A [`Field`] is one line in a list: name, kind, unit, meaning, and where it is sent. This line determines its place
//! in the records that ranks send to each other, its dataset in checkpoints, its part of the digest, its history as
//! seen from the other body, its column in memory, and its entry in `talcum info` and docs/files.md. The macro
//! `records!` makes a record and its list; custom fields are added to the list of the particles when a run is set up.

mod column;
mod counters;
mod record;

pub use column::Column;
pub(crate) use counters::{counter_type, counters};
pub use record::{Id, Record, groups};
pub(crate) use record::{records, seen_from_the_other_side, words_of};

use std::fmt;

/// The components of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One number.
    Number,
    /// Three numbers, along x, y and z.
    Vector,
    /// Six numbers: xx, yy, zz, yz, xz, xy.
    SymmetricTensor,
    /// A whole number, which a double holds exactly.
    Integer,
}

/// The unit of a number, in the units of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// No unit.
    One,
    /// Time.
    Time,
    /// Length.
    Length,
    /// Length over time.
    Speed,
    /// Angle, in radians.
    Angle,
    /// Angle over time.
    AngularSpeed,
    /// An angle that is printed, in degrees in both systems of units.
    Degrees,
    /// Cycles over time.
    Frequency,
    /// Events over time.
    Rate,
    /// Area, or squared length.
    Area,
    /// Volume.
    Volume,
    /// Squared velocity, such as a granular temperature.
    SquaredSpeed,
    /// Squared length over time.
    Diffusivity,
    /// Mass.
    Mass,
    /// Mass over area and time.
    MassFlux,
    /// Force.
    Force,
    /// Force times length.
    Torque,
    /// Force over area.
    Pressure,
    /// Energy.
    Energy,
    /// A unit of this name in any case, such as `K`.
    Named(&'static str),
}

/// Where a quantity of a particle is known besides its owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// Nowhere.
    Stays,
    /// Ghosts receive it when they are made: for quantities that do not change.
    WithNewGhosts,
    /// Ghosts have its value at the beginning of each step.
    EachStep,
    /// Amounts added on ghosts are returned to their originals at each step, where they are summed exactly: they are
    /// multiples of one quantum.
    Returned,
}

/// How a quantity of a contact changes when it is seen from the other body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// It does not change.
    Even,
    /// Its sign changes.
    Odd,
}

/// A quantity that a particle, a contact or a cell carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// The name of its dataset, of its column in snapshots and of its place in the record.
    pub name: &'static str,
    /// Its components.
    pub kind: Kind,
    /// Its unit.
    pub unit: Unit,
    /// Its meaning, as files of results give it.
    pub meaning: &'static str,
    /// Where it is known besides its owner.
    pub travel: Travel,
    /// How it changes when it is seen from the other body of a contact.
    pub parity: Parity,
    /// The model that brings it, if not every run has it. It then takes no memory, no part of messages, no dataset and
    /// no part of the digest until one of its values, or of the fields that come with it, is not zero.
    pub comes_with: Option<&'static str>,
    /// Whether it is held in a column of its own rather than in the data that loops over pairs read.
    pub in_column: bool,
}

/// A number that a run counts, over all ranks together.
#[derive(Clone, Copy, Debug)]
pub struct Counter<C: 'static> {
    /// Group and name of its attribute in checkpoints.
    pub place: [&'static str; 2],
    /// Its unit.
    pub unit: Unit,
    /// Its meaning, as files of results and `talcum info` give it.
    pub meaning: &'static str,
    /// Its value.
    pub get: fn(&C) -> CounterValue,
    /// Sets it.
    pub set: fn(&mut C, CounterValue),
}

/// The value of a counter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CounterValue {
    /// A whole number.
    Integer(u64),
    /// A number.
    Number(f64),
}

impl fmt::Display for CounterValue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(count) => count.fmt(formatter),
            Self::Number(number) => number.fmt(formatter),
        }
    }
}

impl Kind {
    /// Number of its components.
    pub const fn width(self) -> usize {
        match self {
            Self::Number | Self::Integer => 1,
            Self::Vector => 3,
            Self::SymmetricTensor => 6,
        }
    }
}

impl Field {
    /// A quantity that every run has, and that stays with its owner.
    pub const fn new(name: &'static str, kind: Kind, unit: Unit, meaning: &'static str) -> Self {
        let (travel, parity) = (Travel::Stays, Parity::Even);
        Self { name, kind, unit, meaning, travel, parity, comes_with: None, in_column: false }
    }

    /// Gives it a column of its own, absent until `what` brings it.
    #[must_use]
    pub const fn column_of(mut self, what: &'static str) -> Self {
        (self.comes_with, self.in_column) = (Some(what), true);
        self
    }

    /// Makes the field absent until `what` brings it.
    #[must_use]
    pub const fn comes_with(mut self, what: &'static str) -> Self {
        self.comes_with = Some(what);
        self
    }

    /// Makes the field known elsewhere too.
    #[must_use]
    pub const fn travels(mut self, travel: Travel) -> Self {
        self.travel = travel;
        self
    }

    /// Makes the field change its sign when it is seen from the other body.
    #[must_use]
    pub const fn odd(mut self) -> Self {
        self.parity = Parity::Odd;
        self
    }

    /// Number of its components.
    pub const fn width(&self) -> usize {
        self.kind.width()
    }

    /// Whether this is its name.
    pub const fn has_name(&self, name: &str) -> bool {
        are_equal(self.name, name)
    }

    /// Whether both are brought by the same model.
    pub const fn comes_together_with(&self, other: &Self) -> bool {
        match (self.comes_with, other.comes_with) {
            (Some(one), Some(other)) => are_equal(one, other),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        }
    }
}

/// Whether two texts are equal; the operator cannot be used in constants.
const fn are_equal(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    if one.len() != other.len() {
        return false;
    }
    let mut byte = 0;
    while byte < one.len() {
        if one[byte] != other[byte] {
            return false;
        }
        byte += 1;
    }
    true
}
