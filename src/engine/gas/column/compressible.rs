//! A compressible column gas: isothermal, ideal, without inertia.
//!
//! With P the absolute pressure above the bed and p the pressure less P, the balances of mass and momentum are
//!
//! ```math
//! \frac{\partial}{\partial t} \left[ (1 - \phi) (P + p) \right] + \frac{\partial}{\partial z} \left[ (P + p) (U - \phi u_s) \right] = 0,
//! \qquad -\frac{\partial p}{\partial z} = \frac{\beta(\phi)}{(1 - \phi)^2} (U - u_s)
//! ```
//!
//! with U = (1 - phi) u_g + phi u_s, which now depends on the height. For P -> infinity it does not, and the gas is the
//! incompressible one. The inflow at the plate is given as volume at P per area and time, so that its mass does not
//! depend on the pressure there; above the highest node p = 0. Where there are no particles there is no drag, and p is
//! constant.
//!
//! **Linear theory.** In a fixed bed p diffuses by D = P / ((1 - phi) R), R = beta / (1 - phi)^2. If the particles
//! follow the gas closely, the bed is a fluid of density rho_s phi in which sound has the speed
//!
//! ```math
//! c = \sqrt{\frac{P}{\rho_s \phi (1 - \phi)}}
//! ```
//!
//! (Roy et al. 1990). A bed of height H on a vibrated plate, open above, has its first resonance at f = c / (4 H),
//! where it contains a quarter of a wave (for standing waves see Herrera et al. 2002).
//!
//! **On the grid.** U is a value of each node k, p and 1 - phi are values of the intervals between nodes. The pressure
//! drop across a node is the force on the particles around it by hat weights, over the cross-section, so that the sum
//! of all drops is the gas force on all particles. The flux of solids through a node follows from the increase of the
//! solids in the intervals below it: with P -> infinity U is then exactly uniform. A step is one of the implicit Euler
//! method, with the pressure that carries the mass through nodes taken from its beginning. It leads to a tridiagonal
//! system of linear equations for U at all nodes.
//!
//! References:
//!
//! * Roy1990: R. Roy, J. F. Davidson, V. G. Tuponogov, "The velocity of sound in fluidised beds", Chem. Eng. Sci. 45 (1990) 3233-3245.
//! * Herrera2002: C. A. Herrera, E. K. Levy, J. Ochs, "Characteristics of acoustic standing waves in fluidized beds", AIChE J. 48
//!   (2002) 503-513.

use super::plenum::BedResistance;
use super::tridiagonal::Tridiagonal;

/// The gas in one interval of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnCell {
    /// p, pressure less that above the bed.
    pub pressure: f64,
    /// 1 - phi, volume of gas per volume.
    pub voidage: f64,
}

/// The gas force on the particles around each node, per cross-section: on those around node k it is
/// `at_rest`\[k\] + `coupling`\[k - 1\] U\[k - 1\] + `slope`\[k\] U\[k\] + `coupling`\[k\] U\[k + 1\].
#[derive(Clone, Debug)]
pub(super) struct NodeForces {
    pub(super) at_rest: Vec<f64>,
    pub(super) slope: Vec<f64>,
    /// Coupling with the next node.
    pub(super) coupling: Vec<f64>,
    /// Largest sum of the rounding errors of all particles' forces.
    pub(super) rounding: f64,
}

/// Largest number of iterations in a step if the drag depends on the Reynolds number; some 10 are usual.
const MOST_ITERATIONS: usize = 100;

impl NodeForces {
    fn around(&self, node: usize, velocity: &[f64]) -> f64 {
        let below = if node > 0 { self.coupling[node - 1] * velocity[node - 1] } else { 0.0 };
        let above = velocity.get(node + 1).map_or(0.0, |above| self.coupling[node] * above);
        self.at_rest[node] + below + self.slope[node] * velocity[node] + above
    }

    /// p below each node; for the lowest node it is the pressure on the plate.
    pub(super) fn pressures(&self, velocity: &[f64]) -> Vec<f64> {
        let mut below = vec![0.0; velocity.len()];
        let mut pressure = 0.0;
        for node in (0..velocity.len()).rev() {
            pressure += self.around(node, velocity);
            below[node] = pressure;
        }
        below
    }

    /// Upper bound of the change of the pressure on the plate due to a change of the velocities.
    pub(super) fn change(&self, from: &[f64], to: &[f64]) -> f64 {
        let change = |node: usize| (to[node] - from[node]).abs();
        let slope = |node: usize| {
            let below = if node > 0 { self.coupling[node - 1] } else { 0.0 };
            below + self.slope[node] + self.coupling.get(node).unwrap_or(&0.0)
        };
        (0..to.len()).map(|node| change(node) * slope(node)).sum()
    }
}

/// A step of the gas: the data that do not depend on the velocities at its end.
pub(super) struct CompressibleStep<'a> {
    /// P.
    ambient: f64,
    before: &'a [ColumnCell],
    /// 1 - phi in each interval at the end of the step.
    voidage: &'a [f64],
    /// dt / dz.
    rate: f64,
    /// phi u_s through each node.
    solids_flux: Vec<f64>,
    /// p at each node at the beginning of the step.
    carried: Vec<f64>,
}

impl<'a> CompressibleStep<'a> {
    /// A step with a length, given as dt / dz, from one state of the intervals to voidages at the end.
    pub(super) fn new(
        ambient: f64,
        before: &'a [ColumnCell],
        voidage: &'a [f64],
        rate: f64,
    ) -> Self {
        let mut solids_flux = vec![0.0]; // none through the plate
        let mut carried = vec![before[0].pressure];
        for (cell, &after) in voidage.iter().enumerate() {
            solids_flux.push(solids_flux[cell] + (after - before[cell].voidage) / rate);
            let above = before.get(cell + 1).map_or(0.0, |above| above.pressure);
            carried.push(0.5 * (before[cell].pressure + above));
        }
        Self { ambient, before, voidage, rate, solids_flux, carried }
    }

    /// U at each node at the end of the step, and the forces with the drag at these velocities. `forces_at` gives
    /// forces with the drag at any velocities; only if this drag depends on them are there iterations. `inflow` gives
    /// the inflow for given forces. `None` if the velocities do not settle to within the rounding of the forces on
    /// particles.
    ///
    /// Drag grows with a power of the velocity between 1 and 2. An error of the velocities may therefore change its
    /// sign and keep its magnitude from one iteration to the next, so every second iteration takes the mean.
    pub(super) fn settled(
        &self,
        repeats: bool,
        forces_at: impl Fn(&[f64]) -> NodeForces,
        inflow: impl Fn(&NodeForces) -> f64,
    ) -> Option<(Vec<f64>, NodeForces)> {
        let mut velocities = vec![0.0; self.before.len() + 1];
        for iteration in 0..MOST_ITERATIONS {
            let forces = forces_at(&velocities);
            let next = self.velocities(&forces, inflow(&forces));
            let on_plate = forces.pressures(&next)[0];
            let rounding = forces.rounding.max(1.0e-13 * on_plate.abs());
            if !repeats || forces.change(&velocities, &next) <= rounding {
                return Some((next, forces));
            }
            let part = if iteration % 2 == 0 { 1.0 } else { 0.5 };
            for (velocity, next) in velocities.iter_mut().zip(next) {
                *velocity += part * (next - *velocity);
            }
        }
        None
    }

    /// U at each node for a given inflow, as volume at P.
    ///
    /// The mass of an interval gives its pressure, p = `pressure_at_rest` - dt / (dz (1 - phi)) \[(P + p') U\], where
    /// the bracket is a difference between the ends of the interval and p' is the pressure carried there; the drop from
    /// one interval to the next is the force around the node.
    pub(super) fn velocities(&self, forces: &NodeForces, inflow: f64) -> Vec<f64> {
        let cells = self.before.len();
        let absolute = |node: usize| self.ambient + self.carried[node];
        let per_flux = |cell: usize| self.rate / self.voidage[cell];
        let on_plate = self.ambient * inflow / absolute(0);
        let mut system = Tridiagonal::with_capacity(cells);
        for node in 1..=cells {
            let below = forces.coupling[node - 1] - per_flux(node - 1) * absolute(node - 1);
            let mut here = forces.slope[node] + per_flux(node - 1) * absolute(node);
            let (mut above, mut drop) = (0.0, self.pressure_at_rest(node - 1));
            if node < cells {
                here += per_flux(node) * absolute(node);
                above = forces.coupling[node] - per_flux(node) * absolute(node + 1);
                drop -= self.pressure_at_rest(node);
            }
            let known = if node == 1 { below * on_plate } else { 0.0 };
            system.push([below, here, above], drop - forces.at_rest[node] - known);
        }
        let mut velocities = vec![on_plate];
        velocities.extend(system.solve());
        velocities
    }

    /// p on the plate as a function of the inflow.
    pub(super) fn resistance(&self, forces: &NodeForces) -> BedResistance {
        let on_plate = |inflow: f64| forces.pressures(&self.velocities(forces, inflow))[0];
        let at_rest = on_plate(0.0);
        BedResistance { at_rest, slope: on_plate(1.0) - at_rest }
    }

    /// p in an interval for U = 0.
    fn pressure_at_rest(&self, cell: usize) -> f64 {
        let carried = |node: usize| self.carried[node] * self.solids_flux[node];
        let held = self.before[cell].voidage * self.before[cell].pressure;
        (held + self.rate * (carried(cell + 1) - carried(cell))) / self.voidage[cell]
    }

    /// Outflow above, as volume at P.
    pub(super) fn outflow(&self, velocities: &[f64]) -> f64 {
        let top = self.before.len();
        let gas_flux = velocities[top] - self.solids_flux[top];
        (self.ambient + self.carried[top]) / self.ambient * gas_flux
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Forces around nodes for a given resistance in each interval, shared by hat weights of particles in its middle.
    fn forces(resistances: &[f64], at_rest: f64) -> NodeForces {
        let nodes = resistances.len() + 1;
        let mut slope = vec![0.0; nodes];
        for (cell, resistance) in resistances.iter().enumerate() {
            slope[cell] += 0.25 * resistance;
            slope[cell + 1] += 0.25 * resistance;
        }
        let coupling = resistances.iter().map(|resistance| 0.25 * resistance).collect();
        NodeForces { at_rest: vec![at_rest; nodes], slope, coupling, rounding: 0.0 }
    }

    proptest! {
        #[test]
        fn mass_closes_in_each_interval(
            cells in prop::collection::vec((-5.0..5.0f64, 0.2..1.0f64, 0.2..1.0f64, 0.0..10.0f64), 1..30),
            (inflow, at_rest, rate) in (-1.0..1.0f64, -0.1..0.1f64, 1.0e-4..1.0f64),
        ) {
            let ambient = 50.0;
            let before: Vec<_> =
                cells.iter().map(|&(pressure, voidage, ..)| ColumnCell { pressure, voidage }).collect();
            let voidage: Vec<_> = cells.iter().map(|it| it.2).collect();
            let forces = forces(&cells.iter().map(|it| it.3).collect::<Vec<_>>(), at_rest);
            let step = CompressibleStep::new(ambient, &before, &voidage, rate);
            let velocities = step.velocities(&forces, inflow);
            let after = &forces.pressures(&velocities)[1..];
            let mut entered = inflow * ambient;
            let mut scale = 1.0;
            for cell in 0..cells.len() {
                let node = cell + 1;
                let gas_flux = velocities[node] - step.solids_flux[node];
                let left = (ambient + step.carried[node]) * gas_flux;
                let held = before[cell].voidage * (ambient + before[cell].pressure);
                let holds = voidage[cell] * (ambient + after[cell]);
                scale = (ambient * velocities[node].abs() * rate).max(scale);
                // Sums of some tens of numbers of this size, each rounded.
                prop_assert!((holds - held - rate * (entered - left)).abs() < 1.0e-12 * scale * ambient);
                entered = left;
            }
            let out = step.outflow(&velocities) * ambient;
            prop_assert!((out - entered).abs() < 1.0e-13 * scale * ambient / rate);
        }
    }

    #[test]
    fn at_an_endless_pressure_the_velocity_is_uniform() {
        let before = [ColumnCell { pressure: 0.3, voidage: 0.4 }; 20];
        let voidage: Vec<_> = (0..20).map(|cell| 0.4 + 0.001 * f64::from(cell)).collect();
        let forces = forces(&[2.0; 20], 0.0);
        let spread = |ambient: f64| {
            let step = CompressibleStep::new(ambient, &before, &voidage, 1.0e-3);
            let velocities = step.velocities(&forces, 0.1);
            velocities.iter().map(|velocity| (velocity - 0.1).abs()).fold(0.0, f64::max)
        };
        // The difference is of first order in 1 / P, with a second order of 12 % at 1e6 and so of 0.1 % at 1e8.
        let [low, middle, high] = [1.0e6, 1.0e8, 1.0e10].map(spread);
        assert!(low > 1.0e-2 && (middle / high - 100.0).abs() < 2.0, "{low} {middle} {high}");
    }
}
