//! Contacts as lines for ParaView: pairs, forces, overlap and age.
//!
//! The history of a contact does not know when it began, and costs the step nothing for that. The measure follows the
//! pairs instead: a contact is as old as the first of the looks without a gap at which the pair touched.

use super::layout::{Column, Layout, Rows, Table};
use super::registered::{MeasureValues, RegisteredMeasure};
use super::stored::Stored;
use super::view::View;
use super::{ContactLine, Findings, Measure, Needs, Setting};
use crate::analysis::{Quantity, send_to_rendezvous, totals};
use crate::contact::PairForce;
use crate::parallel::Communicator;
use crate::schema::{Allowed, Key, Value};
use bytemuck::{Pod, Zeroable};

/// Settings of the kind `contacts`.
#[derive(Clone, Debug, PartialEq)]
pub struct Contacts {
    /// Every so many looks lines are written.
    looks_per_write: u64,
}

/// A pair and when it began to touch.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Birth {
    lower: u64,
    higher: u64,
    time: f64,
}

/// The pairs that touch, on the rendezvous ranks of their lower ids, ascending.
struct Followed {
    settings: Contacts,
    births: Vec<Birth>,
    /// Looks since lines were written.
    looks: u64,
}

impl RegisteredMeasure for Contacts {
    const MEANING: &'static str =
        "touching pairs as lines for ParaView, with normal and tangential force, overlap and age";

    const KEYS: &'static [Key] = &[Key::number(
        "write",
        Allowed::POSITIVE,
        "Interval at which lines are written, a whole multiple of `every`; looks between follow the ages, which are \
         known to `every`",
    )
    .unit("time")
    .default(Value::Derived("`every`"))];

    fn from_keys(values: &dyn MeasureValues) -> Option<Self> {
        let every = values.number("every")?;
        let write = if values.is_given("write") { values.number("write")? } else { every };
        let looks = write / every;
        if looks < 0.999 || (looks - looks.round()).abs() > 1.0e-6 * looks {
            values.fail("write", format!("must be a whole multiple of every, {every}"));
            return None;
        }
        Some(Self { looks_per_write: looks.round() as u64 })
    }

    fn begin(&self, _: &Setting<'_>) -> Box<dyn Measure> {
        let settings = self.clone();
        // The first look writes.
        Box::new(Followed { looks: settings.looks_per_write - 1, settings, births: Vec::new() })
    }
}

impl Measure for Followed {
    fn layout(&self) -> Layout {
        let columns = vec![
            Column::scalar("contacts", Quantity::Number, "number of touching pairs"),
            Column::scalar("mean_normal_force", Quantity::Force, "mean normal force of contacts"),
            Column::scalar("largest_normal_force", Quantity::Force, "largest normal force"),
            Column::scalar("mean_overlap", Quantity::Length, "mean overlap"),
            Column::scalar("mean_age", Quantity::Time, "mean age of contacts"),
        ];
        let tables = vec![Table { name: "results", columns }];
        Layout { tables, lines: true, ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { contact_forces: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Findings {
        self.looks += 1;
        let is_written = self.looks >= self.settings.looks_per_write;
        let touching = view.pair_forces().iter().filter(|pair| pair.touching);
        let lines = touching.map(|pair| line_of(pair, view));
        if !is_written {
            let pairs = lines.map(|line| Birth {
                lower: line.lower,
                higher: line.higher,
                time: view.time(),
            });
            let mut pairs = send_to_rendezvous(pairs, |pair| pair.lower, ranks);
            pairs.sort_unstable_by_key(|pair| (pair.lower, pair.higher));
            self.follow(&mut pairs);
            self.births = pairs;
            return Findings::default();
        }
        self.looks = 0;
        let mut lines = send_to_rendezvous(lines, |line| line.lower, ranks);
        lines.sort_unstable_by_key(|line| (line.lower, line.higher));
        let birth = |line: &ContactLine| Birth {
            lower: line.lower,
            higher: line.higher,
            time: view.time(),
        };
        let mut births: Vec<Birth> = lines.iter().map(birth).collect();
        self.follow(&mut births);
        for (line, birth) in lines.iter_mut().zip(&births) {
            line.age = view.time() - birth.time;
        }
        self.births = births;
        let rows = vec![summary(&lines, ranks)];
        Findings { rows, lines: Some(lines), ..Findings::default() }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        stored.add_records("births", &self.births);
        stored.add_numbers("looks", &[self.looks as f64], ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let births: Vec<Birth> = stored.records("births")?;
        self.births = send_to_rendezvous(births, |birth| birth.lower, ranks);
        self.births.sort_unstable_by_key(|birth| (birth.lower, birth.higher));
        self.looks = *stored.numbers("looks", ranks)?.first()? as u64;
        Some(())
    }
}

impl Followed {
    /// Gives those of ascending pairs that touched at the last look the time at which they began to.
    fn follow(&self, pairs: &mut [Birth]) {
        let key = |birth: &Birth| (birth.lower, birth.higher);
        let mut rest = &self.births[..];
        for pair in pairs {
            rest = &rest[rest.partition_point(|known| key(known) < key(pair))..];
            if let Some(known) = rest.first().filter(|known| key(known) == key(pair)) {
                pair.time = known.time;
            }
        }
    }
}

fn line_of(pair: &PairForce, view: &View<'_>) -> ContactLine {
    let start = view.bounds().wrap(pair.position);
    ContactLine {
        lower: pair.lower,
        higher: pair.higher,
        start: start.into(),
        end: (start + pair.branch).into(),
        normal_force: pair.normal,
        cohesive_force: pair.cohesion,
        tangential_force: pair.tangential.map(|component| component + 0.0).into(),
        overlap: pair.overlap,
        age: 0.0,
    }
}

/// The row of results of these lines. Collective.
fn summary(lines: &[ContactLine], ranks: &dyn Communicator) -> Rows {
    let sums =
        totals(lines.iter().map(|line| [1.0, line.normal_force, line.overlap, line.age]), ranks);
    let [count, force, overlap, age] = sums;
    let mut largest =
        [lines.iter().map(|line| line.normal_force).fold(f64::NEG_INFINITY, f64::max)];
    ranks.maximum(&mut largest);
    let mean = |sum: f64| if count > 0.0 { sum / count } else { f64::NAN };
    let largest = if count > 0.0 { largest[0] } else { f64::NAN };
    Rows::of(0, &[[count, mean(force), largest, mean(overlap), mean(age)]])
}
