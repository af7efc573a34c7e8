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

    /// Least number of steps between two looks at which processor time is read, if there are as many.
    const LEAST_TIMED: u64 = 16;

    /// From the least number of steps between looks, and the largest imbalance that is let be.
    pub fn new(every: u64, threshold: f64) -> Self {
        Self { every, threshold, last_look: 0 }
    }

    /// Whether processor time is read at this step, on all ranks. Reading it is a call of the operating system, which takes
    /// 0.2 to 0.7 us, ten times a step: at all steps it would be a tenth of the time of a rank with a thousand particles.
    pub fn is_timed(&self, step: u64) -> bool {
        step.is_multiple_of((self.every / Self::LEAST_TIMED).max(1))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_steps_or_more_are_timed_between_two_looks() {
        for every in [16, 100, 1000] {
            let balance = Balance::new(every, 1.1);
            for look in [0, 7 * every] {
                let timed = (look..look + every).filter(|&step| balance.is_timed(step)).count();
                assert!((16..32).contains(&timed), "{every}: {timed}");
            }
        }
        let frequent = Balance::new(3, 1.1);
        assert!((0..10).all(|step| frequent.is_timed(step)));
    }
}
