//! The box: its size, the effect of its faces on particles, and the quantum of positions.

use super::BoxFace;
use crate::numbers::Quantum;
use nalgebra::Vector3;

/// Effect of a face of the box on particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The box is repeated beyond this face; the opposite face is periodic too.
    Periodic,
    /// A flat wall lies in this face.
    Wall,
    /// Particles whose centre passes the face leave the run; they are counted.
    Open,
    /// A particle whose centre passes the face stops the run with an error message.
    Stop,
}

/// A box from the origin to `lengths`.
///
/// Positions are rounded to multiples of [`Bounds::position_quantum`], and so are the lengths, so that wrapping a
/// position, or shifting it by a length of the box, is exact.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lengths: Vector3<f64>,
    faces: [[Face; 2]; 3],
    quantum: Quantum,
}

impl Bounds {
    /// A box with faces `[axis][lower, upper]`. Lengths are rounded to the quantum of positions, which is about 10^-15
    /// of the longest.
    pub fn new(lengths: Vector3<f64>, faces: [[Face; 2]; 3]) -> Self {
        let quantum = Quantum::spanning(2.0 * lengths.max());
        Self { lengths: quantum.round_vector(lengths), faces, quantum }
    }

    /// Edge lengths.
    pub fn lengths(&self) -> Vector3<f64> {
        self.lengths
    }

    /// Effects of the lower and the upper face along an axis.
    pub fn faces(&self, axis: usize) -> [Face; 2] {
        self.faces[axis]
    }

    /// Effect of a face.
    pub fn face(&self, face: BoxFace) -> Face {
        self.faces[face.axis][face.side]
    }

    /// Whether the box is periodic along an axis.
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.faces[axis][0] == Face::Periodic
    }

    /// Whether the box is periodic along every axis.
    pub fn is_fully_periodic(&self) -> bool {
        (0..3).all(|axis| self.is_periodic(axis))
    }

    /// The quantum of positions.
    pub fn position_quantum(&self) -> Quantum {
        self.quantum
    }

    /// Area of the horizontal cross-section.
    pub fn cross_section(&self) -> f64 {
        self.lengths.x * self.lengths.y
    }

    /// Volume of the box.
    pub fn volume(&self) -> f64 {
        self.cross_section() * self.lengths.z
    }

    /// A coordinate brought into [0, length) along a periodic axis, exactly; unchanged along others.
    #[inline(always)]
    pub fn wrap_coordinate(&self, axis: usize, coordinate: f64) -> f64 {
        if !self.is_periodic(axis) {
            return coordinate;
        }
        let length = self.lengths[axis];
        if (0.0..length).contains(&coordinate) {
            return coordinate + 0.0; // removes the sign of a zero, as the subtraction below does
        }
        coordinate - length * (coordinate / length).floor()
    }

    /// A position with every periodic coordinate brought into the box, exactly.
    #[inline(always)]
    pub fn wrap(&self, mut position: Vector3<f64>) -> Vector3<f64> {
        for axis in 0..3 {
            position[axis] = self.wrap_coordinate(axis, position[axis]);
        }
        position
    }

    /// Smallest distance of the region between two corners from an open face or one that stops the run; negative beyond
    /// such a face.
    pub fn clearance(&self, [lower, upper]: &[Vector3<f64>; 2]) -> f64 {
        let passable = |face: Face| matches!(face, Face::Open | Face::Stop);
        let to_faces = (0..3).flat_map(|axis| {
            self.faces[axis].into_iter().zip([lower[axis], self.lengths[axis] - upper[axis]])
        });
        let distances = to_faces.filter(|&(face, _)| passable(face)).map(|(_, distance)| distance);
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The first face of this kind beyond which a position lies.
    #[inline]
    pub fn passed(&self, kind: Face, position: &Vector3<f64>) -> Option<BoxFace> {
        (0..3).find_map(|axis| {
            let x = position[axis];
            if x < 0.0 && self.faces[axis][0] == kind {
                Some(BoxFace { axis, side: 0 })
            } else if x > self.lengths[axis] && self.faces[axis][1] == kind {
                Some(BoxFace { axis, side: 1 })
            } else {
                None
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn column() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(5.1, 5.3, 100.0), [periodic, periodic, [Face::Wall, Face::Open]])
    }

    proptest! {
        #[test]
        fn wrapping_a_position_is_exact(x in -15.0..15.0f64) {
            let bounds = column();
            let x = bounds.position_quantum().round(x);
            let wrapped = bounds.wrap_coordinate(0, x);
            let length = bounds.lengths().x;
            prop_assert!((0.0..length).contains(&wrapped));
            let box_lengths = ((x - wrapped) / length).round();
            prop_assert_eq!(wrapped + box_lengths * length, x);
        }
    }

    #[test]
    fn the_clearance_is_the_distance_to_open_and_stop_faces() {
        let clearance = |bounds: &Bounds, z| bounds.clearance(&[Vector3::new(0.1, 9.0, z); 2]);
        assert_eq!(clearance(&column(), 30.0), 70.0);
        assert_eq!(clearance(&column(), 100.5), -0.5);
        let stop = Bounds::new(
            column().lengths(),
            [[Face::Periodic; 2], [Face::Stop; 2], [Face::Wall; 2]],
        );
        assert!((stop.clearance(&[Vector3::new(1.0, 0.3, 0.1); 2]) - 0.3).abs() < 1.0e-12);
        let corners = [Vector3::new(1.0, 2.0, 0.1), Vector3::new(1.5, stop.lengths().y - 0.2, 0.1)];
        assert!((stop.clearance(&corners) - 0.2).abs() < 1.0e-12);
        let closed = Bounds::new(column().lengths(), [[Face::Wall; 2]; 3]);
        assert_eq!(clearance(&closed, 0.1), f64::INFINITY);
    }

    #[test]
    fn particles_pass_open_faces_only() {
        let bounds = column();
        assert_eq!(bounds.passed(Face::Open, &Vector3::new(-1.0, 9.0, 50.0)), None);
        let passed = bounds.passed(Face::Open, &Vector3::new(1.0, 1.0, 100.5));
        assert_eq!(passed, BoxFace::named("z upper"));
        assert_eq!(bounds.passed(Face::Open, &Vector3::new(1.0, 1.0, -0.5)), None);
    }
}
