//! Systems of units for a case.

/// The coherent system of units of all numbers of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Metre, kilogram, second.
    Si,
    /// The system in which solid density rho_s, reference diameter d and gravity g are 1.
    Dimensionless,
}

impl Units {
    /// All systems, with their names in the case file.
    pub(super) const ALL: [(&str, Self); 2] =
        [("si", Self::Si), ("dimensionless", Self::Dimensionless)];

    /// Its name in the case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "si",
            Self::Dimensionless => "dimensionless",
        }
    }
}
