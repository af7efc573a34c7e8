//! The tables of a study: one row for each run, each search, and each point.

use super::measured::QuantityColumns;
use crate::study::bisection::Bisection;
use crate::study::member::{Member, short_name};
use crate::study::plan::Point;
use crate::study::quantity::Value;
use crate::study::session::Session;
use crate::study::setting::{Setting, shortest};
use crate::study::task::{Records, RunState};
use std::collections::BTreeSet;
use std::sync::Arc;
use talcum_engine::fields::Column;
use talcum_results::output::{Cells, ResultTable, TableColumn};

/// The tables, and why values are missing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Collected {
    /// `runs`, `searches` if there are any, and `points`.
    pub(crate) tables: Vec<ResultTable>,
    /// Why quantities are missing from complete runs.
    pub(crate) failures: Vec<String>,
}

/// A run with its values; `None` for values that could not be read.
struct Row {
    member: Arc<Member>,
    state: RunState,
    measured: Vec<Option<Value>>,
}

/// Reads all runs and makes the tables. They depend only on the results, not on the order in which runs ended, or on
/// their ranks.
///
/// # Errors
/// If the case cannot be read.
pub(crate) fn collect(session: &Session<'_>) -> Result<Collected, String> {
    let mut collector = Collector { session, units: Vec::new(), failures: Vec::new() };
    collector.units = vec![None; session.study.quantities.len()];
    let mut rows = Vec::new();
    let search = session.study.bisection.as_ref();
    for task in &session.plan.tasks {
        let members = task.members(search, &session.factory, &session.results())?;
        rows.extend(members.into_iter().map(|member| collector.row(member)));
    }
    // The runs of a chain belong to several points.
    if search.is_none() {
        rows.sort_by_key(|row| (row.member.point, row.member.replicate));
    }
    let provenance = collector.provenance(&rows);
    let mut tables = vec![collector.runs(&rows)];
    match search {
        Some(search) => {
            let records = collector.searches(search)?;
            tables.push(collector.search_table(&records));
            tables.push(collector.critical(search, &records));
        }
        None => tables.push(collector.points(&rows)),
    }
    for table in &mut tables {
        table.provenance.clone_from(&provenance);
    }
    Ok(Collected { tables, failures: collector.failures })
}

pub(super) struct Collector<'s> {
    pub(super) session: &'s Session<'s>,
    /// Units of the quantities, as far as a run has given them.
    units: Vec<Option<String>>,
    failures: Vec<String>,
}

impl Collector<'_> {
    fn row(&mut self, member: Arc<Member>) -> Row {
        let (folder, study) = (self.session.folder, self.session.study);
        let state = folder.state(&member);
        let mut measured = vec![None; study.quantities.len()];
        if let RunState::Done(_) = state {
            for (index, quantity) in study.quantities.iter().enumerate() {
                match self.session.results().measure(&member, &quantity.name) {
                    Ok(value) => {
                        if let Value::Nothing(reason) = &value.value {
                            log::info!("{}: {}: {reason}", folder.name_of(&member), quantity.name);
                        }
                        measured[index] = Some(value.value);
                        self.units[index].get_or_insert(value.unit);
                    }
                    Err(error) => self.failures.push(error),
                }
            }
        }
        Row { member, state, measured }
    }

    fn runs(&self, rows: &[Row]) -> ResultTable {
        let folder = self.session.folder;
        let point = rows.iter().map(|row| row.member.point as u64 + 1).collect();
        let mut columns = vec![
            text_column(rows, "run", "folder in runs/", &|row| {
                folder.name_of(&row.member).to_owned()
            }),
            Column::new("point", "number of the point", Cells::Whole(point)),
        ];
        let settings: Vec<&[Setting]> =
            rows.iter().map(|row| row.member.settings.as_slice()).collect();
        columns.extend(self.key_columns(&self.session.study.varied_keys(), &settings));
        columns.extend(self.origin_columns(rows));
        for (index, quantity) in self.session.study.quantities.iter().enumerate() {
            let values: Vec<_> = rows.iter().map(|row| row.measured[index].as_ref()).collect();
            let unit = self.unit_of(index);
            columns.push(QuantityColumns { quantity, unit }.of_runs(&values));
        }
        ResultTable::new("runs", columns)
    }

    /// The unit of a quantity; empty if no run has given it.
    fn unit_of(&self, quantity: usize) -> &str {
        self.units[quantity].as_deref().unwrap_or_default()
    }

    /// State, digest and provenance of each run.
    fn origin_columns(&self, rows: &[Row]) -> Vec<TableColumn> {
        let digest = |row: &Row| match &row.state {
            RunState::Done(digest) => digest.clone(),
            _ => String::new(),
        };
        let mut columns = vec![
            text_column(rows, "state", "of the run", &|row| state_name(&row.state).to_owned()),
            text_column(rows, "digest", "of the last state", &digest),
        ];
        if self.session.study.continuation.is_some() || self.session.study.start.is_some() {
            let before = |row: &Row| match (&row.member.predecessor, &row.member.start) {
                (Some(run), _) => self.session.folder.name_of(run).to_owned(),
                (None, Some(start)) => start.name.clone(),
                (None, None) => String::new(),
            };
            columns.push(text_column(rows, "begins_with", "run whose end it begins with", &before));
        }
        let identity = |row: &Row| row.member.identity.clone();
        let about = "hash of what decides the results";
        columns.push(text_column(rows, "identity_blake3", about, &identity));
        columns
    }

    /// Mean and interval over the replicates of every point.
    fn points(&self, rows: &[Row]) -> ResultTable {
        let points = &self.session.plan.points;
        let mut columns = self.point_columns(points);
        let is_done = |row: &&Row| matches!(row.state, RunState::Done(_));
        let of_point =
            |point: usize| rows.iter().filter(is_done).filter(move |row| row.member.point == point);
        let counts = (0..points.len()).map(|point| of_point(point).count() as u64).collect();
        columns.push(Column::new("runs", "complete runs of the point", Cells::Whole(counts)));
        for (index, quantity) in self.session.study.quantities.iter().enumerate() {
            let values: Vec<Vec<_>> = (0..points.len())
                .map(|point| of_point(point).map(|row| row.measured[index].as_ref()).collect())
                .collect();
            let (unit, confidence) = (self.unit_of(index), self.session.study.confidence);
            columns.extend(QuantityColumns { quantity, unit }.of_points(&values, confidence));
        }
        ResultTable::new("points", columns)
    }

    /// The number of each point, and its settings.
    pub(super) fn point_columns(&self, points: &[Point]) -> Vec<TableColumn> {
        let numbers = (1..=points.len() as u64).collect();
        let keys: Vec<String> =
            self.session.study.axes.iter().flat_map(|axis| axis.keys.clone()).collect();
        let settings: Vec<&[Setting]> =
            points.iter().map(|point| point.settings.as_slice()).collect();
        let number = Column::new("point", "number of the point", Cells::Whole(numbers));
        [number].into_iter().chain(self.key_columns(&keys, &settings)).collect()
    }

    /// A column for each key, under its short name.
    pub(super) fn key_columns(&self, keys: &[String], rows: &[&[Setting]]) -> Vec<TableColumn> {
        let all = self.session.study.varied_keys();
        let column = |key: &String| {
            let value = |settings: &&[Setting]| {
                let setting = settings.iter().find(|setting| setting.key == *key);
                setting.map(|setting| setting.value.plain()).unwrap_or_default()
            };
            let cells = Cells::of_values(rows.iter().map(value).collect());
            Column::new(&short_name(key, &all), &format!("{key} of the case"), cells)
        };
        keys.iter().map(column).collect()
    }

    /// Provenance of the tables. It does not depend on ranks, machines or dates.
    fn provenance(&self, rows: &[Row]) -> Vec<(String, String)> {
        let study = self.session.study;
        let done: Vec<&Row> =
            rows.iter().filter(|row| matches!(row.state, RunState::Done(_))).collect();
        let of_runs = |name: &str| {
            let texts =
                done.iter().flat_map(|row| self.session.folder.provenance(&row.member, name));
            texts.collect::<BTreeSet<String>>().into_iter().collect::<Vec<_>>().join(", ")
        };
        let file_name = |path: &std::path::Path| {
            path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
        };
        let case = std::fs::read(&study.case).unwrap_or_default();
        let mut entries = vec![
            ("title", study.title.clone()),
            ("study", file_name(&study.file)),
            ("talcum_version", of_runs("talcum_version")),
            ("commit", of_runs("commit")),
            ("units", of_runs("units")),
            ("case", file_name(&study.case)),
            ("case_blake3", blake3::hash(&case).to_hex().to_string()),
            ("confidence", shortest(study.confidence)),
        ];
        entries.extend(study.common.iter().map(|setting| ("set", setting.argument())));
        if let Some(search) = &study.bisection {
            let Bisection { key, quantity, threshold, tolerance, direction, .. } = search;
            let text = format!(
                "{key} where {quantity} crosses {threshold} ({}), tolerance {tolerance}",
                direction.name()
            );
            entries.push(("search", text));
        }
        let quantities = study.quantities.iter();
        entries.extend(
            quantities.map(|q| ("measure", format!("{}: {}", q.name, q.quantity.describe()))),
        );
        entries.into_iter().map(|(name, text)| (name.to_owned(), text)).collect()
    }
}

fn text_column(rows: &[Row], name: &str, about: &str, of: &dyn Fn(&Row) -> String) -> TableColumn {
    Column::new(name, about, Cells::Text(rows.iter().map(of).collect()))
}

/// The name of a run's state in tables and for `--status`.
pub(crate) fn state_name(state: &RunState) -> &'static str {
    match state {
        RunState::Done(_) => "complete",
        RunState::Failed(_) => "failed",
        RunState::Waiting | RunState::Begun => "not complete",
    }
}
