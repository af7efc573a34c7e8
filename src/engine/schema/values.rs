//! The interface by which a table of keys is read.

/// The values of the keys of a table. A value that is missing or wrong has been reported, and is `None`.
pub trait KeyValues {
    /// A number, or its default.
    fn number(&self, key: &str) -> Option<f64>;

    /// A chosen word, or its default.
    fn word(&self, key: &str) -> Option<&str>;

    /// Whether a key is given.
    fn is_given(&self, key: &str) -> bool;

    /// The one of several keys that is given; `None` if none is given, or more than one.
    fn given(&self, keys: &[&'static str]) -> Option<&'static str> {
        let mut given = keys.iter().copied().filter(|key| self.is_given(key));
        let first = given.next();
        first.filter(|_| given.next().is_none())
    }
}
