//! One particle and two, compared with closed forms: MFiX DEM01 to DEM06 by name (Garg et al., Powder Technol. 220
//! (2012) 122), impacts, cohesion, and the gas. Each test has a negative control.

mod cohesive_impact;
mod drag;
mod falling;
mod impact;
mod kharaz;
mod rolling;
mod softened;
mod stacked;

/// |b| of the damped oscillator: gamma_n / (2 sqrt(k m*)) for a restitution coefficient.
///
/// Dashpots act at velocities half a step old, which is an added mass of b omega_0 dt: the relative error,
/// of first order, that most tolerances for e < 1 come from.
fn damping_ratio(restitution: f64) -> f64 {
    let log = restitution.ln();
    -log / (std::f64::consts::PI.powi(2) + log * log).sqrt()
}
