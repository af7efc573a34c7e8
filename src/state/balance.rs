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

    /// From the least number of steps between looks, and the largest imbalance that is let be.
    pub fn new(every: u64, threshold: f64) -> Self {
        Self { every, threshold, last_look: 0 }
    }

    /// Whether to look although lists are not rebuilt.
    pub fn is_overdue(&self, step: u64) -> bool {
        step - self.last_look >= Self::LATEST * self.every
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
