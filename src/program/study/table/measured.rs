//! The columns of a quantity in the tables of a study.

use super::of_points::OfPoints;
use crate::study::quantity::{NamedQuantity, Value};
use std::collections::BTreeMap;
use talcum_engine::fields::Column;
use talcum_results::output::{Cells, TableColumn};

/// A quantity and its unit, as tables name them.
pub(super) struct QuantityColumns<'a> {
    pub(super) quantity: &'a NamedQuantity,
    /// Known as soon as a run has given it; empty before.
    pub(super) unit: &'a str,
}

impl QuantityColumns<'_> {
    /// The value of each run; `None` for values that could not be read.
    pub(super) fn of_runs(&self, values: &[Option<&Value>]) -> TableColumn {
        let about = "of the run";
        if self.quantity.quantity.texts().is_some() {
            let text = |value: &Option<&Value>| value.map(text_of).unwrap_or_default();
            let cells = Cells::Text(values.iter().map(text).collect());
            return Column::new(&self.quantity.name, about, cells);
        }
        let values = values.iter().map(|value| number_of(*value)).collect();
        Column::numbers(&self.quantity.name, self.unit, about, values)
    }

    /// The combined values of the runs of each point. Runs without a value do not count; a run that could not
    /// be read leaves the point without a mean.
    pub(super) fn of_points(
        &self,
        values: &[Vec<Option<&Value>>],
        confidence: f64,
    ) -> Vec<TableColumn> {
        if self.quantity.quantity.texts().is_some() {
            let cells = Cells::Text(values.iter().map(|values| tally(values)).collect());
            return vec![Column::new(&self.quantity.name, "texts of the runs", cells)];
        }
        let given: Vec<Vec<f64>> = values.iter().map(|values| given(values)).collect();
        let of_points = OfPoints { name: &self.quantity.name, unit: self.unit, given: &given };
        of_points.columns(self.quantity.quantity.may_be_nothing(), confidence)
    }
}

fn number_of(value: Option<&Value>) -> f64 {
    match value {
        Some(Value::Number(number)) => *number,
        Some(Value::Text(_) | Value::Nothing(_)) | None => f64::NAN,
    }
}

fn text_of(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Number(_) | Value::Nothing(_) => String::new(),
    }
}

/// The numbers of the runs that have one.
fn given(values: &[Option<&Value>]) -> Vec<f64> {
    let has_one = |value: &&Option<&Value>| !matches!(value, Some(Value::Nothing(_)));
    values.iter().filter(has_one).map(|value| number_of(*value)).collect()
}

/// One text if all runs gave the same, otherwise the number of runs for each: `2 frozen, 1 waves`.
fn tally(values: &[Option<&Value>]) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for text in values.iter().flatten().map(|value| text_of(value)) {
        *counts.entry(text).or_default() += 1;
    }
    match counts.len() {
        0 | 1 => counts.into_keys().next().unwrap_or_default(),
        _ => {
            let parts: Vec<String> =
                counts.iter().map(|(text, count)| format!("{count} {text}")).collect();
            parts.join(", ")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_counted_and_what_is_not_there_is_left_out() {
        let text = |text: &str| Value::Text(text.to_owned());
        let (waves, frozen) = (text("waves"), text("frozen"));
        assert_eq!(tally(&[Some(&waves), Some(&waves)]), "waves");
        assert_eq!(tally(&[Some(&waves), Some(&frozen), Some(&waves)]), "1 frozen, 2 waves");
        let (number, nothing) = (Value::Number(2.0), Value::Nothing("no waves".to_owned()));
        assert_eq!(given(&[Some(&number), Some(&nothing)]), [2.0]);
        assert!(given(&[Some(&number), None])[1].is_nan());
    }
}
