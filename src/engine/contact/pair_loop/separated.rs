//! The loop over separated pairs that attract each other, which needs only a small part of the data of a contact.

use crate::contact::force_laws::{ForceOutOfRange, PairLaws, out_of_range};
use crate::contact::lanes::{
    ExcessForce, FourVectors, ManySizes, OneSize, SizesOfPairs, overlaps_and_normals,
    require_within,
};
use crate::contact::van_der_waals::{Attraction, Full, NearContact, Rough};
use crate::contact::{CohesionExpression, VanDerWaalsNow};
use crate::numbers::{F64x4, fetch_ahead, first_flagged, four, four_mut, vectorised};
use crate::particles::{Candidates, ForceTorque, LANES, Lanes, Pair, PairsOfKind, Particles};

/// Candidate pairs, and the attraction between them.
pub(super) struct SeparatedPairs<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) pairs: &'a mut PairsOfKind,
    /// Radius and mass, if they are the same for all particles.
    pub(super) one_size: Option<[f64; 2]>,
    pub(super) reach: SeparatedReach,
    pub(super) laws: PairLaws<'a>,
}

/// The attraction between separated surfaces, with its ranges.
#[derive(Clone, Copy)]
pub(super) struct SeparatedReach {
    pub(super) cohesion: VanDerWaalsNow,
    /// Separation of surfaces below which a pair is left to the loop over contacts.
    pub(super) contact_range: f64,
}

vectorised!(
    /// Adds the attraction of the candidate pairs to the forces on their particles, as the loop over contacts would.
    /// Finds the pairs that have come within the range of contacts, and leaves them to that loop.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub(super) fn attract_candidates<Q: F64x4>(
        candidates: SeparatedPairs,
    ) -> Result<(), ForceOutOfRange> {
        let cohesion = candidates.reach.cohesion;
        match cohesion.expression() {
            CohesionExpression::NearContact => candidates.with_sizes::<Q, _>(NearContact(cohesion)),
            CohesionExpression::Full => candidates.with_sizes::<Q, _>(Full(cohesion)),
            CohesionExpression::Rough { asperity_radius } => {
                let smooth = NearContact(cohesion);
                candidates.with_sizes::<Q, _>(Rough { smooth, asperity_radius })
            }
        }
    }
);

impl SeparatedPairs<'_> {
    #[inline(always)]
    fn with_sizes<Q: F64x4, A: Attraction>(self, attraction: A) -> Result<(), ForceOutOfRange> {
        match self.one_size {
            Some(size) => self.evaluate::<Q, _, _>(attraction, OneSize::new(size)),
            None => self.evaluate::<Q, _, _>(attraction, ManySizes::default()),
        }
    }

    #[inline(always)]
    fn evaluate<Q: F64x4, A: Attraction, S: SizesOfPairs>(
        self,
        attraction: A,
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, pairs, reach: SeparatedReach { contact_range, .. }, laws, .. } = self;
        let Candidates { pairs, to_promote } = pairs.candidates();
        let fetches = particles.exceed_caches();
        let mut block = SeparatedBlock::default();
        for (number, present) in pairs.chunks(LANES).enumerate() {
            let coming = pairs.get((number + 1) * LANES..).filter(|_| fetches).unwrap_or_default();
            block.gather::<Q, S>(&mut sizes, (present, coming), particles);
            block.attract(attraction, contact_range, &sizes);
            block.collect_in_contact_range(number, present.len(), to_promote);
            let added = block.scatter::<Q>((present, coming), &mut particles.forces, &laws);
            if let Err(ExcessForce { lane, force_on_j }) = added {
                let [i, j] = [0, 1].map(|side| particles.id[present[lane][side] as usize]);
                let (other, overlap) = (format!("particle {j}"), block.overlap[lane]);
                return Err(out_of_range(i, other, force_on_j, overlap, laws.limit));
            }
        }
        Ok(())
    }
}

/// A block of separated pairs. Lanes beyond the last pair repeat it.
#[derive(Default)]
#[repr(align(64))] // see `Lanes`
struct SeparatedBlock {
    overlap: Lanes,
    normal: [Lanes; 3],
    pull: Lanes,
    /// 1 where the pair is within the range of contacts.
    in_contact_range: [u64; LANES],
}

impl SeparatedBlock {
    /// Gathers overlaps and normals of pairs, and prefetches bodies of later ones.
    #[inline(always)]
    fn gather<Q: F64x4, S: SizesOfPairs>(
        &mut self,
        sizes: &mut S,
        (pairs, coming): (&[Pair], &[Pair]),
        particles: &Particles,
    ) {
        let mut branch_vector = [Q::splat(0.0); 4];
        for from in (0..LANES).step_by(4) {
            for (row, of_pair) in branch_vector.iter_mut().enumerate() {
                let lane = from + row;
                if let Some(&[_, other, _]) = coming.get(lane) {
                    fetch_ahead(&particles.body, other as usize);
                }
                let [i, j, _] = pairs[lane.min(pairs.len() - 1)];
                let (i, j) = (&particles.body[i as usize], &particles.body[j as usize]);
                sizes.gather(lane, [i, j]);
                *of_pair = Q::load(&j.vectors()[0]).minus(Q::load(&i.vectors()[0]));
            }
            let (overlap, normal) =
                overlaps_and_normals(FourVectors::of_rows(branch_vector), sizes.four_radii(from));
            overlap.store(four_mut(&mut self.overlap, from));
            normal.store(&mut self.normal, from);
        }
    }

    #[inline(always)]
    fn attract<A: Attraction, S: SizesOfPairs>(
        &mut self,
        attraction: A,
        contact_range: f64,
        sizes: &S,
    ) {
        for lane in 0..LANES {
            let ([radius_i, radius_j], overlap) = (sizes.radii(lane), self.overlap[lane]);
            let in_contact_range = overlap > -contact_range;
            let pull = attraction.between(radius_i, radius_j, -overlap);
            self.pull[lane] = if in_contact_range { 0.0 } else { pull };
            self.in_contact_range[lane] = u64::from(in_contact_range);
        }
    }

    /// Collects the numbers of the pairs, among the first `used`, that are within the range of contacts.
    #[inline(always)]
    fn collect_in_contact_range(&self, number: usize, used: usize, to_promote: &mut Vec<u32>) {
        if let Some(first) = first_flagged(&self.in_contact_range) {
            let lanes = (first..used).filter(|&lane| self.in_contact_range[lane] != 0);
            to_promote.extend(lanes.map(|lane| (number * LANES + lane) as u32));
        }
    }

    /// Adds the forces of pairs, rounded, and prefetches those of later ones.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[inline(always)]
    fn scatter<Q: F64x4>(
        &self,
        (pairs, coming): (&[Pair], &[Pair]),
        forces: &mut [ForceTorque],
        laws: &PairLaws,
    ) -> Result<(), ExcessForce> {
        for (pairs, from) in pairs.chunks(4).zip((0..LANES).step_by(4)) {
            let towards_i = Q::splat(0.0).minus(Q::load(four(&self.pull, from)));
            let normal = FourVectors::load(&self.normal, from);
            let force_on_j = normal.times(towards_i).rounded(laws.force_quantum);
            require_within(force_on_j, laws.limit, from)?;
            let force = force_on_j.rows();
            for (row, &[i, _, target]) in pairs.iter().enumerate() {
                if let Some(&[_, _, target]) = coming.get(from + row) {
                    fetch_ahead(forces, target as usize);
                }
                let [force_i, _torque] = forces[i as usize].vectors_mut();
                Q::load(force_i).minus(force[row]).store(force_i);
                let [force_j, _torque] = forces[target as usize].vectors_mut();
                Q::load(force_j).plus(force[row]).store(force_j);
            }
        }
        Ok(())
    }
}
