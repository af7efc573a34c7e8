//! The columns of `series.csv` that are drawn.

use anyhow::bail;
use talcum_results::analysis::SeriesRow;
use talcum_results::output::readers::SeriesTable;

/// The default columns: for each row, the first column with data worth drawing.
const DEFAULTS: [&[&str]; 4] = [
    &["grid_pressure_drop", "gas_force", "plate_stress"],
    &["bed_top", "centre_height"],
    &["fluctuating_kinetic_energy"],
    &["coordination_number"],
];

/// Numbers over time that can be drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) name: String,
    /// Its unit; empty for a pure number.
    pub(super) unit: String,
    /// Time and value, finite, in the order of time.
    pub(super) points: Vec<(f64, f64)>,
}

impl Curve {
    /// Name and unit.
    pub(super) fn title(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }

    /// The least and the largest value; `None` without any.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let values = self.points.iter().map(|point| point.1);
        values.fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((least, largest)) => Some((value.min(least), value.max(largest))),
        })
    }

    /// The decimal logarithms of the values above zero.
    pub(super) fn logarithm(&self) -> Self {
        let positive = self.points.iter().filter(|point| point.1 > 0.0);
        Self {
            points: positive.map(|&(time, value)| (time, value.log10())).collect(),
            ..self.clone()
        }
    }

    /// The last value.
    pub(super) fn last(&self) -> Option<f64> {
        self.points.last().map(|point| point.1)
    }
}

/// Rejects names that no column has.
///
/// # Errors
/// If there is such a name; the message lists the columns.
pub(super) fn check_columns(wanted: &[String], series: Option<&SeriesTable>) -> anyhow::Result<()> {
    let written = series.map(names);
    // Before the run has begun its table, its future columns are used.
    let known =
        written.unwrap_or_else(|| SeriesRow::COLUMNS.iter().map(|known| &*known.name).collect());
    let known: Vec<&str> = known.into_iter().filter(|name| *name != "time").collect();
    match wanted.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) => {
            bail!("--columns {name}: series.csv has no such column; there are {}", known.join(", "))
        }
        None => Ok(()),
    }
}

/// The curves of the requested columns, or of those with data worth drawing.
pub(super) fn chosen(wanted: &[String], series: &SeriesTable) -> Vec<Curve> {
    if wanted.is_empty() {
        let first_alive =
            |names: &&[&str]| names.iter().filter_map(|name| curve(series, name)).find(is_alive);
        return DEFAULTS.iter().filter_map(first_alive).collect();
    }
    wanted.iter().filter_map(|name| curve(series, name)).collect()
}

/// The curves of all columns.
pub(super) fn all(series: &SeriesTable) -> Vec<Curve> {
    let names = names(series).into_iter().filter(|name| *name != "time");
    names.filter_map(|name| curve(series, name)).collect()
}

fn names(series: &SeriesTable) -> Vec<&str> {
    series.columns.iter().map(|(name, _)| name.as_str()).collect()
}

fn curve(series: &SeriesTable, name: &str) -> Option<Curve> {
    let (times, values) = (series.column("time")?, series.column(name)?);
    let unit = &series.columns[series.position(name)?].1;
    let points = times.into_iter().zip(values);
    Some(Curve {
        name: name.to_owned(),
        unit: if unit == "1" { String::new() } else { unit.clone() },
        points: points.filter(|(time, value)| time.is_finite() && value.is_finite()).collect(),
    })
}

/// Whether a column is not all zeros; zeros mean that the run has no such thing, such as a gas or a plate.
fn is_alive(curve: &Curve) -> bool {
    curve.points.iter().any(|point| point.1 != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "time [s],grid_pressure_drop [1],plate_stress [1],bed_top [m],odd [1]\n\
                        0,0,0.5,2,NaN\n1,0,0.25,3,7\n";

    fn names_of(curves: &[Curve]) -> Vec<&str> {
        curves.iter().map(|curve| curve.name.as_str()).collect()
    }

    #[test]
    fn columns_with_something_to_show_are_chosen_unless_others_are_named() {
        let series = SeriesTable::parse(TEXT).unwrap();
        // The pressure drop is zero, so the stress on the plate represents the load.
        assert_eq!(names_of(&chosen(&[], &series)), ["plate_stress", "bed_top"]);
        let with_gas = SeriesTable::parse(&TEXT.replace("1,0,0.25", "1,0.9,0.25")).unwrap();
        assert_eq!(names_of(&chosen(&[], &with_gas)), ["grid_pressure_drop", "bed_top"]);
        assert_eq!(names_of(&chosen(&["odd".to_owned()], &series)), ["odd"]);
        assert_eq!(all(&series).len(), 4);
    }

    #[test]
    fn a_curve_has_its_unit_range_and_finite_points() {
        let series = SeriesTable::parse(TEXT).unwrap();
        let curves = chosen(&["bed_top".to_owned(), "odd".to_owned()], &series);
        assert_eq!(curves[0].title(), "bed_top [m]");
        assert_eq!((curves[0].range(), curves[0].last()), (Some((2.0, 3.0)), Some(3.0)));
        let halves = Curve { points: vec![(0.0, -1.0), (1.0, 100.0)], ..curves[0].clone() };
        assert_eq!(halves.logarithm().points, [(1.0, 2.0)]);
        assert_eq!((curves[1].title().as_str(), &curves[1].points[..]), ("odd", &[(1.0, 7.0)][..]));
    }

    #[test]
    fn an_unknown_column_is_refused_with_a_list_of_those_there_are() {
        let series = SeriesTable::parse(TEXT).unwrap();
        let wanted = ["odd".to_owned(), "bed_tip".to_owned()];
        let error = check_columns(&wanted, Some(&series)).unwrap_err().to_string();
        assert!(
            error.contains("--columns bed_tip") && error.contains("plate_stress, bed_top, odd"),
            "{error}"
        );
        assert!(check_columns(&wanted[..1], Some(&series)).is_ok());
        // Before there is a table, the columns of the program count.
        assert!(check_columns(&["bed_top".to_owned()], None).is_ok());
        assert!(check_columns(&wanted[..1], None).is_err());
    }
}
