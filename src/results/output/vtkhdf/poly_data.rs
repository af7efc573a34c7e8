//! PolyData: points, and cells of them; one partition for each time.

use super::table::{Dataset, Fill, Term, data_offsets};

/// The kinds of cells that PolyData may have: the groups of all must be there.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// How the items of a file are drawn.
pub(crate) struct Drawn {
    /// The kind of cells.
    pub(crate) kind: &'static str,
    /// Points of an item.
    pub(crate) points: u64,
    /// Cells of a time, and the points in them.
    pub(crate) counts: [Term; 2],
    /// The first cell of a time, and the first point in it.
    pub(crate) firsts: [Term; 2],
}

/// The index of PolyData: what says which rows are which time's.
pub(crate) struct PolyData {
    pub(crate) drawn: Drawn,
    /// The group of the data that are shown.
    pub(crate) data: &'static str,
    /// What descriptions say of the index, and of what has a number for each kind of cells.
    pub(crate) descriptions: [&'static str; 2],
}

impl PolyData {
    /// The datasets of the index, beside these.
    pub(crate) fn index(&self, datasets: &[Dataset]) -> Vec<Dataset> {
        let Self { drawn, data, descriptions: [description, of_kinds] } = self;
        let one = |name: &str, term| Dataset::index(name, &[term], description);
        let mut index = vec![
            one("Steps/PartOffsets", Term::Step),
            one("Steps/NumberOfParts", Term::One),
            one("Steps/PointOffsets", Term::First(drawn.points)),
            one("NumberOfPoints", Term::Count(drawn.points)),
        ];
        index.extend(data_offsets(data, datasets, description));
        for kind in CELLS {
            let is_drawn = kind == drawn.kind;
            let [cells, points] = if is_drawn { drawn.counts } else { [Term::Zero; 2] };
            index.push(one(&format!("{kind}/NumberOfCells"), cells));
            index.push(one(&format!("{kind}/NumberOfConnectivityIds"), points));
            if !is_drawn {
                index.push(one(&format!("{kind}/Offsets"), Term::Zero));
                let name = format!("{kind}/Connectivity");
                let nothing = Dataset::index(name, &[], "points of cells: there are none");
                index.push(Dataset { fill: Fill::Never, ..nothing });
            }
        }
        let names = ["Steps/CellOffsets", "Steps/ConnectivityIdOffsets"];
        index.extend(names.into_iter().zip(drawn.firsts).map(|(name, first)| {
            let terms = CELLS.map(|kind| if kind == drawn.kind { first } else { Term::Zero });
            Dataset { shape: vec![CELLS.len()], ..Dataset::index(name, &terms, of_kinds) }
        }));
        index
    }
}
