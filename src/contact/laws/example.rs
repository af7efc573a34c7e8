//! Examples that the laws give of themselves, so that tests run over all of them.

use crate::contact::ContactForceLaw;

/// A law that gives examples of itself. Every law of the registry does: the tests of oddness, of energy over closed
/// loops, and of equal bits on any ranks run over these.
pub trait ExampleContactLaw: ContactForceLaw + Sized {
    /// At least one law of these scales, with friction of about 0.4; more than one if the law has regimes that differ,
    /// such as adhesion with and without a limit.
    fn examples(scales: ExampleScales) -> Vec<Self>;
}

/// The scales of a test, in its units.
#[derive(Clone, Copy, Debug)]
pub struct ExampleScales {
    /// Normal stiffness, force per overlap, about.
    pub stiffness: f64,
    /// Overlap of a strong contact. Adhesive forces are about a third of `stiffness` times it.
    pub overlap: f64,
    /// Restitution coefficient of the dashpots; 1 for none.
    pub restitution: f64,
}
