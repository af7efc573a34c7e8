//! The neighbour list: how far it looks, when it is outdated, and how it is built.

use super::contact_history::ContactHistories;
use super::contacts::LostContact;
use super::proximity::{SetBits, close_partners};
use super::range::ListRange;
use super::{CellGrid, Contacts, Particles};
use crate::domain::{Bounds, PosedWalls, Wall, WallPose};
use crate::numbers::{F64x4, SimdKernel, with_simd};

/// What is needed to build the list, and to see when it is outdated. Disposable: a list that is built at another step
/// gives the same bits, because the pairs that act on each other are the same and force sums are exact.
#[derive(Clone, Debug, Default)]
pub struct NeighbourList {
    /// Largest possible displacement of a particle since the list was built.
    displacement: f64,
    /// Steps since.
    age: u64,
    /// Smallest displacement by which a particle can pass a face that particles leave through, or that ends the run.
    clearance: f64,
    reference_poses: Vec<WallPose>,
    cells: CellGrid,
}

impl NeighbourList {
    /// Adds a bound of the displacements of all particles of all ranks since the last call.
    pub fn moved(&mut self, displacement: f64) {
        self.displacement += displacement;
        self.age += 1;
    }

    /// Mean over the steps since the list was built of the largest displacement of a particle; none of a new list.
    pub fn displacement_in_a_step(&self) -> Option<f64> {
        (self.age > 0).then(|| self.displacement / self.age as f64)
    }

    /// Whether a particle may have moved more than half the skin since the list was built.
    pub fn outdated(&self, range: ListRange) -> bool {
        self.displacement >= 0.499 * range.skin
    }

    /// Measures how near the owned particles are to faces that they may pass.
    pub fn measure_clearance(&mut self, particles: &Particles, bounds: &Bounds) {
        let positions = particles.body.iter().map(|body| &body.position);
        let clearances = positions.map(|position| bounds.clearance(position));
        self.clearance = clearances.fold(f64::INFINITY, f64::min);
    }

    /// Whether an owned particle may have passed such a face, if none has moved farther than `displacement` since
    /// [`NeighbourList::moved`] was last called.
    pub fn may_have_passed(&self, displacement: f64) -> bool {
        let kept_clear = self.displacement + displacement < 0.999 * self.clearance;
        !kept_clear
    }

    /// Whether a wall has moved more than half the skin towards particles since the list was built.
    pub fn outdated_by_walls(&self, walls: PosedWalls<'_>, range: ListRange) -> bool {
        let moved = walls.iter().zip(&self.reference_poses);
        let displacement = |((wall, now), then): ((&Wall, &WallPose), &WallPose)| {
            wall.approach(&(now.displacement - then.displacement))
        };
        !moved.map(displacement).all(|displacement| displacement < 0.5 * range.skin)
    }

    /// Sorts the owned particles by cells, so that near particles are near in memory.
    pub fn sort_by_cells(&mut self, particles: &mut Particles, width: f64) {
        self.cells.fill(&particles.body, width);
        particles.select(self.cells.order());
    }

    /// Finds all pairs within the range of the list and gives them their contact histories back.
    ///
    /// Before: ghosts are those of the owned particles' current positions.
    ///
    /// # Errors
    /// If the history of a touching pair has no slot in the new list: a fault of the program.
    pub fn rebuild(
        &mut self,
        particles: &Particles,
        contacts: &mut Contacts,
        walls: PosedWalls<'_>,
        range: ListRange,
        histories: &ContactHistories,
    ) -> Result<(), LostContact> {
        (self.displacement, self.age) = (0.0, 0);
        self.reference_poses.clear();
        self.reference_poses.extend_from_slice(walls.poses);
        let largest = particles.body.iter().map(|body| body.radius).fold(0.0, f64::max);
        self.cells.fill(&particles.body, range.ghost_width(2.0 * largest));
        self.find_pairs(particles, contacts, range);
        contacts.find_wall_pairs(particles, walls, range);
        contacts.restore(particles, range.interaction, histories)
    }

    fn find_pairs(&self, particles: &Particles, contacts: &mut Contacts, range: ListRange) {
        contacts.clear_pairs(particles);
        with_simd(PairSearch { cells: &self.cells, particles, range, contacts });
    }
}

/// Searches the pairs of each owned particle among the particles in the cells around its own.
struct PairSearch<'a> {
    cells: &'a CellGrid,
    particles: &'a Particles,
    range: ListRange,
    contacts: &'a mut Contacts,
}

impl SimdKernel for PairSearch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(self) {
        let Self { cells, particles, range, contacts } = self;
        let separation = Q::splat(range.interaction + range.skin);
        let bodies = &particles.body[..];
        for i in 0..particles.owned_count() {
            // A pair of two owned particles, perhaps through an image, is in the row of the lower index only.
            let is_elsewhere = |partner: usize| {
                particles.owned_original(partner).is_some_and(|original| original <= i)
            };
            for members in cells.neighbourhood(i) {
                for partners in members.chunks(4) {
                    for k in SetBits(close_partners(&bodies[i], partners, bodies, separation)) {
                        if !is_elsewhere(partners[k] as usize) {
                            contacts.partner.push(partners[k]);
                        }
                    }
                }
            }
            contacts.row_start.push(contacts.partner.len() as u32);
        }
    }
}
