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

use super::fixed_point::{FixedPointSums, largest};
use super::periodicity::Periodicity;
use super::rendezvous::ask;
use crate::parallel::{Communicator, Message, records_of_bytes};
use bytemuck::{Pod, Zeroable};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

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
        let placed: Vec<_> = particles.iter().map(|particle| self.placed(particle)).collect();
        let inside: Vec<_> = placed.iter().filter_map(|(cell, p)| Some(((*cell)?, *p))).collect();
        let mut outside = (placed.len() - inside.len()) as i64;
        let solids = self.solids(&inside, ranks);
        let kinetic = self.kinetic(&inside, &solids, ranks);
        let forces = self.forces(contacts, &mut outside, ranks);
        let mut cells: BTreeMap<u64, CellStress> = BTreeMap::new();
        let volume = self.grid.cell_volume();
        let mut cell = |number: u64, change: &dyn Fn(&mut CellStress)| {
            let new = CellStress { cell: number, volume, ..CellStress::default() };
            change(cells.entry(number).or_insert(new));
        };
        for (number, [count, mass, solid, ..]) in &solids {
            cell(*number, &|cell| {
                (cell.count, cell.mass, cell.solids_fraction) = (*count, *mass, solid / volume);
                cell.velocity = mean_velocity(&solids, *number);
            });
        }
        for (&number, sums) in &kinetic {
            cell(number, &|cell| cell.kinetic = symmetric(sums) / volume);
        }
        for (&number, sums) in &forces {
            cell(number, &|cell| {
                [cell.contact, cell.cohesive] = [0, 9]
                    .map(|first| -Matrix3::from_column_slice(&sums[first..first + 9]) / volume);
            });
        }
        let mut total = [outside];
        ranks.sum_integers(&mut total);
        StressField { cells: cells.into_values().collect(), outside: total[0] as u64 }
    }

    /// A particle seen from the frame, and its cell.
    fn placed(&self, particle: &MovingParticle) -> (Option<u64>, MovingParticle) {
        let position = self.seen(&particle.position);
        let velocity = particle.velocity - self.frame.velocity;
        (self.grid.cell_of(&position), MovingParticle { position, velocity, ..*particle })
    }

    /// A position seen from the frame, the same for every image of a particle.
    fn seen(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let wrapped = self.periodicity.wrapped(*position);
        self.periodicity.wrapped(wrapped - self.frame.displacement)
    }

    /// [count, mass, volume, momentum (3)] by cell, each on its rendezvous rank. Collective.
    fn solids(
        &self,
        particles: &[(u64, MovingParticle)],
        ranks: &dyn Communicator,
    ) -> BTreeMap<u64, [f64; 6]> {
        let moments = |particle: &MovingParticle| {
            let p = particle.mass * particle.velocity;
            [1.0, particle.mass, particle.volume, p.x, p.y, p.z]
        };
        let all = particles.iter().map(|(cell, particle)| (*cell, moments(particle)));
        sums_by_cell(all, ranks)
    }

    /// The six components of sum m v~ (x) v~ by cell, each on its rendezvous rank. Collective.
    fn kinetic(
        &self,
        particles: &[(u64, MovingParticle)],
        solids: &BTreeMap<u64, [f64; 6]>,
        ranks: &dyn Communicator,
    ) -> BTreeMap<u64, [f64; 6]> {
        let cells = particles.iter().map(|(cell, _)| *cell);
        let means = ask(cells, |cell| mean_velocity(solids, cell), ranks);
        let moments = |cell: u64, particle: &MovingParticle| {
            let v = particle.velocity - means.get(cell).unwrap_or_default();
            let m = particle.mass;
            [
                m * v.x * v.x,
                m * v.y * v.y,
                m * v.z * v.z,
                m * v.x * v.y,
                m * v.x * v.z,
                m * v.y * v.z,
            ]
        };
        let all = particles.iter().map(|(cell, particle)| (*cell, moments(*cell, particle)));
        sums_by_cell(all, ranks)
    }

    /// The components of sum w f (x) l of contact and cohesive forces by cell, each on its rendezvous rank. What a
    /// branch gives its cells adds up to the whole exactly: differences of f (x) l times the pieces' ends, as
    /// integers. Collective.
    fn forces(
        &self,
        contacts: &[ContactForce],
        outside: &mut i64,
        ranks: &dyn Communicator,
    ) -> BTreeMap<u64, [f64; 18]> {
        let mut sums = FixedPointSums::new(largest(contacts.iter().map(dyads)), ranks);
        for contact in contacts {
            let dyads = dyads(contact);
            let start = self.seen(&contact.position);
            let pieces = self.grid.pieces(&start, &contact.branch).unwrap_or_default();
            *outside += i64::from(pieces.is_empty() || pieces.iter().any(|p| p.cell.is_none()));
            let mut before = [0; 18];
            for piece in pieces {
                let upto = sums.counts_of(&dyads.map(|component| component * piece.last));
                if let Some(cell) = piece.cell {
                    sums.add(cell, &std::array::from_fn(|k| upto[k] - before[k]));
                }
                before = upto;
            }
        }
        sums.totals(ranks)
    }
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

fn sums_by_cell(
    addends: impl Iterator<Item = (u64, [f64; 6])> + Clone,
    ranks: &dyn Communicator,
) -> BTreeMap<u64, [f64; 6]> {
    let mut sums = FixedPointSums::new(largest(addends.clone().map(|(_, values)| values)), ranks);
    for (cell, values) in addends {
        let counts = sums.counts_of(&values);
        sums.add(cell, &counts);
    }
    sums.totals(ranks)
}

fn mean_velocity(solids: &BTreeMap<u64, [f64; 6]>, cell: u64) -> Vector3<f64> {
    match solids.get(&cell) {
        Some(&[_, mass, _, x, y, z]) if mass > 0.0 => Vector3::new(x, y, z) / mass,
        _ => Vector3::zeros(),
    }
}

fn symmetric(&[xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The components of f (x) l by columns, of contact and cohesive force.
fn dyads(contact: &ContactForce) -> [f64; 18] {
    std::array::from_fn(|k| {
        let force = if k < 9 { &contact.contact } else { &contact.cohesive };
        force[k % 3] * contact.branch[k % 9 / 3]
    })
}
