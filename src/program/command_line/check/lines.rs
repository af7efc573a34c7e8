//! Lines of the output of `check`.

use std::fmt::Write;

/// Lines that consist of a name and a value.
pub(super) struct Lines<'a>(pub(super) &'a mut String);

impl Lines<'_> {
    pub(super) fn add(&mut self, name: &str, value: &str) {
        let _ = writeln!(self.0, "  {name:<33} {value}");
    }

    pub(super) fn warn(&mut self, message: &str) {
        self.add("warning", message);
    }
}
