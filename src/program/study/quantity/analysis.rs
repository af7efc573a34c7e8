//! A number or text of `talcum analyse`.

use super::window::{WINDOW, Window};
use super::{Measured, Quantity, Value};
use crate::post_processing::{self, Kind, Results, ScalarName, TimeWindow};
use crate::study::run_outline::RunOutline;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use talcum_engine::schema::{self, Key};
use talcum_results::output::OutputError;
use talcum_runs::input::{Section, advice};

/// The findings of one analysis on a run; runs are read once, however often a search asks for them.
type Found = HashMap<(PathBuf, &'static str, String), Rc<post_processing::Findings>>;

/// Keys of the source `analysis`.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "quantity",
        schema::Kind::Text,
        "A number or text, as `talcum analyse --list` names it: `waves.speed`, `bed.height`, ...",
    ),
    WINDOW,
];

/// The numbers and texts of `talcum analyse`, and what it has found.
#[derive(Clone, Debug, Default)]
pub(super) struct Analysis {
    found: Rc<RefCell<Found>>,
}

impl Analysis {
    /// The quantity of a section.
    pub(super) fn read(&self, section: &Section<'_>) -> Option<Box<dyn Quantity>> {
        let (name, window) = (section.text("quantity"), Window::of_section(section));
        let quantity = self.over(&name?, window?);
        quantity
            .map_err(|advice| section.fail("quantity", format!("no such quantity: {advice}")))
            .ok()
    }

    /// The quantity of a name over a window.
    ///
    /// # Errors
    /// What to write instead, if it is none of its names.
    pub(super) fn over(&self, name: &str, window: Window) -> Result<Box<dyn Quantity>, String> {
        let Some(scalar) = post_processing::scalar_named(name) else {
            let names = post_processing::scalar_names();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            return Err(advice(name, &names));
        };
        Ok(Box::new(Analysed { scalar, window, found: Rc::clone(&self.found) }))
    }
}

/// One number or text, over a window.
#[derive(Clone, Debug)]
struct Analysed {
    scalar: ScalarName,
    window: Window,
    found: Rc<RefCell<Found>>,
}

impl Analysed {
    /// The findings of its analysis on a run.
    fn findings(&self, results: &Path) -> Result<Rc<post_processing::Findings>, OutputError> {
        let analysis = self.scalar.analysis;
        let key = (results.to_owned(), analysis.name, self.window.to_string());
        if let Some(found) = self.found.borrow().get(&key) {
            return Ok(Rc::clone(found));
        }
        let whole = Results::open(results, TimeWindow::WHOLE)?;
        let (from, to) = self.window.bounds(whole.last_time()?);
        let results = Results::open(results, TimeWindow { from, to })?.of_complete_run();
        let found = Rc::new(analysis.take(&results)?);
        self.found.borrow_mut().insert(key, Rc::clone(&found));
        Ok(found)
    }
}

impl Quantity for Analysed {
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
        run.impossible.get(self.scalar.analysis.name).cloned()
    }

    fn texts(&self) -> Option<&'static [&'static str]> {
        self.scalar.kind.texts
    }

    fn may_be_nothing(&self) -> bool {
        true
    }
}
