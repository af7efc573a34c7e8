//! Columns of a file of particles, and the reading of their numbers.

use crate::beds::BedProblem;
use crate::input::nearest;
use std::path::Path;

/// One row: the data of a particle in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// Line of the file, from 1.
    pub(super) line: usize,
    pub(super) id: u64,
    pub(super) position: [f64; 3],
    pub(super) velocity: [f64; 3],
    pub(super) angular_velocity: [f64; 3],
    pub(super) diameter: Option<f64>,
    /// Number of the species.
    pub(super) species: Option<usize>,
}

/// Contents of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Id,
    Position(usize),
    /// Position relative to the box of the file, whose bounds a dump states.
    ScaledPosition(usize),
    Velocity(usize),
    AngularVelocity(usize),
    Diameter,
    Radius,
    /// Name of the species.
    Species,
    /// Number of the species, from 1.
    Type,
    /// A column that is not used.
    Ignored,
}

/// The rows of a file, and whether they contain velocities.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    pub(super) have_velocities: bool,
}

/// A file and a line in it, for errors.
#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    pub(super) file: &'a Path,
    pub(super) line: usize,
}

impl At<'_> {
    pub(super) fn error(self, reason: impl Into<String>) -> BedProblem {
        BedProblem::Line { file: self.file.to_owned(), line: self.line, reason: reason.into() }
    }
}

/// The columns of a file: names and meanings.
pub(super) struct Header<'a> {
    names: Vec<&'a str>,
    columns: Vec<Column>,
    /// The names that may occur in a column of species.
    species: Vec<&'a str>,
}

impl<'a> Header<'a> {
    /// A header whose names are among the known ones; others are ignored or rejected.
    pub(super) fn new(
        names: Vec<&'a str>,
        known: &[(&'static str, Column)],
        ignore_others: bool,
        at: At<'_>,
    ) -> Result<Self, BedProblem> {
        let mut columns = Vec::new();
        for name in &names {
            let column = match known.iter().find(|(known, _)| known == name) {
                Some((_, column)) => *column,
                None if ignore_others => Column::Ignored,
                None => return Err(at.error(unknown(name, known))),
            };
            if column != Column::Ignored && columns.contains(&column) {
                return Err(at.error(format!("column {name:?} is there twice")));
            }
            columns.push(column);
        }
        let header = Self { names, columns, species: Vec::new() };
        header.check().map_err(|reason| at.error(reason))?;
        Ok(header)
    }

    /// This header with these species.
    pub(super) fn with_species(self, species: Vec<&'a str>) -> Self {
        Self { species, ..self }
    }

    /// Whether there are velocities.
    pub(super) fn has_velocities(&self) -> bool {
        self.columns.iter().any(|column| matches!(column, Column::Velocity(_)))
    }

    fn check(&self) -> Result<(), String> {
        let has = |column: Column| self.columns.contains(&column);
        if !has(Column::Id) {
            return Err("there is no column id".to_owned());
        }
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            match (has(Column::Position(axis)), has(Column::ScaledPosition(axis))) {
                (false, false) => return Err(format!("there is no column {name}")),
                (true, true) => return Err(format!("there are several columns for {name}")),
                _ => {}
            }
        }
        if has(Column::Diameter) && has(Column::Radius) {
            return Err("there are columns of both diameter and radius".to_owned());
        }
        Ok(())
    }

    /// Parses one row from its fields; scaled positions refer to a box `[axis][lower, upper]`.
    pub(super) fn row(
        &self,
        fields: &[&str],
        file_box: &[[f64; 2]; 3],
        at: At<'_>,
    ) -> Result<Row, BedProblem> {
        let (found, wanted) = (fields.len(), self.columns.len());
        if found != wanted {
            return Err(at.error(format!("has {found} fields where the header names {wanted}")));
        }
        let mut row = Row { line: at.line, ..Row::default() };
        for ((field, name), column) in fields.iter().zip(&self.names).zip(&self.columns) {
            if *column == Column::Ignored {
                continue;
            }
            let wrong = |what: &str| at.error(format!("column {name}: {field:?} is not {what}"));
            if *column == Column::Id {
                let id = field.parse().ok().filter(|&id| id < u64::MAX);
                row.id = id.ok_or_else(|| wrong("an id, a whole number from 0"))?;
                continue;
            }
            if matches!(column, Column::Species | Column::Type) {
                let species = self.species_of(*column, field);
                row.species = Some(species.map_err(|reason| wrong(&reason))?);
                continue;
            }
            let number = field.parse().ok().filter(|number: &f64| number.abs() <= 1.0e30);
            row.set(*column, number.ok_or_else(|| wrong("a finite number"))?, file_box);
            if row.diameter.is_some_and(|diameter| diameter < 1.0e-30) {
                return Err(wrong("above 0"));
            }
        }
        Ok(row)
    }

    /// The number of a species from its name, or from its number counted from 1.
    fn species_of(&self, column: Column, field: &str) -> Result<usize, String> {
        let count = self.species.len();
        if column == Column::Type {
            let number = field.parse().ok().filter(|number| (1..=count).contains(number));
            let allowed = || format!("the number of a species, from 1 to {count}");
            return number.map(|number| number - 1).ok_or_else(allowed);
        }
        let number = self.species.iter().position(|name| *name == field);
        number.ok_or_else(|| format!("a species: known are {}", self.species.join(", ")))
    }
}

impl Row {
    fn set(&mut self, column: Column, number: f64, file_box: &[[f64; 2]; 3]) {
        match column {
            Column::Position(axis) => self.position[axis] = number,
            Column::ScaledPosition(axis) => {
                let [lower, upper] = file_box[axis];
                self.position[axis] = lower + (upper - lower) * number;
            }
            Column::Velocity(axis) => self.velocity[axis] = number,
            Column::AngularVelocity(axis) => self.angular_velocity[axis] = number,
            Column::Diameter => self.diameter = Some(number),
            Column::Radius => self.diameter = Some(2.0 * number),
            Column::Id | Column::Species | Column::Type | Column::Ignored => {}
        }
    }
}

fn unknown(name: &str, known: &[(&'static str, Column)]) -> String {
    let all: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    match nearest(name, &all) {
        Some(near) => format!("unknown column {name:?}: did you mean {near}?"),
        None => format!("unknown column {name:?}: known are {}", all.join(", ")),
    }
}
