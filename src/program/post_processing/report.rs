//! Findings as text.

use super::{ANALYSES, Analysis, Findings, Scalar, Value, full_name};
use std::fmt::Write;

/// Width of the column of names.
const NAMES: usize = 30;

/// The findings of an analysis, a line for each number.
pub fn report(analysis: &Analysis, findings: &Findings) -> String {
    let mut text = format!("{}\n", analysis.title);
    if let Some(reason) = findings.why_nothing() {
        let _ = writeln!(text, "  {}: {reason}", analysis.name);
        return text;
    }
    for scalars in findings.scalars.chunk_by(|a, b| reason(a).is_some() && reason(a) == reason(b)) {
        let names: Vec<String> =
            scalars.iter().map(|scalar| full_name(analysis, &scalar.kind)).collect();
        let value = scalars.iter().map(value_of).next().unwrap_or_default();
        let _ = writeln!(text, "  {:<NAMES$} {value}", names.join(", "));
    }
    for note in &findings.notes {
        let _ = writeln!(text, "  ({note})");
    }
    text
}

fn reason(scalar: &Scalar) -> Option<&str> {
    match &scalar.value {
        Value::Nothing(reason) => Some(reason.reason()),
        Value::Number { .. } | Value::Text(_) => None,
    }
}

fn value_of(scalar: &Scalar) -> String {
    let unit = if scalar.unit == "1" { String::new() } else { format!(" {}", scalar.unit) };
    match &scalar.value {
        Value::Number { value, error: Some(error) } if *error > 0.0 => {
            let (value, error) = (digits(*value, *error), digits(*error, *error));
            format!("{value} +- {error}{unit}")
        }
        Value::Number { value, .. } => format!("{}{unit}", digits(*value, 0.0)),
        Value::Text(text) => (*text).to_owned(),
        Value::Nothing(reason) => format!("- ({})", reason.reason()),
    }
}

/// A number with the digits that its error justifies, two of them uncertain; with five if there is no error.
fn digits(value: f64, error: f64) -> String {
    let largest = value.abs().max(error.abs());
    let whole = error == 0.0 && largest < 1.0e6 && libm::trunc(value) == value;
    if whole || !value.is_finite() || !largest.is_finite() {
        return value.to_string();
    }
    let leading = |x: f64| libm::floor(libm::log10(x)) as i32;
    let last = if error > 0.0 { leading(error) - 1 } else { leading(largest) - 4 };
    if (-4..6).contains(&leading(largest)) {
        return format!("{value:.*}", usize::try_from(-last).unwrap_or(0));
    }
    let places = usize::try_from(leading(largest) - last).unwrap_or(0);
    format!("{value:.places$e}")
}

/// All names, each with its meaning.
pub fn list() -> String {
    let mut text = String::new();
    for analysis in ANALYSES {
        let _ = writeln!(text, "{}\n    {}", analysis.name, analysis.title);
        for kind in (analysis.scalars)() {
            let name = full_name(analysis, &kind);
            let _ = write!(text, "  {name:<NAMES$} {}", kind.meaning);
            let texts = kind.texts.map(|texts| format!(": {}", texts.join(", ")));
            let _ = writeln!(text, "{}", texts.unwrap_or_default());
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn numbers_have_the_digits_that_their_errors_leave() {
        assert_eq!(digits(0.384_712, 0.010_4), "0.385");
        assert_eq!(digits(0.010_4, 0.010_4), "0.010");
        assert_eq!(digits(12345.678, 0.0), "12346");
        assert_eq!(digits(1.234_567e-7, 0.0), "1.2346e-7");
        assert_eq!(digits(2.0e-6, 3.0e-8), "2.000e-6");
        assert_eq!((digits(0.0, 0.0), digits(3000.0, 0.0)), ("0".to_owned(), "3000".to_owned()));
        assert_eq!(digits(f64::NAN, 0.0), "NaN");
    }
}
