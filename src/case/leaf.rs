//! Values of a case file through serde: a node is a deserialiser whose errors say what is allowed.

use super::tree::{Node, Value};
use serde::de::value::{MapDeserializer, SeqDeserializer};
use serde::de::{
    Deserializer, EnumAccess, Error, Expected, IntoDeserializer, Unexpected, VariantAccess, Visitor,
};
use serde::{Deserialize, forward_to_deserialize_any};
use std::fmt;

/// What a value must be, in words.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mismatch(pub(super) String);

impl Node {
    /// The value as a type.
    pub(super) fn to<'de, T: Deserialize<'de>>(&'de self) -> Result<T, Mismatch> {
        T::deserialize(self)
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for Mismatch {}

impl Error for Mismatch {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self(format!("must be {}", in_words(&expected.to_string())))
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Self {
        Self(format!("must be {}", in_words(&expected.to_string())))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self(must_be_one_of(variant, expected))
    }
}

/// What may stand instead of an unknown word.
pub(super) fn must_be_one_of(word: &str, expected: &[&str]) -> String {
    let list: Vec<String> = expected.iter().map(|name| format!("{name:?}")).collect();
    let hint = nearest(word, expected).map_or(String::new(), |n| format!("; did you mean {n:?}?"));
    format!("must be {}{hint}", list.join(" or "))
}

/// The candidate that differs least from a word, if any is near.
pub(super) fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&word.to_lowercase(), name);
    let begins = |name: &str| word.len() >= 3 && (name.starts_with(word) || word.starts_with(name));
    let best = candidates.iter().copied().min_by_key(|name| (!begins(name), distance(name)))?;
    let is_close = distance(best) <= 1 + best.len() / 4;
    (is_close || begins(best) || strsim::jaro_winkler(word, best) > 0.88).then_some(best)
}

/// What a value of this type must be, in words.
pub(super) fn words_for<'de, T: Deserialize<'de>>() -> String {
    T::deserialize(Nothing).err().map_or(String::new(), |mismatch| mismatch.0)
}

/// A value that is not there: every type refuses it and says what it wants.
struct Nothing;

impl<'de> Deserializer<'de> for Nothing {
    type Error = Mismatch;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        visitor.visit_unit()
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Mismatch> {
        Err(Mismatch(must_be_one_of("", variants)))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

fn in_words(expected: &str) -> String {
    match expected {
        "f64" => "a number".into(),
        "u8" | "u32" | "u64" | "usize" => "a whole number, not negative".into(),
        "a string" | "a borrowed string" => "a text in quotes".into(),
        "a boolean" => "true or false".into(),
        "an array of length 3" => "a list of 3 numbers".into(),
        "a sequence" => "a list".into(),
        other => other.into(),
    }
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = Mismatch;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        match &self.value {
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::Integer(number) => visitor.visit_i64(*number),
            Value::Number(number) => visitor.visit_f64(*number),
            Value::Boolean(truth) => visitor.visit_bool(*truth),
            Value::List(items) => {
                let mut members = SeqDeserializer::new(items.iter());
                let value = visitor.visit_seq(&mut members)?;
                members.end().map_err(|_| Mismatch("has too many members".into()))?;
                Ok(value)
            }
            Value::Table(entries) => {
                let entries = entries.iter().map(|(key, node)| (key.as_str(), node));
                visitor.visit_map(MapDeserializer::new(entries))
            }
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        match &self.value {
            Value::Text(text) => visitor.visit_enum(Word(text)),
            _ => Err(Mismatch(must_be_one_of("", variants))),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Mismatch> for &'de Node {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// A word that names the variant of an enum.
struct Word<'de>(&'de str);

impl<'de> EnumAccess<'de> for Word<'de> {
    type Error = Mismatch;
    type Variant = Self;

    fn variant_seed<S: serde::de::DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self), Mismatch> {
        let word: serde::de::value::BorrowedStrDeserializer<'de, Mismatch> =
            serde::de::value::BorrowedStrDeserializer::new(self.0);
        Ok((seed.deserialize(word)?, self))
    }
}

impl<'de> VariantAccess<'de> for Word<'de> {
    type Error = Mismatch;

    fn unit_variant(self) -> Result<(), Mismatch> {
        Ok(())
    }

    fn newtype_variant_seed<S: serde::de::DeserializeSeed<'de>>(
        self,
        _: S,
    ) -> Result<S::Value, Mismatch> {
        Err(Mismatch("must be a word".into()))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Mismatch> {
        Err(Mismatch("must be a word".into()))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Mismatch> {
        Err(Mismatch("must be a word".into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::errors::Problems;

    fn value(text: &str) -> Node {
        let root = Node::parse(&format!("x = {text}"), &Problems::default()).unwrap();
        root.get("x").unwrap().clone()
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(rename_all = "snake_case")]
    enum Drag {
        WenYu,
        WenYuCreeping,
    }

    #[test]
    fn values_become_types() {
        assert_eq!(value("3").to::<f64>(), Ok(3.0));
        assert_eq!(value("[1, 2.5, 3]").to::<[f64; 3]>(), Ok([1.0, 2.5, 3.0]));
        assert_eq!(value("'wen_yu'").to::<Drag>(), Ok(Drag::WenYu));
    }

    #[test]
    fn mismatches_say_what_is_allowed() {
        let words = |error: Result<(), Mismatch>| error.unwrap_err().0;
        assert_eq!(words(value("'a'").to::<f64>().map(drop)), "must be a number");
        assert_eq!(
            words(value("-1").to::<u64>().map(drop)),
            "must be a whole number, not negative"
        );
        assert_eq!(words(value("[1,2]").to::<[f64; 3]>().map(drop)), "must be a list of 3 numbers");
        assert_eq!(words(value("[1,2,3,4]").to::<[f64; 3]>().map(drop)), "has too many members");
        assert_eq!(words(value("{}").to::<String>().map(drop)), "must be a text in quotes");
        assert_eq!(
            words(value("'wenyu'").to::<Drag>().map(drop)),
            "must be \"wen_yu\" or \"wen_yu_creeping\"; did you mean \"wen_yu\"?"
        );
        assert_eq!(
            words(value("1").to::<Drag>().map(drop)),
            "must be \"wen_yu\" or \"wen_yu_creeping\""
        );
    }
}
