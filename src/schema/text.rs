//! Texts that users write: what may have been meant by a word that nobody knows, and bytes that are no text.

/// The candidate that differs least from a word, if any is near.
pub fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&word.to_lowercase(), name);
    let begins = |name: &str| word.len() >= 3 && (name.starts_with(word) || word.starts_with(name));
    let best = candidates.iter().copied().min_by_key(|name| (!begins(name), distance(name)))?;
    let is_close = distance(best) <= 1 + best.len() / 4;
    (is_close || begins(best) || strsim::jaro_winkler(word, best) > 0.88).then_some(best)
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
