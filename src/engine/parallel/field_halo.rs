//! Halos of fields: copies of the neighbours' cells around a rank's own.
//!
//! They are exchanged axis by axis. Cells received along one axis are sent on along the next, so that edges and corners
//! need no messages of their own.

use super::{AxisNeighbours, Communicator, Exchange};
use crate::domain::Subdomain;
use crate::grid::Field;
use bytemuck::Pod;
use std::ops::Range;

/// The neighbours of a rank, and the messages between them.
#[derive(Clone, Debug)]
pub(crate) struct FieldHalo {
    rank: usize,
    messages: [AxisMessages; 3],
}

/// The messages to and from the neighbours along an axis: one to each rank, even if it is the neighbour on both sides.
#[derive(Clone, Debug)]
struct AxisMessages {
    neighbours: AxisNeighbours,
    exchange: Exchange,
}

/// Layers of cells along an axis, at the lower and the upper end.
struct Slabs {
    inner: [Range<isize>; 2],
    halo: [Range<isize>; 2],
}

impl Slabs {
    fn of<T: Pod>(field: &Field<T>, axis: usize) -> Self {
        let (count, halo) = (field.count()[axis] as isize, field.halo() as isize);
        Self { inner: [0..halo, count - halo..count], halo: [-halo..0, count..count + halo] }
    }
}

/// Treatment of the axes across the one along which halos are copied.
#[derive(Clone, Copy)]
struct Across {
    neighbours: [AxisNeighbours; 3],
    axis: usize,
}

impl Across {
    /// Ranges of indices of the rows in `layers` along the axis. They include the halos along the axes before it, which
    /// are filled by then, but not those that are filled when their own axis comes; they also include the cells above
    /// an upper face of the box.
    fn rows<T: Pod>(
        self,
        field: &Field<T>,
        layers: Range<isize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        field.rows_within(std::array::from_fn(|other| {
            if other == self.axis {
                return layers.clone();
            }
            let count = field.count()[other] as isize;
            let filled = if other < self.axis { field.halo() as isize } else { 0 };
            let [below, above] = self.neighbours[other].map(|neighbour| neighbour.is_some());
            let from = if below { -filled } else { 0 };
            from..count + if above { filled } else { 1 }
        }))
    }
}

impl FieldHalo {
    /// A halo for the fields of a subdomain.
    pub(crate) fn new(subdomain: Subdomain) -> Self {
        let messages = [0, 1, 2].map(|axis| AxisMessages::new(subdomain.neighbours(axis)));
        Self { rank: subdomain.rank, messages }
    }

    fn neighbours(&self) -> [AxisNeighbours; 3] {
        self.messages.each_ref().map(|messages| messages.neighbours)
    }

    /// Fills the halos from the owners. This call is collective. Cells beyond a face of the box that is not periodic
    /// have no owner. A halo there stays as it is, with one exception: in the cells above an upper face it takes the
    /// values that the neighbours along this face hold there, since the lower faces of these cells lie in that face.
    ///
    /// Before: owned cells are current; along a divided axis every rank has at least as many cells as the halo is wide.
    /// After: halo cells equal those of their owners.
    pub(crate) fn refresh<T: Pod>(
        &mut self,
        fields: &mut [&mut Field<T>],
        ranks: &dyn Communicator,
    ) {
        let neighbours = self.neighbours();
        for axis in 0..3 {
            let across = Across { neighbours, axis };
            if neighbours[axis] == [Some(self.rank); 2] {
                fields.iter_mut().for_each(|field| copy_images(field, across));
                continue;
            }
            let rows = |layers: fn(Slabs) -> [Range<isize>; 2]| {
                move |field: &Field<T>, side: usize| {
                    across.rows(field, layers(Slabs::of(field, axis))[side].clone())
                }
            };
            let (inner, halo) = (rows(|slabs| slabs.inner), rows(|slabs| slabs.halo));
            self.messages[axis].exchange(fields, inner, ranks);
            self.messages[axis].receive(fields, halo, |value, sent| *value = sent);
        }
    }

    /// Adds the values in halos to those of their owners, and sets the halos to zero, except for those beyond faces of
    /// the box that are not periodic. The values must be multiples of one quantum, so that their sums are exact. This
    /// call is collective.
    pub(crate) fn add_to_owners(&mut self, fields: &mut [&mut Field], ranks: &dyn Communicator) {
        let neighbours = self.neighbours();
        for axis in (0..3).rev() {
            if neighbours[axis] == [Some(self.rank); 2] {
                fields.iter_mut().for_each(|field| fold_images(field, axis));
                continue;
            }
            let rows = |layers: fn(Slabs) -> [Range<isize>; 2]| {
                move |field: &Field, side: usize| {
                    field.slab(axis, layers(Slabs::of(field, axis))[side].clone())
                }
            };
            let (inner, halo) = (rows(|slabs| slabs.inner), rows(|slabs| slabs.halo));
            self.messages[axis].exchange(fields, halo, ranks);
            self.messages[axis].receive(fields, inner, |value, sent| *value += sent);
            for side in (0..2).filter(|&side| neighbours[axis][side].is_some()) {
                for field in fields.iter_mut() {
                    for row in halo(field, side) {
                        field.values_mut()[row].fill(0.0);
                    }
                }
            }
        }
    }
}

impl AxisMessages {
    fn new(neighbours: AxisNeighbours) -> Self {
        let mut ranks: Vec<usize> = neighbours.into_iter().flatten().collect();
        ranks.dedup();
        let empty = || ranks.iter().map(|&rank| (rank, 0));
        Self { neighbours, exchange: Exchange::with_lengths(empty(), empty()) }
    }

    /// The place of the message to or from the neighbour on a side, if there is one.
    fn place(&self, side: usize) -> Option<usize> {
        self.neighbours[side].map(|_| if side == 0 { 0 } else { self.exchange.outgoing.len() - 1 })
    }

    /// Sends rows of all fields to the neighbours below and above, and waits for as many rows from them. Collective.
    fn exchange<T: Pod, R: Iterator<Item = Range<usize>>>(
        &mut self,
        fields: &[&mut Field<T>],
        rows: impl Fn(&Field<T>, usize) -> R,
        ranks: &dyn Communicator,
    ) {
        self.exchange.outgoing.iter_mut().for_each(|message| message.bytes.clear());
        for side in 0..2 {
            let Some(place) = self.place(side) else { continue };
            let bytes = &mut self.exchange.outgoing[place].bytes;
            for field in fields {
                rows(field, side).for_each(|row| append(bytes, &field.values()[row]));
            }
        }
        let Exchange { outgoing, incoming } = &mut self.exchange;
        for (incoming, outgoing) in incoming.iter_mut().zip(outgoing) {
            incoming.bytes.resize(outgoing.bytes.len(), 0);
        }
        self.exchange.complete(ranks);
    }

    /// Combines the values received from below and above with rows of the fields.
    fn receive<T: Pod, R: Iterator<Item = Range<usize>>>(
        &self,
        fields: &mut [&mut Field<T>],
        rows: impl Fn(&Field<T>, usize) -> R,
        combine: impl Fn(&mut T, T),
    ) {
        let mut bytes: Vec<&[u8]> =
            self.exchange.incoming.iter().map(|message| &message.bytes[..]).collect();
        // The rows that a rank sends downwards come first in its message; they arrive from above.
        for side in [1, 0] {
            let Some(place) = self.place(side) else { continue };
            for field in fields.iter_mut() {
                for row in rows(field, side) {
                    let (sent, rest) = bytes[place].split_at(row.len() * size_of::<T>());
                    bytes[place] = rest;
                    let numbers = sent.chunks_exact(size_of::<T>());
                    let numbers = numbers.map(bytemuck::pod_read_unaligned::<T>);
                    let row = field.values_mut()[row].iter_mut();
                    row.zip(numbers).for_each(|(value, sent)| combine(value, sent));
                }
            }
        }
    }
}

/// Appends the values of a row. In a halo at the ends of rows, rows are only as long as the halo is wide, and a call
/// that copies each would take longer than the copy.
#[inline(always)]
fn append<T: Pod>(buffer: &mut Vec<u8>, row: &[T]) {
    match row {
        [one] => buffer.extend_from_slice(bytemuck::bytes_of(one)),
        [one, two] => {
            buffer.extend_from_slice(bytemuck::bytes_of(one));
            buffer.extend_from_slice(bytemuck::bytes_of(two));
        }
        row => buffer.extend_from_slice(bytemuck::cast_slice(row)),
    }
}

/// Pairs (halo layer, owned layer) along a periodic axis that is not divided. The axis may be narrower than the halo.
fn image_layers<T: Pod>(
    field: &Field<T>,
    axis: usize,
) -> impl Iterator<Item = (isize, isize)> + use<T> {
    let (count, halo) = (field.count()[axis] as isize, field.halo() as isize);
    (-halo..0).chain(count..count + halo).map(move |layer| (layer, layer.rem_euclid(count)))
}

fn copy_images<T: Pod>(field: &mut Field<T>, across: Across) {
    let axis = across.axis;
    if axis == field.order()[0] {
        return copy_images_along_rows(field);
    }
    for (image, original) in image_layers(field, axis) {
        let sources = across.rows(field, original..original + 1);
        for (source, target) in sources.zip(across.rows(field, image..image + 1)) {
            field.values_mut().copy_within(source, target.start);
        }
    }
}

/// Fills the halo along rows, where each row holds its own images. The images are so few that a call that copies them
/// would take longer than the copy. The nearest ones come first, since those further out may be images of images.
fn copy_images_along_rows<T: Pod>(field: &mut Field<T>) {
    let (count, halo) = (field.row_length(), field.halo());
    for row in field.values_mut().chunks_exact_mut(count + 2 * halo) {
        (0..halo).rev().for_each(|below| row[below] = row[below + count]);
        (halo..2 * halo).for_each(|original| row[original + count] = row[original]);
    }
}

fn fold_images(field: &mut Field, axis: usize) {
    for (image, original) in image_layers(field, axis) {
        let targets = field.slab(axis, original..original + 1);
        for (target, source) in targets.zip(field.slab(axis, image..image + 1)) {
            for (target, source) in target.zip(source) {
                let amount = std::mem::take(&mut field.values_mut()[source]);
                field.values_mut()[target] += amount;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::run_on_threads;
    use super::*;
    use crate::domain::{Bounds, Decomposition, Face, RankGrid};
    use crate::grid::{BoxGrid, LocalCells};
    use nalgebra::Vector3;

    const COUNTS: [usize; 3] = [6, 5, 9];

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(6.0, 5.0, 9.0), [periodic, periodic, [Face::Wall, Face::Open]])
    }

    /// Calls `check` with each cell of a rank and its halo, and with the global index of the cell if it lies in the
    /// box.
    fn for_each_cell(
        local: &LocalCells,
        halo: isize,
        mut check: impl FnMut([isize; 3], Option<usize>),
    ) {
        let range = |axis: usize| -halo..local.count[axis] as isize + halo;
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    let global = [0, 1, 2].map(|a| [i, j, k][a] + local.start[a] as isize);
                    let [x, y] = [0, 1].map(|a| global[a].rem_euclid(COUNTS[a] as isize) as usize);
                    let inside = (0..COUNTS[2] as isize).contains(&global[2]);
                    let number = |z| x + COUNTS[0] * (y + COUNTS[1] * z);
                    check([i, j, k], inside.then(|| number(global[2] as usize)));
                }
            }
        }
    }

    fn on_ranks(grid: [usize; 3], work: impl Fn(LocalCells, FieldHalo, &dyn Communicator) + Sync) {
        run_on_threads(grid.iter().product(), |ranks| {
            let cells = BoxGrid::new(&bounds(), COUNTS);
            let even = Decomposition::even(RankGrid(grid), &bounds());
            let decomposition = cells.aligned(&even, [2; 3]).expect("there are enough cells");
            let bounds = bounds();
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            work(cells.local_cells(subdomain), FieldHalo::new(subdomain), ranks);
        });
    }

    #[test]
    fn refreshed_halos_equal_their_owners_at_edges_and_corners_too() {
        for grid in [[1, 1, 1], [1, 1, 3], [2, 2, 2], [3, 2, 1]] {
            on_ranks(grid, |local, mut halo, ranks| {
                let mut field = Field::new(&local, 2);
                for_each_cell(&local, 0, |cell, owner| {
                    *field.at_mut(cell) = owner.expect("owned cells lie in the box") as f64;
                });
                halo.refresh(&mut [&mut field], ranks);
                for_each_cell(&local, 2, |cell, owner| {
                    assert_eq!(field.at(cell), owner.unwrap_or(0) as f64, "cell {cell:?}");
                });
            });
        }
    }

    #[test]
    fn values_beyond_the_box_are_refreshed_along_its_faces() {
        for grid in [[1, 1, 1], [3, 2, 1]] {
            on_ranks(grid, |local, mut halo, ranks| {
                // Values on the upper face of the box, which no cell owns: it would be the lower face of cell 9.
                let mut field = Field::new(&local, 2);
                let number = |cell: [isize; 3]| {
                    let wrapped = |a: usize| {
                        (cell[a] + local.start[a] as isize).rem_euclid(COUNTS[a] as isize)
                    };
                    (wrapped(0) + 10 * wrapped(1)) as f64
                };
                let [x, y, z] = local.count.map(|count| count as isize);
                for cell in (0..y).flat_map(|j| (0..x).map(move |i| [i, j, z])) {
                    *field.at_mut(cell) = number(cell);
                }
                halo.refresh(&mut [&mut field], ranks);
                for cell in (-2..y + 2).flat_map(|j| (-2..x + 2).map(move |i| [i, j, z])) {
                    assert_eq!(field.at(cell), number(cell), "cell {cell:?} of {grid:?}");
                }
            });
        }
    }

    #[test]
    fn owners_receive_the_sum_of_all_halos() {
        let expected = |grid| {
            let sums = std::sync::Mutex::new(vec![0.0; COUNTS.iter().product()]);
            on_ranks(grid, |local, mut halo, ranks| {
                let mut field = Field::new(&local, 2);
                let mut wanted = sums.lock().expect("no thread panics here");
                for_each_cell(&local, 2, |cell, owner| {
                    let amount =
                        (ranks.rank() * 100) as f64 + (cell[0] + 2 * cell[1] + 4 * cell[2]) as f64;
                    *field.at_mut(cell) = amount;
                    if let Some(owner) = owner {
                        wanted[owner] += amount;
                    }
                });
                drop(wanted);
                ranks.any(true); // all have added theirs
                halo.add_to_owners(&mut [&mut field], ranks);
                let wanted = sums.lock().expect("no thread panics here");
                for_each_cell(&local, 0, |cell, owner| {
                    let owner = owner.expect("owned cells lie in the box");
                    assert_eq!(field.at(cell), wanted[owner], "cell {cell:?} of {grid:?}");
                });
            });
        };
        for grid in [[1, 1, 1], [1, 1, 3], [2, 2, 2], [3, 2, 1]] {
            expected(grid);
        }
    }

    #[test]
    fn a_periodic_axis_may_be_one_cell_wide() {
        let bounds = bounds();
        let grid = BoxGrid::new(&bounds, [1, 2, 4]);
        let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
        run_on_threads(1, |ranks| {
            let subdomain = decomposition.subdomain(&bounds, 0);
            let mut halo = FieldHalo::new(subdomain);
            let mut field = Field::new(&grid.local_cells(subdomain), 2);
            *field.at_mut([0, 0, 1]) = 3.0;
            *field.at_mut([0, 1, 1]) = 5.0;
            halo.refresh(&mut [&mut field], ranks);
            assert_eq!([-2, -1, 1, 2].map(|i| field.at([i, 0, 1])), [3.0; 4]);
            assert_eq!([-2, -1, 2, 3].map(|j| field.at([0, j, 1])), [3.0, 5.0, 3.0, 5.0]);
            halo.add_to_owners(&mut [&mut field], ranks);
            // Each cell occurs five times along x and three times along y.
            assert_eq!(field.owned().sum::<f64>(), 5.0 * (3.0 * 3.0 + 3.0 * 5.0));
        });
    }
}
