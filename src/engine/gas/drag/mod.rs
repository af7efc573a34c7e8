//! The drag laws: pure functions of solids fraction and Reynolds number. One file each, its `mod` line, and its line in
//! the registry.

mod agglomerates;
mod custom;
mod law;
#[macro_use]
mod registry;

mod beetstra;
mod di_felice;
mod ergun;
mod gidaspow;
mod particle_drag;
mod tenneti;
mod wen_yu;

pub use agglomerates::{AgglomerateBall, AgglomerateDrag};
pub use custom::{BlockDrag, CustomDragLaw};
pub use di_felice::SingleSphere;
pub use gidaspow::Switch;
pub use law::{DragCorrelation, RegisteredDragLaw};
pub use particle_drag::ParticleDrag;

// These lines define the enum `DragLaw`, its dispatch, the names that a case can choose from, the laws that the tests
// run over, and the table in docs/laws.md.
drag_laws! {
    "wen_yu" => wen_yu::WenYu,
    "wen_yu_creeping" => wen_yu::WenYuCreeping,
    "ergun" => ergun::Ergun,
    "gidaspow" => gidaspow::Gidaspow,
    "beetstra" => beetstra::Beetstra,
    "tenneti" => tenneti::Tenneti,
    "di_felice" => di_felice::DiFelice,
}

impl DragLaw {
    /// Wen & Yu with the usual exponent.
    pub const WEN_YU: Self = Self::WenYu(WenYu::USUAL);
    /// The limit of Wen & Yu at small Reynolds numbers.
    pub const WEN_YU_CREEPING: Self = Self::WenYuCreeping(WenYuCreeping::USUAL);
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

    /// The laws of the table's columns.
    fn tabulated() -> [DragLaw; 5] {
        let dallavalle = DiFelice { single_sphere: SingleSphere::Dallavalle };
        [DragLaw::WEN_YU, Ergun.into(), Beetstra.into(), Tenneti.into(), dallavalle.into()]
    }

    #[test]
    fn laws_give_their_tabulated_values() {
        for [phi, reynolds, expected @ ..] in TABLE {
            for (law, expected) in tabulated().into_iter().zip(expected) {
                let found = law.scaled_drag(phi, reynolds) / (1.0 - phi);
                // The table has five decimals.
                assert!((found - expected).abs() < 6.0e-6, "{law:?} at {phi}, {reynolds}: {found}");
            }
        }
    }

    #[test]
    fn every_law_of_the_registry_gives_examples_of_itself() {
        for name in DragLaw::NAMES {
            assert!(DragLaw::examples().iter().any(|law| law.name() == *name), "{name}");
        }
    }

    #[test]
    fn many_at_once_are_as_one_by_one() {
        for law in DragLaw::examples() {
            let (phi, reynolds) = ([0.0, 0.1, 0.64, 0.3], [0.0, 100.0, 3.0e-4, 2000.0]);
            let expected: [f64; 4] =
                std::array::from_fn(|lane| law.scaled_drag(phi[lane], reynolds[lane]));
            assert_eq!(law.scaled_drags(&phi, &reynolds), expected, "{law:?}");
        }
    }

    #[test]
    fn laws_that_deny_the_reynolds_number_do_not_use_it() {
        for law in DragLaw::examples() {
            let same = law.scaled_drag(0.3, 1.0) == law.scaled_drag(0.3, 50.0);
            assert_eq!(same, !law.depends_on_reynolds(), "{law:?}");
        }
    }

    #[test]
    fn misprints_in_circulation_are_seen() {
        // Tenneti's last term with phi^(1/3) in place of phi^3 differs by 29 % at phi = 0.6, Re = 100.
        let (phi, reynolds, eps) = (0.6_f64, 100.0, 0.4_f64);
        let right = Tenneti.scaled_drag(phi, reynolds) / eps;
        let misprint =
            right + phi.powi(3) * reynolds * 0.61 * (phi.cbrt() - phi.powi(3)) / (eps * eps);
        assert!((misprint / right - 1.29).abs() < 0.01, "{}", misprint / right);
        // Beetstra without eps in the Stokes drag to which F refers differs by a factor 1 / eps.
        let found = Beetstra.scaled_drag(phi, reynolds);
        assert!((found - 89.78942).abs() > 10.0);
    }

    #[test]
    fn drag_of_a_single_slow_sphere_is_that_of_stokes() {
        for law in DragLaw::examples() {
            let expected = match &law {
                DragLaw::Ergun(_) => 0.0, // for dense beds only
                DragLaw::DiFelice(DiFelice { single_sphere: SingleSphere::Dallavalle }) => 0.96,
                DragLaw::Gidaspow(Gidaspow { switch: Switch::Smooth }) => {
                    // The weight of Wen & Yu, since the rest is Ergun's drag, which is zero here.
                    libm::atan(150.0 * 1.75 * 0.2) / std::f64::consts::PI + 0.5
                }
                _ => 1.0,
            };
            // phi^(1/3) of the smallest number is not 0; all other terms vanish.
            assert!((law.scaled_drag(0.0, 0.0) - expected).abs() < 1.0e-12, "{law:?}");
        }
    }

    #[test]
    fn laws_are_finite_and_grow_with_reynolds_and_crowding() {
        for law in DragLaw::examples() {
            let mut previous = 0.0;
            for reynolds in [0.0, 1.0e-300, 1.0e-9, 1.0e-3, 1.0, 30.0, 999.0] {
                let found = law.scaled_drag(0.4, reynolds);
                // Di Felice's voidage function falls where its exponent does, but less than the sphere's drag grows.
                assert!(found.is_finite() && found >= previous, "{law:?} at {reynolds}: {found}");
                previous = found;
            }
            // Gidaspow's sharp switch jumps, so each range must lie within one law.
            for pair in [[0.25, 0.4], [0.4, 0.55], [0.55, 0.7]] {
                assert!(law.scaled_drag(pair[0], 1.0) < law.scaled_drag(pair[1], 1.0), "{law:?}");
            }
        }
    }
}
