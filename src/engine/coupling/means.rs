//! Means in cells of quantities that are known in or across their faces.

use crate::grid::{ColumnOnCells, Field};
use crate::numbers::vectorised;

vectorised!(
    /// Sets each owned cell to the mean of a face field's values at its two faces along `axis`.
    ///
    /// It is the adjoint of the gas's average of two cells to a face.
    pub(crate) fn mean_of_faces(faces: &Field, axis: usize, cells: &mut Field) {
        let (stride, length) = (faces.strides()[axis], faces.row_length());
        for (from, to) in faces.rows().zip(cells.rows()) {
            let [below, above] = [from, from + stride].map(|row| &faces.values()[row..][..length]);
            let means = &mut cells.values_mut()[to..][..length];
            for i in 0..length {
                means[i] = 0.5 * (below[i] + above[i]);
            }
        }
    }
);

vectorised!(
    /// Sets each owned cell to the mean of a field's gradients at its two faces along `axis`: half the difference
    /// of the cells above and below over the distance of cells. Halos must be current.
    pub(crate) fn mean_gradient(field: &Field, axis: usize, distance: f64, cells: &mut Field) {
        let (stride, length) = (field.strides()[axis], field.row_length());
        for (from, to) in field.rows().zip(cells.rows()) {
            let [below, here, above] =
                [from - stride, from, from + stride].map(|row| &field.values()[row..][..length]);
            let means = &mut cells.values_mut()[to..][..length];
            for i in 0..length {
                let upper = (above[i] - here[i]) / distance;
                let lower = (here[i] - below[i]) / distance;
                means[i] = 0.5 * (upper + lower);
            }
        }
    }
);

/// Replaces the gradient across a round column, as [`mean_gradient`] left it, in cells next to closed ones. The
/// gradient there is the one on the open side alone, as if the field continued linearly beyond the wall.
pub(crate) fn mend_gradient_at_wall(
    field: &Field,
    (axis, distance): (usize, f64),
    column: &ColumnOnCells,
    cells: &mut Field,
) {
    let (stride, length) = (field.strides()[axis], field.row_length());
    for row in field.rows() {
        for place in row..row + length {
            let is_open = |place: usize| column.at(place) > 0.0;
            let sides = [place - stride, place + stride].map(is_open);
            if !is_open(place) || sides == [true, true] {
                continue;
            }
            let values = field.values();
            let difference = match sides {
                [true, _] => values[place] - values[place - stride],
                [_, true] => values[place + stride] - values[place],
                _ => 0.0,
            };
            cells.values_mut()[place] = difference / distance;
        }
    }
}
