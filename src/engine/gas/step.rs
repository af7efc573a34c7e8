//! A step of the gas: its time, and a report on it.

/// Time, length and gravity of a step of the gas.
#[derive(Clone, Copy, Debug)]
pub struct GasStep {
    /// Time at its beginning.
    pub time: f64,
    /// Its length.
    pub dt: f64,
    /// Downward acceleration.
    pub gravity: f64,
}

/// Report on the last step of a gas on cells, over all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GasReport {
    /// Iterations of the pressure equation.
    pub iterations: u64,
    /// Number of cells whose voidage was raised to the smallest one.
    pub raised_cells: u64,
    /// Courant number.
    pub courant: f64,
    /// Largest component of the difference between the force on particles and the force that the gas loses at its
    /// faces.
    pub momentum_error: f64,
}
