//! Displacements in a box that is periodic along some axes.

use crate::domain::Bounds;
use nalgebra::Vector3;

/// Number of box lengths by which a point has been shifted along each axis.
pub type Image = [i32; 3];

/// The lengths of the box along its periodic axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Periodicity {
    /// Length of the box by axis; `None` along an axis that is not periodic.
    pub lengths: [Option<f64>; 3],
}

impl Periodicity {
    /// The periodicity of a box.
    pub fn of(bounds: &Bounds) -> Self {
        let length = |axis: usize| bounds.is_periodic(axis).then(|| bounds.lengths()[axis]);
        Self { lengths: [length(0), length(1), length(2)] }
    }

    /// A position brought into [0, length) along each periodic axis. The image of a particle that a rank holds depends
    /// on the decomposition, but this position does not.
    #[inline(always)]
    pub fn wrapped(&self, mut position: Vector3<f64>) -> Vector3<f64> {
        for (axis, length) in self.periodic_axes() {
            let x = position[axis];
            if (0.0..length).contains(&x) {
                position[axis] = x + 0.0;
                continue;
            }
            let inside = x - length * (x / length).floor();
            // Rounding may change a coordinate just below 0 to the length itself. A zero has no sign.
            position[axis] = if inside < length { inside + 0.0 } else { 0.0 };
        }
        position
    }

    /// The image of `to` that is nearest to `from`: to + image * length.
    pub fn nearest_image(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> Image {
        let mut image = [0; 3];
        for (axis, length) in self.periodic_axes() {
            let along = to[axis] - from[axis];
            // Most pairs are in the same image, which needs no division.
            if 2.0 * along.abs() >= length {
                image[axis] = -(along / length).round() as i32;
            }
        }
        image
    }

    /// A position shifted by whole box lengths.
    pub fn shifted(&self, mut position: Vector3<f64>, image: Image) -> Vector3<f64> {
        for (axis, length) in self.periodic_axes() {
            position[axis] += f64::from(image[axis]) * length;
        }
        position
    }

    /// The shortest displacement from one point to an image of another.
    pub fn displacement(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
        self.shifted(to - from, self.nearest_image(from, to))
    }

    /// Number and length of each periodic axis.
    #[inline(always)]
    pub fn periodic_axes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let axes = self.lengths.iter().enumerate();
        axes.filter_map(|(axis, length)| length.map(|length| (axis, length)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOX: Periodicity = Periodicity { lengths: [Some(4.0), Some(5.5), None] };

    proptest! {
        #[test]
        fn images_do_not_change_a_displacement(
            a in prop::array::uniform3(-9.0..9.0f64),
            b in prop::array::uniform3(-9.0..9.0f64),
            image in prop::array::uniform3(-3..3),
        ) {
            let (a, b) = (Vector3::from(a), Vector3::from(b));
            let shortest = BOX.displacement(&a, &b);
            prop_assert!(shortest.x.abs() <= 2.0 + 1e-14 && shortest.y.abs() <= 2.75 + 1e-14);
            prop_assert_eq!(shortest.z, b.z - a.z);
            let other = BOX.displacement(&BOX.wrapped(a), &BOX.shifted(b, image));
            let same = |d: f64, length: f64| d.abs() < 1e-13 || (d.abs() - length).abs() < 1e-13;
            prop_assert!(same(other.x - shortest.x, 4.0) && same(other.y - shortest.y, 5.5));
            let wrapped = BOX.wrapped(a);
            prop_assert!((0.0..4.0).contains(&wrapped.x) && (0.0..5.5).contains(&wrapped.y));
        }
    }

    #[test]
    fn a_coordinate_just_below_zero_stays_inside() {
        let wrapped = BOX.wrapped(Vector3::new(-1e-20, -0.0, -1.0));
        assert_eq!(wrapped, Vector3::new(0.0, 0.0, -1.0));
        assert!(wrapped.y.is_sign_positive());
    }
}
