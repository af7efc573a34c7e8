//! The neighbour list: who is near whom, and when that must be found anew.

use super::closeness::{Places, near_partners};
use super::contacts::{ContactHistories, LostContact};
use super::{CellGrid, Contacts, Particles};
use crate::domain::{Bounds, PosedWalls, Wall, WallPose};
use crate::numbers::{F64x4, SimdKernel, with_simd};

/// How far the list looks beyond touching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Separation of surfaces up to which particles act on each other.
    pub range: f64,
    /// Margin that lets the list live for many steps.
    pub skin: f64,
}

impl Reach {
    /// Largest distance of two centres in the list; ghosts must reach as far.
    pub fn ghost_width(&self, largest_diameter: f64) -> f64 {
        largest_diameter + self.range + self.skin
    }
}

/// When the list was built, and the cells it is built with. Disposable: a list built at another step
/// gives the same bits, because the pairs that act are the same and force sums are exact.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// How far a particle may have moved since.
    displacement: f64,
    /// How far it must move to pass a face that particles leave through, or that ends the run.
    clearance: f64,
    reference_poses: Vec<WallPose>,
    cells: CellGrid,
}

impl Neighbours {
    /// Takes note that no particle of any rank has moved farther than this since the last time.
    pub fn moved(&mut self, displacement: f64) {
        self.displacement += displacement;
    }

    /// Whether a particle may have moved more than half the skin since the list was built.
    pub fn outdated(&self, reach: Reach) -> bool {
        self.displacement >= 0.499 * reach.skin
    }

    /// Takes note of how near the owned particles are to faces that they may pass.
    pub fn note_faces(&mut self, particles: &Particles, bounds: &Bounds) {
        let positions = particles.body.iter().map(|body| &body.position);
        let clearances = positions.map(|position| bounds.clearance(position));
        self.clearance = clearances.fold(f64::INFINITY, f64::min);
    }

    /// Whether an owned particle may have passed such a face, if none has moved farther than `displacement` since
    /// [`Neighbours::moved`] was last called.
    pub fn may_have_passed(&self, displacement: f64) -> bool {
        let kept_clear = self.displacement + displacement < 0.999 * self.clearance;
        !kept_clear
    }

    /// Whether a wall has moved more than half the skin towards particles since the list was built.
    pub fn outdated_by_walls(&self, walls: PosedWalls<'_>, reach: Reach) -> bool {
        let moved = walls.iter().zip(&self.reference_poses);
        let displacement = |((wall, now), then): ((&Wall, &WallPose), &WallPose)| {
            wall.approach(&(now.displacement - then.displacement))
        };
        !moved.map(displacement).all(|displacement| displacement < 0.5 * reach.skin)
    }

    /// Sorts the owned particles by cells, so that near particles are near in memory.
    pub fn sort_by_cells(&mut self, particles: &mut Particles, width: f64) {
        self.cells.fill(&particles.body, width);
        particles.select(self.cells.order());
    }

    /// Finds all near pairs and gives them back their contact histories.
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
        reach: Reach,
        histories: &ContactHistories,
    ) -> Result<(), LostContact> {
        self.displacement = 0.0;
        self.reference_poses.clear();
        self.reference_poses.extend_from_slice(walls.poses);
        let largest = particles.body.iter().map(|body| body.radius).fold(0.0, f64::max);
        self.cells.fill(&particles.body, reach.ghost_width(2.0 * largest));
        self.find_pairs(particles, contacts, reach);
        contacts.find_wall_pairs(particles, walls, reach);
        contacts.recall(particles, histories)
    }

    fn find_pairs(&self, particles: &Particles, contacts: &mut Contacts, reach: Reach) {
        contacts.clear_pairs();
        with_simd(PairSearch { cells: &self.cells, particles, reach, contacts });
    }
}

/// Looks for the pairs of each owned particle among the particles of the cells around its own.
struct PairSearch<'a> {
    cells: &'a CellGrid,
    particles: &'a Particles,
    reach: Reach,
    contacts: &'a mut Contacts,
}

impl SimdKernel for PairSearch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(self) {
        let Self { cells, particles, reach, contacts } = self;
        let margin = Q::splat(reach.range + reach.skin);
        let bodies = &particles.body[..];
        for i in 0..particles.owned_count() {
            // Both owned here, perhaps as an image: in the row of the lower index only.
            let is_elsewhere = |partner: usize| {
                particles.owned_original(partner).is_some_and(|original| original <= i)
            };
            for members in cells.neighbourhood(i) {
                for partners in members.chunks(4) {
                    for place in Places(near_partners(&bodies[i], partners, bodies, margin)) {
                        if !is_elsewhere(partners[place] as usize) {
                            contacts.partner.push(partners[place]);
                        }
                    }
                }
            }
            contacts.row_start.push(contacts.partner.len() as u32);
        }
    }
}
