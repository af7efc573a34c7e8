//! The tables of searches for critical values: one row for each search, and one for each point.

use super::collect::Collector;
use super::replicates::Replicates;
use crate::study::bisection::{Bisection, Search};
use crate::study::plan::Point;
use crate::study::setting::Setting;
use crate::study::task::{SearchRecord, Task};
use talcum_engine::fields::Column;
use talcum_results::output::{Cells, ResultTable};

impl Collector<'_> {
    pub(super) fn searches(
        &self,
        search: &Bisection,
    ) -> Result<Vec<(&Task, SearchRecord)>, String> {
        let session = self.session;
        let record = |task| {
            Task::search(task, search, &session.factory, &session.results()).map(|r| (task, r))
        };
        session.plan.tasks.iter().map(record).collect()
    }

    /// One row for each search.
    pub(super) fn search_table(&self, records: &[(&Task, SearchRecord)]) -> ResultTable {
        let study = self.session.study;
        let keys: Vec<String> =
            study.replicates.iter().flat_map(|axis| axis.keys.clone()).collect();
        let points: Vec<Point> =
            records.iter().map(|(task, _)| self.session.plan.points[task.point].clone()).collect();
        let mut columns = self.point_columns(&points);
        columns[0].values =
            Cells::Whole(records.iter().map(|(task, _)| task.point as u64 + 1).collect());
        let seeds: Vec<Vec<Setting>> = records
            .iter()
            .map(|(task, _)| {
                study.replicates.iter().flat_map(|a| a.settings(task.replicate)).collect()
            })
            .collect();
        let seeds: Vec<&[Setting]> = seeds.iter().map(Vec::as_slice).collect();
        columns.extend(self.key_columns(&keys, &seeds));
        let states = records.iter().map(|(_, record)| search_state(record).to_owned()).collect();
        columns.push(Column::new("state", "of the search", Cells::Text(states)));
        let runs = records.iter().map(|(_, record)| record.members.len() as u64).collect();
        columns.push(Column::new("runs", "runs of the search", Cells::Whole(runs)));
        for (index, name) in ["lower", "upper"].into_iter().enumerate() {
            let end =
                |(_, record): &(&Task, SearchRecord)| found(record).map_or(f64::NAN, |f| f[index]);
            let about = "end of the last bracket";
            columns.push(Column::new(
                name,
                about,
                Cells::Number(records.iter().map(end).collect()),
            ));
        }
        ResultTable::new("searches", columns)
    }

    /// The critical value of every point, with its interval over the replicates.
    pub(super) fn critical(
        &self,
        search: &Bisection,
        records: &[(&Task, SearchRecord)],
    ) -> ResultTable {
        let points = &self.session.plan.points;
        let mut columns = self.point_columns(points);
        let brackets = |point: usize| -> Vec<[f64; 2]> {
            let of_point = records.iter().filter(move |(task, _)| task.point == point);
            of_point.filter_map(|(_, record)| found(record)).collect()
        };
        let found: Vec<Vec<[f64; 2]>> = (0..points.len()).map(brackets).collect();
        let counts = found.iter().map(|found| found.len() as u64).collect();
        columns.push(Column::new("found", "searches that found a crossing", Cells::Whole(counts)));
        let estimates: Vec<[f64; 5]> = found
            .iter()
            .map(|found| critical_value(search, found, self.session.study.confidence))
            .collect();
        let names = [
            ("critical", "mean of the middles of the last brackets"),
            ("deviation", "standard deviation of the middles"),
            ("lower", "lower end of the interval"),
            ("upper", "upper end of the interval"),
            ("resolution", "half the width of the widest last bracket"),
        ];
        for (index, (name, about)) in names.into_iter().enumerate() {
            let values = estimates.iter().map(|estimate| estimate[index]).collect();
            columns.push(Column::new(name, about, Cells::Number(values)));
        }
        ResultTable::new("points", columns)
    }
}

fn search_state(record: &SearchRecord) -> &'static str {
    match (&record.failure, &record.search) {
        (Some(_), _) => "failed",
        (None, Search::Found(_)) => "found",
        (None, Search::Unchanged { .. }) => "no crossing",
        (None, Search::Needs(_)) => "not complete",
    }
}

fn found(record: &SearchRecord) -> Option<[f64; 2]> {
    match record.search {
        Search::Found(bracket) if record.failure.is_none() => Some(bracket),
        _ => None,
    }
}

/// Mean, deviation, lower and upper end of the interval, and resolution, for the last brackets of some searches.
///
/// Student's interval is widened by the resolution at both ends, since the crossing lies anywhere in a bracket. For a
/// single search there is only its bracket.
fn critical_value(search: &Bisection, brackets: &[[f64; 2]], confidence: f64) -> [f64; 5] {
    let middles: Vec<f64> =
        brackets.iter().map(|&[lower, upper]| search.middle(lower, upper)).collect();
    let Some(estimate) = Replicates::of(&middles, confidence) else { return [f64::NAN; 5] };
    let half_widths = brackets.iter().map(|&[lower, upper]| 0.5 * (upper - lower));
    let resolution = half_widths.fold(0.0, f64::max);
    let (lower, upper) = match brackets {
        &[[lower, upper]] => (lower, upper),
        _ => {
            let half_width = estimate.half_width + resolution;
            (estimate.mean - half_width, estimate.mean + half_width)
        }
    };
    [estimate.mean, estimate.deviation, lower, upper, resolution]
}
