//! Checks of values against their keys, and descriptions of the allowed values.

use super::suggestion::nearest;
use super::tree::{Node, Value};
use super::wall_time;
use talcum_engine::schema::{Allowed, Key, Kind, Word};

/// A number for people: 9 digits.
pub fn rounded(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// Checks a value, but not the contents of a table.
///
/// # Errors
/// A description of the allowed values: "must be ...".
pub(super) fn check(kind: &Kind, node: &Node) -> Result<(), String> {
    let must = || format!("must be {}", description(kind));
    match kind {
        Kind::Text => match node.as_text().ok_or_else(must)?.trim() {
            "" => Err("must not be empty".to_owned()),
            _ => Ok(()),
        },
        Kind::WallTime => node.as_text().and_then(wall_time::parse).map(|_| ()).ok_or_else(must),
        Kind::Boolean => node.as_boolean().map(|_| ()).ok_or_else(must),
        Kind::Number(allowed) | Kind::Schedule(allowed, _) => check_number(*allowed, kind, node),
        Kind::Count(least, most) => match node.as_count().ok_or_else(must)? {
            count if (*least..=*most).contains(&count) => Ok(()),
            _ => Err(format!("must be between {least} and {most}")),
        },
        Kind::Counts(least, most) => {
            let counts = node.as_list(Node::as_count).filter(|counts| counts.len() == 3);
            check_counts(&counts.ok_or_else(must)?, [*least, *most])
        }
        Kind::CountList(least, most) => {
            check_counts(&node.as_list(Node::as_count).ok_or_else(must)?, [*least, *most])
        }
        Kind::Vector(allowed, length) => check_numbers(*allowed, Some(*length), kind, node),
        Kind::Vectors(allowed, length) => check_vectors(&Kind::Vector(*allowed, *length), node),
        Kind::List(allowed) => check_numbers(*allowed, None, kind, node),
        Kind::Texts => check_texts(&words_of(node).ok_or_else(must)?),
        Kind::Values => {
            require_members(&node.as_list(|item| Some(item.span.start)).ok_or_else(must)?)
        }
        Kind::Word(words) => check_word(words, node.as_text().unwrap_or_default()),
        Kind::Words(words) => check_words(words, &words_of(node).ok_or_else(must)?),
        Kind::Table(_) | Kind::Settings => match &node.value {
            Value::Table(_) => Ok(()),
            _ => Err(format!("must be a section of keys, [{}] or {{ ... }}", node.path)),
        },
        Kind::Named(_) => match &node.value {
            Value::Table(_) => Ok(()),
            _ => Err(format!("must be sections of your own names, [{}.NAME]", node.path)),
        },
        Kind::Tables(_) => match &node.value {
            Value::List(items) if !items.is_empty() => Ok(()),
            _ => Err(format!("must be a list of sections, each [[{}]]", node.path)),
        },
        Kind::Merged(merged) => match (&node.value, node.as_text()) {
            (Value::Table(_), _) => Ok(()),
            (_, Some("off" | "on")) if merged.switched => Ok(()),
            _ => Err(must()),
        },
        Kind::Either(kinds) => match chosen(kinds, node) {
            Some(kind) => check(kind, node),
            None => Err(must()),
        },
    }
}

fn check_number(allowed: Allowed, kind: &Kind, node: &Node) -> Result<(), String> {
    if matches!((kind, &node.value), (Kind::Schedule(..), Value::Table(_))) {
        return Ok(());
    }
    let number = node.as_number().ok_or("must be a number")?;
    allowed.check(number).map_err(|range| format!("must be {range}"))
}

fn require_members<T>(members: &[T]) -> Result<(), String> {
    match members {
        [] => Err("must not be empty".to_owned()),
        _ => Ok(()),
    }
}

fn check_texts(texts: &[String]) -> Result<(), String> {
    require_members(texts)?;
    if texts.iter().any(|text| text.trim().is_empty()) {
        return Err("none may be empty".to_owned());
    }
    Ok(())
}

fn check_counts(counts: &[u64], [least, most]: [u64; 2]) -> Result<(), String> {
    require_members(counts)?;
    if counts.iter().all(|count| (least..=most).contains(count)) {
        Ok(())
    } else {
        Err(format!("each must be between {least} and {most}"))
    }
}

fn check_vectors(of: &Kind, node: &Node) -> Result<(), String> {
    require_members(node.items())?;
    node.items().iter().try_for_each(|item| check(of, item)).map_err(|must| format!("each {must}"))
}

fn check_numbers(
    allowed: Allowed,
    length: Option<usize>,
    kind: &Kind,
    node: &Node,
) -> Result<(), String> {
    let numbers = node.as_list(Node::as_number);
    let numbers = numbers.ok_or_else(|| format!("must be {}", description(kind)))?;
    require_members(&numbers)?;
    if length.is_some_and(|length| length != numbers.len()) {
        return Err(format!("must be {}", description(kind)));
    }
    if numbers.iter().all(|&number| allowed.check(number).is_ok()) {
        Ok(())
    } else {
        Err(format!("each must be {allowed}"))
    }
}

/// The texts of a list.
pub(super) fn words_of(node: &Node) -> Option<Vec<String>> {
    node.as_list(|item| item.as_text().map(str::to_owned))
}

fn check_words(words: &[Word], given: &[String]) -> Result<(), String> {
    require_members(given)?;
    for (number, word) in given.iter().enumerate() {
        check_word(words, word).map_err(|must| format!("each {must}"))?;
        if given[..number].contains(word) {
            return Err(format!("names {word:?} twice"));
        }
    }
    Ok(())
}

fn check_word(words: &[Word], given: &str) -> Result<(), String> {
    if words.iter().any(|word| word.name == given) {
        return Ok(());
    }
    let names: Vec<&str> = words.iter().map(|word| word.name).collect();
    let hint = nearest(given, &names).map_or(String::new(), |n| format!("; did you mean {n:?}?"));
    Err(format!("must be {}{hint}", listed(words)))
}

/// The intended one of several kinds, as far as the written value shows.
fn chosen<'a>(kinds: &'a [Kind], node: &Node) -> Option<&'a Kind> {
    let is_list = |item: &Node| matches!(item.value, Value::List(_));
    kinds.iter().find(|kind| match (&node.value, kind) {
        (Value::Table(_), Kind::Table(_)) => true,
        (Value::List(_), Kind::List(_) | Kind::CountList(..)) => true,
        (Value::List(items), Kind::Vector(..)) => !items.iter().any(is_list),
        (Value::List(items), Kind::Vectors(..)) => items.iter().any(is_list),
        (Value::Integer(_) | Value::Number(_), Kind::Number(_) | Kind::Count(..)) => true,
        (Value::Text(_), Kind::Text) => true,
        (Value::Text(text), Kind::Word(words)) => {
            let names: Vec<&str> = words.iter().map(|word| word.name).collect();
            nearest(text, &names).is_some()
        }
        _ => false,
    })
}

/// A description of the allowed values, to follow "must be".
pub(super) fn description(kind: &Kind) -> String {
    match kind {
        Kind::Text => "a text in quotes".to_owned(),
        Kind::WallTime => wall_time::ALLOWED.to_owned(),
        Kind::Boolean => "true or false".to_owned(),
        Kind::Number(allowed) => allowed.to_string(),
        Kind::Schedule(allowed, _) => format!("{allowed}, or a schedule"),
        Kind::Count(0, most) if *most == u64::MAX - 1 => "a whole number, not negative".to_owned(),
        Kind::Count(least, most) => format!("a whole number between {least} and {most}"),
        Kind::Counts(least, most) => {
            format!("a list of 3 whole numbers, each between {least} and {most}")
        }
        Kind::CountList(0, most) if *most == u64::MAX - 1 => {
            "a list of whole numbers, not negative".to_owned()
        }
        Kind::CountList(least, most) => {
            format!("a list of whole numbers, each between {least} and {most}")
        }
        Kind::Vectors(_, length) => format!("a list of lists of {length} numbers"),
        Kind::Vector(Allowed::FINITE, length) => format!("a list of {length} numbers"),
        Kind::Vector(allowed, length) => format!("a list of {length} numbers, each {allowed}"),
        Kind::List(allowed) => format!("a list of numbers, each {allowed}"),
        Kind::Word(words) => listed(words),
        Kind::Texts => "a list of texts in quotes".to_owned(),
        Kind::Words(words) => format!("a list of {}", listed(words)),
        Kind::Values => "a list of values".to_owned(),
        Kind::Settings => "keys of the case, each with a value".to_owned(),
        Kind::Table(keys) if keys.len() <= 2 => {
            let entries: Vec<String> = keys.iter().map(placeholder).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        Kind::Table(_) => "a table { ... }".to_owned(),
        Kind::Tables(_) => "a list of sections".to_owned(),
        Kind::Named(_) => "sections of your own names".to_owned(),
        Kind::Merged(merged) if merged.switched => {
            "a section of keys, \"off\" or \"on\"".to_owned()
        }
        Kind::Merged(_) => "a section of keys".to_owned(),
        Kind::Either(kinds) => {
            let all: Vec<String> = kinds.iter().map(description).collect();
            all.join(" or ")
        }
    }
}

fn placeholder(key: &Key) -> String {
    let value = match key.kind {
        Kind::Word(_) => "WORD".to_owned(),
        _ if !key.unit.is_empty() => key.unit.to_uppercase(),
        _ => "NUMBER".to_owned(),
    };
    format!("{} = {value}", key.name)
}

fn listed(words: &[Word]) -> String {
    let list: Vec<String> = words.iter().map(|word| format!("{:?}", word.name)).collect();
    list.join(" or ")
}

#[cfg(test)]
mod tests {
    use super::super::errors::Problems;
    use super::*;

    /// What is wrong with a value.
    fn wrong(kind: &Kind, value: &str) -> Option<String> {
        let root = Node::parse(&format!("key = {value}"), &Problems::default()).unwrap();
        check(kind, root.get("key").unwrap()).err()
    }

    #[test]
    fn what_is_written_chooses_between_kinds() {
        const COUNTS: Kind = Kind::Either(&[Kind::Count(1, 9), Kind::CountList(0, u64::MAX - 1)]);
        const PAIRS: Kind =
            Kind::Either(&[Kind::Vector(Allowed::FINITE, 2), Kind::Vectors(Allowed::FINITE, 2)]);
        const NUMBER_OR_TEXT: Kind = Kind::Either(&[Kind::Number(Allowed::POSITIVE), Kind::Text]);
        for (kind, value, expected) in [
            (COUNTS, "9", None),
            (COUNTS, "[0, 12]", None),
            (COUNTS, "10", Some("must be between 1 and 9")),
            (COUNTS, "[]", Some("must not be empty")),
            (COUNTS, "[-1]", Some("must be a list of whole numbers, not negative")),
            (
                COUNTS,
                "true",
                Some(
                    "must be a whole number between 1 and 9 or a list of whole numbers, not negative",
                ),
            ),
            (PAIRS, "[1, 2.5]", None),
            (PAIRS, "[[1, 2], [3, 4]]", None),
            (PAIRS, "[1]", Some("must be a list of 2 numbers")),
            (PAIRS, "[[1, 2], [3]]", Some("each must be a list of 2 numbers")),
            (NUMBER_OR_TEXT, "\"frozen\"", None),
            (NUMBER_OR_TEXT, "-1", Some("must be above 0")),
            (Kind::Texts, "[\"a\", \" \"]", Some("none may be empty")),
            (Kind::Values, "[1, \"x\", [2]]", None),
            (Kind::Values, "[]", Some("must not be empty")),
            (Kind::Settings, "{ a.b = 1 }", None),
            (Kind::Settings, "1", Some("must be a section of keys, [key] or { ... }")),
        ] {
            assert_eq!(wrong(&kind, value).as_deref(), expected, "{kind:?}: {value}");
        }
    }
}
