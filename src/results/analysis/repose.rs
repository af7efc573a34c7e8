//! Angle of repose: the surface of a heap along a horizontal axis, and the slope of its sides.

use super::no_value::{Estimate, NoValue, require_finite, require_positive};

/// Fractions of the crest's height between which the slope of a side is measured: the rounded crest and the thin foot
/// are left out.
const FALL: [f64; 2] = [0.8, 0.2];

/// The height of a heap in columns of equal width, side by side along a horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Width of a column.
    pub width: f64,
    /// Heights of the columns above the plate; 0 where the plate is bare.
    pub heights: Vec<f64>,
}

/// Base of a heap: its extent along the axis from 0, and across it from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Length along the axis.
    pub length: f64,
    /// Breadth across the axis.
    pub breadth: f64,
}

/// A sphere of a heap: its positions along and across the axis, its height, its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Position of the centre along the axis.
    pub along: f64,
    /// Position of the centre across the axis.
    pub across: f64,
    /// Height of the centre above the plate.
    pub height: f64,
    /// Radius.
    pub radius: f64,
}

impl Surface {
    /// The surface of these spheres. The plate is divided into squares whose sides are about `side`. The height of a
    /// column is the mean over its squares, across the axis, of the highest point of the highest sphere whose centre
    /// lies above the square.
    ///
    /// # Errors
    /// If a length is not positive, or a position is not finite.
    pub fn of(grains: &[Grain], plate: Plate, side: f64) -> Result<Self, NoValue> {
        require_positive("the plate's length", plate.length)?;
        require_positive("the plate's breadth", plate.breadth)?;
        require_positive("the side of a square", side)?;
        let count = |length: f64| libm::floor(length / side).max(1.0);
        let (columns, rows) = (count(plate.length), count(plate.breadth));
        let square = |place: f64, length: f64, count: f64| {
            libm::floor(place / length * count).clamp(0.0, count - 1.0) as usize
        };
        let mut tops = vec![vec![0.0_f64; rows as usize]; columns as usize];
        for Grain { along, across, height, radius } in grains {
            require_finite("the place of a sphere", &[*along, *across, *height, *radius])?;
            let column = &mut tops[square(*along, plate.length, columns)];
            let top = &mut column[square(*across, plate.breadth, rows)];
            *top = top.max(height + radius);
        }
        let heights = tops.iter().map(|tops| tops.iter().sum::<f64>() / rows).collect();
        Ok(Self { width: plate.length / columns, heights })
    }

    /// Height of the highest column.
    pub fn crest(&self) -> f64 {
        self.heights.iter().copied().fold(0.0, f64::max)
    }

    /// Position of the middle of a column along the axis.
    pub fn place(&self, column: usize) -> f64 {
        (column as f64 + 0.5) * self.width
    }

    /// The angle of repose in degrees, for each side
    ///
    /// ```math
    /// \theta = \arctan \frac{0.6\, H}{\lvert x(0.2\, H) - x(0.8\, H) \rvert}
    /// ```
    ///
    /// where H is the height of the crest, and x(h) the position at which the surface, followed from the crest
    /// outwards, first falls through h. The result is the mean over the sides that fall this far. Beyond the end of the
    /// plate the height is 0 if particles can leave there (`open`, at the lower and the upper end); a wall ends the
    /// side. The error is half of the difference between two sides, infinite if there is only one.
    ///
    /// # Errors
    /// If there is no heap, or no side of it falls to a fifth of the crest.
    pub fn angle(&self, open: [bool; 2]) -> Result<Estimate, NoValue> {
        let crest = self.crest();
        let Some(top) = self.heights.iter().position(|&height| height == crest && crest > 0.0)
        else {
            return Err(NoValue::because("the plate is bare"));
        };
        let mut lower: Vec<f64> = self.heights[..=top].iter().rev().copied().collect();
        let mut upper = self.heights[top..].to_vec();
        for (side, open) in [&mut lower, &mut upper].into_iter().zip(open) {
            side.extend(open.then_some(0.0));
        }
        let angles: Vec<f64> =
            [lower, upper].iter().filter_map(|side| self.angle_of(side, crest)).collect();
        match angles[..] {
            [one] => Ok(Estimate { value: one, error: f64::INFINITY }),
            [one, other] => {
                Ok(Estimate { value: 0.5 * (one + other), error: 0.5 * (one - other).abs() })
            }
            _ => Err(NoValue::because("no side of the heap falls to a fifth of its height")),
        }
    }

    /// The angle of a side, whose heights begin at the crest.
    fn angle_of(&self, heights: &[f64], crest: f64) -> Option<f64> {
        let places = FALL.map(|share| first_fall(heights, share * crest));
        let run = self.width * (places[1]? - places[0]?);
        Some(libm::atan2((FALL[0] - FALL[1]) * crest, run).to_degrees())
    }
}

/// Position at which heights first fall through a level, in steps from the first, by linear interpolation.
fn first_fall(heights: &[f64], level: f64) -> Option<f64> {
    let next = heights.iter().position(|&height| height < level)?;
    let (before, after) = (heights[next.checked_sub(1)?], heights[next]);
    Some((next - 1) as f64 + (before - level) / (before - after))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(heights: &[f64]) -> Surface {
        Surface { width: 2.0, heights: heights.to_vec() }
    }

    #[test]
    fn straight_sides_have_their_angle() {
        // Slopes of one in two, and one in one, from a crest of 20.
        let heap = surface(&[
            0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 18.0, 16.0, 14.0, 12.0, 10.0, 8.0, 6.0, 4.0, 2.0,
        ]);
        let angle = heap.angle([true, true]).unwrap();
        let [steep, flat] = [2.0_f64, 1.0].map(|slope| slope.atan().to_degrees());
        // Heights lie on straight lines, so there is only rounding.
        assert!((angle.value - 0.5 * (steep + flat)).abs() < 1e-9, "{angle:?}");
        assert!((angle.error - 0.5 * (steep - flat)).abs() < 1e-9, "{angle:?}");
        // Control: heights twice as large give another angle.
        let high = surface(&heap.heights.iter().map(|height| 2.0 * height).collect::<Vec<_>>());
        assert!(high.angle([true, true]).unwrap().value > angle.value + 5.0);
    }

    #[test]
    fn a_wall_ends_a_side_and_an_open_end_is_a_cliff() {
        let block = surface(&[10.0, 10.0, 10.0]);
        assert!(block.angle([false, false]).unwrap_err().reason().contains("no side"));
        let cliff = block.angle([false, true]).unwrap();
        assert!((cliff.value - (10.0_f64 / 2.0).atan().to_degrees()).abs() < 1e-9, "{cliff:?}");
        assert!(cliff.error.is_infinite());
        assert!(surface(&[0.0, 0.0]).angle([true, true]).unwrap_err().reason().contains("bare"));
    }

    #[test]
    fn the_surface_is_that_of_the_highest_spheres() {
        let grain = |along, across, height| Grain { along, across, height, radius: 0.5 };
        let grains = [
            grain(0.5, 0.5, 0.5),
            grain(0.5, 0.5, 1.5),
            grain(0.5, 2.5, 0.5),
            grain(3.0, 1.0, 0.5),
        ];
        let plate = Plate { length: 4.0, breadth: 4.0 };
        let found = Surface::of(&grains, plate, 2.0).unwrap();
        // First column: squares with tops 2 and 1; second: 1 and bare.
        assert_eq!(found.heights, [1.5, 0.5]);
        assert_eq!(found.place(1), 3.0);
        assert!(Surface::of(&grains, Plate { length: 0.0, ..plate }, 2.0).is_err());
    }
}
