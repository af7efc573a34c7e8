//! A filter of given width for cells that are not much larger than particles.

use crate::grid::{BoxGrid, ColumnOnCells, Field};
use crate::parallel::{Communicator, FieldHalo};
use std::f64::consts::LN_2;

/// Diffusion over a pseudo-time, which spreads a field as a Gaussian of a given width does (Capecelatro & Desjardins,
/// J. Comput. Phys. 238 (2013), section 3.3). Each step is
///
/// f_c <- f_c + sum over axes of kappa (f_above - 2 f_c + f_below),  kappa = width^2 / (16 ln 2 dx^2 n),
///
/// where the number n of steps is chosen so that sum 2 kappa <= 1: no weight is then negative, and positive fields stay
/// positive. Nothing passes the ends of a box that is not periodic. The filter is symmetric, so that its effect on a
/// field deposited by particles is adjoint to its effect on a field read by particles, and it conserves sums to
/// round-off.
///
/// In a round column a difference across it is weighted by min(theta_c, theta_nb) / theta_c, with theta the open
/// fractions of the two cells: this is symmetric per volume, leaves uniform fields unchanged, and no weight is
/// negative.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Filter {
    steps: usize,
    /// kappa along x, y, z.
    strength: [f64; 3],
    periodic: [bool; 3],
    column: Option<ColumnShares>,
    scratch: Vec<f64>,
}

/// Weights of the differences to the cells below and above along x and y in a round column, for each cell.
#[derive(Clone, Debug, PartialEq)]
struct ColumnShares {
    sides: [[Vec<f64>; 2]; 2],
}

impl Filter {
    /// Full width at half maximum of the Gaussian; no filter if it is 0.
    pub(crate) fn new(
        grid: &BoxGrid,
        width: f64,
        column: Option<&ColumnOnCells>,
        field: &Field,
    ) -> Option<Self> {
        // Variance width^2 / (8 ln 2) = 2 kappa n dx^2.
        let whole = [0, 1, 2].map(|a| width * width / (16.0 * LN_2 * grid.spacing()[a].powi(2)));
        let steps = (2.0 * (whole[0] + whole[1] + whole[2])).ceil() as usize;
        let periodic = std::array::from_fn(|axis| grid.is_periodic(axis));
        let strength = whole.map(|whole| whole / steps as f64);
        let column = column.map(|column| ColumnShares::new(column, field));
        (steps > 0).then_some(Self { steps, strength, periodic, column, scratch: Vec::new() })
    }

    /// Factor by which the filter multiplies a wave, given by sin^2 of half its phase angle from cell to cell along
    /// each axis.
    pub(crate) fn part_of_wave(&self, squares: [f64; 3]) -> f64 {
        let change: f64 = (0..3).map(|axis| 4.0 * self.strength[axis] * squares[axis]).sum();
        (1.0 - change).powi(self.steps as i32)
    }

    /// Filters the owned cells of fields. Collective. After: halos are out of date.
    pub(crate) fn apply(
        &mut self,
        fields: &mut [&mut Field],
        ends: &[[bool; 2]; 3],
        halo: &mut FieldHalo,
        ranks: &dyn Communicator,
    ) {
        for _ in 0..self.steps {
            halo.refresh(fields, ranks);
            for field in fields.iter_mut() {
                self.step(field, ends);
            }
        }
    }

    /// One step; `ends` holds for each axis whether the part reaches the lower and upper end of the grid.
    fn step(&mut self, field: &mut Field, ends: &[[bool; 2]; 3]) {
        for axis in (0..3).filter(|&axis| !self.periodic[axis]) {
            for side in (0..2).filter(|&side| ends[axis][side]) {
                copy_outwards(field, axis, side);
            }
        }
        self.scratch.clear();
        self.scratch.extend_from_slice(field.values());
        let (old, strides, length) = (&self.scratch, field.strides(), field.row_length());
        if let Some(column) = &self.column {
            column.step(field, old, self.strength);
            return;
        }
        for row in field.rows() {
            for (place, value) in (row..).zip(&mut field.values_mut()[row..row + length]) {
                let mut change = 0.0;
                for (strength, stride) in self.strength.iter().zip(strides) {
                    let around = old[place + stride] + old[place - stride];
                    change += strength * (around - 2.0 * old[place]);
                }
                *value += change;
            }
        }
    }
}

impl ColumnShares {
    fn new(column: &ColumnOnCells, field: &Field) -> Self {
        let (values, strides) = (column.values(), field.strides());
        let open = |place: Option<usize>| place.and_then(|place| values.get(place)).copied();
        let share = |place: usize, other: Option<usize>| match values[place] {
            0.0 => 0.0,
            own => open(other).unwrap_or(0.0).min(own) / own,
        };
        let along = |axis: usize| {
            let below = |place: usize| share(place, place.checked_sub(strides[axis]));
            let above = |place: usize| share(place, Some(place + strides[axis]));
            [(0..values.len()).map(below).collect(), (0..values.len()).map(above).collect()]
        };
        Self { sides: [along(0), along(1)] }
    }

    /// One step of the filter, from `old`.
    fn step(&self, field: &mut Field, old: &[f64], strength: [f64; 3]) {
        let ([along_x, along_y, along_z], length) = (field.strides(), field.row_length());
        let [[left, right], [front, back]] = &self.sides;
        for row in field.rows() {
            for (place, value) in (row..).zip(&mut field.values_mut()[row..row + length]) {
                let here = old[place];
                let across_x = left[place] * (old[place - along_x] - here)
                    + right[place] * (old[place + along_x] - here);
                let across_y = front[place] * (old[place - along_y] - here)
                    + back[place] * (old[place + along_y] - here);
                let vertical = old[place + along_z] + old[place - along_z] - 2.0 * here;
                *value += strength[0] * across_x + strength[1] * across_y + strength[2] * vertical;
            }
        }
    }
}

/// Gives the layer beyond an end of the box the numbers of the last layer inside.
fn copy_outwards(field: &mut Field, axis: usize, side: usize) {
    let last = field.count()[axis] as isize - 1;
    let (inside, outside) = [(0, -1), (last, last + 1)][side];
    let sources = field.slab(axis, inside..inside + 1);
    for (source, target) in sources.zip(field.slab(axis, outside..outside + 1)) {
        field.values_mut().copy_within(source, target.start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Bounds, Decomposition, Face, RankGrid};
    use crate::parallel::run_on_threads;
    use nalgebra::Vector3;
    use std::sync::Mutex;

    const COUNTS: [usize; 3] = [8, 6, 16];

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(8.0, 9.0, 16.0), [periodic, [Face::Wall; 2], periodic])
    }

    /// A field of the whole grid after filtering on this number of ranks.
    fn filtered(
        width: f64,
        grid: [usize; 3],
        start: impl Fn([usize; 3]) -> f64 + Sync,
    ) -> Vec<f64> {
        let cells = BoxGrid::new(&bounds(), COUNTS);
        let even = Decomposition::even(RankGrid(grid), &bounds());
        let decomposition = cells.aligned(&even, [2; 3]).unwrap();
        let whole = Mutex::new(vec![0.0; COUNTS.iter().product()]);
        run_on_threads(grid.iter().product(), |ranks| {
            let bounds = bounds();
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            let part = cells.local_cells(subdomain);
            let mut halo = FieldHalo::new(subdomain);
            let mut field = Field::new(&part, 2);
            let [nx, ny, _] = part.count;
            let global = |n: usize| {
                let local = [n % nx, n / nx % ny, n / (nx * ny)];
                [0, 1, 2].map(|a| local[a] + part.start[a])
            };
            field.set_owned((0..part.cells()).map(|n| start(global(n))));
            let ends = [0, 1, 2].map(|axis| part.at_ends(axis));
            let mut filter = Filter::new(&cells, width, None, &field).unwrap();
            filter.apply(&mut [&mut field], &ends, &mut halo, ranks);
            let mut whole = whole.lock().unwrap();
            for (n, value) in field.owned().enumerate() {
                let [i, j, k] = global(n);
                whole[i + COUNTS[0] * (j + COUNTS[1] * k)] = value;
            }
        });
        whole.into_inner().unwrap()
    }

    fn peak(at: [usize; 3]) -> impl Fn([usize; 3]) -> f64 + Sync {
        move |cell| if cell == at { 1.0 } else { 0.0 }
    }

    #[test]
    fn a_peak_becomes_a_gaussian_of_the_width() {
        let width = 3.0;
        let field = filtered(width, [1; 3], peak([4, 3, 8]));
        let variance: f64 = field
            .iter()
            .enumerate()
            .map(|(n, f)| f * ((n / (COUNTS[0] * COUNTS[1])) as f64 - 8.0).powi(2))
            .sum();
        // Diffusion gives the variance of each step exactly, except for the part that meets its image 8 cells away.
        assert!((variance - width * width / (8.0 * LN_2)).abs() < 1.0e-6, "{variance}");
        assert!(field.iter().all(|&f| f >= 0.0));
    }

    #[test]
    fn sums_are_conserved_at_walls_too_and_the_filter_is_symmetric() {
        let at = |cell: [usize; 3]| cell[0] + COUNTS[0] * (cell[1] + COUNTS[1] * cell[2]);
        for [one, other] in [[[2, 0, 3], [3, 1, 4]], [[7, 5, 0], [0, 4, 15]]] {
            let [of_one, of_other] = [one, other].map(|cell| filtered(2.5, [1; 3], peak(cell)));
            // Some 10 steps, each of 768 cells that add up to 1, rounded.
            assert!((of_one.iter().sum::<f64>() - 1.0).abs() < 1.0e-13);
            assert!((of_one[at(other)] - of_other[at(one)]).abs() < 1.0e-16);
            assert!(of_one[at(other)] > 1.0e-3); // a control: something has come there
        }
    }

    #[test]
    fn the_bits_do_not_depend_on_the_cut() {
        let start = |[i, j, k]: [usize; 3]| ((i * 7 + j * 11 + k * 13) % 17) as f64 / 17.0;
        let alone = filtered(2.5, [1; 3], start);
        for grid in [[1, 1, 3], [2, 2, 2], [3, 1, 1]] {
            assert!(filtered(2.5, grid, start) == alone, "on {grid:?}");
        }
    }
}
