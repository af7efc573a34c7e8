//! A number or text measured by `talcum analyse`.

use super::{Measure, MeasureSource, Measured, Value, Window, window_of};
use crate::output::OutputError;
use crate::post_processing::{self, Kind, Results, ScalarName, TimeWindow};
use crate::study::run_outline::RunOutline;
use crate::study::section::{Section, advice};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Findings on a run by one measure; runs are read only once, even if a search requests them several times.
type Found = HashMap<(PathBuf, &'static str, String), Rc<post_processing::Findings>>;

/// The source `analysis`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Analysis {
    found: Rc<RefCell<Found>>,
}

impl MeasureSource for Analysis {
    fn name(&self) -> &'static str {
        "analysis"
    }

    fn prepare(&self, section: &Section<'_>) -> Option<Box<dyn Measure>> {
        let quantity = section
            .required("quantity", "what talcum analyse measures: waves.speed, bed.height, ...");
        let window = window_of(section);
        let entry = quantity?;
        let name = entry.text()?;
        let Some(scalar) = post_processing::scalar_named(&name) else {
            let names = self.names();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            entry.fail(format!("no such quantity: {}", advice(&name, &names)));
            return None;
        };
        Some(Box::new(Quantity { scalar, window: window?, found: Rc::clone(&self.found) }))
    }

    fn names(&self) -> Vec<String> {
        post_processing::scalar_names()
    }

    fn named(&self, name: &str) -> Option<Box<dyn Measure>> {
        self.over(name, Window::default())
    }
}

impl Analysis {
    /// The measure with one of its names, over a window.
    pub(super) fn over(&self, name: &str, window: Window) -> Option<Box<dyn Measure>> {
        let scalar = post_processing::scalar_named(name)?;
        Some(Box::new(Quantity { scalar, window, found: Rc::clone(&self.found) }))
    }
}

/// One quantity, over a window.
#[derive(Clone, Debug)]
struct Quantity {
    scalar: ScalarName,
    window: Window,
    found: Rc<RefCell<Found>>,
}

impl Quantity {
    /// The findings of its measure on a run.
    fn findings(&self, results: &Path) -> Result<Rc<post_processing::Findings>, OutputError> {
        let measure = self.scalar.measure;
        let key = (results.to_owned(), measure.name, self.window.to_string());
        if let Some(found) = self.found.borrow().get(&key) {
            return Ok(Rc::clone(found));
        }
        let whole = Results::open(results, TimeWindow::WHOLE)?;
        let (from, to) = self.window.bounds(whole.last_time()?);
        let results = Results::open(results, TimeWindow { from, to })?.of_complete_run();
        let found = Rc::new(measure.take(&results)?);
        self.found.borrow_mut().insert(key, Rc::clone(&found));
        Ok(found)
    }
}

impl Measure for Quantity {
    fn value(&self, results: &Path) -> Result<Measured, OutputError> {
        let found = self.findings(results)?;
        let (value, unit) = found.value_of(&self.scalar);
        let value = match value {
            post_processing::Value::Number { value, .. } => Value::Number(value),
            post_processing::Value::Text(text) => Value::Text(text.to_owned()),
            post_processing::Value::Nothing(reason) => Value::Nothing(reason.to_string()),
        };
        Ok(Measured { value, unit: unit.to_owned() })
    }

    fn describe(&self) -> String {
        let Kind { meaning, .. } = &self.scalar.kind;
        format!("{} by talcum analyse ({meaning}){}", self.scalar, self.window)
    }

    fn check(&self, run: &RunOutline) -> Result<(), String> {
        self.window.check(run.end_time)
    }

    fn impossible(&self, run: &RunOutline) -> Option<String> {
        run.impossible.get(self.scalar.measure.name).cloned()
    }

    fn texts(&self) -> Option<&'static [&'static str]> {
        self.scalar.kind.texts
    }

    fn may_be_nothing(&self) -> bool {
        true
    }
}
