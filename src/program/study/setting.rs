//! Values that a study gives to keys of its case.

use std::fmt;

/// The key of the case that seeds all random numbers.
pub(crate) const SEED: &str = "particles.seed";

/// One key of the case and its value, as in `--set KEY=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Setting {
    /// Path of the key in the case, for example `stage.ramp.gas.superficial_velocity`.
    pub(crate) key: String,
    /// Its value.
    pub(crate) value: Value,
    /// The line of the study file that contains it, from 1.
    pub(crate) line: usize,
}

impl Setting {
    /// The setting as an argument of `--set`.
    pub(crate) fn argument(&self) -> String {
        format!("{}={}", self.key, self.value)
    }
}

/// A value of TOML, as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Value {
    written: String,
    number: Option<f64>,
}

impl Value {
    /// A value from its text in TOML, and from its number if it is one.
    pub(crate) fn new(written: &str, number: Option<f64>) -> Self {
        Self { written: written.trim().to_owned(), number }
    }

    /// A text, in the quotes of TOML.
    pub(crate) fn from_text(text: String) -> Self {
        Self::new(&toml_edit::Value::from(text).to_string(), None)
    }

    /// A floating-point number, in the shortest text that reads back to the same bits.
    pub(crate) fn from_number(number: f64) -> Self {
        Self { written: format!("{number:?}"), number: Some(number) }
    }

    /// A whole number.
    pub(crate) fn from_count(count: u64) -> Self {
        Self { written: count.to_string(), number: Some(count as f64) }
    }

    /// The number, if it is one.
    pub(crate) fn number(&self) -> Option<f64> {
        self.number
    }

    /// Whether two values are equal: `4`, `4.0` and `4e0` are.
    pub(crate) fn same_as(&self, other: &Self) -> bool {
        match (self.number, other.number) {
            (Some(one), Some(two)) => one == two,
            _ => self.written == other.written,
        }
    }

    /// The value in tables: numbers in one form, texts without quotes.
    pub(crate) fn plain(&self) -> String {
        match self.number {
            // A seed may have more digits than a floating-point number holds.
            Some(_) if self.written.parse::<i64>().is_ok() => self.written.clone(),
            Some(number) => shortest(number),
            None => self.written.trim_matches('"').to_owned(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.written)
    }
}

/// The shortest text from which the same bits are read.
pub(crate) fn shortest(number: f64) -> String {
    let plain = number == 0.0 || (1.0e-4..1.0e15).contains(&number.abs());
    if plain { format!("{number}") } else { format!("{number:e}") }
}

/// The number with twelve digits: 0.1 + 2 * 0.1 is meant to be 0.3.
pub(crate) fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}
