//! Stress and granular temperature on bins of height or on cells.
//!
//! Pressure is positive. With V the volume of a cell,
//!
//! ```math
//! \boldsymbol{\sigma} = \frac{1}{V} \left[ \sum_i m_i \tilde{\mathbf{v}}_i \otimes \tilde{\mathbf{v}}_i - \sum_c w_c\, \mathbf{f}_c \otimes \mathbf{l}_c \right]
//! ```
//!
//! where v~ is the velocity about the mean velocity of the particles of the cell, f_c the force of a contact on the
//! particle of the lower id, l_c the branch vector from its centre to the partner's (to the contact point on a wall),
//! and w_c the part of the branch that lies in the cell. Repulsion gives positive, cohesion negative normal stress.
//! sigma_ij is the flux of momentum i along j.
//!
//! Sources: Moon, Kevrekidis & Sundaresan, Ind. Eng. Chem. Res. 45 (2006) 6966, eq. (19), where the whole branch
//! counts in one averaging volume; Irving & Kirkwood, J. Chem. Phys. 18 (1950) 817, doi:10.1063/1.1747782, and
//! Goldhirsch, Granular Matter 12 (2010) 239, doi:10.1007/s10035-010-0181-z, for the integral along the branch.
//!
//! With it momentum closes exactly: with L the hat function that is 1 on the face between the bins k and k + 1 and 0
//! on their outer faces, A the cross-section and K the kinetic part with whole instead of fluctuating velocities,
//!
//! ```math
//! \frac{d}{dt} \sum_i m_i \mathbf{v}_i L(z_i) = \sum_i \mathbf{b}_i L(z_i) - A \left[ (\boldsymbol{\sigma}_c + \mathbf{K})_{k+1} - (\boldsymbol{\sigma}_c + \mathbf{K})_k \right] \cdot \mathbf{e}_z
//! ```
//!
//! with b the body forces: the difference of the stress of two neighbouring bins is the net force on what lies about
//! the face between them.

mod grid;
#[cfg(test)]
mod tests;

pub use grid::CellGrid;

use super::exact_sums::Keyed;
use super::fixed_point::{FixedPointSum, Quanta, Slots, largest, sums_by_key};
use super::periodicity::Periodicity;
use super::rendezvous::{ask, distinct};
use crate::numbers::{VectorWork, in_wide_vectors};
use crate::parallel::{Communicator, Message, records_of_bytes};
use bytemuck::{Pod, Zeroable};
use nalgebra::{Matrix3, Vector3};

/// A particle, as far as stress is concerned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingParticle {
    /// Mass.
    pub mass: f64,
    /// Volume.
    pub volume: f64,
    /// Centre, in any periodic image.
    pub position: Vector3<f64>,
    /// Velocity.
    pub velocity: Vector3<f64>,
}

/// The force of a contact, or of a pair that attracts each other. Each is held by one rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Centre of the particle of the lower id, or of the one that touches a wall, in any periodic image.
    pub position: Vector3<f64>,
    /// From there to the centre of the partner, or to the contact point on the wall.
    pub branch: Vector3<f64>,
    /// Force on that particle by spring, dashpot and friction.
    pub contact: Vector3<f64>,
    /// Force on that particle by cohesion.
    pub cohesive: Vector3<f64>,
}

/// A frame of reference that moves with a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// How far the frame has moved.
    pub displacement: Vector3<f64>,
    /// Its velocity.
    pub velocity: Vector3<f64>,
}

/// Where and in which frame stress is measured.
#[derive(Clone, Copy, Debug)]
pub struct StressMeasurement {
    /// The cells, at rest in the frame.
    pub grid: CellGrid,
    /// The box.
    pub periodicity: Periodicity,
    /// The frame.
    pub frame: Frame,
}

/// Solids and stress of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellStress {
    /// Number of the cell.
    pub cell: u64,
    /// Number of particles whose centres lie in it.
    pub count: f64,
    /// Their mass.
    pub mass: f64,
    /// Their volume over that of the cell.
    pub solids_fraction: f64,
    /// Velocity of their centre of mass in the frame; zero without particles.
    pub velocity: Vector3<f64>,
    /// (1/V) sum m v~ (x) v~.
    pub kinetic: Matrix3<f64>,
    /// Of spring, dashpot and friction. Not symmetric where torques act.
    pub contact: Matrix3<f64>,
    /// Of cohesion.
    pub cohesive: Matrix3<f64>,
    volume: f64,
}

impl CellStress {
    /// Mass per volume.
    pub fn density(&self) -> f64 {
        self.mass / self.volume
    }

    /// All three parts.
    pub fn total(&self) -> Matrix3<f64> {
        self.kinetic + self.contact + self.cohesive
    }

    /// tr(sigma) / 3 of all parts.
    pub fn pressure(&self) -> f64 {
        self.total().trace() / 3.0
    }

    /// T = sum m v~^2 / (3 sum m), velocity squared. About the mean velocity of the cell: a shear rate g across a
    /// cell of height h adds (g h)^2 / 36. Zero without particles.
    pub fn granular_temperature(&self) -> f64 {
        if self.mass > 0.0 { self.kinetic.trace() * self.volume / (3.0 * self.mass) } else { 0.0 }
    }

    /// The flux of momentum in the frame, with whole instead of fluctuating velocities.
    pub fn momentum_flux(&self) -> Matrix3<f64> {
        let density = self.mass / self.volume;
        self.total() + density * self.velocity * self.velocity.transpose()
    }
}

/// Stress on the cells that meet on this rank, by ascending cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StressField {
    /// Cells with particles or contacts; the others are empty.
    pub cells: Vec<CellStress>,
    /// Number of particles and of branches on all ranks that lie outside of the grid, be it in part, or are
    /// undefined.
    pub outside: u64,
}

impl StressMeasurement {
    /// Measures. Two passes over the particles: mean velocities first. Collective.
    pub fn run(
        &self,
        particles: &[MovingParticle],
        contacts: &[ContactForce],
        ranks: &dyn Communicator,
    ) -> StressField {
        let Placed { inside, cells } = self.placed(particles);
        let mut outside = (particles.len() - inside.len()) as i64;
        let solids = solids(&inside, &cells, ranks);
        let kinetic = kinetic(&inside, &cells, &solids, ranks);
        let contact = self.forces(contacts, |contact| &contact.contact, Some(&mut outside), ranks);
        let cohesive = self.forces(contacts, |contact| &contact.cohesive, None, ranks);
        let volume = self.grid.cell_volume();
        let known = solids.iter().map(|sums| sums.key);
        let known = known.chain(contact.iter().chain(&cohesive).map(|sums| sums.key));
        let known = distinct(known);
        let [mut solids, mut kinetic] = [solids, kinetic].map(InOrder::of);
        let [mut contact, mut cohesive] = [contact, cohesive].map(InOrder::of);
        let cell = |cell: u64| {
            let [count, mass, solid, px, py, pz] = solids.of_key(cell);
            let momentum = Vector3::new(px, py, pz);
            let stress = |sums: [f64; 9]| -Matrix3::from_column_slice(&sums) / volume;
            CellStress {
                cell,
                count,
                mass,
                solids_fraction: solid / volume,
                velocity: mean_velocity(mass, momentum),
                kinetic: symmetric(&kinetic.of_key(cell)) / volume,
                contact: stress(contact.of_key(cell)),
                cohesive: stress(cohesive.of_key(cell)),
                volume,
            }
        };
        let cells = known.into_iter().map(cell).collect();
        let mut total = [outside];
        ranks.sum_integers(&mut total);
        StressField { cells, outside: total[0] as u64 }
    }

    /// The particles inside of the grid, seen from the frame, and their cells.
    fn placed(&self, particles: &[MovingParticle]) -> Placed {
        let mut cells = Slots::new(self.grid.cells());
        let inside = particles.iter().filter_map(|particle| {
            let position = self.seen(&particle.position);
            let velocity = particle.velocity - self.frame.velocity;
            let slot = cells.of(self.grid.cell_of(&position)?);
            Some((slot, MovingParticle { position, velocity, ..*particle }))
        });
        Placed { inside: inside.collect(), cells }
    }

    /// A position seen from the frame, the same for every image of a particle.
    #[inline(always)]
    fn seen(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let wrapped = self.periodicity.wrapped(*position);
        if self.frame.displacement == Vector3::zeros() {
            return wrapped;
        }
        self.periodicity.wrapped(wrapped - self.frame.displacement)
    }

    /// The components of sum w f (x) l by cell, by columns, each on its rendezvous rank; f is one of the forces of a
    /// contact. Counts the branches that leave the grid. Collective.
    fn forces(
        &self,
        contacts: &[ContactForce],
        force: impl Fn(&ContactForce) -> &Vector3<f64>,
        outside: Option<&mut i64>,
        ranks: &dyn Communicator,
    ) -> Vec<Keyed<9>> {
        let quanta = quanta_of_dyads(contacts.iter().map(|it| (force(it), &it.branch)), ranks);
        if quanta.are_zero() && outside.is_none() {
            return Vec::new();
        }
        let shared = in_wide_vectors(Share { measurement: self, contacts, force, quanta: &quanta });
        if let Some(outside) = outside {
            *outside += shared.leaving;
        }
        sums_by_key(shared.cells.keys(), &shared.sums, &quanta, ranks)
    }
}

/// Shares the dyads f (x) l of contacts among the cells through which their branches pass. What a branch gives its cells
/// adds up to the whole exactly: differences of f (x) l times the pieces' ends, as integers.
struct Share<'a, F> {
    measurement: &'a StressMeasurement,
    contacts: &'a [ContactForce],
    force: F,
    quanta: &'a Quanta<9>,
}

/// The shares of the cells, and the number of branches that leave the grid.
struct Shared {
    cells: Slots,
    sums: Vec<FixedPointSum<9>>,
    leaving: i64,
}

impl<F: Fn(&ContactForce) -> &Vector3<f64>> VectorWork for Share<'_, F> {
    type Output = Shared;

    #[inline(always)]
    fn run(self) -> Shared {
        let Self { measurement, contacts, force, quanta } = self;
        let ruler = measurement.grid.ruler();
        let mut cells = Slots::new(measurement.grid.cells());
        let mut sums = Vec::<FixedPointSum<9>>::new();
        let (mut pieces, mut leaving) = (Vec::new(), 0);
        for contact in contacts {
            ruler.pieces(&measurement.seen(&contact.position), &contact.branch, &mut pieces);
            leaving += i64::from(pieces.is_empty() || pieces.iter().any(|p| p.cell.is_none()));
            let dyad = dyad(force(contact), &contact.branch);
            let mut before = [0; 9];
            for piece in &pieces {
                let upto = quanta.counts_of(&dyad.map(|component| component * piece.last));
                if let Some(cell) = piece.cell {
                    let slot = cells.of(cell);
                    if slot == sums.len() {
                        sums.push(FixedPointSum::default());
                    }
                    sums[slot].add(&std::array::from_fn(|k| upto[k].wrapping_sub(before[k])));
                }
                before = upto;
            }
        }
        Shared { cells, sums, leaving }
    }
}

/// Particles inside of the grid.
struct Placed {
    /// Each with the slot of its cell.
    inside: Vec<(usize, MovingParticle)>,
    cells: Slots,
}

/// Sums by ascending key, which are asked for in the same order.
struct InOrder<const N: usize>(std::iter::Peekable<std::vec::IntoIter<Keyed<N>>>);

impl<const N: usize> InOrder<N> {
    fn of(sums: Vec<Keyed<N>>) -> Self {
        Self(sums.into_iter().peekable())
    }

    /// Those of a key; zero if there are none.
    fn of_key(&mut self, key: u64) -> [f64; N] {
        self.0.next_if(|sums| sums.key == key).map_or([0.0; N], |sums| sums.values)
    }
}

/// [count, mass, volume, momentum (3)] by cell, each on its rendezvous rank. Collective.
fn solids(
    particles: &[(usize, MovingParticle)],
    cells: &Slots,
    ranks: &dyn Communicator,
) -> Vec<Keyed<6>> {
    let moments = |(slot, particle): &(usize, MovingParticle)| {
        let p = particle.mass * particle.velocity;
        (*slot, [1.0, particle.mass, particle.volume, p.x, p.y, p.z])
    };
    sums_by_cell(particles.iter().map(moments), cells, ranks)
}

/// The six components of sum m v~ (x) v~ by cell, each on its rendezvous rank. Collective.
fn kinetic(
    particles: &[(usize, MovingParticle)],
    cells: &Slots,
    solids: &[Keyed<6>],
    ranks: &dyn Communicator,
) -> Vec<Keyed<6>> {
    let mean = |cell: u64| {
        let place = solids.binary_search_by_key(&cell, |sums| sums.key);
        place.map_or_else(
            |_| Vector3::zeros(),
            |place| {
                let [_, mass, _, x, y, z] = solids[place].values;
                mean_velocity(mass, Vector3::new(x, y, z))
            },
        )
    };
    let means = ask(cells.keys().iter().copied(), mean, ranks);
    let means: Vec<Vector3<f64>> =
        cells.keys().iter().map(|&cell| means.get(cell).unwrap_or_default()).collect();
    let moments = |(slot, particle): &(usize, MovingParticle)| {
        let (m, v) = (particle.mass, particle.velocity - means[*slot]);
        let moments = [
            m * v.x * v.x,
            m * v.y * v.y,
            m * v.z * v.z,
            m * v.x * v.y,
            m * v.x * v.z,
            m * v.y * v.z,
        ];
        (*slot, moments)
    };
    sums_by_cell(particles.iter().map(moments), cells, ranks)
}

impl StressField {
    /// All cells on all ranks, by ascending cell: for profiles, which are small. Collective.
    pub fn gathered(&self, ranks: &dyn Communicator) -> Vec<CellStress> {
        let gathered = ranks.gather_to_root(&Message::of(0, &self.cells).bytes);
        let mut bytes = gathered.map_or_else(Vec::new, |all| all.concat());
        ranks.broadcast_from_root(&mut bytes);
        let mut cells: Vec<CellStress> = records_of_bytes(&bytes).collect();
        cells.sort_unstable_by_key(|cell| cell.cell);
        cells
    }
}

/// Rumpf's estimate of the tensile strength, (1 - porosity) / pi * k F / d^2: k the coordination number, F the force
/// that parts a contact, d the diameter (Moon et al. 2006, eq. (20)).
pub fn rumpf_strength(solids_fraction: f64, coordination: f64, force: f64, diameter: f64) -> f64 {
    solids_fraction / std::f64::consts::PI * coordination * force / (diameter * diameter)
}

/// Sums of addends, each with the slot of its cell. Collective.
fn sums_by_cell(
    addends: impl Iterator<Item = (usize, [f64; 6])> + Clone,
    cells: &Slots,
    ranks: &dyn Communicator,
) -> Vec<Keyed<6>> {
    let quanta = Quanta::new(largest(addends.clone().map(|(_, values)| values)), ranks);
    let mut sums = vec![FixedPointSum::default(); cells.keys().len()];
    addends.for_each(|(slot, values)| sums[slot].add(&quanta.counts_of(&values)));
    sums_by_key(cells.keys(), &sums, &quanta, ranks)
}

fn mean_velocity(mass: f64, momentum: Vector3<f64>) -> Vector3<f64> {
    if mass > 0.0 { momentum / mass } else { Vector3::zeros() }
}

fn symmetric(&[xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Quanta of the dyads of forces and branches, from the largest component of each. Collective.
fn quanta_of_dyads<'a>(
    factors: impl Iterator<Item = (&'a Vector3<f64>, &'a Vector3<f64>)>,
    ranks: &dyn Communicator,
) -> Quanta<9> {
    let mut factors = largest(factors.map(|(f, l)| [f.x, f.y, f.z, l.x, l.y, l.z]));
    // First over ranks: products of the largest of each rank would depend on who has which contacts.
    ranks.maximum(&mut factors);
    let [fx, fy, fz, lx, ly, lz] = factors;
    let (force, branch) = (Vector3::new(fx, fy, fz), Vector3::new(lx, ly, lz));
    Quanta::new(dyad(&force, &branch), ranks)
}

/// The components of f (x) l by columns.
#[inline(always)]
fn dyad(force: &Vector3<f64>, branch: &Vector3<f64>) -> [f64; 9] {
    std::array::from_fn(|k| force[k % 3] * branch[k / 3])
}
