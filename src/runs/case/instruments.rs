//! The instruments of a run, from their sections.

use super::Case;
use super::context::require_a_step;
use crate::input::Section;
use talcum_engine::domain::{Bounds, Vibration};
use talcum_engine::grid::BoxGrid;
use talcum_engine::schema::KeyValues;
use talcum_engine::state::SizeRange;
use talcum_results::instruments::{InstrumentKind, InstrumentPlan, InstrumentValues};

/// The interface through which a kind of instrument reads its keys.
struct InstrumentSection<'a> {
    section: &'a Section<'a>,
    case: &'a Case,
}

/// Reads all `[measure.NAME]` sections, for a case that is otherwise complete.
pub(super) fn read_instruments(root: &Section<'_>, case: &Case) -> Option<Vec<InstrumentPlan>> {
    let plans = root.named("measure").into_iter().map(|(name, section)| {
        if !is_name(name) {
            section.problems.add(section.node.error(
                "its name is part of a file's name: it may have A to Z, a to z, 0 to 9, _ and - only",
            ));
            return None;
        }
        read_instrument(name, &section, case)
    });
    // All of them are read, so that all errors are reported.
    plans.collect::<Vec<_>>().into_iter().collect()
}

/// Checks that the instrument whose agglomerates snapshots contain is one of agglomerates.
pub(super) fn check_agglomerates(output: &Section<'_>, case: &Case) {
    let Some(name) = &case.output.agglomerates else { return };
    let is_it = |plan: &&InstrumentPlan| plan.name == *name;
    if !matches!(
        case.instruments.iter().find(is_it).map(|plan| &plan.kind),
        Some(InstrumentKind::Agglomerates(_))
    ) {
        let message = "must be the NAME of a [measure.NAME] of the kind \"agglomerates\"";
        output.fail("agglomerates", message);
    }
}

fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(allowed)
}

fn read_instrument(name: &str, section: &Section<'_>, case: &Case) -> Option<InstrumentPlan> {
    let every = section.number("every");
    let step = case.stages.first().map(|stage| stage.physics.time_step);
    require_a_step(section, "every", every, step);
    let kind = section.word("kind")?;
    let kind = InstrumentKind::from_keys(kind, &InstrumentSection { section, case });
    Some(InstrumentPlan {
        name: name.to_owned(),
        every: every?,
        start: section.number("start")?,
        kind: kind?,
    })
}

impl KeyValues for InstrumentSection<'_> {
    fn number(&self, key: &str) -> Option<f64> {
        self.section.number(key)
    }

    fn word(&self, key: &str) -> Option<&str> {
        self.section.word(key)
    }

    fn is_given(&self, key: &str) -> bool {
        self.section.has(key)
    }
}

impl InstrumentValues for InstrumentSection<'_> {
    fn count(&self, key: &str) -> Option<u64> {
        self.section.count(key)
    }

    fn counts(&self, key: &str) -> Option<[usize; 3]> {
        self.section.counts(key)
    }

    fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        self.section.numbers(key)
    }

    fn fail(&self, key: &'static str, message: String) {
        self.section.fail(key, message);
    }

    fn bounds(&self) -> &Bounds {
        &self.case.domain.bounds
    }

    fn sizes(&self) -> Option<SizeRange> {
        self.case.size_range()
    }

    fn gas_grid(&self) -> Option<&BoxGrid> {
        self.case.volume_averaged().map(|model| &model.grid)
    }

    fn vibration(&self) -> Option<Vibration> {
        self.case.stages.iter().find_map(|stage| stage.physics.gravity.vibration)
    }
}
