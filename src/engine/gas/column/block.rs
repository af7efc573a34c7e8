//! The column gas at a block of particles: fields, drag, and force.

use crate::coupling::{ColumnBlock, DragShare};
use crate::gas::ParticleDrag;
use crate::numbers::{F64x4, Quantum, first_flagged, vectorised};
use crate::particles::{ForceTorque, LANES, Lanes};
use std::f64::consts::PI;

/// Particles, and the fields of the gas between the nodes of its grid.
#[derive(Clone)]
pub(super) struct ParticlesInColumn<'a> {
    /// The particles in it.
    pub(super) blocks: &'a [ColumnBlock],
    /// phi and u_s as [`interval_fields`](crate::coupling::interval_fields); likewise shares of drag per volume and
    /// u_d, which are empty if all particles are of one size.
    pub(super) between_nodes: &'a [Vec<[f64; 4]>; 2],
    pub(super) drag: ParticleDrag,
    /// U_s.
    pub(super) superficial_velocity: SuperficialVelocity<'a>,
}

/// U_s over the height.
#[derive(Clone, Copy)]
pub(super) enum SuperficialVelocity<'a> {
    /// The same at all heights, in an incompressible gas.
    Uniform(f64),
    /// For each interval of the grid, the value at its lower end and the change to its upper end.
    Between(&'a [[f64; 2]]),
}

impl SuperficialVelocity<'_> {
    /// U_s at the particles of a block, by the weights of the other fields.
    #[inline(always)]
    fn at(self, particles: &ColumnBlock) -> Lanes {
        match self {
            Self::Uniform(velocity) => [velocity; LANES],
            Self::Between(intervals) => std::array::from_fn(|lane| {
                let [lower, change] = intervals[particles.interval[lane] as usize];
                lower + particles.of_upper[lane] * change
            }),
        }
    }
}

/// Fields and drag at the particles of a block.
#[derive(Default)]
#[repr(align(64))] // see `Lanes`
pub(super) struct GasBlock {
    solids_fraction: Lanes,
    solids_velocity: Lanes,
    share_density: Lanes,
    /// u_d; u_s if all particles are of one size.
    drag_velocity: Lanes,
    superficial_velocity: Lanes,
    /// (V / phi) beta.
    drag: Lanes,
    /// V (-dp/dz) per velocity difference u_g - u_d: V B / (1 - phi), B the drag per volume.
    gradient: Lanes,
}

impl GasBlock {
    #[inline(always)]
    pub(super) fn fill<Q: F64x4>(&mut self, column: &ParticlesInColumn, particles: &ColumnBlock) {
        self.superficial_velocity = column.superficial_velocity.at(particles);
        let [of_volume, of_drag] = column.between_nodes;
        let fields = [&mut self.solids_fraction, &mut self.solids_velocity];
        particles.interpolate::<Q>(of_volume, fields);
        let sizes_differ = !of_drag.is_empty();
        if sizes_differ {
            let fields = [&mut self.share_density, &mut self.drag_velocity];
            particles.interpolate::<Q>(of_drag, fields);
        } else {
            self.drag_velocity = self.solids_velocity;
        }
        let share = if sizes_differ { column.drag.share } else { DragShare::Diameter };
        match share {
            DragShare::Diameter => self.find_drag(column, &particles.radius.map(|r| 2.0 * r)),
            DragShare::Surface => self.share_drag(column, &particles.radius),
        }
        if sizes_differ {
            self.share_gradient(share, &particles.radius);
        }
    }

    /// Sets the drag of a bed of the Sauter mean diameter, shared by surface.
    #[inline(always)]
    fn share_drag(&mut self, column: &ParticlesInColumn, radius: &Lanes) {
        let mean: Lanes = std::array::from_fn(|lane| {
            let [phi, shares] = [self.solids_fraction[lane], self.share_density[lane]];
            DragShare::Surface.diameter_of_equals(phi, shares)
        });
        self.find_drag(column, &mean);
        for lane in 0..LANES {
            let ratio = 2.0 * radius[lane] / mean[lane];
            self.drag[lane] *= ratio * ratio;
            self.gradient[lane] *= ratio * ratio;
        }
    }

    #[inline(always)]
    fn find_drag(&mut self, column: &ParticlesInColumn, diameter: &Lanes) {
        let mut slip = [0.0; LANES];
        for (lane, slip) in slip.iter_mut().enumerate() {
            *slip = self.superficial_velocity[lane] - self.solids_velocity[lane];
        }
        self.drag = column.drag.per_velocities(diameter, &self.solids_fraction, &slip);
        for lane in 0..LANES {
            let phi = self.solids_fraction[lane];
            self.gradient[lane] = self.drag[lane] * phi / (1.0 - phi); // V beta / (1 - phi)
        }
    }

    /// Sets the gradient for sizes that differ: V B in place of V beta, where B = c over a particle's share of drag
    /// times the sum of shares per volume.
    #[inline(always)]
    fn share_gradient(&mut self, share: DragShare, radius: &Lanes) {
        for lane in 0..LANES {
            let (phi, radius) = (self.solids_fraction[lane], radius[lane]);
            let of_one_size = match share {
                DragShare::Diameter => phi * 6.0 / (PI * 4.0 * radius.powi(2)),
                DragShare::Surface => phi * 6.0 / (PI * 2.0 * radius),
            };
            self.gradient[lane] *= self.share_density[lane] / of_one_size;
        }
    }

    /// Vertical force at a velocity of the particle and a superficial velocity.
    #[inline(always)]
    pub(super) fn vertical_force(
        &self,
        lane: usize,
        velocity: f64,
        superficial_velocity: f64,
    ) -> f64 {
        let u = self.solids_velocity[lane];
        let gas_velocity = u + (superficial_velocity - u) / (1.0 - self.solids_fraction[lane]);
        let pressure = self.gradient[lane] * (gas_velocity - self.drag_velocity[lane]);
        self.drag[lane] * (gas_velocity - velocity) + pressure
    }

    /// Change of that force with the superficial velocity.
    #[inline(always)]
    pub(super) fn slope(&self, lane: usize) -> f64 {
        let slope = self.drag[lane] + self.gradient[lane];
        slope / (1.0 - self.solids_fraction[lane])
    }
}

/// A force that exceeds the limit or is undefined.
pub(super) struct ForceTooLarge {
    /// Index of the particle.
    pub(super) index: usize,
    /// A component of it.
    pub(super) force: f64,
    pub(super) solids_fraction: f64,
}

vectorised!(
    /// Adds the gas force to each particle, with lateral drag if the gas has it. No component may exceed the limit.
    pub(super) fn add_forces<Q: F64x4>(
        column: ParticlesInColumn,
        lateral: bool,
        quantum: Quantum,
        limit: f64,
        loads: &mut [ForceTorque],
    ) -> Result<(), ForceTooLarge> {
        let mut block = GasBlock::default();
        let (mut force, mut out_of_range) = ([0.0; LANES], [0; LANES]);
        let chunks = column.blocks.iter().zip(loads.chunks_mut(LANES));
        for (number, (particles, loads)) in chunks.enumerate() {
            block.fill::<Q>(&column, particles);
            let axes = if lateral { 0..3 } else { 2..3 };
            for axis in axes {
                for lane in 0..LANES {
                    let velocity = particles.velocity[axis][lane];
                    let component = match axis {
                        2 => block.vertical_force(lane, velocity, block.superficial_velocity[lane]),
                        _ => -block.drag[lane] * velocity,
                    };
                    force[lane] = quantum.round(component);
                    let within = force[lane].abs() <= limit; // an undefined force is not
                    out_of_range[lane] = u64::from(!within);
                }
                if let Some(lane) = first_flagged(&out_of_range) {
                    return Err(ForceTooLarge {
                        index: number * LANES + lane,
                        force: force[lane].abs(),
                        solids_fraction: block.solids_fraction[lane],
                    });
                }
                loads.iter_mut().zip(&force).for_each(|(load, force)| load.force[axis] += force);
            }
        }
        Ok(())
    }
);

vectorised!(
    /// Sums the force at U_s = 0 and its slope dF/dU_s over the particles, `count` of them, with the drag of the
    /// column's U_s, as counts of their quanta.
    pub(super) fn sum_slopes<Q: F64x4>(
        column: ParticlesInColumn,
        quanta: [Quantum; 2],
        count: usize,
    ) -> [i64; 2] {
        let [of_force, of_slope] = quanta;
        let mut block = GasBlock::default();
        let mut sums = [0; 2];
        for (number, particles) in column.blocks.iter().enumerate() {
            block.fill::<Q>(&column, particles);
            let (mut forces, mut slopes) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                forces[lane] =
                    of_force.round(block.vertical_force(lane, particles.velocity[2][lane], 0.0));
                slopes[lane] = of_slope.round(block.slope(lane));
            }
            for lane in 0..LANES.min(count - number * LANES) {
                // Forces far beyond the limit may wrap around, equally on any number of ranks; they are refused when
                // they are added.
                sums[0] = i64::wrapping_add(sums[0], of_force.count(forces[lane]));
                sums[1] = i64::wrapping_add(sums[1], of_slope.count(slopes[lane]));
            }
        }
        sums
    }
);
