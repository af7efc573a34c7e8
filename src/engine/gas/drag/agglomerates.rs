//! Drag on a member of an agglomerate: that of a permeable ball among others like it, shared by volume.
//!
//! References:
//! * H. C. Brinkman, "A calculation of the viscous force exerted by a flowing fluid on a dense swarm of particles", Appl. Sci.
//!   Res. A1 (1947) 27-34, doi:10.1007/BF02120313: the drag of a permeable ball alone
//! * G. Neale, N. Epstein, W. Nader, "Creeping flow relative to permeable spheres", Chem. Eng. Sci. 28 (1973) 1865-1874,
//!   doi:10.1016/0009-2509(73)85070-5: the same, and swarms of such balls
//! * A. Castellanos, J. M. Valverde, M. A. S. Quintanilla, "Aggregation and sedimentation in gas-fluidized beds of cohesive
//!   powders", Phys. Rev. E 64 (2001) 041304, doi:10.1103/PhysRevE.64.041304: agglomerates hinder each other by the volume
//!   that they take, not by that of their solids

use super::ParticleDrag;
use std::f64::consts::PI;

/// Dependence of the drag on the agglomerates of the particles.
///
/// Agglomerates are found again at each search: connected sets of the pairs that touch now and touched at the previous
/// search (Liu et al. 2016).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AgglomerateDrag {
    /// Steps of the gas from one search to the next.
    pub every: u64,
    /// Sets of fewer particles are treated as single particles.
    pub smallest: u64,
}

/// The ball that represents an agglomerate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgglomerateBall {
    /// D; length.
    pub diameter: f64,
    /// phi_a, ratio of the volume of the members to that of the ball; above 0, and below 1 for more than one member.
    pub packing: f64,
}

impl AgglomerateBall {
    /// The ball with the mass and the moments of inertia of the members, which are treated as solid spheres:
    ///
    /// ```math
    /// \frac{D}{2} = \sqrt{\tfrac{5}{3} R^2 + r^2}, \qquad \phi_a = \frac{6 V}{\pi D^3}
    /// ```
    ///
    /// R is the radius of gyration of the members' centres, r the radius of a sphere with their mean volume, V the
    /// volume of all members. The ball of a single particle is the particle itself.
    pub fn of(radius_of_gyration: f64, member_radius: f64, volume: f64) -> Self {
        let square = 5.0 / 3.0 * radius_of_gyration.powi(2) + member_radius.powi(2);
        let diameter = 2.0 * square.sqrt();
        Self { diameter, packing: volume / (PI / 6.0 * diameter.powi(3)) }
    }
}

impl ParticleDrag {
    /// xi, the ratio of the drag on a member of an agglomerate to that of the law at the same place, above 0 and at
    /// most 1; both are per velocity difference. `diameter` is that of the member, `solids_fraction` is phi of the
    /// gas's cells, `slip` is U_s - u_s.
    ///
    /// ```math
    /// \xi = \min\!\left(1, \frac{\varepsilon}{b(d, \phi)}\, c\, \Omega(B)\right), \qquad
    /// c = \frac{d^3}{\phi_a D^3}\, \frac{b(D, \Phi)}{1 - \Phi}, \qquad \Phi = \frac{\phi}{\phi_a}, \qquad
    /// \Omega = \frac{2 B^2 (1 - \tanh B / B)}{2 B^2 + 3 (1 - \tanh B / B)}, \qquad
    /// B^2 = \frac{9}{2 c}\, \frac{b(d, \phi_a)}{1 - \phi_a}
    /// ```
    ///
    /// with b(d, phi) the drag of the law on a sphere of diameter d per difference of the velocities of gas and
    /// particle, and eps = 1 - phi, so that b / eps is the drag per superficial slip. c is the member's share, by
    /// volume, of the drag of solid balls of diameter D that fill the fraction Phi of the space: they hinder each other
    /// according to the law. Omega is Brinkman's factor for the flow through a ball, and B its radius over the root of
    /// its permeability: B^2 is 9/2 times the ratio of the drag of the members at their own packing, if all of the gas
    /// went through, to that of the solid ball. A ball alone has Brinkman's drag. The use of the balls' hindered drag
    /// in B where there are others is Talcum's own: all of the gas thus goes through where balls fill the space, and xi
    /// is 1 where phi reaches phi_a.
    ///
    /// Limits: a particle alone has xi = 1; many members in a compact ball alone have 6 pi mu D / 2 in all; members of
    /// a ball that the cells of the gas resolve (phi is phi_a in them) have xi = 1, since the gas itself then flows
    /// around it.
    #[inline(always)]
    pub fn factor_in_agglomerate(
        &self,
        diameter: f64,
        ball: &AgglomerateBall,
        solids_fraction: f64,
        slip: f64,
    ) -> f64 {
        let AgglomerateBall { diameter: large, packing } = *ball;
        let filled = solids_fraction / packing;
        // Members of very different sizes may give a ball that is too small for them: the drag of the law is then used
        // unchanged, as for undefined numbers.
        if !(filled < 1.0 && packing < 1.0) {
            return 1.0;
        }
        let share = (diameter / large).powi(3) / packing;
        let per_superficial =
            |size: f64, fraction: f64| self.per_velocity(size, fraction, slip) / (1.0 - fraction);
        let around = share * per_superficial(large, filled);
        let through = per_superficial(diameter, packing);
        let permeable = around * brinkman_factor((4.5 * through / around).sqrt());
        (permeable / per_superficial(diameter, solids_fraction)).min(1.0)
    }
}

/// Omega, ratio of the drag on a permeable ball to that on a solid one (Brinkman 1947): 2 B^2 / 9 for small B, 1 for
/// large B.
fn brinkman_factor(ratio: f64) -> f64 {
    let square = ratio * ratio;
    // The difference has lost its digits: its series, good to a part in 10^8 there.
    let inside = if ratio < 0.01 {
        square / 3.0 * (1.0 - 0.4 * square)
    } else {
        1.0 - libm::tanh(ratio) / ratio
    };
    2.0 * square * inside / (2.0 * square + 3.0 * inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::{DragLaw, DragShare};

    /// Drag on particles of diameter 1 in a gas of viscosity 1, whose density has no effect.
    fn creeping() -> ParticleDrag {
        ParticleDrag {
            law: DragLaw::WEN_YU_CREEPING,
            factor: 1.0,
            share: DragShare::Diameter,
            viscosity: 1.0,
            density: 1.0,
            parcel_size: 1.0,
        }
    }

    /// Ball of this number of particles of diameter 1 at a packing.
    fn ball(members: f64, packing: f64) -> AgglomerateBall {
        AgglomerateBall { diameter: libm::cbrt(members / packing), packing }
    }

    fn factor(of: &AgglomerateBall, solids_fraction: f64) -> f64 {
        creeping().factor_in_agglomerate(1.0, of, solids_fraction, 0.0)
    }

    #[test]
    fn a_value_computed_by_hand() {
        // 30 members at a packing of 0.4 alone: D = 75^(1/3) = 4.21716; c = D / 30 = 0.140572 and the drag through the
        // ball 0.6^-3.65 = 6.45280, both over 3 pi mu d; B^2 = 4.5 x 6.45280 / 0.140572 = 206.567,
        // 1 - tanh B / B = 0.930422, Omega = 0.924178.
        let found = factor(&ball(30.0, 0.4), 0.0);
        assert!((found - 0.129914).abs() < 2.0e-6, "{found}"); // six digits by hand
    }

    #[test]
    fn a_particle_alone_has_the_drag_of_the_law() {
        let single = AgglomerateBall::of(0.0, 0.5, PI / 6.0);
        assert!((single.diameter - 1.0).abs() < 1.0e-15 && (single.packing - 1.0).abs() < 1.0e-15);
        for phi in [0.0, 0.3, 0.6] {
            assert_eq!(factor(&AgglomerateBall { diameter: 1.0, packing: 1.0 }, phi), 1.0);
        }
    }

    /// Two touching spheres along their line of centres have 0.645 of their drag alone (Stimson & Jeffery 1926,
    /// doi:10.1098/rspa.1926.0053), and more across it.
    #[test]
    fn a_pair_has_nearly_the_drag_of_two_touching_spheres() {
        let pair = AgglomerateBall::of(0.5, 0.5, PI / 3.0);
        let found = factor(&pair, 0.0);
        assert!((0.645..0.75).contains(&found), "{found}");
        // Control: a solid ball would have more drag.
        let solid = 0.5 * pair.diameter;
        assert!(solid > 0.8, "{solid}");
    }

    #[test]
    fn a_ball_of_many_alone_has_the_drag_of_stokes() {
        for members in [1.0e3, 1.0e5, 1.0e7] {
            let ball = ball(members, 0.6);
            let of_stokes = ball.diameter / members;
            let found = factor(&ball, 0.0) / of_stokes;
            // The gas enters to a depth of about the root of the permeability, a fraction 1 / B of the radius.
            assert!(found < 1.0 && 1.0 - found < 0.5 / libm::cbrt(members), "{members}: {found}");
        }
    }

    #[test]
    fn where_balls_fill_the_space_the_gas_goes_through_them() {
        for members in [2.0, 30.0, 1.0e4] {
            let ball = ball(members, 0.4);
            let close = factor(&ball, 0.4 * (1.0 - 1.0e-6));
            assert!((close - 1.0).abs() < 1.0e-4, "{members}: {close}");
            assert_eq!(factor(&ball, 0.4), 1.0);
            assert_eq!(factor(&ball, 0.6), 1.0);
        }
    }

    #[test]
    fn the_factor_is_above_0_and_at_most_1_with_every_law() {
        for law in DragLaw::examples() {
            let drag = ParticleDrag { law, ..creeping() };
            for members in [2.0, 10.0, 1.0e3, 1.0e6] {
                for (packing, slip) in [(0.05, 0.0), (0.3, 1.0), (0.7, 50.0)] {
                    for phi in (0..70).map(|k| 0.01 * f64::from(k)) {
                        let ball = ball(members, packing);
                        let found = drag.factor_in_agglomerate(1.0, &ball, phi, slip);
                        let is_right = found > 0.0 && found <= 1.0;
                        // Ergun's law does not apply to single particles: its drag is 0 without solids and slip.
                        let has_law = drag.per_velocity(1.0, phi, slip) > 0.0;
                        assert!(is_right || !has_law, "{:?} {ball:?} {phi}: {found}", drag.law);
                    }
                }
            }
        }
    }

    #[test]
    fn small_arguments_of_the_factor_of_brinkman_lose_no_digits() {
        let (below, above) = (brinkman_factor(0.01 * (1.0 - 1.0e-9)), brinkman_factor(0.01));
        // The difference 1 - tanh B / B has a part in 10^12 of its digits there.
        assert!((above / below - 1.0).abs() < 1.0e-7, "{below} {above}");
        assert!((brinkman_factor(1.0e-4) / (2.0e-8 / 9.0) - 1.0).abs() < 1.0e-7);
        assert!((brinkman_factor(1.0e6) - 1.0).abs() < 2.0e-6);
    }
}
