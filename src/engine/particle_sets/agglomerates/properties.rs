//! Mass, position, motion, size and coordination of agglomerates.

use super::{Counts, ParticleSample};
use crate::parallel::Communicator;
use crate::particle_sets::components::ConnectedSets;
use crate::particle_sets::exact_sums::Keyed;
use crate::particle_sets::fixed_point::{FixedPointSums, Quanta, largest, sums_by_key};
use crate::particle_sets::periodicity::Periodicity;
use crate::particle_sets::rendezvous::ask;
use crate::particles::sphere_volume;
use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Number of sums over the members of an agglomerate that are computed first.
const MOMENTS: usize = 18;

/// Properties of one agglomerate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Agglomerate {
    /// The smallest id of its members.
    pub label: u64,
    /// n, number of members.
    pub members: u64,
    /// m_agg, their mass.
    pub mass: f64,
    /// Their volume, sum of 4/3 pi r^3.
    pub volume: f64,
    /// Centre of mass, inside the box. Along an axis along which the agglomerate winds around a periodic box, it is the
    /// mean angle on a circle (Bai & Breen 2008, doi:10.1080/2151237X.2008.10129266).
    pub centre: Vector3<f64>,
    /// Velocity of the centre of mass.
    pub velocity: Vector3<f64>,
    /// R_agg, the radius of gyration: m_agg R_agg^2 = sum m_a l_a^2, where l_a is the distance of a member's centre
    /// from the centre of mass. Zero for a single particle.
    pub radius_of_gyration: f64,
    /// Whether it winds around the box, by axis: 1 or 0. Its size along such an axis is that of the box.
    pub winds: [u64; 3],
    /// Sum over members of their kept contacts: twice the number of these.
    pub bonds: u64,
    /// Sum over members of the number of members that they touch.
    pub contacts_within: u64,
    /// Sum over members of the number of particles that they touch.
    pub contacts: u64,
}

impl Agglomerate {
    /// d_agg = 2 R_agg.
    pub fn diameter(&self) -> f64 {
        2.0 * self.radius_of_gyration
    }

    /// C_N: mean number of touching neighbours of the members, whether these are members or not.
    pub fn coordination_number(&self) -> f64 {
        self.contacts as f64 / self.members as f64
    }

    /// Mean number of touching neighbours of the members that are also members.
    pub fn coordination_within(&self) -> f64 {
        self.contacts_within as f64 / self.members as f64
    }

    /// Mean number of contacts of a member that have been kept since t_0.
    pub fn bonds_per_member(&self) -> f64 {
        self.bonds as f64 / self.members as f64
    }

    /// p = sum of the particles' volume / (4/3 pi R_agg^3).
    ///
    /// The paper only says "the agglomerate's volume"; we take this to be the sphere of radius R_agg. This sphere is
    /// smaller than the agglomerate: a compact ball of radius B has R_agg = sqrt(3/5) B.
    pub fn packing_fraction(&self) -> f64 {
        self.volume / (4.0 / 3.0 * PI * self.radius_of_gyration.powi(3))
    }

    /// Ratio of the volume of the particles to that of the homogeneous ball with the same radius of gyration, whose
    /// radius is sqrt(5/3) R_agg. For a ball it is the packing fraction of its material; it is always 0.465 times
    /// [`Agglomerate::packing_fraction`].
    pub fn packing_fraction_of_ball(&self) -> f64 {
        self.volume / (4.0 / 3.0 * PI * (self.radius_of_gyration * (5.0_f64 / 3.0).sqrt()).powi(3))
    }

    /// r_a, the radius of the sphere of the members' mean volume.
    pub fn member_radius(&self) -> f64 {
        libm::cbrt(self.volume / (4.0 / 3.0 * PI * self.members as f64))
    }

    /// D_f = ln n / ln(R_agg / r_a), from n = (R_agg / r_a)^D_f: the paper's value for a single agglomerate, with a
    /// prefactor of 1. `None` unless R_agg is above r_a.
    pub fn fractal_dimension(&self) -> Option<f64> {
        let ratio = self.radius_of_gyration / self.member_radius();
        (ratio > 1.0).then(|| libm::log(self.members as f64) / libm::log(ratio))
    }
}

/// The particles of a rank, and the parts of agglomerates that they form.
#[derive(Clone, Copy)]
pub(super) struct Members<'a> {
    pub(super) particles: &'a [ParticleSample],
    /// Unwrapped centres, in the frame of the particle whose id is the label; along axes around which an agglomerate
    /// winds, they are inside the box.
    pub(super) positions: &'a [Vector3<f64>],
    pub(super) sets: &'a ConnectedSets,
    /// Labels of the parts that belong to agglomerates.
    pub(super) large: &'a [Option<u64>],
    pub(super) periodicity: Periodicity,
}

/// A member of an agglomerate.
#[derive(Clone, Copy, Debug)]
struct Body {
    /// Number of its part.
    part: usize,
    mass: f64,
    volume: f64,
    velocity: Vector3<f64>,
    position: Vector3<f64>,
    winds: [bool; 3],
}

impl Body {
    /// Mass times (cos, sin) of the angle on the circle that represents a periodic axis; zeros along other axes.
    fn on_circle(&self, axis: usize, periodicity: &Periodicity) -> [f64; 2] {
        match periodicity.lengths[axis] {
            Some(length) if self.winds[axis] => {
                let angle = TAU * self.position[axis] / length;
                let (sine, cosine) = libm::sincos(angle);
                [self.mass * cosine, self.mass * sine]
            }
            _ => [0.0; 2],
        }
    }

    /// [count, mass, volume, m x (3), m v (3), m cos (3), m sin (3), winds (3)].
    fn moments(&self, periodicity: &Periodicity) -> [f64; MOMENTS] {
        let (x, v) = (self.mass * self.position, self.mass * self.velocity);
        let [a, b, c] = [0, 1, 2].map(|axis| self.on_circle(axis, periodicity));
        let winds = self.winds.map(f64::from);
        let [cosines, sines] = [0, 1].map(|part| [a[part], b[part], c[part]]);
        let mut moments = [0.0; MOMENTS];
        moments[..3].copy_from_slice(&[1.0, self.mass, self.volume]);
        for axis in 0..3 {
            moments[3 + axis] = x[axis];
            moments[6 + axis] = v[axis];
            moments[9 + axis] = cosines[axis];
            moments[12 + axis] = sines[axis];
            moments[15 + axis] = winds[axis];
        }
        moments
    }
}

/// Centre of mass in the frame of the label's particle.
fn centre_of_moments(moments: &[f64; MOMENTS], periodicity: &Periodicity) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| match periodicity.lengths[axis] {
        Some(length) if moments[15 + axis] > 0.0 => {
            let angle = libm::atan2(moments[12 + axis], moments[9 + axis]);
            angle / TAU * length
        }
        _ => moments[3 + axis] / moments[1],
    })
}

impl Members<'_> {
    /// Properties of the agglomerates of all ranks' members, without contacts, on the rendezvous ranks of their labels
    /// by ascending label. Collective.
    pub(super) fn agglomerates(self, ranks: &dyn Communicator) -> Vec<Agglomerate> {
        let periodicity = &self.periodicity;
        let moments = self.moments(ranks);
        let centre = |label: u64| {
            let place = moments.binary_search_by_key(&label, |sums| sums.key).ok();
            place.map_or_else(Vector3::zeros, |place| {
                centre_of_moments(&moments[place].values, periodicity)
            })
        };
        let centres = ask(self.large.iter().flatten().copied(), centre, ranks);
        let of_part = |label: &Option<u64>| label.and_then(|label| centres.get(label));
        let centres: Vec<_> = self.large.iter().map(|it| of_part(it).unwrap_or_default()).collect();
        let second = self.second_moments(&centres, ranks);
        let both = moments.iter().zip(&second);
        both.map(|(sums, second)| agglomerate(sums, second, periodicity)).collect()
    }

    fn bodies(self) -> impl Iterator<Item = Body> + Clone {
        let body = move |place: usize| {
            let part = self.sets.part_of(place)?;
            self.large[part]?;
            let ParticleSample { mass, radius, velocity, .. } = self.particles[place];
            let (position, winds) = (self.positions[place], self.sets.parts[part].winds);
            Some(Body { part, mass, volume: sphere_volume(radius), velocity, position, winds })
        };
        (0..self.particles.len()).filter_map(body)
    }

    /// Sums of [`Body::moments`]. Collective.
    fn moments(self, ranks: &dyn Communicator) -> Vec<Keyed<MOMENTS>> {
        let magnitudes = self.bodies().map(|body| {
            let (x, v) = (body.position, body.velocity);
            [body.mass, body.volume, x.x, x.y, x.z, v.x, v.y, v.z]
        });
        let mut factors = largest(magnitudes);
        // The maximum over ranks comes first: products of the largest values of each rank would depend on the
        // distribution of the members.
        ranks.maximum(&mut factors);
        let [mass, volume, at_and_along @ ..] = factors;
        let mut bounds = [1.0; MOMENTS];
        (bounds[1], bounds[2]) = (mass, volume);
        bounds[3..9].copy_from_slice(&at_and_along.map(|x| mass * x));
        bounds[9..15].fill(mass);
        let addends = self.bodies().map(|body| (body.part, body.moments(&self.periodicity)));
        self.sums(addends, bounds, ranks)
    }

    /// Sums of m l^2, where l is the distance from the centre of the part. Collective.
    fn second_moments(self, centres: &[Vector3<f64>], ranks: &dyn Communicator) -> Vec<Keyed<1>> {
        let addends = self.bodies().map(|body| {
            let centre = &centres[body.part];
            let mut displacement = body.position - centre;
            if body.winds != [false; 3] {
                let nearest = self.periodicity.displacement(centre, &body.position);
                let wound = (0..3).filter(|&axis| body.winds[axis]);
                wound.for_each(|axis| displacement[axis] = nearest[axis]);
            }
            (body.part, [body.mass * displacement.norm_squared()])
        });
        let addends: Vec<(usize, [f64; 1])> = addends.collect();
        let bounds = largest(addends.iter().map(|(_, moment)| *moment));
        self.sums(addends.into_iter(), bounds, ranks)
    }

    /// Sums of addends by the label of their part, on the rendezvous ranks of the labels by ascending label. The
    /// magnitudes of the addends are at most `bounds`. Collective.
    fn sums<const N: usize>(
        self,
        addends: impl Iterator<Item = (usize, [f64; N])>,
        bounds: [f64; N],
        ranks: &dyn Communicator,
    ) -> Vec<Keyed<N>> {
        // Parts that do not belong to an agglomerate have no sums.
        let mut labels = Vec::new();
        let mut slots = vec![usize::MAX; self.large.len()];
        for (slot, label) in slots.iter_mut().zip(self.large) {
            if let Some(label) = label {
                *slot = labels.len();
                labels.push(*label);
            }
        }
        let quanta = Quanta::new(bounds, ranks);
        let mut sums = FixedPointSums::zero(labels.len());
        addends.for_each(|(part, values)| sums.add(slots[part], &quanta.counts_of(&values)));
        sums_by_key(&labels, &sums, &quanta, ranks)
    }
}

fn agglomerate(sums: &Keyed<MOMENTS>, second: &Keyed<1>, periodicity: &Periodicity) -> Agglomerate {
    let [count, mass, volume] = [sums.values[0], sums.values[1], sums.values[2]];
    Agglomerate {
        label: sums.key,
        members: count as u64,
        mass,
        volume,
        centre: periodicity.wrapped(centre_of_moments(&sums.values, periodicity)),
        velocity: Vector3::from_fn(|axis, _| sums.values[6 + axis] / mass),
        radius_of_gyration: (second.values[0] / mass).sqrt(),
        winds: [0, 1, 2].map(|axis| u64::from(sums.values[15 + axis] > 0.0)),
        ..Agglomerate::default()
    }
}

/// Adds the contacts, which were counted on the same ranks.
pub(super) fn add_contacts(found: &mut [Agglomerate], contacts: &[(u64, Counts)]) {
    for agglomerate in found {
        if let Ok(place) = contacts.binary_search_by_key(&agglomerate.label, |count| count.0) {
            let [bonds, within, all] = contacts[place].1.map(|count| count as u64);
            agglomerate.bonds = bonds;
            agglomerate.contacts_within = within;
            agglomerate.contacts = all;
        }
    }
}
