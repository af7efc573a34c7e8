//! The strict reader of the files that users write, cases and studies alike.
//!
//! A text becomes a tree of values that know their lines (`tree`). A `Section` checks a part of it against a table of keys
//! (`schema`) and is then read key by key. All errors are reported at once, each with file, line, key, value and what is
//! allowed. `reference` shows the same tables to people and to editors.

mod allowed_values;
mod errors;
mod places;
mod reference;
mod section;
mod suggestion;
mod tree;
mod wall_time;

pub use allowed_values::rounded;
pub use errors::{InputError, InputErrors, Problems, SourcePlace};
pub use places::Places;
pub use reference::{Chapter, FileKeys, UnknownSection};
pub use section::Section;
pub use suggestion::{advice, nearest};
pub use tree::{NOT_UTF8, Node, Value, read_text, utf8_text};
