//! The box: its size, what its faces do, and the lattice that positions lie on.

use super::BoxFace;
use crate::numbers::Quantum;
use nalgebra::Vector3;

/// What a face of the box does to particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The box repeats beyond this face; the opposite face is periodic too.
    Periodic,
    /// A flat wall lies in this face.
    Wall,
    /// Particles whose centre passes leave for good; they are counted.
    Open,
    /// A particle whose centre passes stops the run with an error.
    Stop,
}

/// A box from the origin to `lengths`.
///
/// Positions are multiples of `lattice().spacing()`, and so are the lengths: wrapping a position, or
/// shifting it by a box length, is exact.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lengths: Vector3<f64>,
    faces: [[Face; 2]; 3],
    quantum: Quantum,
}

impl Bounds {
    /// A box with faces `[axis][lower, upper]`. Lengths are rounded to the position lattice, which spans
    /// twice the longest: 1 part in 10^15.
    pub fn new(lengths: Vector3<f64>, faces: [[Face; 2]; 3]) -> Self {
        let quantum = Quantum::spanning(2.0 * lengths.max());
        Self { lengths: quantum.round_vector(lengths), faces, quantum }
    }

    /// Edge lengths.
    pub fn lengths(&self) -> Vector3<f64> {
        self.lengths
    }

    /// What the lower and upper face of an axis do.
    pub fn faces(&self, axis: usize) -> [Face; 2] {
        self.faces[axis]
    }

    /// What a face does.
    pub fn face(&self, face: BoxFace) -> Face {
        self.faces[face.axis][face.side]
    }

    /// Whether the box repeats along an axis.
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.faces[axis][0] == Face::Periodic
    }

    /// Whether the box repeats along every axis.
    pub fn is_fully_periodic(&self) -> bool {
        (0..3).all(|axis| self.is_periodic(axis))
    }

    /// The quantum of positions.
    pub fn position_quantum(&self) -> Quantum {
        self.quantum
    }

    /// Horizontal cross-section, the area that gas and weight per area refer to.
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
            return coordinate + 0.0; // a zero has no sign, nor has it below
        }
        coordinate - length * (coordinate / length).floor()
    }

    /// A position with every periodic coordinate brought into the box, exactly.
    pub fn wrap(&self, mut position: Vector3<f64>) -> Vector3<f64> {
        for axis in 0..3 {
            position[axis] = self.wrap_coordinate(axis, position[axis]);
        }
        position
    }

    /// How far a position may move without passing an open face or one that ends the run; not above zero beyond one.
    #[inline]
    pub fn clearance(&self, position: &Vector3<f64>) -> f64 {
        let passable = |face: Face| matches!(face, Face::Open | Face::Stop);
        let to_faces = (0..3).flat_map(|axis| {
            let x = position[axis];
            self.faces[axis].into_iter().zip([x, self.lengths[axis] - x])
        });
        let displacements =
            to_faces.filter(|&(face, _)| passable(face)).map(|(_, displacement)| displacement);
        displacements.fold(f64::INFINITY, f64::min)
    }

    /// The first face of this kind that a position lies beyond.
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
        fn wrapping_is_exact(x in -15.0..15.0f64) {
            let bounds = column();
            let x = bounds.position_quantum().round(x);
            let wrapped = bounds.wrap_coordinate(0, x);
            let length = bounds.lengths().x;
            prop_assert!((0.0..length).contains(&wrapped));
            let turns = ((x - wrapped) / length).round();
            prop_assert_eq!(wrapped + turns * length, x);
        }
    }

    #[test]
    fn only_open_faces_and_stops_are_kept_clear_of() {
        let clearance = |bounds: &Bounds, z| bounds.clearance(&Vector3::new(0.1, 9.0, z));
        assert_eq!(clearance(&column(), 30.0), 70.0);
        assert_eq!(clearance(&column(), 100.5), -0.5);
        let stop = Bounds::new(
            column().lengths(),
            [[Face::Periodic; 2], [Face::Stop; 2], [Face::Wall; 2]],
        );
        assert!((stop.clearance(&Vector3::new(1.0, 0.3, 0.1)) - 0.3).abs() < 1.0e-12);
        let closed = Bounds::new(column().lengths(), [[Face::Wall; 2]; 3]);
        assert_eq!(clearance(&closed, 0.1), f64::INFINITY);
    }

    #[test]
    fn only_the_open_face_lets_particles_out() {
        let bounds = column();
        assert_eq!(bounds.passed(Face::Open, &Vector3::new(-1.0, 9.0, 50.0)), None);
        let passed = bounds.passed(Face::Open, &Vector3::new(1.0, 1.0, 100.5));
        assert_eq!(passed, BoxFace::named("z upper"));
        assert_eq!(bounds.passed(Face::Open, &Vector3::new(1.0, 1.0, -0.5)), None);
    }
}
