//! A JSON schema of a kind of file, for editors of TOML.

use super::{FileKeys, absence, allowed};
use serde_json::{Map, Value, json};
use talcum_engine::schema::{
    Allowed, Key, Kind, Merged, Required, Value as Literal, Word, every_key,
};

/// Pattern of a span of time such as `1d2h3m4s`.
const WALL_TIME: &str = "^\\s*([0-9]+[dhms])+\\s*$";

/// The schema, as the text of a file: draft 7, which Taplo reads.
pub(super) fn json_schema(file: &FileKeys) -> String {
    let mut definitions = Map::new();
    define(file.root, &mut definitions);
    let mut schema = table(file.root, true);
    if let Value::Object(entries) = &mut schema {
        entries.insert("$schema".into(), json!("http://json-schema.org/draft-07/schema#"));
        entries.insert("title".into(), json!(file.title));
        if !definitions.is_empty() {
            entries.insert("definitions".into(), Value::Object(definitions));
        }
    }
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// Sections that are merged from several places: each key is optional in each place.
fn define(keys: &'static [Key], definitions: &mut Map<String, Value>) {
    for key in every_key(keys) {
        if let Kind::Merged(Merged { section, keys, .. }) = key.kind
            && !definitions.contains_key(section)
        {
            definitions.insert(section.to_owned(), table(keys, false));
            define(keys, definitions);
        } else if let Kind::Tables(keys) | Kind::Named(keys) = key.kind {
            define(keys, definitions);
        }
    }
}

/// A table with these keys; if `complete`, it is at a single place of the file, so that required keys must be there.
fn table(keys: &'static [Key], complete: bool) -> Value {
    let mut properties = Map::new();
    for key in every_key(keys) {
        let schema = described(key, keys);
        match properties.get_mut(key.name) {
            None => drop(properties.insert(key.name.to_owned(), schema)),
            Some(known) if *known != schema => add_alternative(known, schema),
            Some(_) => {}
        }
    }
    let mut rules = exclusions(keys);
    rules.extend(keys.iter().flat_map(|key| choices(key, keys, complete)));
    let mut schema = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    });
    if complete {
        rules.extend(requirements(keys));
    }
    if !rules.is_empty() {
        schema["allOf"] = Value::Array(rules);
    }
    schema
}

/// Adds a key that several words declare, each in its own form.
fn add_alternative(known: &mut Value, schema: Value) {
    match known.get_mut("anyOf").and_then(Value::as_array_mut) {
        Some(forms) if !forms.contains(&schema) => forms.push(schema),
        Some(_) => {}
        None => *known = json!({ "anyOf": [known.clone(), schema] }),
    }
}

/// The value of a key, with its meaning.
fn described(key: &Key, keys: &'static [Key]) -> Value {
    let mut schema = value(&key.kind);
    let unit = if key.unit.is_empty() { String::new() } else { format!(" Unit: {}.", key.unit) };
    let of = owners(key, keys).map_or(String::new(), |of| format!(" With {of}."));
    let range = allowed(&key.kind);
    let absence = absence(key);
    let text = format!("{}.{of}{unit} Allowed: {range}. If left out: {absence}.", key.meaning);
    schema["description"] = json!(text);
    if let Some(default) = key.default.and_then(|default| literal(default.value)) {
        schema["default"] = default;
    }
    schema
}

/// The words that bring a key, as `law = "jkr"`.
fn owners(key: &Key, keys: &'static [Key]) -> Option<String> {
    let mut found: Vec<String> = Vec::new();
    for selector in every_key(keys) {
        let bringing = selector.kind.words().iter().filter(|word| word.keys.contains(key));
        found.extend(bringing.map(|word| format!("{} = {:?}", selector.name, word.name)));
    }
    (!found.is_empty()).then(|| found.join(" or "))
}

fn literal(value: Literal) -> Option<Value> {
    match value {
        Literal::Number(number) => Some(json!(number)),
        Literal::Count(count) => Some(json!(count)),
        Literal::Word(word) => Some(json!(word)),
        Literal::Boolean(truth) => Some(json!(truth)),
        Literal::Derived(_) => None,
    }
}

/// Schema of a value.
fn value(kind: &Kind) -> Value {
    match kind {
        Kind::Text => json!({ "type": "string", "minLength": 1 }),
        Kind::WallTime => json!({ "type": "string", "pattern": WALL_TIME }),
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Number(allowed) => number(*allowed),
        Kind::Schedule(allowed, keys) => json!({ "anyOf": [number(*allowed), table(keys, true)] }),
        Kind::Count(least, most) => count(*least, *most),
        Kind::Counts(least, most) => list(count(*least, *most), Some(3)),
        Kind::CountList(least, most) => list(count(*least, *most), None),
        Kind::Vector(allowed, length) => list(number(*allowed), Some(*length)),
        Kind::Vectors(allowed, length) => list(list(number(*allowed), Some(*length)), None),
        Kind::List(allowed) => list(number(*allowed), None),
        Kind::Values => json!({ "type": "array", "minItems": 1 }),
        Kind::Settings => json!({ "type": "object" }),
        Kind::Word(words) => word(words),
        Kind::Texts => list(json!({ "type": "string" }), None),
        Kind::Words(words) => list(word(words), None),
        Kind::Table(keys) => table(keys, true),
        Kind::Tables(keys) => json!({ "type": "array", "minItems": 1, "items": table(keys, true) }),
        Kind::Named(keys) => json!({ "type": "object", "additionalProperties": table(keys, true) }),
        Kind::Merged(merged) => {
            let keys = json!({ "$ref": format!("#/definitions/{}", merged.section) });
            if merged.switched {
                json!({ "anyOf": [keys, { "enum": ["off", "on"] }] })
            } else {
                json!({ "allOf": [keys] })
            }
        }
        Kind::Either(kinds) => {
            json!({ "anyOf": kinds.iter().map(value).collect::<Vec<Value>>() })
        }
    }
}

fn number(allowed: Allowed) -> Value {
    let mut schema = json!({ "type": "number" });
    let (lower, is_least) = allowed.lower();
    if lower.is_finite() {
        schema[if is_least { "minimum" } else { "exclusiveMinimum" }] = json!(lower);
    }
    let (upper, is_most) = allowed.upper();
    if upper.is_finite() {
        schema[if is_most { "maximum" } else { "exclusiveMaximum" }] = json!(upper);
    }
    schema
}

fn count(least: u64, most: u64) -> Value {
    let mut schema = json!({ "type": "integer", "minimum": least });
    if most < u64::MAX - 1 {
        schema["maximum"] = json!(most);
    }
    schema
}

fn list(items: Value, length: Option<usize>) -> Value {
    let mut schema = json!({ "type": "array", "items": items, "minItems": length.unwrap_or(1) });
    if let Some(length) = length {
        schema["maxItems"] = json!(length);
    }
    schema
}

fn word(words: &[Word]) -> Value {
    let names: Vec<&str> = words.iter().map(|word| word.name).collect();
    let meanings: Vec<&str> = words.iter().map(|word| word.meaning).collect();
    let mut schema = json!({ "type": "string", "enum": names });
    if meanings.iter().any(|meaning| !meaning.is_empty()) {
        schema["x-taplo"] = json!({ "docs": { "enumValues": meanings } });
    }
    schema
}

/// Partners exclude each other.
fn exclusions(keys: &'static [Key]) -> Vec<Value> {
    let mut pairs: Vec<[&str; 2]> = Vec::new();
    for key in every_key(keys) {
        for partner in key.partners {
            let mut pair = [key.name, partner];
            pair.sort_unstable();
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }
    pairs.iter().map(|pair| json!({ "not": { "required": pair } })).collect()
}

/// Requirements: each required key, or one of its partners.
fn requirements(keys: &[Key]) -> Vec<Value> {
    let required = keys.iter().filter_map(|key| match key.required {
        Required::Always => Some((key, &[][..])),
        // The first stage may also give it.
        Required::AtStart => Some((key, &["stage"][..])),
        _ => None,
    });
    let rules = required.map(|(key, instead)| {
        let any = std::iter::once(&key.name).chain(key.partners).chain(instead);
        let any: Vec<Value> = any.map(|name| json!({ "required": [name] })).collect();
        match key.with {
            Some(owner) => json!({
                "if": { "required": [owner] },
                "then": { "required": [key.name] },
                "else": { "not": { "required": [key.name] } },
            }),
            None if any.len() == 1 => any[0].clone(),
            None => json!({ "anyOf": any }),
        }
    });
    rules.collect()
}

/// Conditions for each word: keys that are not used with it, and in a complete table those that it requires.
fn choices(key: &'static Key, keys: &'static [Key], complete: bool) -> Vec<Value> {
    let words = key.kind.words();
    let brought = || words.iter().flat_map(|word| every_key(word.keys));
    if brought().next().is_none() {
        return Vec::new();
    }
    let of = |word: &'static Word| {
        // Another key of the section may also bring it.
        let others = keys.iter().filter(|other| other.name != key.name);
        let allowed: Vec<&str> = every_key(word.keys)
            .into_iter()
            .chain(others.flat_map(|other| every_key(std::slice::from_ref(other))))
            .map(|key| key.name)
            .collect();
        let refused: Map<String, Value> = brought()
            .filter(|key| !allowed.contains(&key.name))
            .map(|key| (key.name.to_owned(), json!(false)))
            .collect();
        let mut then = json!({ "properties": refused });
        let required = if complete { requirements(word.keys) } else { Vec::new() };
        if !required.is_empty() {
            then["allOf"] = Value::Array(required);
        }
        let chosen = json!({ key.name: { "const": word.name } });
        json!({ "if": { "properties": chosen, "required": [key.name] }, "then": then })
    };
    words.iter().map(of).collect()
}
