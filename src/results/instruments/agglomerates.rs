//! Agglomerates: connected sets of contacts that persist, their properties, and their breakage and growth.
//!
//! Source: Liu, van Wachem, Mudde, Chen & van Ommen, Powder Technology (2016), sections 2.3, 2.4 and 3.2.

mod columns;
mod rows;

use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Layout, Readings, Setting};
use crate::analysis::agglomerates::{Agglomerates as Found, Search};
use crate::analysis::breakage::{AtLag, Changes, Look, RateCounts};
use crate::analysis::{Pair, Persistence, PersistentContacts};
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

/// Settings of the kind `agglomerates`.
#[derive(Clone, Debug, PartialEq)]
pub struct Agglomerates {
    persistence: Persistence,
    /// Number of samples from one reference time to the next.
    looks_per_window: u64,
    /// Sets of fewer particles do not count as agglomerates.
    smallest: u64,
    /// Ascending limits of the number of members, for distributions and rates.
    sizes: Vec<u64>,
    /// Number of agglomerates below which tau_N15 is reached.
    few: u64,
    /// Relative range within which a diameter is steady.
    steady: f64,
    /// Number of members that must be lost or gained for an event.
    event: u64,
    every: f64,
}

/// Agglomerates over windows of time, each with its own reference time t_0.
struct Followed {
    settings: Agglomerates,
    reference: Option<Reference>,
    /// The agglomerates at the end of the previous window.
    before: Option<Look>,
    /// Results of the last sample.
    last: Option<Look>,
    rates: RateCounts,
}

/// A window that begins at its reference time.
struct Reference {
    time: f64,
    contacts: PersistentContacts,
    /// Results so far.
    at_lags: Vec<AtLag>,
}

const PERSISTENCE: &[Word] = &[
    Word::new("both_times", "a contact of t_0 counts if the pair touches now (Liu et al. 2016)"),
    Word::new(
        "every_look",
        "a contact of t_0 counts if the pair has touched at every sample since",
    ),
];

impl RegisteredInstrument for Agglomerates {
    const MEANING: &'static str =
        "agglomerates: connected sets of the contacts that persist since a reference time t_0";

    const KEYS: &'static [Key] = &[
        Key::number(
            "window",
            Allowed::POSITIVE,
            "Time from one t_0 to the next, a whole multiple of `every`: the largest lag",
        )
        .unit("time"),
        Key::word("persistence", PERSISTENCE, "Which contacts have persisted")
            .default(Value::Word("both_times")),
        Key::new(
            "smallest",
            Kind::Count(2, 1_000_000),
            "Sets of fewer particles are no agglomerates",
        )
        .default(Value::Count(15)),
        Key::new(
            "sizes",
            Kind::List(Allowed::at_least(2.0)),
            "Ascending limits of the number of members, for distributions and rates",
        )
        .default(Value::Derived("`smallest` times 1, 2, 4 ... 65,536")),
        Key::new("few", Kind::Count(1, 1_000_000), "tau_N15 is reached with fewer agglomerates")
            .default(Value::Count(15)),
        Key::number(
            "steady",
            Allowed::FRACTION,
            "The diameter is steady (tau_ds) if it stays within this fraction of its mean",
        )
        .default(Value::Number(0.1)),
        Key::new(
            "event",
            Kind::Count(1, 1_000_000),
            "Members that are lost or gained over a window for an event of breakage or growth",
        )
        .default(Value::Count(1)),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let (every, window) = (values.number("every")?, values.number("window")?);
        let looks = window / every;
        if looks < 0.999 || (looks - looks.round()).abs() > 1.0e-6 * looks {
            values.fail("window", format!("must be a whole multiple of every, {every}"));
            return None;
        }
        let smallest = values.count("smallest")?;
        Some(Self {
            persistence: match values.word("persistence")? {
                "every_look" => Persistence::AtEveryLook,
                _ => Persistence::AtBothTimes,
            },
            looks_per_window: looks.round() as u64,
            smallest,
            sizes: sizes(values, smallest)?,
            few: values.count("few")?,
            steady: values.number("steady")?,
            event: values.count("event")?,
            every,
        })
    }

    fn begin(&self, _: &Setting<'_>) -> Box<dyn Instrument> {
        let rates = RateCounts::new(&self.sizes, self.event);
        Box::new(Followed {
            settings: self.clone(),
            reference: None,
            before: None,
            last: None,
            rates,
        })
    }
}

/// The limits of sizes, given or by default.
fn sizes(values: &dyn InstrumentValues, smallest: u64) -> Option<Vec<u64>> {
    if !values.is_given("sizes") {
        return Some((0..=16).map(|power| smallest << power).collect());
    }
    let sizes: Vec<u64> = values.numbers("sizes")?.iter().map(|&size| size as u64).collect();
    if sizes.len() < 2 || !sizes.is_sorted_by(|a, b| a < b) {
        values.fail("sizes", "must be two numbers or more, ascending".to_owned());
        return None;
    }
    Some(sizes)
}

impl Instrument for Followed {
    fn layout(&self) -> Layout {
        columns::layout(&self.settings)
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let Some(reference) = &mut self.reference else {
            self.begin_window(view, ranks);
            return Readings::default();
        };
        let bonds = reference.contacts.look(view.touching(ranks), view.ownership(), ranks);
        let lag = view.time() - reference.time;
        let search = Search {
            particles: view.samples(),
            bonds: &bonds,
            touching: view.touching(ranks),
            periodicity: view.periodicity(),
            smallest: self.settings.smallest,
        };
        let found = search.run(ranks);
        let (rows, at_lag) = rows::of_look(&found, &search, lag, &self.settings, ranks);
        reference.at_lags.push(at_lag);
        self.last = Some(Look::take(view.ownership().ids(), &found.labels));
        let mut readings = Readings { rows, ..Readings::default() };
        if reference.at_lags.len() as u64 >= self.settings.looks_per_window {
            readings.rows.extend(self.end_window(&found, &search, ranks));
            self.begin_window(view, ranks);
        }
        readings
    }

    fn agglomerates(&self, ids: &[u64], ranks: &dyn Communicator) -> Option<Vec<Option<u64>>> {
        let known = self.last.as_ref().map(|last| last.of(ids, ranks));
        Some(known.unwrap_or_else(|| vec![None; ids.len()]))
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        let reference = self.reference.as_ref();
        let contacts = reference.map(|reference| reference.contacts.stored()).unwrap_or_default();
        stored.add_records("contacts", contacts);
        let at_lags = reference.map(|reference| &reference.at_lags[..]).unwrap_or_default();
        let at_lags = at_lags.iter().flat_map(|at| [at.lag, at.count as f64, at.diameter]);
        let time = reference.map(|reference| reference.time);
        let numbers: Vec<f64> = time.into_iter().chain(at_lags).collect();
        stored.add_numbers("window", &numbers, ranks);
        let looks = [("before", &self.before), ("last", &self.last)];
        for (name, look) in looks {
            stored.add_records(name, look.as_ref().map(Look::records).unwrap_or_default());
        }
        let are_there = looks.map(|(_, look)| f64::from(u8::from(look.is_some())));
        stored.add_numbers("are_there", &are_there, ranks);
        let mut counts = self.rates.stored();
        ranks.sum_integers(&mut counts);
        let counts: Vec<f64> = counts.into_iter().map(|count| count as f64).collect();
        stored.add_numbers("rates", &counts, ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let contacts: Vec<Pair> = stored.records("contacts")?;
        let persistence = self.settings.persistence;
        let contacts = PersistentContacts::begin(persistence, &contacts);
        let window = stored.numbers("window", ranks)?;
        self.reference = window.split_first().map(|(&time, at_lags)| Reference {
            time,
            contacts,
            at_lags: at_lags
                .chunks_exact(3)
                .map(|at| AtLag { lag: at[0], count: at[1] as u64, diameter: at[2] })
                .collect(),
        });
        let are_there = stored.numbers("are_there", ranks)?;
        let looks = [("before", &mut self.before), ("last", &mut self.last)];
        for ((name, look), is_there) in looks.into_iter().zip(are_there) {
            let records = Look::of_records(stored.records(name)?);
            *look = (is_there == 1.0).then_some(records);
        }
        let counts = stored.numbers("rates", ranks)?;
        if ranks.is_root() {
            let counts: Vec<i64> = counts.into_iter().map(|count| count as i64).collect();
            self.rates.add_stored(&counts);
        }
        Some(())
    }
}

impl Followed {
    /// Takes the present contacts as those of t_0. Collective.
    fn begin_window(&mut self, view: &View<'_>, ranks: &dyn Communicator) {
        let contacts = PersistentContacts::begin(self.settings.persistence, view.touching(ranks));
        self.reference = Some(Reference { time: view.time(), contacts, at_lags: Vec::new() });
    }

    /// Computes critical times of the window, and the fate of the agglomerates of the previous one. Collective.
    fn end_window(
        &mut self,
        found: &Found,
        search: &Search<'_>,
        ranks: &dyn Communicator,
    ) -> Vec<super::Rows> {
        let now = self.last.clone().unwrap_or_default();
        let settings = &self.settings;
        let mut rows = Vec::new();
        if let Some(Reference { time, at_lags, .. }) = &self.reference {
            rows.push(rows::window(*time, at_lags, found, search, settings, ranks));
        }
        if let Some(before) = &self.before {
            let changes = Changes::between(before, &now, ranks);
            self.rates.add(&changes.fates);
            let window = settings.looks_per_window as f64 * settings.every;
            rows.push(rows::rates(&self.rates.rates(window, ranks)));
            rows.extend(rows::events(&changes.fates, settings.event, ranks));
        }
        self.before = Some(now);
        rows
    }
}
