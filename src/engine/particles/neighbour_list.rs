//! The neighbour list: its range, its validity, and its construction.

use super::cell_grid::Neighbourhood;
use super::contact_state::ContactHistories;
use super::contacts::LostContact;
use super::proximity::{FourPairs, push_set_bits};
use super::range::ListRange;
use super::{CellGrid, Contacts, Particles};
use crate::domain::{Bounds, PosedWalls, Wall, WallPose};
use crate::numbers::{F64x4, vectorised};
use std::ops::Range;

/// Data for building the list and for checking whether it is outdated. It is not part of the state of a run: a list
/// that is built at another step gives the same bits, because the pairs that act on each other are the same and force
/// sums are exact.
#[derive(Clone, Debug, Default)]
pub struct NeighbourList {
    /// Largest possible displacement of a particle since the list was built.
    displacement: f64,
    /// Steps since the list was built.
    age: u64,
    /// Smallest displacement by which a particle can pass a face at which particles leave, or which ends the run.
    clearance: f64,
    reference_poses: Vec<WallPose>,
    cells: CellGrid,
}

impl NeighbourList {
    /// Adds an upper bound of the displacements of all particles of all ranks since the last call.
    pub fn moved(&mut self, displacement: f64) {
        self.displacement += displacement;
        self.age += 1;
    }

    /// Largest displacement of a particle in a step, averaged over the steps since the list was built; `None` for a new
    /// list.
    pub fn displacement_in_a_step(&self) -> Option<f64> {
        (self.age > 0).then(|| self.displacement / self.age as f64)
    }

    /// Whether a particle may have moved more than half the skin since the list was built.
    pub fn outdated(&self, range: ListRange) -> bool {
        self.displacement >= 0.499 * range.skin
    }

    /// Measures the distance of the owned particles from faces that they may pass. Before: they have been sorted by
    /// cells, and no list has been made since.
    pub fn measure_clearance(&mut self, bounds: &Bounds) {
        self.clearance = bounds.clearance(self.cells.corners());
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
        let displacement =
            |((wall, now), then): ((&Wall, &WallPose), &WallPose)| wall.approach(then, now);
        !moved.map(displacement).all(|displacement| displacement < 0.5 * range.skin)
    }

    /// Sorts the owned particles by cells, so that particles that are near each other are also near in memory.
    pub fn sort_by_cells(&mut self, particles: &mut Particles, width: f64) {
        self.cells.fill(&particles.body, width);
        particles.select(self.cells.order());
    }

    /// Finds all pairs within the range of the list and restores their contact histories.
    ///
    /// Before: the owned particles have not moved since they were last sorted by cells, which are at least as wide as
    /// the range of the list; ghosts are those of these positions.
    ///
    /// # Errors
    /// If the history of a touching pair has no slot in the new list: an error of the program.
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
        // Lists live long, so the cells return their memory.
        find_pairs(std::mem::take(&mut self.cells), particles, contacts, range);
        contacts.find_wall_pairs(particles, walls, range);
        contacts.restore(particles, range.interaction, histories)
    }
}

/// Lists the pairs of particles that have been sorted into these cells.
fn find_pairs(
    mut cells: CellGrid,
    particles: &Particles,
    contacts: &mut Contacts,
    range: ListRange,
) {
    cells.add_ghosts(&particles.body[particles.owned_count()..]);
    contacts.clear_pairs(particles);
    add_rows(&cells, particles, range, contacts);
}

vectorised!(
    /// Adds the row of each owned particle: its partners among the particles in the cells around its own. A pair of two
    /// owned particles is only in the row of the lower index: in the order of the cells the other is in the same cell
    /// or in one behind. Ghosts are ahead of this rank's subdomain, so that a pair with one of them is in no other row,
    /// of this rank or another.
    fn add_rows<Q: F64x4>(
        cells: &CellGrid,
        particles: &Particles,
        range: ListRange,
        contacts: &mut Contacts,
    ) {
        let separation = Q::splat(range.interaction + range.skin);
        for Neighbourhood { own, own_end, behind, ghosts } in cells.neighbourhoods() {
            for i in own {
                let mut row = Row { particles, i, separation, partners: &mut contacts.partner };
                row.add_owned(i + 1..own_end);
                for others in &behind {
                    row.add_owned(others.clone());
                }
                for others in ghosts {
                    row.add_ghosts(others);
                }
                contacts.row_start.push(contacts.partner.len() as u32);
            }
        }
    }
);

/// The partners of one particle.
struct Row<'a, Q> {
    particles: &'a Particles,
    i: usize,
    separation: Q,
    partners: &'a mut Vec<u32>,
}

impl<Q: F64x4> Row<'_, Q> {
    /// Adds the near ones among these owned particles.
    #[inline(always)]
    fn add_owned(&mut self, others: Range<usize>) {
        let Self { particles, i, separation, .. } = *self;
        for from in others.clone().step_by(4) {
            let four = &particles.body[from..others.end.min(from + 4)];
            let close = FourPairs::of_bodies(&particles.body[i], four).closer_than(separation);
            push_set_bits(self.partners, close, |bit| from as u32 + bit);
        }
    }

    /// Adds the near ones among these ghosts.
    #[inline(always)]
    fn add_ghosts(&mut self, others: &[u32]) {
        let Self { particles, i, separation, .. } = *self;
        let owned = particles.owned_count();
        let ghosts = &particles.body[owned..];
        for four in others.chunks(4) {
            let pairs = FourPairs::of_partners(&particles.body[i], four, ghosts);
            let close = pairs.closer_than(separation);
            push_set_bits(self.partners, close, |bit| owned as u32 + four[bit as usize]);
        }
    }
}
