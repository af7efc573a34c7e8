//! A step of the gas: when it is, and how it went.

/// When and how long a step of the gas is.
#[derive(Clone, Copy, Debug)]
pub struct GasStep {
    /// Time at its beginning.
    pub time: f64,
    /// Its length.
    pub dt: f64,
    /// Downward acceleration.
    pub gravity: f64,
}

/// How the last step of a gas on cells went, over all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GasReport {
    /// Iterations of the pressure equation.
    pub iterations: u64,
    /// Cells whose voidage was raised to the least one.
    pub raised_cells: u64,
    /// Courant number.
    pub courant: f64,
    /// Largest component of the force on particles less what the gas loses at its faces.
    pub momentum_error: f64,
}
