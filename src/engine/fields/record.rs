//! Records: fields side by side in memory, in messages and in files.

use super::{Field, Parity};
use bytemuck::Pod;
use std::ops::Range;

/// A whole number by which records are identified and sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id {
    /// The name of its dataset.
    pub name: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
}

/// A record of 64-bit words: ids, then the numbers of its fields, one after another. It contains nothing else.
pub trait Record: Pod {
    /// The group of its datasets in a checkpoint.
    const GROUP: &'static str;
    /// The whole numbers at its beginning.
    const IDS: &'static [Id];
    /// The fields that follow.
    const FIELDS: &'static [Field];

    /// Each field with the place of its first word.
    fn places() -> impl Iterator<Item = (usize, &'static Field)> {
        let first = Self::IDS.len();
        Self::FIELDS.iter().scan(first, |next, field| {
            let place = *next;
            *next += field.width();
            Some((place, field))
        })
    }

    /// The ids, and the bits of the numbers.
    fn words(&self) -> &[u64] {
        bytemuck::cast_slice(std::slice::from_ref(self))
    }

    /// Mutable access to the words.
    fn words_mut(&mut self) -> &mut [u64] {
        bytemuck::cast_slice_mut(std::slice::from_mut(self))
    }
}

/// Fields that come together, from left to right: the model that brings them, and their range in the list.
pub fn groups(fields: &[Field]) -> impl Iterator<Item = (&'static str, Range<usize>)> + '_ {
    let mut first = 0;
    let chunks = fields.chunk_by(Field::comes_together_with);
    chunks.filter_map(move |group| {
        let range = first..first + group.len();
        first = range.end;
        Some((group[0].comes_with?, range))
    })
}

/// The numbers of a record's fields as they are seen from the other body of a contact.
pub(crate) fn seen_from_the_other_side(fields: &[Field], numbers: &mut [f64]) {
    let mut rest = numbers;
    for field in fields {
        let (of_field, others) = rest.split_at_mut(field.width());
        if field.parity == Parity::Odd {
            of_field.iter_mut().for_each(|number| *number = -*number);
        }
        rest = others;
    }
}

/// The type that holds the numbers of a kind.
macro_rules! words_of {
    (Number) => {
        f64
    };
    (Integer) => {
        f64
    };
    (Vector) => {
        [f64; 3]
    };
    (SymmetricTensor) => {
        [f64; 6]
    };
}
pub(crate) use words_of;

/// Declares a record: its ids, then one line per field, `name: Kind, Unit, "meaning" => attribute, ...;` with the
/// methods of [`Field`] as attributes. It makes the struct and its list `FIELDS`.
macro_rules! records {
    (
        $(#[$outer:meta])*
        $visibility:vis struct $Record:ident {
            $([$id:ident]: $id_meaning:literal;)*
            $($field:ident: $kind:ident, $unit:ident $(($symbol:literal))?, $meaning:literal
                $(=> $($attribute:ident $(($argument:expr))?),+)?;)*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        $visibility struct $Record {
            $(#[doc = $id_meaning] pub $id: u64,)*
            $(#[doc = $meaning] pub $field: $crate::fields::words_of!($kind),)*
        }

        impl $Record {
            /// The whole numbers at the beginning of the record.
            pub const IDS: &'static [$crate::fields::Id] =
                &[$($crate::fields::Id { name: stringify!($id), meaning: $id_meaning }),*];
            /// The fields that follow, in their order.
            pub const FIELDS: &'static [$crate::fields::Field] = &[$(
                $crate::fields::Field::new(
                    stringify!($field),
                    $crate::fields::Kind::$kind,
                    $crate::fields::Unit::$unit $(($symbol))?,
                    $meaning,
                )$($(.$attribute($($argument)?))+)?
            ),*];
        }
    };
}
pub(crate) use records;
