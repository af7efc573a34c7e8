//! The cells that particles are sorted into to find their neighbours.

use super::Body;
use nalgebra::Vector3;

/// A grid of cells over the particles' bounding box, each at least as wide as the range of the list.
///
/// The choice of cells changes the order of work, never a result.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellGrid {
    origin: Vector3<f64>,
    inverse_width: Vector3<f64>,
    counts: [usize; 3],
    /// Cell c holds `members[start[c]..start[c + 1]]`.
    start: Vec<u32>,
    members: Vec<u32>,
    cell_of: Vec<u32>,
}

/// Largest number of cells per particle: a few particles in a large box would need too much memory.
const CELLS_PER_PARTICLE: f64 = 4.0;

impl CellGrid {
    /// Sorts bodies into cells at least `width` wide.
    pub(crate) fn fill(&mut self, bodies: &[Body], width: f64) {
        self.lay_out(bodies, width);
        let cells = self.counts.iter().product::<usize>();
        self.cell_of.clear();
        self.cell_of.extend(bodies.iter().map(|body| {
            let [i, j, k] =
                cell_index(&body.position, self.origin, self.inverse_width, self.counts);
            (i + self.counts[0] * (j + self.counts[1] * k)) as u32
        }));
        self.start.clear();
        self.start.resize(cells + 1, 0);
        for &cell in &self.cell_of {
            self.start[cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            self.start[cell + 1] += self.start[cell];
        }
        self.members.clear();
        self.members.resize(bodies.len(), 0);
        let mut next = self.start.clone();
        for (index, &cell) in self.cell_of.iter().enumerate() {
            self.members[next[cell as usize] as usize] = index as u32;
            next[cell as usize] += 1;
        }
    }

    /// All particle indices, cell by cell.
    pub(crate) fn order(&self) -> &[u32] {
        &self.members
    }

    /// The particles of each row of cells along x, in the cells around that of particle `index`, its own included.
    #[inline(always)]
    pub(crate) fn neighbourhood(&self, index: usize) -> impl Iterator<Item = &[u32]> {
        let cell = self.cell_of[index] as usize;
        let [nx, ny, nz] = self.counts;
        let (i, j, k) = (cell % nx, (cell / nx) % ny, cell / (nx * ny));
        let around = |cell: usize, count: usize| cell.saturating_sub(1)..(cell + 2).min(count);
        let along_x = around(i, nx);
        around(k, nz).flat_map(move |kk| around(j, ny).map(move |jj| nx * (jj + ny * kk))).map(
            move |row| {
                let from = self.start[row + along_x.start] as usize;
                let to = self.start[row + along_x.end] as usize;
                &self.members[from..to]
            },
        )
    }

    fn lay_out(&mut self, bodies: &[Body], width: f64) {
        let infinite = Vector3::repeat(f64::INFINITY);
        let lower = bodies.iter().fold(infinite, |lower, body| lower.inf(&body.position));
        let upper = bodies.iter().fold(-infinite, |upper, body| upper.sup(&body.position));
        let extent = if bodies.is_empty() { Vector3::zeros() } else { upper - lower };
        self.origin = if bodies.is_empty() { Vector3::zeros() } else { lower };
        let mut width = width;
        let most = CELLS_PER_PARTICLE * bodies.len() as f64 + 27.0;
        let cells = |width: f64| extent.map(|length| (length / width).floor().max(1.0));
        while cells(width).product() > most {
            width *= 1.25;
        }
        let counts = cells(width);
        self.counts = [counts.x as usize, counts.y as usize, counts.z as usize];
        self.inverse_width = extent
            .zip_map(&counts, |length, count| if length > 0.0 { count / length } else { 0.0 });
    }
}

fn cell_index(
    position: &Vector3<f64>,
    origin: Vector3<f64>,
    inverse_width: Vector3<f64>,
    counts: [usize; 3],
) -> [usize; 3] {
    std::array::from_fn(|axis| {
        let cell = (position[axis] - origin[axis]) * inverse_width[axis];
        (cell as usize).min(counts[axis] - 1)
    })
}
