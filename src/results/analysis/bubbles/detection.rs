//! Connected regions of high voidage.

use crate::analysis::no_value::{NoValue, require_finite, require_positive};
use std::f64::consts::PI;

/// Voidage on a regular grid of cells, at one time.
#[derive(Clone, Copy, Debug)]
pub struct VoidageField<'a> {
    /// \[(z * ny + y) * nx + x\], as in `gas.vtkhdf`.
    pub values: &'a [f64],
    /// Cells along x, y, z. A bed in two dimensions has one cell along y (or x).
    pub cells: [usize; 3],
    /// Lower corner of the grid. Length.
    pub origin: [f64; 3],
    /// Size of a cell. Length.
    pub spacing: [f64; 3],
    /// Whether the grid is periodic along x and along y.
    pub periodic: [bool; 2],
}

/// Criteria for a bubble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BubbleOptions {
    /// Voidage above which a cell belongs to a bubble.
    pub threshold: f64,
    /// Smallest number of cells of a bubble.
    pub fewest_cells: usize,
}

impl Default for BubbleOptions {
    /// A voidage of 0.7, which is common for bubbles in simulated voidages (values in use are 0.7 to 0.85; sizes depend
    /// on this choice, so state it with them), and four cells.
    fn default() -> Self {
        Self { threshold: 0.7, fewest_cells: 4 }
    }
}

/// A bubble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bubble {
    /// Centroid of its cells; along a periodic direction it may lie beyond the grid. Length.
    pub centroid: [f64; 3],
    /// Volume; in two dimensions, area times the thickness of the grid.
    pub volume: f64,
    /// Diameter of the sphere with its volume; in two dimensions, of the circle with its area. Length.
    pub equivalent_diameter: f64,
    /// Ratio of vertical to horizontal size, from second moments about the centroid, each including that of a cell: 1
    /// for a sphere, above 1 if it is tall. The horizontal size is the root mean square of those along x and y.
    pub aspect_ratio: f64,
    /// Lowest and highest faces of its cells. Length.
    pub vertical_extent: [f64; 2],
    /// Whether it meets itself around the grid, so that its centroid along that direction has no meaning.
    pub encircles: bool,
}

/// Finds the regions of cells connected by faces whose voidage exceeds the threshold, in the order of their lowest,
/// rearmost, leftmost cell. Regions that reach the top layer of cells are the freeboard, or open to it, and are left
/// out.
///
/// Fails if the length of the field does not fit its cells, or sizes or threshold are not valid.
pub fn find_bubbles(field: &VoidageField, options: &BubbleOptions) -> Result<Vec<Bubble>, NoValue> {
    check(field, options)?;
    let mut taken: Vec<bool> =
        field.values.iter().map(|&voidage| voidage <= options.threshold).collect();
    let [nx, ny, nz] = field.cells;
    let mut bubbles = Vec::new();
    // The freeboard is filled first, from the top layer.
    for start in (nz - 1) * ny * nx..nz * ny * nx {
        if !taken[start] {
            fill(field, start, &mut taken);
        }
    }
    for start in 0..taken.len() {
        if !taken[start] {
            let region = fill(field, start, &mut taken);
            if region.cells.len() >= options.fewest_cells {
                bubbles.push(measure(field, &region));
            }
        }
    }
    Ok(bubbles)
}

fn check(field: &VoidageField, options: &BubbleOptions) -> Result<(), NoValue> {
    require_finite("voidages", field.values)?;
    require_finite("origin", &field.origin)?;
    for size in field.spacing {
        require_positive("the size of a cell", size)?;
    }
    let cells = field.cells.iter().product::<usize>();
    if cells == 0 || cells != field.values.len() {
        let values = field.values.len();
        return Err(NoValue::because(format!("the field has {values} values for {cells} cells")));
    }
    if !(options.threshold > 0.0 && options.threshold < 1.0) {
        let threshold = options.threshold;
        return Err(NoValue::because(format!(
            "the threshold of the voidage is {threshold}, not between 0 and 1"
        )));
    }
    Ok(())
}

/// A connected region: places of its cells, continued around the grid along periodic directions.
struct Region {
    cells: Vec<[i64; 3]>,
    encircles: bool,
}

/// Takes the region of a cell, breadth first.
fn fill(field: &VoidageField, start: usize, taken: &mut [bool]) -> Region {
    let [nx, ny, _] = field.cells;
    let place = [start % nx, start / nx % ny, start / (nx * ny)].map(|index| index as i64);
    taken[start] = true;
    let mut region = Region { cells: vec![place], encircles: false };
    // The place at which each cell of this region was first met shows whether the region meets itself around the grid.
    let mut met = std::collections::BTreeMap::from([(start, place)]);
    let mut next = 0;
    while next < region.cells.len() {
        let place = region.cells[next];
        next += 1;
        for (direction, step) in [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)] {
            let mut neighbour = place;
            neighbour[direction] += step;
            let Some(index) = index_of(field, neighbour) else { continue };
            if !taken[index] {
                taken[index] = true;
                met.insert(index, neighbour);
                region.cells.push(neighbour);
            } else if met.get(&index).is_some_and(|other| *other != neighbour) {
                region.encircles = true;
            }
        }
    }
    region
}

/// Index of a place, which may lie beyond the grid along periodic directions.
fn index_of(field: &VoidageField, place: [i64; 3]) -> Option<usize> {
    let mut inside = [0; 3];
    for direction in 0..3 {
        let count = field.cells[direction] as i64;
        let periodic = direction < 2 && field.periodic[direction];
        let index = if periodic { place[direction].rem_euclid(count) } else { place[direction] };
        if !(0..count).contains(&index) {
            return None;
        }
        inside[direction] = index as usize;
    }
    let [nx, ny, _] = field.cells;
    Some((inside[2] * ny + inside[1]) * nx + inside[0])
}

fn measure(field: &VoidageField, region: &Region) -> Bubble {
    let count = region.cells.len() as f64;
    let mean = [0, 1, 2].map(|direction| {
        region.cells.iter().map(|cell| cell[direction] as f64).sum::<f64>() / count
    });
    let mut squares =
        [0, 1, 2].map(|direction| mean_square(field, region, direction, mean[direction]));
    let thin: Vec<usize> = (0..2).filter(|&direction| field.cells[direction] == 1).collect();
    let volume = count * field.spacing.iter().product::<f64>();
    let equivalent_diameter = match thin.first() {
        Some(&direction) => 2.0 * (volume / field.spacing[direction] / PI).sqrt(),
        None => libm::cbrt(6.0 * volume / PI),
    };
    for &direction in &thin {
        squares[direction] = squares[1 - direction];
    }
    let heights = region.cells.iter().map(|cell| cell[2]);
    let face = |index: i64| field.origin[2] + index as f64 * field.spacing[2];
    let lowest = heights.clone().fold(i64::MAX, i64::min);
    let highest = heights.fold(i64::MIN, i64::max);
    Bubble {
        centroid: [0, 1, 2].map(|direction| {
            field.origin[direction] + (mean[direction] + 0.5) * field.spacing[direction]
        }),
        volume,
        equivalent_diameter,
        aspect_ratio: (squares[2] / (0.5 * (squares[0] + squares[1]))).sqrt(),
        vertical_extent: [face(lowest), face(highest + 1)],
        encircles: region.encircles,
    }
}

/// Mean square distance from the centroid along a direction, with that within a cell.
fn mean_square(field: &VoidageField, region: &Region, direction: usize, mean: f64) -> f64 {
    let distances = region.cells.iter().map(|cell| cell[direction] as f64 - mean);
    let sum: f64 = distances.map(|distance| distance * distance).sum();
    let spacing = field.spacing[direction];
    (sum / region.cells.len() as f64 + 1.0 / 12.0) * spacing * spacing
}
