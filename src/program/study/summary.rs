//! `talcum summary`: a table of statistics of runs that were made by hand.

use crate::study::case_text::EffectiveCase;
use crate::study::folder::{COMPLETE, digest_of};
use crate::study::member::short_name;
use crate::study::quantity::{Quantity, Reduction, Registry, Statistic, Value, Window, reduced};
use crate::study::table::{OfPoints, csv};
use anyhow::{Context, bail};
use clap::Args;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use talcum_engine::fields::Column;
use talcum_results::output::readers::SeriesTable;
use talcum_results::output::{Cells, ResultTable, TableColumn, print, read_text};

/// Options of `talcum summary`.
#[derive(Clone, Debug, Args)]
pub struct SummaryOptions {
    /// The folders of results.
    #[arg(required = true)]
    pub(crate) results: Vec<PathBuf>,
    /// Include this column of series.csv (default: all columns, or none with --quantity); may be repeated.
    #[arg(long = "column", value_name = "NAME")]
    pub(crate) columns: Vec<String>,
    /// Include this number of `talcum analyse` (waves.speed), or of an instrument of the case (NAME.COLUMN); may be
    /// repeated.
    #[arg(long = "quantity", alias = "measure", value_name = "NAME")]
    pub(crate) quantities: Vec<String>,
    /// Take this statistic of the rows: mean, last, max, min or deviation; it does not apply to `talcum analyse`.
    #[arg(long, value_name = "NAME", default_value = "mean")]
    pub(crate) statistic: String,
    /// Ignore everything before this time.
    #[arg(long, value_name = "TIME")]
    pub(crate) from: Option<f64>,
    /// Ignore everything after this time.
    #[arg(long, value_name = "TIME")]
    pub(crate) to: Option<f64>,
    /// Use only so much time before the end of each run; excludes --from and --to.
    #[arg(long, value_name = "DURATION", conflicts_with_all = ["from", "to"])]
    pub(crate) last: Option<f64>,
    /// Print means and intervals over runs that differ only in their seeds, instead of a row for each run.
    #[arg(long)]
    pub(crate) points: bool,
    /// Confidence level of the intervals.
    #[arg(long, value_name = "LEVEL", default_value_t = 0.95)]
    pub(crate) confidence: f64,
    /// Write runs.csv and points.csv to this folder, instead of printing a table.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}

/// A run made by hand.
struct Run {
    folder: String,
    digest: String,
    case_blake3: String,
    keys: BTreeMap<String, String>,
    series: SeriesTable,
}

/// Prints or writes the tables.
///
/// # Errors
/// If a folder holds no results, or a column is unknown.
pub fn summary(options: &SummaryOptions) -> anyhow::Result<()> {
    let Some(statistic) = Statistic::named(&options.statistic) else {
        bail!("--statistic {}: must be mean, last, max, min or deviation", options.statistic);
    };
    if !(0.5..=0.999).contains(&options.confidence) {
        bail!("--confidence {}: must be from 0.5 to 0.999", options.confidence);
    }
    let runs: anyhow::Result<Vec<Run>> =
        options.results.iter().map(|folder| read(folder)).collect();
    let summary = Summary::new(runs?, options, statistic)?;
    let tables = [summary.runs(), summary.points()];
    match &options.output {
        Some(folder) => {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            csv::write(&tables, folder).map_err(anyhow::Error::msg)?;
        }
        None => print(csv::text(&tables[usize::from(options.points)]).trim_end())?,
    }
    Ok(())
}

fn read(folder: &Path) -> anyhow::Result<Run> {
    let text = |name: &str| {
        let path = folder.join(name);
        read_text(&path).with_context(|| format!("{} cannot be read", path.display()))
    };
    let case_text = text("case.toml")?;
    let case = EffectiveCase::parse(&case_text);
    let case =
        case.map_err(|message| anyhow::anyhow!("{}/case.toml: {message}", folder.display()))?;
    // Without a digest the run has not come to its end.
    let digest = text(COMPLETE).ok().and_then(|text| digest_of(&text)).unwrap_or_default();
    Ok(Run {
        folder: folder.display().to_string(),
        digest,
        case_blake3: blake3::hash(case_text.as_bytes()).to_hex().to_string(),
        keys: case.flat(),
        series: SeriesTable::read(&folder.join("series.csv"))?,
    })
}

/// The seed: runs that differ in nothing else are replicates.
const REPLICATE_KEYS: [&str; 1] = [crate::study::setting::SEED];

struct Summary<'o> {
    runs: Vec<Run>,
    options: &'o SummaryOptions,
    /// Keys that differ between the cases.
    keys: Vec<String>,
    columns: Vec<(String, String)>,
    /// A row of numbers for each run.
    values: Vec<Vec<f64>>,
}

impl<'o> Summary<'o> {
    fn new(
        runs: Vec<Run>,
        options: &'o SummaryOptions,
        statistic: Statistic,
    ) -> anyhow::Result<Self> {
        let columns = columns(&runs, options)?;
        let SummaryOptions { from, to, last, .. } = *options;
        let reduction = Reduction { statistic, window: Window { from, to, last } };
        let mut values = Vec::new();
        for run in &runs {
            let row: Result<Vec<f64>, String> =
                columns.iter().map(|(name, _)| value_of(&run.series, name, &reduction)).collect();
            values
                .push(row.map_err(|error| anyhow::anyhow!("{}/series.csv: {error}", run.folder))?);
        }
        let mut summary = Self { keys: differing_keys(&runs), runs, options, columns, values };
        let registry = Registry::default();
        for name in &options.quantities {
            let quantity = registry.of_results(name, reduction, &options.results);
            let quantity =
                quantity.map_err(|error| anyhow::anyhow!("--quantity {name}: {error}"))?;
            summary.add(name, quantity.as_ref()).with_context(|| format!("--quantity {name}"))?;
        }
        Ok(summary)
    }

    /// Adds a column. Where a run gives nothing, the reason is printed and the cell stays empty.
    fn add(&mut self, name: &str, quantity: &dyn Quantity) -> anyhow::Result<()> {
        let mut unit = None;
        for (run, row) in self.runs.iter().zip(&mut self.values) {
            let measured = quantity.value(Path::new(&run.folder))?;
            row.push(match measured.value {
                Value::Number(value) => value,
                Value::Text(reason) | Value::Nothing(reason) => {
                    log::warn!("{}: {name}: {reason}", run.folder);
                    f64::NAN
                }
            });
            unit.get_or_insert(measured.unit);
        }
        self.columns.push((name.to_owned(), unit.unwrap_or_default()));
        Ok(())
    }

    fn runs(&self) -> ResultTable {
        let all: Vec<usize> = (0..self.runs.len()).collect();
        let text = |of: &dyn Fn(&Run) -> &String| {
            Cells::Text(self.runs.iter().map(|run| of(run).clone()).collect())
        };
        let mut columns = vec![Column::new("run", "folder", text(&|run| &run.folder))];
        columns.extend(self.keys.iter().map(|key| self.key_column(key, &all)));
        columns.push(Column::new("digest", "of the last state", text(&|run| &run.digest)));
        columns.push(Column::new(
            "case_blake3",
            "hash of case.toml",
            text(&|run| &run.case_blake3),
        ));
        for (index, (name, unit)) in self.columns.iter().enumerate() {
            let values = self.values.iter().map(|row| row[index]).collect();
            columns.push(Column::numbers(name, unit, "of the run", values));
        }
        ResultTable { provenance: self.provenance(), ..ResultTable::new("runs", columns) }
    }

    /// One row for runs that differ only in their seeds.
    fn points(&self) -> ResultTable {
        let keys: Vec<&String> =
            self.keys.iter().filter(|key| !REPLICATE_KEYS.contains(&key.as_str())).collect();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for run in 0..self.runs.len() {
            let alike = |group: &&mut Vec<usize>| {
                keys.iter()
                    .all(|key| self.runs[group[0]].keys.get(*key) == self.runs[run].keys.get(*key))
            };
            match groups.iter_mut().find(alike) {
                Some(group) => group.push(run),
                None => groups.push(vec![run]),
            }
        }
        let first: Vec<usize> = groups.iter().map(|group| group[0]).collect();
        let mut columns: Vec<TableColumn> =
            keys.iter().map(|key| self.key_column(key, &first)).collect();
        let counts = groups.iter().map(|group| group.len() as u64).collect();
        columns.push(Column::new("runs", "runs of the point", Cells::Whole(counts)));
        for (index, (name, unit)) in self.columns.iter().enumerate() {
            columns.extend(self.estimates(&groups, index, name, unit));
        }
        ResultTable { provenance: self.provenance(), ..ResultTable::new("points", columns) }
    }

    fn estimates(
        &self,
        groups: &[Vec<usize>],
        index: usize,
        name: &str,
        unit: &str,
    ) -> Vec<TableColumn> {
        let given = |group: &Vec<usize>| -> Vec<f64> {
            let values = group.iter().map(|&run| self.values[run][index]);
            values.filter(|value| !value.is_nan()).collect()
        };
        let given: Vec<Vec<f64>> = groups.iter().map(given).collect();
        let of_points = OfPoints { name, unit, given: &given };
        let may_be_nothing = self.options.quantities.iter().any(|quantity| quantity == name);
        of_points.columns(may_be_nothing, self.options.confidence)
    }

    fn key_column(&self, key: &String, runs: &[usize]) -> TableColumn {
        let value = |&run: &usize| self.runs[run].keys.get(key).cloned().unwrap_or_default();
        let cells = Cells::of_values(runs.iter().map(value).collect());
        Column::new(&short_name(key, &self.keys), &format!("{key} of the case"), cells)
    }

    fn provenance(&self) -> Vec<(String, String)> {
        let distinct = |name: &str| {
            let entries = self.runs.iter().filter_map(|run| run.series.entry(name));
            entries
                .collect::<std::collections::BTreeSet<_>>()
                .into_iter()
                .collect::<Vec<_>>()
                .join(", ")
        };
        let entries =
            ["talcum_version", "commit", "units"].map(|name| (name.to_owned(), distinct(name)));
        let SummaryOptions { from, to, last, statistic, confidence, .. } = self.options;
        let ends = [("from", from), ("to", to), ("last", last)].into_iter();
        let window = ends.filter_map(|(end, time)| Some(format!(" {end} {}", (*time)?)));
        let statistic = format!("{statistic}{}", window.collect::<String>());
        let own = [("statistic", statistic), ("confidence", confidence.to_string())];
        entries.into_iter().chain(own.map(|(name, text)| (name.to_owned(), text))).collect()
    }
}

fn value_of(series: &SeriesTable, column: &str, reduction: &Reduction) -> Result<f64, String> {
    match reduced(series, column, reduction)?.value {
        Value::Number(value) => Ok(value),
        Value::Text(_) | Value::Nothing(_) => Ok(f64::NAN),
    }
}

/// The requested columns, which all runs must have, with their units.
fn columns(runs: &[Run], options: &SummaryOptions) -> anyhow::Result<Vec<(String, String)>> {
    let Some(first) = runs.first() else { bail!("there are no runs") };
    let in_all = |name: &str| {
        runs.iter().all(|run| run.series.columns.iter().any(|(known, _)| known == name))
    };
    let all = first.series.columns.iter().filter(|(name, _)| name != "time" && in_all(name));
    if options.columns.is_empty() {
        return Ok(if options.quantities.is_empty() { all.cloned().collect() } else { Vec::new() });
    }
    let known: Vec<(String, String)> = all.cloned().collect();
    let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
    let find = |wanted: &String| {
        let column = known.iter().find(|(name, _)| name == wanted).cloned();
        column.with_context(|| {
            format!(
                "--column {wanted}: no such column: {}",
                talcum_runs::input::advice(wanted, &names)
            )
        })
    };
    options.columns.iter().map(find).collect()
}

/// Keys that do not have the same value in all cases.
fn differing_keys(runs: &[Run]) -> Vec<String> {
    let all: std::collections::BTreeSet<&String> =
        runs.iter().flat_map(|run| run.keys.keys()).collect();
    let differs =
        |key: &&&String| runs.iter().any(|run| run.keys.get(**key) != runs[0].keys.get(**key));
    all.iter().filter(differs).map(|key| (**key).clone()).collect()
}
