//! Overrides of the command line, `key.path=value`: they are inserted into the text, whose format is kept.

use super::merging::useless_keys;
use super::schema::ROOT;
use crate::input::{Node, Problems, SourcePlace};
use talcum_engine::schema::{Key, Kind, displaced_by, every_key};
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// Largest number of keys in a path, above that of any path of the schema.
const DEEPEST: usize = 16;

/// The text with overrides applied, and its tree: places are lines of the original text, or overrides.
pub(super) fn apply(
    text: &str,
    overrides: &[String],
    problems: &Problems,
) -> Option<(String, Node)> {
    let original = Node::parse(text, problems)?;
    if overrides.is_empty() {
        return Some((text.to_owned(), original));
    }
    let mut document: DocumentMut = match text.parse() {
        Ok(document) => document,
        Err(error) => {
            problems.add_at(SourcePlace::File, format!("not valid TOML: {error}"));
            return None;
        }
    };
    let mut applied = Vec::new();
    for given in overrides {
        match set(&mut document, given) {
            Ok(path) => applied.push((path, given.clone())),
            Err(message) => problems.add_at(SourcePlace::Override(given.clone()), message),
        }
    }
    let effective = document.to_string();
    let mut tree = Node::parse(&effective, problems)?;
    let mut places = Vec::new();
    original.clone().for_each(&mut |node| places.push((node.path.clone(), node.place.clone())));
    tree.for_each(&mut |node| node.place = place_of(&node.path, &applied, &places));
    Some((effective, tree))
}

fn place_of(
    path: &str,
    applied: &[(String, String)],
    places: &[(String, SourcePlace)],
) -> SourcePlace {
    let below = |inner: &str, outer: &str| {
        inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    if let Some((_, given)) = applied.iter().rev().find(|(set, _)| below(path, set)) {
        return SourcePlace::Override(given.clone());
    }
    if let Some((_, place)) = places.iter().find(|(known, _)| known == path) {
        return place.clone();
    }
    // A section that was made by an override.
    let maker = applied.iter().find(|(set, _)| below(set, path));
    maker.map_or(SourcePlace::File, |(_, given)| SourcePlace::Override(given.clone()))
}

/// Applies one override; returns the path that it sets, with members of lists by number.
fn set(document: &mut DocumentMut, given: &str) -> Result<String, String> {
    let (path, value) =
        given.split_once('=').ok_or("an override must look like key.path=value".to_owned())?;
    let keys: Vec<&str> = path.trim().split('.').map(str::trim).collect();
    if keys.len() > DEEPEST {
        return Err(format!(
            "the path has {} keys: no key of a case has more than {DEEPEST}",
            keys.len()
        ));
    }
    let plain = |key: &str| {
        !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || "_- ".contains(c))
    };
    if !keys.iter().all(|key| plain(key)) {
        return Err("an override must look like key.path=value".to_owned());
    }
    let value = value_of(value.trim())?;
    let mut resolved = Vec::new();
    set_in(Target { table: document.as_table_mut(), keys: ROOT }, &keys, value, &mut resolved)?;
    Ok(resolved.join("."))
}

/// A value of TOML; a bare word, or a duration such as 3h50m, is read as text.
fn value_of(text: &str) -> Result<Value, String> {
    if let Ok(value) = text.parse::<Value>() {
        return Ok(value);
    }
    let word = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    let alphabetic = |c: char| c.is_ascii_alphabetic();
    let duration = text.starts_with(|c: char| c.is_ascii_digit()) && text.ends_with(alphabetic);
    let is_word = (text.starts_with(alphabetic) || duration) && text.chars().all(word);
    if is_word {
        Ok(Value::from(text))
    } else {
        Err(format!("{text:?} is not a value of TOML; texts need quotes"))
    }
}

/// A table of the file, and the keys that are allowed in it.
struct Target<'a> {
    table: &'a mut dyn TableLike,
    keys: &'static [Key],
}

fn set_in(
    target: Target<'_>,
    path: &[&str],
    value: Value,
    resolved: &mut Vec<String>,
) -> Result<(), String> {
    let (name, rest) = path.split_first().ok_or("the path ends too early".to_owned())?;
    resolved.push((*name).to_owned());
    if rest.is_empty() {
        insert(target, name, value);
        return Ok(());
    }
    let Target { table, keys } = target;
    let inner = every_key(keys).into_iter().find(|key| key.name == *name);
    let keys = inner.map(|key| key.kind.keys()).unwrap_or_default();
    let item = table.entry(name).or_insert(Item::Table(Table::new()));
    if item.as_str() == Some("on") && !keys.is_empty() {
        // A section instead of the switch also switches it on.
        *item = Item::Value(InlineTable::new().into());
    }
    if let Some(table) = item.as_table_like_mut() {
        let table = Target { table, keys };
        return match inner.map(|key| key.kind) {
            Some(Kind::Named(_)) => set_in_named(table, rest, value, resolved),
            _ => set_in(table, rest, value, resolved),
        };
    }
    let path = resolved.join(".");
    let members = members_of(item).ok_or_else(|| format!("{path} is not a section"))?;
    let (chosen, rest) = rest.split_first().ok_or("the path ends too early".to_owned())?;
    let (number, table) = choose(members, chosen).ok_or_else(|| {
        format!("{path} has no member {chosen:?}: give its number, from 1, or its name")
    })?;
    resolved.push(number.to_string());
    match rest {
        [] => Err(format!("{path}.{chosen} is a section: set one of its keys")),
        _ => set_in(Target { table, keys }, rest, value, resolved),
    }
}

/// Sets a key in one of the sections with names chosen by the user.
fn set_in_named(
    Target { table, keys }: Target<'_>,
    path: &[&str],
    value: Value,
    resolved: &mut Vec<String>,
) -> Result<(), String> {
    let (name, rest) = path.split_first().ok_or("the path ends too early".to_owned())?;
    resolved.push((*name).to_owned());
    let item = table.entry(name).or_insert(Item::Table(Table::new()));
    let path = resolved.join(".");
    match item.as_table_like_mut() {
        Some(_) if rest.is_empty() => Err(format!("{path} is a section: set one of its keys")),
        Some(table) => set_in(Target { table, keys }, rest, value, resolved),
        None => Err(format!("{path} is not a section")),
    }
}

/// The tables of a list of tables.
fn members_of(item: &mut Item) -> Option<Vec<&mut dyn TableLike>> {
    match item {
        Item::ArrayOfTables(tables) => {
            Some(tables.iter_mut().map(|table| table as &mut dyn TableLike).collect())
        }
        Item::Value(Value::Array(array)) => {
            let tables = array.iter_mut().filter_map(Value::as_inline_table_mut);
            Some(tables.map(|table| table as &mut dyn TableLike).collect())
        }
        _ => None,
    }
}

/// Sets a key, replacing its partners; a new word drops the keys that only the old one has. A comment behind the old
/// value is kept.
fn insert(Target { table, keys }: Target<'_>, name: &str, mut value: Value) {
    for partner in displaced_by(keys, name) {
        table.remove(partner);
    }
    let old = table.get(name).and_then(Item::as_value);
    let is_new = old.and_then(Value::as_str) != value.as_str();
    if let Some(old) = old {
        *value.decor_mut() = old.decor().clone();
    }
    table.insert(name, Item::Value(value));
    if is_new {
        let word_of = |key: &str| table.get(key).and_then(Item::as_str);
        for useless in useless_keys(keys, &word_of, &[name]) {
            table.remove(useless);
        }
    }
}

/// The member of a list by its number, from 1, or by its name.
fn choose<'a>(
    members: Vec<&'a mut dyn TableLike>,
    chosen: &str,
) -> Option<(usize, &'a mut dyn TableLike)> {
    let number = chosen.parse().ok().or_else(|| {
        let named = |table: &&mut dyn TableLike| {
            table.get("name").and_then(Item::as_str).is_some_and(|name| name == chosen)
        };
        members.iter().position(named).map(|index| index + 1)
    })?;
    members.into_iter().enumerate().nth(usize::checked_sub(number, 1)?).map(|(_, m)| (number, m))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a = 1 # one\n[gas]\nviscosity = 2 # two\n[[stage]]\nname = \"x\"\n[[stage]]\nname = \"y\"\n[stage.gas]\nweight = \"w\"\n";

    fn applied(overrides: &[&str]) -> Result<(String, Node), String> {
        let problems = Problems::default();
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let result = apply(TEXT, &overrides, &problems);
        if problems.is_empty() {
            Ok(result.unwrap())
        } else {
            Err(problems.into_errors("f.toml").to_string())
        }
    }

    #[test]
    fn format_and_places_are_kept() {
        let (text, tree) = applied(&["gas.stokes_number=55", "new.key=word", "a=3"]).unwrap();
        assert!(text.contains("a = 3 # one"), "{text}");
        assert!(!text.contains("viscosity"), "{text}");
        let stokes = tree.get("gas").unwrap().get("stokes_number").unwrap();
        assert_eq!(stokes.place, SourcePlace::Override("gas.stokes_number=55".into()));
        assert_eq!(tree.get("gas").unwrap().place, SourcePlace::Line(2));
        assert_eq!(tree.get("new").unwrap().place, SourcePlace::Override("new.key=word".into()));
        assert_eq!(tree.get("stage").unwrap().items()[1].place, SourcePlace::Line(6));
    }

    #[test]
    fn stages_go_by_number_or_name() {
        for path in ["stage.2.gas.superficial_velocity=0.1", "stage.y.gas.superficial_velocity=0.1"]
        {
            let (text, tree) = applied(&[path]).unwrap();
            assert!(!text.contains("weight"));
            let gas = tree.get("stage").unwrap().items()[1].get("gas").unwrap().clone();
            assert_eq!(gas.entries()[0].1.path, "stage.2.gas.superficial_velocity");
            assert_eq!(gas.entries()[0].1.place, SourcePlace::Override(path.into()));
        }
    }

    #[test]
    fn wrong_overrides_are_refused_with_a_message() {
        for (given, words) in [
            ("a", "must look like key.path=value"),
            ("a..b=1", "must look like key.path=value"),
            ("a=[1", "is not a value of TOML"),
            ("a.b=1", "a is not a section"),
            ("stage.3.name='z'", "stage has no member \"3\""),
            ("stage.0.name='z'", "stage has no member \"0\""),
            ("stage=1.5.2", "is not a value of TOML"),
            ("stage.1=2", "stage.1 is a section"),
        ] {
            let error = applied(&[given]).unwrap_err();
            assert!(error.starts_with(&format!("f.toml, --set {given}: ")), "{error}");
            assert!(error.contains(words), "{error}");
        }
    }
}
