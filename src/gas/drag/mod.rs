//! Drag laws: pure functions of solids fraction and Reynolds number, one file each.

mod beetstra;
mod di_felice;
mod ergun;
mod gidaspow;
mod particle_drag;
mod tenneti;
mod wen_yu;

pub use beetstra::Beetstra;
pub use di_felice::{DiFelice, SingleSphere};
pub use ergun::Ergun;
pub use gidaspow::{Gidaspow, Switch};
pub use particle_drag::ParticleDrag;
pub use tenneti::Tenneti;
pub use wen_yu::{WenYu, WenYuCreeping};

/// Drag of a suspension over the Stokes drag of a single sphere:
/// F = F_d / (3 pi mu d eps |u_g - v|), eps = 1 - phi, Re = eps rho_g d |u_g - v| / mu.
///
/// F_d is the drag beside the force of the mean pressure gradient (model A). The momentum transfer per volume is
/// beta = 18 mu eps phi F / d^2, and the force per particle (V / phi) beta (u_g - v) = 3 pi mu d eps F (u_g - v).
pub trait DragCorrelation: Copy {
    /// eps F at a solids fraction in [0, 1) and a Reynolds number >= 0.
    fn scaled_drag(self, solids_fraction: f64, reynolds: f64) -> f64;

    /// The same for many at once, in vector instructions.
    #[inline(always)]
    fn scaled_drags<const N: usize>(
        self,
        solids_fraction: &[f64; N],
        reynolds: &[f64; N],
    ) -> [f64; N] {
        let mut scaled = [0.0; N];
        for lane in 0..N {
            scaled[lane] = self.scaled_drag(solids_fraction[lane], reynolds[lane]);
        }
        scaled
    }

    /// Whether the drag depends on the Reynolds number: if not, gas forces are linear in the velocities.
    fn depends_on_reynolds(self) -> bool {
        true
    }
}

/// The drag laws that a case can choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DragLaw {
    /// Wen & Yu.
    WenYu(WenYu),
    /// Its limit at small Reynolds numbers.
    WenYuCreeping(WenYuCreeping),
    /// Ergun.
    Ergun(Ergun),
    /// Ergun in dense, Wen & Yu in dilute suspensions.
    Gidaspow(Gidaspow),
    /// Beetstra, van der Hoef & Kuipers.
    Beetstra(Beetstra),
    /// Tenneti, Garg & Subramaniam.
    Tenneti(Tenneti),
    /// Di Felice.
    DiFelice(DiFelice),
}

impl DragLaw {
    /// Wen & Yu with their own exponent.
    pub const WEN_YU: Self = Self::WenYu(WenYu::USUAL);
    /// Its limit at small Reynolds numbers.
    pub const WEN_YU_CREEPING: Self = Self::WenYuCreeping(WenYuCreeping::USUAL);
}

/// Calls a function of whichever law it is.
macro_rules! each_law {
    ($drag:expr, $law:ident => $call:expr) => {
        match $drag {
            DragLaw::WenYu($law) => $call,
            DragLaw::WenYuCreeping($law) => $call,
            DragLaw::Ergun($law) => $call,
            DragLaw::Gidaspow($law) => $call,
            DragLaw::Beetstra($law) => $call,
            DragLaw::Tenneti($law) => $call,
            DragLaw::DiFelice($law) => $call,
        }
    };
}

impl DragCorrelation for DragLaw {
    #[inline(always)]
    fn scaled_drag(self, solids_fraction: f64, reynolds: f64) -> f64 {
        each_law!(self, law => law.scaled_drag(solids_fraction, reynolds))
    }

    /// The law is chosen once, so that the loop holds no branch.
    #[inline(always)]
    fn scaled_drags<const N: usize>(
        self,
        solids_fraction: &[f64; N],
        reynolds: &[f64; N],
    ) -> [f64; N] {
        each_law!(self, law => law.scaled_drags(solids_fraction, reynolds))
    }

    fn depends_on_reynolds(self) -> bool {
        !matches!(self, Self::WenYuCreeping(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// phi, Re, and F of Wen-Yu, Ergun, Beetstra, Tenneti, Di Felice with Dallavalle's sphere: computed from the
    /// published formulas by other means, with six digits.
    const TABLE: [[f64; 7]; 8] = [
        [0.1, 1.0, 1.68932, 1.14883, 2.49816, 2.71501, 1.77433],
        [0.1, 100.0, 6.68220, 13.03155, 8.55375, 7.47152, 7.13658],
        [0.3, 1.0, 4.22756, 5.30045, 7.05609, 9.79927, 4.26420],
        [0.3, 100.0, 16.72232, 24.94331, 19.68823, 22.33773, 15.65729],
        [0.5, 1.0, 14.43635, 17.05556, 20.53869, 38.69250, 13.79351],
        [0.5, 100.0, 57.10366, 55.55556, 50.41343, 81.41416, 44.82992],
        [0.6, 1.0, 32.59709, 31.85764, 37.86540, 88.63494, 30.04634],
        [0.6, 100.0, 128.93935, 92.01389, 89.78942, 179.66696, 90.06275],
    ];

    const LAWS: [DragLaw; 5] = [
        DragLaw::WEN_YU,
        DragLaw::Ergun(Ergun),
        DragLaw::Beetstra(Beetstra),
        DragLaw::Tenneti(Tenneti),
        DragLaw::DiFelice(DiFelice { single_sphere: SingleSphere::Dallavalle }),
    ];

    #[test]
    fn laws_give_their_tabulated_values() {
        for [phi, reynolds, expected @ ..] in TABLE {
            for (law, expected) in LAWS.into_iter().zip(expected) {
                let found = law.scaled_drag(phi, reynolds) / (1.0 - phi);
                // The table has five decimals.
                assert!((found - expected).abs() < 6.0e-6, "{law:?} at {phi}, {reynolds}: {found}");
            }
        }
    }

    #[test]
    fn many_at_once_are_as_one_by_one() {
        let creeping = [DragLaw::WEN_YU_CREEPING];
        for law in LAWS.into_iter().chain(creeping) {
            let (phi, reynolds) = ([0.0, 0.1, 0.64, 0.3], [0.0, 100.0, 3.0e-4, 2000.0]);
            let expected: [f64; 4] =
                std::array::from_fn(|lane| law.scaled_drag(phi[lane], reynolds[lane]));
            assert_eq!(law.scaled_drags(&phi, &reynolds), expected, "{law:?}");
        }
    }

    #[test]
    fn misprints_in_circulation_are_seen() {
        // Tenneti's last term with phi^(1/3) in the place of phi^3: 29 % at phi = 0.6, Re = 100.
        let (phi, reynolds, eps) = (0.6_f64, 100.0, 0.4_f64);
        let right = Tenneti.scaled_drag(phi, reynolds) / eps;
        let misprint =
            right + phi.powi(3) * reynolds * 0.61 * (phi.cbrt() - phi.powi(3)) / (eps * eps);
        assert!((misprint / right - 1.29).abs() < 0.01, "{}", misprint / right);
        // Beetstra without eps in the Stokes drag that F refers to: a factor 1 / eps.
        let found = Beetstra.scaled_drag(phi, reynolds);
        assert!((found - 89.78942).abs() > 10.0);
    }

    #[test]
    fn all_laws_but_ergun_become_stokes_for_a_single_slow_sphere() {
        let schiller = DiFelice { single_sphere: SingleSphere::SchillerNaumann };
        let gidaspow = Gidaspow { switch: Switch::Sharp };
        let exact = [DragLaw::WEN_YU, DragLaw::WEN_YU_CREEPING, DragLaw::Beetstra(Beetstra)];
        let others = [DragLaw::DiFelice(schiller), DragLaw::Gidaspow(gidaspow)];
        for law in exact.into_iter().chain(others).chain([DragLaw::Tenneti(Tenneti)]) {
            // phi^(1/3) of the smallest number is not 0; nothing else is left.
            assert!((law.scaled_drag(0.0, 0.0) - 1.0).abs() < 1.0e-12, "{law:?}");
        }
        assert_eq!(Ergun.scaled_drag(0.0, 0.0), 0.0);
        // Dallavalle's sphere has 24 / 25 of Stokes' drag.
        assert!((LAWS[4].scaled_drag(0.0, 0.0) - 0.96).abs() < 1.0e-12);
    }

    #[test]
    fn laws_are_finite_and_grow_with_reynolds_and_crowding() {
        let gidaspow = [Switch::Smooth, Switch::Sharp].map(|switch| Gidaspow { switch });
        let all = LAWS.into_iter().chain(gidaspow.map(DragLaw::Gidaspow));
        for law in all {
            let mut previous = 0.0;
            for reynolds in [0.0, 1.0e-300, 1.0e-9, 1.0e-3, 1.0, 30.0, 999.0] {
                let found = law.scaled_drag(0.4, reynolds);
                // Di Felice's crowding falls where its exponent does, by less than the sphere's drag grows.
                assert!(found.is_finite() && found >= previous, "{law:?} at {reynolds}: {found}");
                previous = found;
            }
            // Gidaspow's sharp switch jumps, so only where one law holds.
            for pair in [[0.25, 0.4], [0.4, 0.55], [0.55, 0.7]] {
                assert!(law.scaled_drag(pair[0], 1.0) < law.scaled_drag(pair[1], 1.0), "{law:?}");
            }
        }
    }
}
