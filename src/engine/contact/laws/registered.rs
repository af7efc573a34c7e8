//! Properties of a law of the registry: its keys in the case file, and examples for tests.

use crate::contact::{CoarseGraining, ContactForceLaw, Elasticity, InvalidContactLaw};
use crate::schema::{Allowed, Key, KeyValues, Mixing};

/// `restitution`, a key of every law.
pub const RESTITUTION: Key = Key::number(
    "restitution",
    Allowed::FRACTION,
    "Coefficient of restitution e of the dashpots; plasticity and adhesion dissipate more",
)
.mixed(Mixing::Geometric);

/// `friction`, a key of every law.
pub const FRICTION: Key =
    Key::number("friction", Allowed::NOT_NEGATIVE, "Coefficient mu of sliding friction")
        .mixed(Mixing::Geometric);

/// A law of the registry. The tests of oddness, of energy over closed loops, and of equal bits on any ranks run over
/// its examples.
pub trait RegisteredContactLaw: ContactForceLaw + Sized {
    /// Meaning of the law, for the manual.
    const MEANING: &'static str;

    /// Its keys in the case file, besides [`RESTITUTION`] and [`FRICTION`].
    const KEYS: &'static [Key];

    /// Its adhesion.
    const ADHESION: Adhesion = Adhesion { keys: &[], replaces_cohesion: false };

    /// Exponent n of the overlap to which the normal force of first loading is proportional.
    const OVERLAP_EXPONENT: f64 = 1.0;

    /// This law for bodies whose stiffnesses are larger by a factor, with the same adhesion and restitution.
    #[must_use]
    fn stiffened(&self, factor: f64) -> Self;

    /// This law with its own adhesion scaled such that the work of separation is the one of
    /// [`stiffened`](Self::stiffened) bodies ([`adhesion_factor`](crate::rules::adhesion_factor)). The law is unchanged
    /// if it has no adhesion, or one that is a stiffness.
    #[must_use]
    fn keeping_work(&self, reduction: f64) -> Self;

    /// This law for parcels: at l times the overlap and the radius all forces are multiplied by the factor of
    /// [`CoarseGraining`].
    #[must_use]
    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self;

    /// The law with these values; `None` if one is missing or wrong.
    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>>;

    /// Example laws of these scales, with friction of about 0.4: at least one, and more if the law has regimes that
    /// differ, such as adhesion with and without a limit.
    fn examples(scales: ExampleScales) -> Vec<Self>;
}

/// The adhesion that a law includes.
#[derive(Clone, Copy, Debug)]
pub struct Adhesion {
    /// The keys of its strength, whose values walls do not inherit from particles; empty without adhesion.
    pub keys: &'static [&'static str],
    /// Whether it excludes van der Waals cohesion.
    pub replaces_cohesion: bool,
}

/// The values of a law's keys, and other data of the case.
pub trait ContactLawValues: KeyValues {
    /// Reports a missing key if it is not given: for keys that are required under a condition.
    fn require(&self, key: &'static str);

    /// Reports the default of a key that is not given.
    fn note_default(&self, key: &'static str);

    /// Reports an error of a key.
    fn fail(&self, key: &'static str, message: String);

    /// Whether there is van der Waals cohesion.
    fn is_cohesive(&self) -> bool;

    /// Whether units are SI.
    fn is_si(&self) -> bool;

    /// Elastic constants of the other body, if its material is different.
    fn other_body(&self) -> Option<Elasticity>;

    /// The attraction with this Bond number at the reference diameter; force. Without gravity an error is reported at
    /// `key`, which proposes the key `instead`.
    fn attraction_of_bond_number(
        &self,
        bond_number: f64,
        key: &'static str,
        instead: &'static str,
    ) -> Option<f64>;
}

/// The scales of a test, in its units.
#[derive(Clone, Copy, Debug)]
pub struct ExampleScales {
    /// Approximate normal stiffness, force per overlap.
    pub stiffness: f64,
    /// Overlap of a strong contact. Adhesive forces are about a third of `stiffness` times it.
    pub overlap: f64,
    /// Restitution coefficient of the dashpots; 1 for none.
    pub restitution: f64,
}
