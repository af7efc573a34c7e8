//! What may have been meant by a word that nobody knows.

/// The candidate that differs least from a word, if any is near.
pub fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&word.to_lowercase(), name);
    let begins = |name: &str| word.len() >= 3 && (name.starts_with(word) || word.starts_with(name));
    let best = candidates.iter().copied().min_by_key(|name| (!begins(name), distance(name)))?;
    let is_close = distance(best) <= 1 + best.len() / 4;
    (is_close || begins(best) || strsim::jaro_winkler(word, best) > 0.88).then_some(best)
}

/// What to write instead of an unknown name: the one that may have been meant, or the list of all.
pub fn advice(unknown: &str, known: &[&str]) -> String {
    match nearest(unknown, known) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("known here are {}", known.join(", ")),
    }
}
