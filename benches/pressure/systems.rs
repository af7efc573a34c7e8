//! Pressure equations of fluidised beds: spheres in a box with bubbles and a freeboard, as coefficients of faces.

use nalgebra::Vector3;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use talcum::domain::{Bounds, Decomposition, Face, RankGrid};
use talcum::grid::{BoxGrid, Field, LocalCells};

/// Edge of a cell in sphere diameters.
const CELL: f64 = 2.0;
/// Solids fraction between bubbles.
const PACKING: f64 = 0.55;
/// Height of the bed over that of the box.
const BED: f64 = 0.55;
/// Number of bubbles, each of its own size.
const BUBBLES: u64 = 40;

/// Coefficients and right-hand side of the whole grid, x fastest.
pub(crate) struct System {
    /// Cells along each axis.
    pub(crate) counts: [usize; 3],
    /// a_f on the lower faces for x, y, z.
    pub(crate) faces: [Vec<f64>; 3],
    /// d_c.
    pub(crate) diagonal: Vec<f64>,
    /// b.
    pub(crate) right: Vec<f64>,
}

/// A number in [0, 1) from two integers (SplitMix64).
fn hashed(stream: u64, number: u64) -> f64 {
    let mut z = (stream << 40).wrapping_add(number).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 * 0.5_f64.powi(53)
}

/// Centre and radius of a bubble, in box lengths: radii from 0.02 to 0.15.
fn bubble(number: u64) -> ([f64; 3], f64) {
    let draw = |k| hashed(1, 4 * number + k);
    let radius = 0.02 * 7.5_f64.powf(draw(3).powi(2));
    ([draw(0), draw(1), BED * draw(2)], radius)
}

/// Whether a point is empty: in a bubble, except for a few spheres that rain through it, or above the bed, except for a
/// splash zone.
fn is_empty([x, y, z]: [f64; 3], bubbles: &[([f64; 3], f64)], draw: f64) -> bool {
    let inside = |&([a, b, c], radius): &([f64; 3], f64)| {
        (x - a).powi(2) + (y - b).powi(2) + ((z - c) / 0.8).powi(2) < radius * radius
    };
    let surface = BED + 0.04 * (9.0 * x).sin() * (7.0 * y).cos();
    if z > surface {
        return draw > 0.3 * (-(z - surface) / 0.05).exp();
    }
    bubbles.iter().any(inside) && draw > 0.005
}

/// Solids fraction of n^3 cells: spheres displaced at random from lattice sites, deposited with linear weights and
/// filtered, as in a simulation with cells smaller than three diameters.
pub(crate) fn solids_fraction(n: usize) -> Vec<f64> {
    let bubbles: Vec<_> = (0..BUBBLES).map(bubble).collect();
    let box_length = n as f64 * CELL;
    let sphere = std::f64::consts::PI / 6.0;
    let along = (box_length * (PACKING / sphere).cbrt()).round() as u64;
    let mut fraction = vec![0.0; n * n * n];
    for number in 0..along.pow(3) {
        let site = [number % along, number / along % along, number / along / along];
        let jittered = [0, 1, 2].map(|a| {
            let jitter = hashed(2, 3 * number + a as u64) - 0.5;
            (site[a] as f64 + 0.5 + 0.9 * jitter) / along as f64
        });
        if is_empty(jittered, &bubbles, hashed(3, number)) {
            continue;
        }
        deposit(&mut fraction, n, jittered, sphere / CELL.powi(3));
    }
    smoothed(fraction, n)
}

/// Gives a quarter of each cell to each of its two neighbours along x, y and z: a filter of 3.3 diameters width at half
/// maximum.
fn smoothed(mut fraction: Vec<f64>, n: usize) -> Vec<f64> {
    for stride in [1, n, n * n] {
        let before = fraction.clone();
        for cell in 0..before.len() {
            let index = (cell / stride) % n;
            let below = if index == 0 { cell } else { cell - stride };
            let above = if index + 1 == n { cell } else { cell + stride };
            fraction[cell] = 0.5 * before[cell] + 0.25 * (before[below] + before[above]);
        }
    }
    fraction
}

/// Distributes an amount over the eight cells around a point; at walls the outermost cell takes all.
fn deposit(fraction: &mut [f64], n: usize, point: [f64; 3], amount: f64) {
    let at = point.map(|x| x * n as f64 - 0.5);
    let first = at.map(|x| x.floor());
    for corner in 0..8 {
        let mut weight = amount;
        let mut cell = [0; 3];
        for axis in 0..3 {
            let upper = (corner >> axis) & 1;
            let of_upper = at[axis] - first[axis];
            weight *= if upper == 1 { of_upper } else { 1.0 - of_upper };
            cell[axis] = (first[axis] + upper as f64).clamp(0.0, n as f64 - 1.0) as usize;
        }
        fraction[cell[0] + n * (cell[1] + n * cell[2])] += weight;
    }
}

/// Mobility of the gas: voidage / (1 + K f), f the drag of the solids (Wen and Yu's voidage function), 1 at a solids
/// fraction of 0.6; the contrast between freeboard and bed is about 1 + K.
fn mobility(solids: f64, contrast: f64) -> f64 {
    let drag = |phi: f64| phi * (1.0 - phi).powf(-3.65);
    let solids = solids.min(0.64);
    (1.0 - solids) / (1.0 + (contrast - 1.0) * drag(solids) / drag(0.6))
}

impl System {
    /// A bed in a box with walls, gas coming in through the floor, an outlet on top; contrast 1 is an empty box.
    pub(crate) fn bed(n: usize, solids: &[f64], contrast: f64) -> Self {
        let cells = n * n * n;
        let strides = [1, n, n * n];
        let solids: Vec<f64> = if contrast > 1.0 { solids.to_vec() } else { vec![0.0; cells] };
        let faces = strides.map(|stride| {
            let face = |cell: usize| {
                if (cell / stride).is_multiple_of(n) {
                    return 0.0;
                }
                mobility(0.5 * (solids[cell] + solids[cell - stride]), contrast)
            };
            (0..cells).map(face).collect()
        });
        let top = cells - n * n;
        let diagonal = (0..cells)
            .map(|cell| if cell >= top { 2.0 * mobility(solids[cell], contrast) } else { 0.0 })
            .collect();
        let right = (0..cells)
            .map(|cell| {
                let inflow = if cell < n * n { 1.0 } else { 0.0 };
                inflow + 0.5 * (hashed(4, cell as u64) - 0.5)
            })
            .collect();
        Self { counts: [n; 3], faces, diagonal, right }
    }

    /// Counts, faces, diagonal and right-hand side as doubles in the machine's order, for scripts/hypre.
    pub(crate) fn write(&self, path: &Path) -> io::Result<()> {
        let mut file = io::BufWriter::new(File::create(path)?);
        let counts = self.counts.map(|count| count as f64);
        let [x, y, z] = &self.faces;
        for numbers in [&counts[..], x, y, z, &self.diagonal, &self.right] {
            for number in numbers {
                file.write_all(&number.to_ne_bytes())?;
            }
        }
        file.flush()
    }

    /// The box of the cells: walls all around.
    pub(crate) fn bounds(&self) -> Bounds {
        let lengths = self.counts.map(|count| count as f64);
        Bounds::new(Vector3::from(lengths), [[Face::Wall; 2]; 3])
    }

    /// The grid, and slabs along z for some ranks.
    pub(crate) fn grid(&self, ranks: usize) -> (BoxGrid, Decomposition) {
        let grid = BoxGrid::new(&self.bounds(), self.counts);
        let even = Decomposition::even(RankGrid::slabs(2, ranks), &self.bounds());
        let decomposition = grid.aligned(&even, [2; 3]).expect("there are enough cells");
        (grid, decomposition)
    }
}

/// The values of a rank's cells, from those of the whole grid.
pub(crate) fn local_field(values: &[f64], cells: &LocalCells) -> Field {
    let mut field = Field::new(cells, 1);
    let [nx, ny, _] = cells.counts;
    let start = cells.start;
    let (count, mut owned) = (cells.count, Vec::with_capacity(cells.cells()));
    for k in start[2]..start[2] + count[2] {
        for j in start[1]..start[1] + count[1] {
            let row = start[0] + nx * (j + ny * k);
            owned.extend_from_slice(&values[row..row + count[0]]);
        }
    }
    field.set_owned(owned.into_iter());
    field
}
