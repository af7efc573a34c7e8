//! Spheres sorted by cell, to find overlaps in a time proportional to their number.

use super::Sphere;
use nalgebra::Vector3;
use talcum_engine::domain::Bounds;

/// Marks the absence of a sphere.
const NONE: u32 = u32::MAX;

/// Spheres in cells at least as wide as the largest one; those outside the box belong to its outer cells.
pub(super) struct Cells<'a> {
    bounds: &'a Bounds,
    counts: [usize; 3],
    first: Vec<u32>,
    next: Vec<u32>,
}

impl<'a> Cells<'a> {
    /// Empty cells for about this number of spheres up to a diameter.
    pub(super) fn new(bounds: &'a Bounds, largest: f64, spheres: usize) -> Self {
        let mut counts = [0, 1, 2]
            .map(|axis| (bounds.lengths()[axis] / largest).floor().clamp(1.0, 1.0e6) as usize);
        // There should not be many more cells than spheres.
        while counts.iter().product::<usize>() > 8 * spheres + 1000 {
            let longest = counts.iter().copied().max().unwrap_or(1);
            counts = counts.map(|count| if count == longest { count.div_ceil(2) } else { count });
        }
        Self { bounds, counts, first: vec![NONE; counts.iter().product()], next: Vec::new() }
    }

    /// Adds the sphere of the next number, from 0.
    pub(super) fn push(&mut self, position: [f64; 3]) {
        let cell = self.number_of(self.cell_of(position));
        self.next.push(self.first[cell]);
        self.first[cell] = (self.next.len() - 1) as u32;
    }

    /// The first pair found of this sphere and one in the cells that overlap by more than a fraction of the smaller
    /// diameter: number of the other, and overlap over that diameter.
    pub(super) fn overlap(
        &self,
        spheres: &[Sphere],
        sphere: &Sphere,
        allowed: f64,
    ) -> Option<(usize, f64)> {
        let centre = self.cell_of(sphere.position);
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.neighbours(axis, centre[axis]));
        for z in zs.into_iter().flatten() {
            for y in ys.into_iter().flatten() {
                for x in xs.into_iter().flatten() {
                    let mut other = self.first[self.number_of([x, y, z])];
                    while other != NONE {
                        let overlap = self.relative_overlap(sphere, &spheres[other as usize]);
                        if overlap > allowed {
                            return Some((other as usize, overlap));
                        }
                        other = self.next[other as usize];
                    }
                }
            }
        }
        None
    }

    /// Overlap of two spheres, also through periodic faces, over the smaller diameter.
    fn relative_overlap(&self, first: &Sphere, second: &Sphere) -> f64 {
        let mut distance = Vector3::from(first.position) - Vector3::from(second.position);
        for axis in 0..3 {
            if self.bounds.is_periodic(axis) {
                let length = self.bounds.lengths()[axis];
                distance[axis] -= length * (distance[axis] / length).round();
            }
        }
        let contact = first.radius + second.radius;
        (contact - distance.norm()) / first.diameter().min(second.diameter())
    }

    fn cell_of(&self, position: [f64; 3]) -> [usize; 3] {
        let inside = self.bounds.wrap(position.into());
        [0, 1, 2].map(|axis| {
            let part = inside[axis] / self.bounds.lengths()[axis];
            ((part * self.counts[axis] as f64).max(0.0) as usize).min(self.counts[axis] - 1)
        })
    }

    fn number_of(&self, cell: [usize; 3]) -> usize {
        cell[0] + self.counts[0] * (cell[1] + self.counts[1] * cell[2])
    }

    /// A cell along an axis, which comes first since it contains most overlaps, and its neighbours, each once.
    fn neighbours(&self, axis: usize, cell: usize) -> [Option<usize>; 3] {
        let count = self.counts[axis];
        let periodic = self.bounds.is_periodic(axis);
        let below = match cell {
            0 if periodic && count > 1 => Some(count - 1),
            0 => None,
            cell => Some(cell - 1),
        };
        let above = match cell + 1 {
            next if next < count => Some(next),
            _ if periodic && count > 1 => Some(0),
            _ => None,
        };
        [Some(cell), below, above.filter(|_| above != below)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use talcum_engine::domain::Face;

    proptest! {
        #[test]
        fn overlaps_are_those_of_all_pairs(
            centres in prop::collection::vec(prop::array::uniform3(0.0..1.0f64), 2..40),
            lengths in prop::array::uniform3(2.0..7.0f64),
            periodic in prop::array::uniform3(any::<bool>()),
        ) {
            let faces = periodic.map(|is| [if is { Face::Periodic } else { Face::Wall }; 2]);
            let bounds = Bounds::new(Vector3::from(lengths), faces);
            let spheres: Vec<Sphere> = centres.iter().enumerate().map(|(id, centre)| Sphere {
                position: Vector3::from(*centre).component_mul(&bounds.lengths()).into(),
                velocity: [0.0; 3],
                radius: if id % 2 == 0 { 0.5 } else { 0.3 },
                density: 1.0,
            }).collect();
            let mut cells = Cells::new(&bounds, 1.0, spheres.len());
            for (number, sphere) in spheres.iter().enumerate() {
                let all = spheres[..number].iter()
                    .any(|other| cells.relative_overlap(sphere, other) > 0.1);
                prop_assert_eq!(cells.overlap(&spheres, sphere, 0.1).is_some(), all);
                cells.push(sphere.position);
            }
        }
    }
}
