//! Systems of units that a case may be in.

/// The coherent system of units that all numbers of a case are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Metre, kilogram, second.
    Si,
    /// Solid density rho_s, reference diameter d and gravity g are 1.
    Dimensionless,
}

impl Units {
    /// All, by the words that the case file uses.
    pub(super) const ALL: [(&str, Self); 2] =
        [("si", Self::Si), ("dimensionless", Self::Dimensionless)];

    /// The word that the case file uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "si",
            Self::Dimensionless => "dimensionless",
        }
    }
}
