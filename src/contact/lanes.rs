//! Near pairs evaluated side by side: gathered into lanes, run through the law, scattered.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it
//! into vector instructions. Every operation is an IEEE one, rounded once, so the width of the vectors
//! changes no bit.

use super::block::{Block, Lanes, ManySizes, OneSize, Sizes, overlap_and_normal, vector};
use super::forces::{ForceLaws, ForceOutOfRange, out_of_range};
use super::rolling::{NoRolling, Rolling};
use super::van_der_waals::{Attraction, Full, NearContact};
use super::{CohesionExpression, Contact, ContactForceLaw, ContactLaw};
use crate::numbers::{F64x4, SimdKernel, fetch_ahead, first_flagged, within};
use crate::particles::{
    AngleLanes, ContactHistory, HISTORY_FIELDS, HistoryLanes, LANES, NearPairs, PairBlock,
    PairBlocks, Particles,
};
use nalgebra::Vector3;

/// With more bytes of pairs than this, little of them is in a cache of the processor's core from one step to the next.
const CACHED: usize = 1 << 22;

/// Bodies and pairs, and what acts between them.
pub(super) struct PairWork<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) near: &'a mut NearPairs,
    pub(super) laws: &'a ForceLaws<'a>,
}

impl SimdKernel for PairWork<'_> {
    type Output = Result<(), ForceOutOfRange>;

    /// Chooses the law once, for all pairs.
    #[inline(always)]
    fn run<Q: F64x4>(self) -> Self::Output {
        match &self.laws.contact.law {
            ContactLaw::LinearSpringDashpot(law) => self.with_rolling::<Q, _>(law),
            ContactLaw::AdhesiveElasticPlastic(law) => self.with_rolling::<Q, _>(law),
            ContactLaw::HertzMindlin(law) => self.with_rolling::<Q, _>(law),
            ContactLaw::Jkr(law) => self.with_rolling::<Q, _>(law),
            ContactLaw::LinearHysteretic(law) => self.with_rolling::<Q, _>(law),
        }
    }
}

impl PairWork<'_> {
    /// Chooses rolling and, without it, whether all particles are alike.
    #[inline(always)]
    fn with_rolling<Q: F64x4, L: ContactForceLaw>(self, law: &L) -> Result<(), ForceOutOfRange> {
        match (self.laws.contact.rolling, self.near.one_size) {
            (Some(rolling), _) => self.evaluate::<Q, _, _, _>((law, rolling), ManySizes::default()),
            (None, None) => self.evaluate::<Q, _, _, _>((law, NoRolling), ManySizes::default()),
            (None, Some([radius, mass])) => {
                self.evaluate::<Q, _, _, _>((law, NoRolling), OneSize { radius, mass })
            }
        }
    }

    #[inline(always)]
    fn evaluate<Q: F64x4, L: ContactForceLaw, R: Rolling, S: Sizes>(
        self,
        law: (&L, R),
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, near, laws } = self;
        let mut block = Block::default();
        let mut no_angles = [[0.0; LANES]; 3];
        let count = near.acting.count();
        let from_memory = size_of_val(&near.acting.blocks[..]) > CACHED;
        let PairBlocks { blocks, rolling_angle, .. } = &mut near.acting;
        for index in 0..blocks.len() {
            let (done, coming) = blocks.split_at_mut(index + 1);
            let pairs = &mut done[index];
            let ends = [&pairs.first, &pairs.second];
            block.gather::<Q, S>(&mut sizes, ends, &particles.body, R::ACTS);
            if from_memory {
                fetch_particles(coming.first(), particles);
                coming.get(1).into_iter().for_each(fetch_ahead);
            }
            approach(&mut block, &sizes);
            attract(&mut block, &sizes, laws);
            let angles = rolling_angle.get_mut(index).unwrap_or(&mut no_angles);
            run(law, &sizes, laws, &mut block, (&mut pairs.history, angles));
            add_up::<R, S>(&mut block, &sizes, laws);
            block.note_touching(&mut pairs.touching);
            if let Some(lane) = first_flagged(&block.out_of_range) {
                let force = Vector3::from_fn(|axis, _| block.force_on_j[axis][lane]);
                let [i, j] = ends.map(|of| particles.id[of[lane] as usize]);
                let (other, overlap) = (format!("particle {j}"), block.overlap[lane]);
                return Err(out_of_range(i, other, force, overlap, laws.limit));
            }
            let used = PairBlock::used(index, count);
            let targets = [ends[0], &pairs.target];
            block.scatter::<Q, S>(targets, used, &mut particles.forces);
        }
        Ok(())
    }
}

/// Asks for the particles of the block that comes next: while the processor computes, memory would else wait, and
/// then the processor.
#[inline(always)]
fn fetch_particles(next: Option<&PairBlock>, particles: &Particles) {
    let Some(pairs) = next else { return };
    for index in pairs.first.into_iter().chain(pairs.second) {
        fetch_ahead(&particles.body[index as usize]);
        fetch_ahead(&particles.forces[index as usize]);
    }
}

/// How the surfaces of the pairs meet. A loop of its own: a processor sees only so far ahead, and here it sees
/// several square roots at once.
#[inline(always)]
fn approach<S: Sizes>(block: &mut Block, sizes: &S) {
    for lane in 0..LANES {
        let (overlap, normal) = overlap_and_normal(vector(&block.branch, lane), sizes.radii(lane));
        let velocity = vector(&block.relative_velocity, lane)
            - vector(&block.surface_spin, lane).cross(&normal);
        block.overlap[lane] = overlap;
        for axis in 0..3 {
            block.normal[axis][lane] = normal[axis];
            block.relative_velocity[axis][lane] = velocity[axis];
        }
    }
}

/// Attraction of the pairs, if there is any.
#[inline(always)]
fn attract<S: Sizes>(block: &mut Block, sizes: &S, laws: &ForceLaws) {
    let Some(cohesion) = laws.cohesion else { return };
    match cohesion.expression() {
        CohesionExpression::NearContact => attract_by(NearContact(cohesion), block, sizes),
        CohesionExpression::Full => attract_by(Full(cohesion), block, sizes),
    }
}

#[inline(always)]
fn attract_by<A: Attraction, S: Sizes>(attraction: A, block: &mut Block, sizes: &S) {
    // Nearly all pairs of a dense bed touch; nearer than the cut-off the attraction of equal pairs is one number.
    if S::EQUAL && none_beyond(attraction.cut_off(), &block.overlap) {
        let [radius_i, radius_j] = sizes.radii(0);
        block.cohesion = [attraction.between(radius_i, radius_j, 0.0); LANES];
        return;
    }
    for lane in 0..LANES {
        let [radius_i, radius_j] = sizes.radii(lane);
        block.cohesion[lane] = attraction.between(radius_i, radius_j, -block.overlap[lane]);
    }
}

/// Whether no separation exceeds a limit.
#[inline(always)]
fn none_beyond(limit: f64, overlap: &Lanes) -> bool {
    let mut beyond = 0;
    for overlap in overlap {
        beyond |= u64::from(-overlap > limit);
    }
    beyond == 0
}

/// All lanes, those that only fill up the last block too: what they give is not used.
#[inline(always)]
fn run<L: ContactForceLaw, R: Rolling, S: Sizes>(
    (law, rolling): (&L, R),
    sizes: &S,
    laws: &ForceLaws,
    block: &mut Block,
    (histories, angles): (&mut HistoryLanes, &mut AngleLanes),
) {
    for lane in 0..LANES {
        let contact = contact_of(block, sizes, lane);
        let mut numbers = [0.0; HISTORY_FIELDS];
        for (number, field) in numbers.iter_mut().zip(&*histories) {
            *number = field[lane];
        }
        let mut history: ContactHistory = bytemuck::cast(numbers);
        let touches = law.touches(&contact, &history);
        let force = law.force(&contact, &mut history, laws.dt);
        // Apart, the law has nothing to say, whatever it gave.
        let if_touching = |value: f64| if touches { value } else { 0.0 };
        block.normal_force[lane] = if_touching(force.normal);
        for axis in 0..3 {
            block.tangential_force[axis][lane] = if_touching(force.tangential[axis]);
        }
        if R::ACTS {
            let mut angle = vector(angles, lane);
            let stiffness = law.stiffness_over(&contact, laws.dt);
            let torque =
                rolling.torque(&contact, force.friction_normal, stiffness, &mut angle, laws.dt);
            for axis in 0..3 {
                block.rolling_torque[axis][lane] = if_touching(torque[axis]);
                angles[axis][lane] = if_touching(angle[axis]);
            }
        }
        let numbers: [f64; HISTORY_FIELDS] = bytemuck::cast(history);
        for (number, field) in numbers.into_iter().zip(&mut *histories) {
            field[lane] = if_touching(number);
        }
        block.touching[lane] = u64::from(touches);
    }
}

/// Forces and torques of the pairs, each rounded to its lattice.
#[inline(always)]
fn add_up<R: Rolling, S: Sizes>(block: &mut Block, sizes: &S, laws: &ForceLaws) {
    for lane in 0..LANES {
        let [radius_i, radius_j] = sizes.radii(lane);
        let normal = vector(&block.normal, lane);
        let tangential = vector(&block.tangential_force, lane);
        let along = block.normal_force[lane] - block.cohesion[lane];
        let on_j = laws.force_quantum.round_vector(normal * along + tangential);
        let twist = normal.cross(&tangential);
        let mut twists = [twist * radius_i, twist * radius_j];
        if R::ACTS {
            let torque = vector(&block.rolling_torque, lane);
            twists = [twists[0] + torque, twists[1] - torque];
        }
        for axis in 0..3 {
            block.force_on_j[axis][lane] = on_j[axis];
            block.torque_off_i[axis][lane] = laws.torque_quantum.round(twists[0][axis]);
            if !S::EQUAL {
                block.torque_off_j[axis][lane] = laws.torque_quantum.round(twists[1][axis]);
            }
        }
        block.out_of_range[lane] = u64::from(!within(&on_j, laws.limit));
    }
}

#[inline(always)]
fn contact_of<S: Sizes>(block: &Block, sizes: &S, lane: usize) -> Contact {
    let ([radius_i, radius_j], [mass_i, mass_j]) = (sizes.radii(lane), sizes.masses(lane));
    Contact {
        overlap: block.overlap[lane],
        normal: vector(&block.normal, lane),
        relative_velocity: vector(&block.relative_velocity, lane),
        relative_spin: vector(&block.relative_spin, lane),
        reduced_mass: mass_i * mass_j / (mass_i + mass_j),
        reduced_radius: radius_i * radius_j / (radius_i + radius_j),
        reduced_inertia: reduced_inertia([radius_i, radius_j], [mass_i, mass_j]),
        cohesion: block.cohesion[lane],
    }
}

/// I* of two solid spheres.
#[inline(always)]
fn reduced_inertia(radius: [f64; 2], mass: [f64; 2]) -> f64 {
    let one = 0.4 * mass[0] * radius[0] * radius[0];
    let other = 0.4 * mass[1] * radius[1] * radius[1];
    one * other / (one + other)
}
