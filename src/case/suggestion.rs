//! Suggestions for unknown words.

/// The candidate that differs least from a word, if any is near.
pub(super) fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&word.to_lowercase(), name);
    let begins = |name: &str| word.len() >= 3 && (name.starts_with(word) || word.starts_with(name));
    let best = candidates.iter().copied().min_by_key(|name| (!begins(name), distance(name)))?;
    let is_close = distance(best) <= 1 + best.len() / 4;
    (is_close || begins(best) || strsim::jaro_winkler(word, best) > 0.88).then_some(best)
}
