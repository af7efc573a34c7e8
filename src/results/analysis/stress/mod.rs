//! Stress and granular temperature in bins over height or in cells.
//!
//! Pressure is positive. With V the volume of a cell,
//!
//! ```math
//! \boldsymbol{\sigma} = \frac{1}{V} \left[ \sum_i m_i \tilde{\mathbf{v}}_i \otimes \tilde{\mathbf{v}}_i - \sum_c w_c\, \mathbf{f}_c \otimes \mathbf{l}_c \right]
//! ```
//!
//! where v~ is the velocity relative to the mean velocity of the particles of the cell, f_c the force of a contact on
//! the particle with the lower id, l_c the branch vector from its centre to the partner's (to the contact point on a
//! wall), and w_c the fraction of the branch that lies in the cell. Repulsion gives positive, cohesion negative normal
//! stress. sigma_ij is the flux of momentum i along j.
//!
//! Sources: Moon, Kevrekidis & Sundaresan, Ind. Eng. Chem. Res. 45 (2006) 6966, eq. (19), where the whole branch counts
//! in one averaging volume; Irving & Kirkwood, J. Chem. Phys. 18 (1950) 817, doi:10.1063/1.1747782, and Goldhirsch,
//! Granular Matter 12 (2010) 239, doi:10.1007/s10035-010-0181-z, for the integral along the branch.
//!
//! With this integral the momentum balance closes exactly. Let L be the hat function that is 1 on the face between the
//! bins k and k + 1 and 0 on their outer faces, A the cross-section, and K the kinetic part with whole instead of
//! fluctuating velocities. Then
//!
//! ```math
//! \frac{d}{dt} \sum_i m_i \mathbf{v}_i L(z_i) = \sum_i \mathbf{b}_i L(z_i) - A \left[ (\boldsymbol{\sigma}_c + \mathbf{K})_{k+1} - (\boldsymbol{\sigma}_c + \mathbf{K})_k \right] \cdot \mathbf{e}_z
//! ```
//!
//! with b the body forces: the difference of the stress of two neighbouring bins is the net force on the matter around
//! the face between them.

mod grid;
#[cfg(test)]
mod tests;

pub use grid::CellGrid;

use bytemuck::{Pod, Zeroable};
use nalgebra::{Matrix3, Vector3};
use talcum_engine::numbers::vectorised;
use talcum_engine::parallel::{Communicator, Message, records_of_bytes};
use talcum_engine::particle_sets::Periodicity;
use talcum_engine::particle_sets::exact_sums::Keyed;
use talcum_engine::particle_sets::fixed_point::{
    FixedPointSums, Quanta, Slots, largest, sums_by_key,
};
use talcum_engine::particle_sets::rendezvous::{ask, distinct};

/// A particle, with the data needed for stress.
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

/// The force of a contact, or of a pair that attracts each other. Each is on one rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Centre of the particle with the lower id, or of the one that touches a wall, in any periodic image.
    pub position: Vector3<f64>,
    /// Vector from there to the centre of the partner, or to the contact point on the wall.
    pub branch: Vector3<f64>,
    /// Force on that particle by spring, dashpot and friction.
    pub contact: Vector3<f64>,
    /// Force on that particle by cohesion.
    pub cohesive: Vector3<f64>,
}

/// A frame of reference that moves with a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Displacement of the frame.
    pub displacement: Vector3<f64>,
    /// Velocity of the frame.
    pub velocity: Vector3<f64>,
}

/// The cells and the frame in which stress is measured.
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
    /// Stress of spring, dashpot and friction; it is not symmetric if torques act.
    pub contact: Matrix3<f64>,
    /// Stress of cohesion.
    pub cohesive: Matrix3<f64>,
    volume: f64,
}

impl CellStress {
    /// Mass per volume.
    pub fn density(&self) -> f64 {
        self.mass / self.volume
    }

    /// Sum of all three parts.
    pub fn total(&self) -> Matrix3<f64> {
        self.kinetic + self.contact + self.cohesive
    }

    /// tr(sigma) / 3 of the total.
    pub fn pressure(&self) -> f64 {
        self.total().trace() / 3.0
    }

    /// T = sum m v~^2 / (3 sum m), velocity squared. It is relative to the mean velocity of the cell: a shear rate g
    /// across a cell of height h adds (g h)^2 / 36. Zero without particles.
    pub fn granular_temperature(&self) -> f64 {
        if self.mass > 0.0 { self.kinetic.trace() * self.volume / (3.0 * self.mass) } else { 0.0 }
    }

    /// The flux of momentum in the frame, with whole instead of fluctuating velocities.
    pub fn momentum_flux(&self) -> Matrix3<f64> {
        let density = self.mass / self.volume;
        self.total() + density * self.velocity * self.velocity.transpose()
    }
}

/// Stress in the cells whose rendezvous is this rank, by ascending cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StressField {
    /// Cells with particles or contacts; all others are empty.
    pub cells: Vec<CellStress>,
    /// Number of particles and of branches on all ranks that lie wholly or partly outside the grid, or are undefined.
    pub outside: u64,
}

impl StressMeasurement {
    /// Computes the stress, in two passes over the particles: mean velocities first. Collective.
    pub fn run(
        &self,
        particles: &[MovingParticle],
        contacts: &ContactForces,
        ranks: &dyn Communicator,
    ) -> StressField {
        let Placed { inside, cells } = self.placed(particles);
        let solids = solids(&inside, &cells, ranks);
        let kinetic = kinetic(&inside, &cells, &solids, ranks);
        let forces = self.forces(contacts, ranks);
        let volume = self.grid.cell_volume();
        let known = solids.iter().map(|sums| sums.key);
        let known = distinct(known.chain(forces.dyads.iter().map(|sums| sums.key)));
        let [mut solids, mut kinetic] = [solids, kinetic].map(InOrder::of);
        let mut dyads = InOrder::of(forces.dyads);
        let cell = |cell: u64| {
            let [count, mass, solid, px, py, pz] = solids.of_key(cell);
            let momentum = Vector3::new(px, py, pz);
            let dyads = dyads.of_key(cell);
            let (contact, cohesive) = dyads.split_at(DYAD);
            let stress = |sums: &[f64]| -Matrix3::from_column_slice(sums) / volume;
            CellStress {
                cell,
                count,
                mass,
                solids_fraction: solid / volume,
                velocity: mean_velocity(mass, momentum),
                kinetic: symmetric(&kinetic.of_key(cell)) / volume,
                contact: stress(contact),
                cohesive: stress(cohesive),
                volume,
            }
        };
        let cells = known.into_iter().map(cell).collect();
        let mut total = [(particles.len() - inside.len()) as i64 + forces.leaving];
        ranks.sum_integers(&mut total);
        StressField { cells, outside: total[0] as u64 }
    }

    /// The particles inside the grid, as seen from the frame, and their cells.
    fn placed(&self, particles: &[MovingParticle]) -> Placed {
        let ruler = self.grid.ruler();
        let mut cells = Slots::new(self.grid.cells());
        let mut inside = Vec::with_capacity(particles.len());
        for particle in particles {
            let position = self.seen(&particle.position);
            if let Some(cell) = ruler.cell_of(&position) {
                let velocity = particle.velocity - self.frame.velocity;
                inside.push((cells.of(cell), MovingParticle { position, velocity, ..*particle }));
            }
        }
        Placed { inside, cells }
    }

    /// A position as seen from the frame, equal for all images of a particle.
    #[inline(always)]
    fn seen(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let wrapped = self.periodicity.wrapped(*position);
        if self.frame.displacement == Vector3::zeros() {
            return wrapped;
        }
        self.periodicity.wrapped(wrapped - self.frame.displacement)
    }

    /// The dyads of forces and branches by cell. Collective.
    fn forces(&self, contacts: &ContactForces, ranks: &dyn Communicator) -> ForcesOnCells {
        let mut largest = contacts.largest;
        // The maximum over ranks comes first: products of the largest values of each rank would depend on the
        // distribution of the contacts.
        ranks.maximum(&mut largest);
        let [lx, ly, lz, fx, fy, fz, cx, cy, cz] = largest;
        let largest = ContactForce {
            position: Vector3::zeros(),
            branch: Vector3::new(lx, ly, lz),
            contact: Vector3::new(fx, fy, fz),
            cohesive: Vector3::new(cx, cy, cz),
        };
        if largest.cohesive == Vector3::zeros() {
            self.shared(contacts, &Quanta::<DYAD>::spanning(dyads(&largest)), ranks)
        } else {
            self.shared(contacts, &Quanta::<DYADS>::spanning(dyads(&largest)), ranks)
        }
    }

    /// The dyads by cell, for the first N components of all dyads. Collective.
    fn shared<const N: usize>(
        &self,
        contacts: &ContactForces,
        quanta: &Quanta<N>,
        ranks: &dyn Communicator,
    ) -> ForcesOnCells {
        let Shared { cells, sums, leaving } = share(self, &contacts.contacts, quanta);
        let sums = sums_by_key(cells.keys(), &sums, quanta, ranks).into_iter();
        let filled =
            |values: [f64; N]| std::array::from_fn(|k| values.get(k).copied().unwrap_or_default());
        let dyads = sums.map(|Keyed { key, values }| Keyed { key, values: filled(values) });
        ForcesOnCells { dyads: dyads.collect(), leaving }
    }
}

/// Contributions of contacts to cells.
struct ForcesOnCells {
    /// The components of sum w f (x) l for both forces of contacts, each cell on its rendezvous rank.
    dyads: Vec<Keyed<DYADS>>,
    /// Number of this rank's branches that extend beyond the grid.
    leaving: i64,
}

/// The shares of the cells, and the number of branches that extend beyond the grid.
struct Shared<const N: usize> {
    cells: Slots,
    sums: FixedPointSums<N>,
    leaving: i64,
}

vectorised!(
    /// Distributes the dyads f (x) l of contacts among the cells through which their branches pass. The shares of a
    /// branch add up to the whole exactly: they are differences of f (x) l times the pieces' ends, as integers.
    fn share<const N: usize>(
        measurement: &StressMeasurement,
        contacts: &[ContactForce],
        quanta: &Quanta<N>,
    ) -> Shared<N> {
        let ruler = measurement.grid.ruler();
        let mut cells = Slots::new(measurement.grid.cells());
        let mut sums = FixedPointSums::zero(0);
        let (mut pieces, mut leaving) = (Vec::new(), 0);
        for contact in contacts {
            ruler.pieces(&measurement.seen(&contact.position), &contact.branch, &mut pieces);
            leaving += i64::from(pieces.is_empty() || pieces.iter().any(|p| p.cell.is_none()));
            let dyads = dyads::<N>(contact);
            let mut before = [0; N];
            for piece in &pieces {
                let upto = quanta.counts_of(&dyads.map(|component| component * piece.last));
                if let Some(cell) = piece.cell {
                    let slot = cells.of(cell);
                    if slot == sums.places() {
                        sums.grow();
                    }
                    sums.add(slot, &std::array::from_fn(|k| upto[k].wrapping_sub(before[k])));
                }
                before = upto;
            }
        }
        Shared { cells, sums, leaving }
    }
);

/// The forces of a rank's contacts, and of its pairs that attract each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactForces {
    contacts: Vec<ContactForce>,
    /// The largest magnitudes of the components of branches, contact forces and cohesive forces.
    largest: [f64; 9],
}

impl ContactForces {
    /// Collects these contacts.
    pub fn of(contacts: Vec<ContactForce>) -> Self {
        let largest = largest_components(&contacts);
        Self { contacts, largest }
    }
}

vectorised!(
    /// Finds the largest magnitude of each component.
    fn largest_components(contacts: &[ContactForce]) -> [f64; 9] {
        largest(contacts.iter().map(
            |ContactForce { branch: l, contact: f, cohesive: c, .. }| {
                [l.x, l.y, l.z, f.x, f.y, f.z, c.x, c.y, c.z]
            },
        ))
    }
);

/// Number of components of a dyad, and of the dyads of both forces of a contact.
const DYAD: usize = 9;
const DYADS: usize = 2 * DYAD;

/// The components of f (x) l by columns: first for the contact force, then for cohesion.
#[inline(always)]
fn dyads<const N: usize>(contact: &ContactForce) -> [f64; N] {
    std::array::from_fn(|k| {
        let force = if k < DYAD { &contact.contact } else { &contact.cohesive };
        force[k % 3] * contact.branch[k % DYAD / 3]
    })
}

/// Particles inside the grid.
struct Placed {
    /// These particles, each with the slot of its cell.
    inside: Vec<(usize, MovingParticle)>,
    cells: Slots,
}

/// Sums by ascending key, which are requested in the same order.
struct InOrder<const N: usize>(std::iter::Peekable<std::vec::IntoIter<Keyed<N>>>);

impl<const N: usize> InOrder<N> {
    fn of(sums: Vec<Keyed<N>>) -> Self {
        Self(sums.into_iter().peekable())
    }

    /// The sums for a key; zero if there are none.
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

/// Rumpf's estimate of the tensile strength, (1 - porosity) / pi * k F / d^2, where k is the coordination number, F the
/// force that separates a contact, and d the diameter (Moon et al. 2006, eq. (20)).
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
    let mut sums = FixedPointSums::zero(cells.keys().len());
    addends.for_each(|(slot, values)| sums.add(slot, &quanta.counts_of(&values)));
    sums_by_key(cells.keys(), &sums, &quanta, ranks)
}

fn mean_velocity(mass: f64, momentum: Vector3<f64>) -> Vector3<f64> {
    if mass > 0.0 { momentum / mass } else { Vector3::zeros() }
}

fn symmetric(&[xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
