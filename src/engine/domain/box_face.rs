//! The six faces of the box.

use nalgebra::Vector3;
use std::fmt;

/// A face of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoxFace {
    /// Axis along its normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// 0 for the lower face, 1 for the upper one.
    pub side: usize,
}

impl BoxFace {
    /// All faces, x first and the lower one before the upper.
    pub const ALL: [Self; 6] = [
        Self { axis: 0, side: 0 },
        Self { axis: 0, side: 1 },
        Self { axis: 1, side: 0 },
        Self { axis: 1, side: 1 },
        Self { axis: 2, side: 0 },
        Self { axis: 2, side: 1 },
    ];

    /// The names of [`BoxFace::ALL`], in case files, results and messages.
    pub const NAMES: [&'static str; 6] =
        ["x lower", "x upper", "y lower", "y upper", "z lower", "z upper"];

    /// Its name, for example "x lower".
    pub fn name(self) -> &'static str {
        Self::NAMES[2 * self.axis + self.side]
    }

    /// The face with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|face| face.name() == name)
    }

    /// Unit normal, into the box.
    pub fn inward_normal(self) -> Vector3<f64> {
        let mut normal = Vector3::zeros();
        normal[self.axis] = 1.0 - 2.0 * self.side as f64;
        normal
    }
}

impl fmt::Display for BoxFace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_found_by_its_name() {
        for (face, name) in BoxFace::ALL.into_iter().zip(BoxFace::NAMES) {
            assert_eq!((face.name(), BoxFace::named(name)), (name, Some(face)));
        }
        assert_eq!(BoxFace::named("lower x"), None);
    }
}
