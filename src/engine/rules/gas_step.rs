//! Limits for the step of the volume-averaged gas: advection and viscosity are explicit in time.

/// The largest [`step_number`] of a gas step.
pub const LARGEST_STEP_NUMBER: f64 = 1.0;

/// Rate whose product with the gas step is the Courant number C: the sum over axes of |u| / h, where u is the velocity
/// of the gas between the particles and h the cell size along each axis.
pub fn courant_rate(velocity: [f64; 3], cell_size: [f64; 3]) -> f64 {
    velocity.into_iter().zip(cell_size).map(|(velocity, size)| velocity.abs() / size).sum()
}

/// Rate whose product with the gas step is the viscous number V: a bound on the rate at which viscosity damps any
/// velocity on the grid,
///
/// ```math
/// \frac{16}{3}\, \frac{\mu}{\rho}\, \frac{1 + r}{2} \sum_a \frac{1}{h_a^2}
/// ```
///
/// 16 / 3 = 4 (4 / 3) comes from the shortest wave and the normal stresses. r >= 1 is the largest ratio of the voidages
/// of neighbouring cells, which enters as the ratio of the mean at an edge to the value in a face. mu is the viscosity
/// and rho the density of the gas, h the cell size along each axis; velocities do not vary along a periodic axis of one
/// cell.
pub fn viscous_rate(
    viscosity: f64,
    density: f64,
    voidage_ratio: f64,
    cell_size: [f64; 3],
    varies: [bool; 3],
) -> f64 {
    let curvature = |axis: usize| 1.0 / (cell_size[axis] * cell_size[axis]);
    let curvature: f64 = (0..3).filter(|&axis| varies[axis]).map(curvature).sum();
    16.0 / 3.0 * viscosity / density * (0.5 + 0.5 * voidage_ratio) * curvature
}

/// 2 C + V / 2, which must not exceed [`LARGEST_STEP_NUMBER`]: C and V are the Courant and the viscous number, or their
/// rates. 2 C is the limit of advection with the limiter, V / 2 that of the explicit viscous force.
pub fn step_number(courant: f64, viscous: f64) -> f64 {
    2.0 * courant + 0.5 * viscous
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_without_variation_does_not_limit_the_step() {
        let rate = |varies| viscous_rate(2.0, 4.0, 1.0, [0.5, 0.5, 0.25], varies);
        // (16 / 3) 0.5 (4 + 16) and with one axis of 4 more, in exact numbers up to rounding.
        assert!((rate([true, false, true]) - 160.0 / 3.0).abs() < 1.0e-12);
        assert!((rate([true, true, true]) - 64.0).abs() < 1.0e-12);
    }
}
