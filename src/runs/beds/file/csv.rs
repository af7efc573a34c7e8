//! Tables with a header: `id,x,y,z` and optionally `vx,vy,vz`, `wx,wy,wz`, `d`, `species`, in any order. Lines that
//! begin with `#` are comments.

use super::columns::{At, Column, Header, Rows};
use crate::beds::{BedProblem, Species};
use std::path::Path;

const KNOWN: [(&str, Column); 12] = [
    ("id", Column::Id),
    ("x", Column::Position(0)),
    ("y", Column::Position(1)),
    ("z", Column::Position(2)),
    ("vx", Column::Velocity(0)),
    ("vy", Column::Velocity(1)),
    ("vz", Column::Velocity(2)),
    ("wx", Column::AngularVelocity(0)),
    ("wy", Column::AngularVelocity(1)),
    ("wz", Column::AngularVelocity(2)),
    ("d", Column::Diameter),
    ("species", Column::Species),
];

/// The rows of a text, in a bed of these species.
pub(super) fn parse(text: &str, file: &Path, species: &[Species]) -> Result<Rows, BedProblem> {
    let lines = text.lines().enumerate();
    let mut lines = lines
        .map(|(index, line)| (At { file, line: index + 1 }, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((at, header)) = lines.next() else {
        return Err(At { file, line: 1 }.error("there is no header; it begins id,x,y,z"));
    };
    let names = header.split(',').map(str::trim).collect();
    let header = Header::new(names, &KNOWN, false, at)?;
    let header = header.with_species(species.iter().map(|species| &*species.name).collect());
    let rows = lines.map(|(at, line)| {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        header.row(&fields, &[[0.0, 1.0]; 3], at)
    });
    Ok(Rows { rows: rows.collect::<Result<_, _>>()?, have_velocities: header.has_velocities() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_may_come_in_any_order() {
        let text = "# a bed\n z, id ,x,y,d,vy\n\n3,7,1,2,0.5,-4\n";
        let rows = parse(text, Path::new("bed.csv"), &[]).unwrap();
        let row = rows.rows[0];
        assert_eq!((row.line, row.id, row.position), (4, 7, [1.0, 2.0, 3.0]));
        assert_eq!((row.velocity, row.diameter), ([0.0, -4.0, 0.0], Some(0.5)));
        assert!(rows.have_velocities);
    }

    #[test]
    fn errors_name_file_line_and_column() {
        for (text, words) in [
            ("", "bed.csv:1: there is no header"),
            ("id,x,y\n", "bed.csv:1: there is no column z"),
            ("id,x,y,z,x\n", "bed.csv:1: column \"x\" is there twice"),
            ("id,x,y,z,vel\n", "bed.csv:1: unknown column \"vel\""),
            ("id,x,y,z\n1,2,3\n", "bed.csv:2: has 3 fields where the header names 4"),
            ("id,x,y,z\n1,2,3,a\n", "bed.csv:2: column z: \"a\" is not a finite number"),
            ("id,x,y,z\n1,2,3,nan\n", "bed.csv:2: column z: \"nan\" is not a finite number"),
            ("id,x,y,z\n-1,2,3,4\n", "bed.csv:2: column id: \"-1\" is not an id"),
            ("id,x,y,z,d\n1,2,3,4,0\n", "bed.csv:2: column d: \"0\" is not above 0"),
        ] {
            let error = parse(text, Path::new("bed.csv"), &[]).unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }
}
