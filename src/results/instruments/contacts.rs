//! Contacts as lines for ParaView: pairs, forces, overlap and age.
//!
//! The history of a contact does not contain its start, and thus costs the step nothing for it. The instrument follows the
//! pairs instead: the age of a contact is counted from the first of the uninterrupted samples at which the pair
//! touched.

use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{ContactLine, Instrument, Needs, Readings, Setting};
use crate::analysis::{Pair, totals};
use bytemuck::{Pod, Zeroable};
use talcum_engine::contact::PairForce;
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;
use talcum_engine::particle_sets::pair::ascending;
use talcum_engine::schema::{Allowed, Key, Value};

/// Settings of the kind `contacts`.
#[derive(Clone, Debug, PartialEq)]
pub struct Contacts {
    /// Number of samples from one writing of lines to the next.
    looks_per_write: u64,
}

/// A pair and the time at which it began to touch.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Birth {
    lower: u64,
    higher: u64,
    time: f64,
}

impl Birth {
    fn ids(&self) -> [u64; 2] {
        [self.lower, self.higher]
    }
}

/// The pairs that touch, each on the rank that owned its lower id at the last sample.
struct Followed {
    settings: Contacts,
    /// Ascending from the first sample on.
    births: Vec<Birth>,
    /// Number of samples since lines were written.
    looks: u64,
}

impl RegisteredInstrument for Contacts {
    const MEANING: &'static str =
        "touching pairs as lines for ParaView, with normal and tangential force, overlap and age";

    const KEYS: &'static [Key] = &[Key::number(
        "write",
        Allowed::POSITIVE,
        "Interval at which lines are written, a whole multiple of `every`; samples in between follow the ages, which are \
         known to `every`",
    )
    .unit("time")
    .default(Value::Derived("`every`"))];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let every = values.number("every")?;
        let write = if values.is_given("write") { values.number("write")? } else { every };
        let looks = write / every;
        if looks < 0.999 || (looks - looks.round()).abs() > 1.0e-6 * looks {
            values.fail("write", format!("must be a whole multiple of every, {every}"));
            return None;
        }
        Some(Self { looks_per_write: looks.round() as u64 })
    }

    fn begin(&self, _: &Setting<'_>) -> Box<dyn Instrument> {
        let settings = self.clone();
        // The first sample writes.
        Box::new(Followed { looks: settings.looks_per_write - 1, settings, births: Vec::new() })
    }
}

impl Instrument for Followed {
    fn layout(&self) -> Layout {
        let columns = vec![
            Column::scalar("contacts", Unit::One, "number of touching pairs"),
            Column::scalar("mean_normal_force", Unit::Force, "mean normal force of contacts"),
            Column::scalar("largest_normal_force", Unit::Force, "largest normal force"),
            Column::scalar("mean_overlap", Unit::Length, "mean overlap"),
            Column::scalar("mean_age", Unit::Time, "mean age of contacts"),
        ];
        let tables = vec![Table { name: "results", columns }];
        Layout { tables, lines: true, ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs {
            contact_forces: self.looks + 1 >= self.settings.looks_per_write,
            ..Needs::default()
        }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        self.looks += 1;
        view.ownership().align(&mut self.births, Birth::ids, ranks);
        if self.looks < self.settings.looks_per_write {
            let pairs = view.touching(ranks).iter().map(Pair::ends);
            self.births = self.followed(pairs, view.time());
            return Readings::default();
        }
        self.looks = 0;
        let mut lines = lines_of(view, ranks);
        self.births =
            self.followed(lines.iter().map(|line| [line.lower, line.higher]), view.time());
        for (line, birth) in lines.iter_mut().zip(&self.births) {
            line.age = view.time() - birth.time;
        }
        let rows = vec![summary(&lines, ranks)];
        Readings { rows, lines: Some(lines), ..Readings::default() }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        stored.add_records("births", &self.births);
        stored.add_numbers("looks", &[self.looks as f64], ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        self.births = stored.records("births")?;
        self.looks = *stored.numbers("looks", ranks)?.first()? as u64;
        Some(())
    }
}

impl Followed {
    /// The present pairs, ascending; those that touched at the last sample keep the time at which they began to touch.
    fn followed(&self, pairs: impl Iterator<Item = [u64; 2]>, now: f64) -> Vec<Birth> {
        let mut known = self.births.iter().peekable();
        let birth = |ids: [u64; 2]| {
            while known.next_if(|birth| birth.ids() < ids).is_some() {}
            let time = known.peek().filter(|birth| birth.ids() == ids).map_or(now, |it| it.time);
            Birth { lower: ids[0], higher: ids[1], time }
        };
        pairs.map(birth).collect()
    }
}

/// The lines of the touching pairs, each on the rank that owns the lower id, ascending. Collective.
fn lines_of(view: &View<'_>, ranks: &dyn Communicator) -> Vec<ContactLine> {
    let mut lines = Vec::with_capacity(3 * view.samples().len());
    view.for_each_pair_force(|pair| {
        if pair.touching {
            lines.push(line_of(&pair, view));
        }
    });
    // Lines are large, so their places are sorted.
    let places =
        lines.iter().enumerate().map(|(place, line)| [line.lower, line.higher, place as u64]);
    let places = ascending(places.collect(), |&[lower, higher, _]| [lower, higher]);
    let mut lines: Vec<ContactLine> =
        places.into_iter().map(|[_, _, place]| lines[place as usize]).collect();
    view.ownership().align(&mut lines, |line| [line.lower, line.higher], ranks);
    lines
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
