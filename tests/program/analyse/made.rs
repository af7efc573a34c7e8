//! Results folders made by hand, with the writers that runs use.

use std::path::Path;
use talcum::analysis::SeriesRow;
use talcum::output::{
    Head, Output, ParticleSnapshots, ProfileRow, Profiles, Provenance, Series, SnapshotFormat,
};
use talcum::parallel::{OneRank, ParticleRecord};
use talcum::post_processing::{Analysis, Findings, Results, TimeWindow, Value, scalar_named};

/// A bed in a column gas, 5 x 5 x 120 diameters, periodic across; a grid of 1.5 diameters.
pub(crate) const CASE: &str = r#"title = "Made by hand"
units = "dimensionless"
[box]
lengths = [5.0, 5.0, 120.0]
x = "periodic"
y = "periodic"
z = "wall"
[particles]
count = 500
diameter = 1.0
density = 1.0
seed = 1
[particles.start]
kind = "lattice"
spacing = 1.1
jitter = 0.9
[gravity]
magnitude = 1.0
[contact]
law = "linear_spring_dashpot"
normal_stiffness = 2.0e4
poisson_ratio = 0.3
restitution = 0.9
friction = 0.1
friction_cap = "contact"
[gas]
kind = "column"
stokes_number = 55.0
drag = "wen_yu_creeping"
spacing = 1.5
superficial_velocity = 0.12
[time]
step = 8.0e-4
end = 1000.0
[output]
series = 0.5
[checkpoint]
every = 1.0
"#;

/// A folder of results.
pub(crate) struct Made {
    folder: tempfile::TempDir,
    case: String,
    provenance: Provenance,
}

impl Made {
    /// With a case file alone.
    pub(crate) fn of(case: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("case.toml"), case).unwrap();
        let provenance = Provenance::here_and_now("Made by hand", "dimensionless", &OneRank);
        Self { folder, case: case.to_owned(), provenance }
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    fn head(&self) -> Head<'_> {
        Head { case_text: &self.case, provenance: &self.provenance }
    }

    /// Rows of the series.
    pub(crate) fn series(&self, rows: impl IntoIterator<Item = SeriesRow>) {
        let path = self.path().join("series.csv");
        let mut series = Series::create(&path, self.head(), &OneRank).unwrap();
        rows.into_iter().for_each(|row| series.append(&row, &OneRank).unwrap());
        series.commit(&OneRank).unwrap();
    }

    /// Profiles of the solids fraction phi(z, t) on 81 nodes.
    pub(crate) fn profiles(&self, times: &[f64], phi: impl Fn(f64, f64) -> f64) {
        let path = self.path().join("profiles.h5");
        let heights: Vec<f64> = (0..81).map(|node| 1.5 * f64::from(node)).collect();
        let profiles = Profiles::create(&path, &heights, self.head(), &OneRank).unwrap();
        for &time in times {
            let solids_fraction: Vec<f64> = heights.iter().map(|&z| phi(z, time)).collect();
            let row = ProfileRow {
                time,
                superficial_velocity: 0.12,
                solids_fraction: &solids_fraction,
                solids_velocity: &vec![0.0; heights.len()],
            };
            profiles.append(&row, &OneRank).unwrap();
        }
    }

    /// Snapshots of particles.
    pub(crate) fn snapshots(&self, snapshots: &[(f64, Vec<ParticleRecord>)]) {
        let path = self.path().join("particles.vtkhdf");
        let format = SnapshotFormat::default();
        let mut file =
            ParticleSnapshots::open(&path, &format, self.head(), None, &OneRank).unwrap();
        for (time, particles) in snapshots {
            file.append(*time, particles, &[], &OneRank).unwrap();
        }
    }

    /// What an analysis finds within some times.
    pub(crate) fn find(&self, analysis: &str, window: TimeWindow) -> Findings {
        let results = Results::open(self.path(), window).unwrap();
        Analysis::named(analysis).unwrap().take(&results).unwrap()
    }
}

/// What was found of a full name: a number with its error, which is 0 if it has none.
#[track_caller]
pub(crate) fn number(found: &Findings, name: &str) -> (f64, f64) {
    match found.value_of(&scalar_named(name).unwrap()).0 {
        Value::Number { value, error } => (value, error.unwrap_or(0.0)),
        other => panic!("{name}: {other:?}"),
    }
}

/// The text that was found.
#[track_caller]
pub(crate) fn text(found: &Findings, name: &str) -> &'static str {
    match found.value_of(&scalar_named(name).unwrap()).0 {
        Value::Text(text) => text,
        other => panic!("{name}: {other:?}"),
    }
}

/// Why there is none.
#[track_caller]
pub(crate) fn reason(found: &Findings, name: &str) -> String {
    match found.value_of(&scalar_named(name).unwrap()).0 {
        Value::Nothing(reason) => reason.to_string(),
        other => panic!("{name}: {other:?}"),
    }
}

/// Numbers of a column of a table that was found.
#[track_caller]
pub(crate) fn column(found: &Findings, table: &str, column: &str) -> Vec<f64> {
    let table = found.tables.iter().find(|known| known.name == table).unwrap();
    let column = table.columns.iter().find(|known| known.name == column).unwrap();
    match &column.values {
        talcum::output::Cells::Number(numbers) => numbers.clone(),
        talcum::output::Cells::Whole(numbers) => numbers.iter().map(|&n| n as f64).collect(),
        talcum::output::Cells::Text(_) => panic!("{} holds texts", column.name),
    }
}

/// Independent numbers, uniform from -1 to 1, that depend on place and time.
pub(crate) fn noise(z: f64, t: f64) -> f64 {
    let place = ((z * 8.0) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut x = place ^ ((t * 16.0) as u64 + 1).wrapping_mul(0xd1b5_4a32_d192_ed03);
    // The finaliser of SplitMix64.
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
