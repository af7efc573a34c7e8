//! Drag laws from outside the crate.

use super::{DragCorrelation, DragLaw};
use crate::numbers::vectorised;
use std::fmt::Debug;
use std::sync::Arc;

/// A drag law whose type is not known to the crate. It is called once per block of particles.
#[derive(Clone, Debug)]
pub struct CustomDragLaw {
    name: Arc<str>,
    law: Arc<dyn BlockDrag>,
}

/// A drag law that can be called once per block of particles. Every [`DragCorrelation`] whose type is `Send`, `Sync`
/// and `Debug` implements it; there can be no other implementation.
pub trait BlockDrag: DragCorrelation + Send + Sync + Debug {
    /// Replaces the Reynolds numbers by eps F.
    #[doc(hidden)]
    fn evaluate_block(&self, solids_fraction: &[f64], reynolds: &mut [f64]);
}

impl<L: DragCorrelation + Send + Sync + Debug> BlockDrag for L {
    fn evaluate_block(&self, solids_fraction: &[f64], reynolds: &mut [f64]) {
        scale_drags(self, solids_fraction, reynolds);
    }
}

/// Number of lanes for a law from outside the crate, whatever the length of the caller's block.
const LANES: usize = 32;

vectorised!(
    fn scale_drags(law: &impl DragCorrelation, solids_fraction: &[f64], reynolds: &mut [f64]) {
        let (full, rest) = reynolds.as_chunks_mut::<LANES>();
        let (full_fractions, other_fractions) = solids_fraction.as_chunks::<LANES>();
        for (numbers, fractions) in full.iter_mut().zip(full_fractions) {
            *numbers = law.scaled_drags(fractions, numbers);
        }
        for (number, &fraction) in rest.iter_mut().zip(other_fractions) {
            *number = law.scaled_drag(fraction, *number);
        }
    }
);

impl CustomDragLaw {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl DragCorrelation for CustomDragLaw {
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        self.law.scaled_drag(solids_fraction, reynolds)
    }

    fn scaled_drags<const N: usize>(
        &self,
        solids_fraction: &[f64; N],
        reynolds: &[f64; N],
    ) -> [f64; N] {
        let mut scaled = *reynolds;
        self.law.evaluate_block(solids_fraction, &mut scaled);
        scaled
    }

    fn depends_on_reynolds(&self) -> bool {
        self.law.depends_on_reynolds()
    }
}

/// Two are equal if they are the same object; equal parameters do not suffice, since they are not known here.
impl PartialEq for CustomDragLaw {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.law, &other.law)
    }
}

impl DragLaw {
    /// A law from outside the crate, with a name for messages and files.
    pub fn custom(name: &str, law: impl BlockDrag + 'static) -> Self {
        Self::Custom(CustomDragLaw { name: name.into(), law: Arc::new(law) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::WenYuCreeping;

    /// Stokes drag of a single sphere.
    #[derive(Debug)]
    struct Stokes;

    impl DragCorrelation for Stokes {
        fn scaled_drag(&self, _solids_fraction: f64, _reynolds: f64) -> f64 {
            1.0
        }

        fn depends_on_reynolds(&self) -> bool {
            false
        }
    }

    #[test]
    fn own_answer_on_the_reynolds_number_is_used() {
        assert!(!DragLaw::custom("stokes", Stokes).depends_on_reynolds());
        // Negative control: a registered law without this dependence, and one with it.
        assert!(!DragLaw::WEN_YU_CREEPING.depends_on_reynolds());
        assert!(DragLaw::WEN_YU.depends_on_reynolds());
    }

    #[test]
    fn custom_laws_give_the_bits_of_registered_ones() {
        let phi: [f64; 40] = std::array::from_fn(|lane| 0.016 * lane as f64);
        let reynolds: [f64; 40] = std::array::from_fn(|lane| 0.3 * (lane * lane) as f64);
        for law in DragLaw::examples() {
            let expected = law.scaled_drags(&phi, &reynolds);
            let custom = match law {
                DragLaw::WenYu(law) => DragLaw::custom("own", law),
                DragLaw::WenYuCreeping(law) => DragLaw::custom("own", law),
                DragLaw::Tenneti(law) => DragLaw::custom("own", law),
                _ => continue,
            };
            assert_eq!(custom.scaled_drags(&phi, &reynolds), expected);
        }
        let other = DragLaw::custom("own", WenYuCreeping { exponent: 2.0 });
        assert_ne!(other.scaled_drag(0.4, 1.0), DragLaw::WEN_YU_CREEPING.scaled_drag(0.4, 1.0));
    }
}
