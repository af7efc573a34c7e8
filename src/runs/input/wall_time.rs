//! Spans of wall-clock time in the usual notation.

use std::time::Duration;

/// Form of a span of time.
pub(super) const ALLOWED: &str = "a time such as \"45s\", \"10m\", \"3h50m\" or \"1d12h\", above 0";

/// The span given by a text such as `3h50m`.
pub(super) fn parse(text: &str) -> Option<Duration> {
    let (mut seconds, mut digits, mut largest) = (0_u64, String::new(), u64::MAX);
    for character in text.trim().chars() {
        if character.is_ascii_digit() {
            digits.push(character);
            continue;
        }
        let unit = match character {
            'd' => 86_400,
            'h' => 3_600,
            'm' => 60,
            's' => 1,
            _ => return None,
        };
        if unit >= largest {
            return None;
        }
        largest = unit;
        let count: u64 = digits.parse().ok()?;
        seconds = seconds.checked_add(count.checked_mul(unit)?)?;
        digits.clear();
    }
    (digits.is_empty() && seconds > 0).then(|| Duration::from_secs(seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_read_as_written() {
        let seconds = |text: &str| parse(text).map(|span| span.as_secs());
        assert_eq!(seconds("3h50m"), Some(13_800));
        assert_eq!(seconds("1d2h3m4s"), Some(93_784));
        assert_eq!(seconds("90s"), Some(90));
        for wrong in ["", "5", "m", "5x", "5m5h", "0s", "-5m", "99999999999999999999d", "5m3"] {
            assert_eq!(seconds(wrong), None, "{wrong}");
        }
    }
}
