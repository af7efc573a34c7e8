//! Dumps of LAMMPS and LIGGGHTS in their own text format; the last frame is used.

use super::columns::{At, Column, Header, Rows};
use crate::beds::BedProblem;
use std::path::Path;

const KNOWN: [(&str, Column); 19] = [
    ("id", Column::Id),
    ("type", Column::Type),
    ("x", Column::Position(0)),
    ("y", Column::Position(1)),
    ("z", Column::Position(2)),
    ("xu", Column::Position(0)),
    ("yu", Column::Position(1)),
    ("zu", Column::Position(2)),
    ("xs", Column::ScaledPosition(0)),
    ("ys", Column::ScaledPosition(1)),
    ("zs", Column::ScaledPosition(2)),
    ("vx", Column::Velocity(0)),
    ("vy", Column::Velocity(1)),
    ("vz", Column::Velocity(2)),
    ("omegax", Column::AngularVelocity(0)),
    ("omegay", Column::AngularVelocity(1)),
    ("omegaz", Column::AngularVelocity(2)),
    ("radius", Column::Radius),
    ("diameter", Column::Diameter),
];

fn without_types() -> Vec<(&'static str, Column)> {
    KNOWN.into_iter().filter(|(_, column)| *column != Column::Type).collect()
}

/// The lines of a frame that are still to be read.
struct Frame<'a, Lines: Iterator<Item = (At<'a>, &'a str)>> {
    lines: Lines,
    end: At<'a>,
}

/// The rows of the last frame of a text, in a bed of so many named species; without any, types mean nothing.
pub(super) fn parse(text: &str, file: &Path, species: usize) -> Result<Rows, BedProblem> {
    let Some(start) = text.rfind("ITEM: TIMESTEP") else {
        return Err(At { file, line: 1 }.error("this is no dump: there is no line ITEM: TIMESTEP"));
    };
    let skipped = text[..start].matches('\n').count();
    let end = At { file, line: skipped + text[start..].lines().count() };
    let lines = text[start..].lines().enumerate();
    let lines = lines.map(|(index, line)| (At { file, line: skipped + index + 1 }, line.trim()));
    let mut frame = Frame { lines, end };
    let (mut count, mut file_box) = (None, None);
    loop {
        let (at, line) = frame.next()?;
        if line.starts_with("ITEM: NUMBER OF ATOMS") {
            let (at, line) = frame.next()?;
            let number = line.parse().map_err(|_| at.error(format!("{line:?} is not a count")))?;
            count = Some(number);
        } else if let Some(kind) = line.strip_prefix("ITEM: BOX BOUNDS") {
            if kind.contains("xy") || kind.contains("abc") {
                return Err(at.error("the box is not rectangular"));
            }
            file_box = Some(frame.bounds()?);
        } else if let Some(names) = line.strip_prefix("ITEM: ATOMS") {
            let (Some(count), Some(file_box)) = (count, file_box) else {
                return Err(at.error("number of atoms and box bounds must come before the rows"));
            };
            let known = if species == 0 { without_types() } else { KNOWN.to_vec() };
            let header = Header::new(names.split_whitespace().collect(), &known, true, at)?;
            let header = header.with_species(vec![""; species]);
            return frame.rows(&header, count, &file_box);
        }
    }
}

impl<'a, Lines: Iterator<Item = (At<'a>, &'a str)>> Frame<'a, Lines> {
    fn next(&mut self) -> Result<(At<'a>, &'a str), BedProblem> {
        self.lines.next().ok_or_else(|| self.end.error("the last frame is cut short"))
    }

    fn bounds(&mut self) -> Result<[[f64; 2]; 3], BedProblem> {
        let mut bounds = [[0.0; 2]; 3];
        for axis in &mut bounds {
            let (at, line) = self.next()?;
            let mut numbers = line.split_whitespace().map(str::parse::<f64>);
            *axis = match (numbers.next(), numbers.next(), numbers.next()) {
                (Some(Ok(lower)), Some(Ok(upper)), None) if upper - lower < 1.0e30 => {
                    [lower, upper]
                }
                _ => return Err(at.error("must be the lower and the upper bound of the box")),
            };
        }
        Ok(bounds)
    }

    fn rows(
        &mut self,
        header: &Header<'_>,
        count: usize,
        file_box: &[[f64; 2]; 3],
    ) -> Result<Rows, BedProblem> {
        let mut rows = Rows { have_velocities: header.has_velocities(), ..Rows::default() };
        for _ in 0..count {
            let (at, line) = self.next()?;
            let fields: Vec<&str> = line.split_whitespace().collect();
            rows.rows.push(header.row(&fields, file_box, at)?);
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(columns: &str, rows: &str) -> String {
        let count = rows.lines().count();
        format!(
            "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS pp pp ff\n-1 1\n0 4\n0 \
             10\nITEM: ATOMS {columns}\n{rows}"
        )
    }

    #[test]
    fn the_last_frame_counts() {
        let first = frame("id type x y z", "1 1 0 0 0\n2 1 1 1 1\n");
        let last = frame("id type xs ys zs vx omegaz radius", "5 1 0.5 0.25 0.1 7 8 0.25\n");
        let rows = parse(&format!("{first}{last}"), Path::new("dump"), 0).unwrap().rows;
        assert_eq!(rows.len(), 1);
        assert_eq!((rows[0].id, rows[0].position), (5, [0.0, 1.0, 1.0]));
        assert_eq!((rows[0].velocity[0], rows[0].angular_velocity[2]), (7.0, 8.0));
        assert_eq!((rows[0].diameter, rows[0].line), (Some(0.5), 21));
    }

    #[test]
    fn errors_name_file_line_and_column() {
        let cut = frame("id x y z", "1 1 2 3\n2 1 2 3\n").replace("2 1 2 3\n", "");
        for (text, words) in [
            ("id x y z\n".to_owned(), "dump:1: this is no dump"),
            (cut, "dump:10: the last frame is cut short"),
            (frame("id x y", "1 2 3\n"), "dump:9: there is no column z"),
            (frame("id x xs y z", "1 2 3 4 5\n"), "dump:9: there are several columns for x"),
            (frame("id x y z", "1 2 3 q\n"), "dump:10: column z: \"q\" is not a finite number"),
            (frame("id x y z", "").replace("0 4", "0"), "dump:7: must be the lower and the upper"),
            (frame("id x y z", "").replace("pp pp ff", "xy xz yz pp pp ff"), "dump:5: the box is"),
            ("ITEM: TIMESTEP\n1\nITEM: ATOMS id x y z\n".to_owned(), "dump:3: number of atoms"),
        ] {
            let error = parse(&text, Path::new("dump"), 0).unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }
}
