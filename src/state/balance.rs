//! When cut planes move.

/// When cut planes move: ranks look at their loads when lists are rebuilt anyway, not before some steps have passed
/// since the last look, and at the latest after [`Balance::LATEST`] times as many: lists are then rebuilt only if the loads
/// are uneven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Least number of steps between looks.
    pub every: u64,
    /// Largest over mean time that ranks spend on their particles above which planes move.
    pub threshold: f64,
    last_look: u64,
}

impl Balance {
    /// Most steps between looks, over the fewest.
    pub const LATEST: u64 = 10;

    /// The threshold where none is given. Planes that lie on faces of the gas's cells can only move by a layer of these, and with each
    /// layer goes a part of the gas, whose time is not counted: they move for more.
    pub fn usual_threshold(on_cells: bool) -> f64 {
        if on_cells { 1.05 } else { 1.02 }
    }

    /// From the least number of steps between looks, and the largest imbalance that is let be.
    pub fn new(every: u64, threshold: f64) -> Self {
        Self { every, threshold, last_look: 0 }
    }

    /// Whether to look although lists are not rebuilt.
    pub fn is_overdue(&self, step: u64) -> bool {
        step - self.last_look >= Self::LATEST * self.every
    }

    /// Begins to count steps at the first of a run.
    pub fn begin(&mut self, step: u64) {
        self.last_look = step;
    }

    /// Whether to look at this step, if lists are rebuilt.
    pub fn look(&mut self, step: u64) -> bool {
        let due = step - self.last_look >= self.every;
        if due {
            self.last_look = step;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_look_neither_too_often_nor_too_rarely() {
        let mut balance = Balance::new(100, 1.1);
        balance.begin(5000);
        assert!(!balance.is_overdue(5999) && balance.is_overdue(6000));
        assert!(!balance.look(5099) && balance.look(5100) && !balance.look(5199));
        assert!(!balance.is_overdue(6099) && balance.is_overdue(6100));
    }
}
