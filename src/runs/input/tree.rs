//! A file as a tree of values that know their line and their path.

use super::errors::{InputError, InputErrors, Problems, SourcePlace};
use std::fmt;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it is.
    pub value: Value,
    /// Where its key stands.
    pub place: SourcePlace,
    /// Path of keys; members of a list by number from 1, as in `stage.2.gas.viscosity`.
    pub path: String,
    /// Where the value itself stands in the text that was parsed, in bytes.
    pub span: Range<usize>,
    /// Number of the stage that sets it; 0 for the base of the file too.
    pub stage: usize,
}

/// What may stand in a file.
#[derive(Clone, Debug)]
pub enum Value {
    /// A text in quotes, or a date, which no key accepts.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// Any other number.
    Number(f64),
    /// True or false.
    Boolean(bool),
    /// A list.
    List(Vec<Node>),
    /// A section or an inline table.
    Table(Vec<(String, Node)>),
}

/// Line and column, from 1, of a position in a text.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..offset.min(text.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
    (line, column)
}

/// What is wrong with a file of other bytes.
pub const NOT_UTF8: &str = "is not a text in UTF-8";

/// The text of a file; an error is the first line, from 1, that is no text.
pub fn utf8_text(bytes: Vec<u8>) -> Result<String, usize> {
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        good.iter().filter(|&&byte| byte == b'\n').count() + 1
    })
}

/// The text of a file.
///
/// # Errors
/// If it cannot be read, or is no text.
pub fn read_text(path: &Path) -> Result<String, InputErrors> {
    let error = |place, reason: String| {
        let problems = Problems::default();
        problems.add_at(place, reason);
        problems.into_errors(&path.display().to_string())
    };
    let bytes = std::fs::read(path)
        .map_err(|reason| error(SourcePlace::File, format!("cannot be read: {reason}")))?;
    utf8_text(bytes).map_err(|line| error(SourcePlace::Line(line), NOT_UTF8.to_owned()))
}

/// The line, from 1, in which most brackets are open or most dots join a key.
fn most_nested_line(text: &str) -> usize {
    let mut open = 0_usize;
    let depths = text.lines().map(|line| {
        let mut deepest = open.max(line.matches('.').count());
        for byte in line.bytes() {
            match byte {
                b'[' | b'{' => open += 1,
                b']' | b'}' => open = open.saturating_sub(1),
                _ => {}
            }
            deepest = deepest.max(open);
        }
        deepest
    });
    let depths: Vec<usize> = depths.collect();
    let most = depths.iter().copied().max().unwrap_or(0);
    1 + depths.iter().position(|&depth| depth == most).unwrap_or(0)
}

impl Node {
    /// The tree of a text; errors of syntax go to `problems`, all of them.
    pub fn parse(text: &str, problems: &Problems) -> Option<Self> {
        let (root, errors) = DeTable::parse_recoverable(text);
        for error in &errors {
            let place = match error.span() {
                Some(span) => {
                    let (line, column) = line_and_column(text, span.start);
                    SourcePlace::Column(line, column)
                }
                // Only the limit of nesting is reported without a place.
                None => SourcePlace::Line(most_nested_line(text)),
            };
            problems.add_at(place, format!("not valid TOML: {}", error.message()));
        }
        if !errors.is_empty() {
            return None;
        }
        let lines = Lines::of(text);
        let value = table(root.get_ref(), "", &lines);
        Some(Self { value, span: 0..text.len(), ..Self::EMPTY })
    }

    /// A table without entries, for a section that the file leaves out.
    pub const EMPTY: Self = Self {
        value: Value::Table(Vec::new()),
        place: SourcePlace::File,
        path: String::new(),
        span: 0..0,
        stage: 0,
    };

    /// A member of a table.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|(name, _)| name == key).map(|(_, n)| n),
            _ => None,
        }
    }

    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number, if it is one.
    pub fn as_number(&self) -> Option<f64> {
        match &self.value {
            Value::Integer(number) => Some(*number as f64),
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The whole number, if it is one and not negative.
    pub fn as_count(&self) -> Option<u64> {
        match &self.value {
            Value::Integer(number) => u64::try_from(*number).ok(),
            _ => None,
        }
    }

    /// True or false, if it is one of them.
    pub fn as_boolean(&self) -> Option<bool> {
        match &self.value {
            Value::Boolean(truth) => Some(*truth),
            _ => None,
        }
    }

    /// The members of a list, if it is one and each of them is of a kind.
    pub fn as_list<T>(&self, member: impl Fn(&Node) -> Option<T>) -> Option<Vec<T>> {
        match &self.value {
            Value::List(items) => items.iter().map(member).collect(),
            _ => None,
        }
    }

    /// The members of a table; none if it is none.
    pub fn entries(&self) -> &[(String, Node)] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The members of a list; none if it is none.
    pub fn items(&self) -> &[Node] {
        match &self.value {
            Value::List(items) => items,
            _ => &[],
        }
    }

    /// The value as it is written in the text that was parsed.
    pub fn written<'t>(&self, text: &'t str) -> &'t str {
        text.get(self.span.clone()).unwrap_or_default()
    }

    /// The line of its key, from 1; 0 if it stands at none.
    pub fn line(&self) -> usize {
        match self.place {
            SourcePlace::Line(line) | SourcePlace::Column(line, _) => line,
            SourcePlace::File | SourcePlace::Override(_) => 0,
        }
    }

    /// An error of this value.
    pub fn error(&self, message: impl Into<String>) -> InputError {
        let value = match &self.value {
            Value::Table(_) => None,
            _ => Some(self.to_string()),
        };
        InputError {
            place: self.place.clone(),
            key: self.path.clone(),
            value,
            message: message.into(),
        }
    }

    /// Applies a function to this node and to all below.
    pub fn for_each(&mut self, function: &mut dyn FnMut(&mut Node)) {
        function(self);
        match &mut self.value {
            Value::List(items) => items.iter_mut().for_each(|item| item.for_each(function)),
            Value::Table(entries) => {
                entries.iter_mut().for_each(|(_, node)| node.for_each(function));
            }
            _ => {}
        }
    }
}

impl fmt::Display for Node {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.value {
            Value::Text(text) => write!(formatter, "{text:?}"),
            Value::Integer(number) => write!(formatter, "{number}"),
            Value::Number(number) => write!(formatter, "{number:?}"),
            Value::Boolean(truth) => write!(formatter, "{truth}"),
            Value::List(items) => {
                let items: Vec<String> = items.iter().map(Node::to_string).collect();
                write!(formatter, "[{}]", items.join(", "))
            }
            Value::Table(entries) => {
                let entries: Vec<String> =
                    entries.iter().map(|(key, node)| format!("{key} = {node}")).collect();
                write!(formatter, "{{ {} }}", entries.join(", "))
            }
        }
    }
}

/// Start of each line of a text.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect())
    }

    fn line_of(&self, offset: usize) -> SourcePlace {
        SourcePlace::Line(self.0.partition_point(|&start| start <= offset))
    }
}

fn table(entries: &DeTable<'_>, path: &str, lines: &Lines) -> Value {
    let nodes = entries.iter().map(|(key, value)| {
        let name = key.get_ref().to_string();
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let start = key.span().start;
        (start, (name, node(value, path, lines.line_of(start), lines)))
    });
    let mut nodes: Vec<(usize, (String, Node))> = nodes.collect();
    nodes.sort_by_key(|(start, _)| *start);
    Value::Table(nodes.into_iter().map(|(_, entry)| entry).collect())
}

fn node(value: &Spanned<DeValue<'_>>, path: String, place: SourcePlace, lines: &Lines) -> Node {
    let span = value.span();
    let value = match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) => Value::Integer(number),
            Err(_) => Value::Number(integer.as_str().parse().unwrap_or(f64::NAN)),
        },
        DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(truth) => Value::Boolean(*truth),
        DeValue::Datetime(date) => Value::Text(date.to_string()),
        DeValue::Table(entries) => table(entries, &path, lines),
        DeValue::Array(items) => {
            let items = items.iter().enumerate().map(|(index, item)| {
                let place = lines.line_of(item.span().start);
                node(item, format!("{path}.{}", index + 1), place, lines)
            });
            Value::List(items.collect())
        }
    };
    Node { value, place, path, span, stage: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_know_their_lines() {
        let text = "a = 1\n\n[box]\nlengths = [\n  1.0,\n  nan ]\n[[stage]]\nname = 'x'\n[stage.gas]\nb = 0x1_F\n[particles.start]\nc = true\n";
        let root = Node::parse(text, &Problems::default()).unwrap();
        let line = |node: Option<&Node>| node.unwrap().place.clone();
        assert_eq!(line(root.get("a")), SourcePlace::Line(1));
        assert_eq!(line(root.get("box")), SourcePlace::Line(3));
        let lengths = root.get("box").unwrap().get("lengths").unwrap();
        assert_eq!(lengths.place, SourcePlace::Line(4));
        assert_eq!(lengths.items()[1].place, SourcePlace::Line(6));
        let stage = &root.get("stage").unwrap().items()[0];
        assert_eq!(stage.place, SourcePlace::Line(7));
        let b = stage.get("gas").unwrap().get("b").unwrap();
        assert_eq!((b.place.clone(), b.path.as_str()), (SourcePlace::Line(10), "stage.1.gas.b"));
        assert_eq!(b.to_string(), "31");
        assert_eq!(line(root.get("particles").unwrap().get("start")), SourcePlace::Line(11));
    }

    #[test]
    fn all_errors_of_syntax_are_reported() {
        let problems = Problems::default();
        assert!(Node::parse("a = \nb = 1\nb = 2\n[c\n", &problems).is_none());
        let text = problems.into_errors("x.toml").to_string();
        assert!(text.contains("x.toml:1:5: not valid TOML"), "{text}");
        assert!(text.contains("x.toml:3:1: not valid TOML: duplicate key"), "{text}");
    }
}
