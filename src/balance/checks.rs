//! When cut planes move.

/// When cut planes move: ranks look at their loads when lists are rebuilt anyway, not before some steps have passed
/// since the last check. Where lists stay, ranks first check after that many steps of a run, whose loads nobody has measured yet,
/// then each time after twice as many as before, up to [`Balance::LATEST`] times the least number. Lists are then rebuilt only if loads
/// are so uneven that this saves more time than it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Least number of steps between checks.
    pub every: u64,
    /// Largest over mean time that ranks spend on their particles above which planes move.
    pub threshold: f64,
    last_look: u64,
    /// Most steps between the last check and the next.
    latest: u64,
}

impl Balance {
    /// Most steps between checks, over the fewest.
    pub const LATEST: u64 = 10;

    /// New lists take as long as so many steps: 10 to 15 in settled beds, 30 to 40 in agitated ones.
    const STEPS_FOR_LISTS: f64 = 20.0;

    /// The threshold where none is given. Planes that lie on faces of the gas's cells can only move by a layer of these, and with each
    /// layer goes a part of the gas, whose time is not counted: they move for more.
    pub fn usual_threshold(on_cells: bool) -> f64 {
        if on_cells { 1.05 } else { 1.01 }
    }

    /// From the least number of steps between checks, and the largest imbalance that is let be.
    pub fn new(every: u64, threshold: f64) -> Self {
        Self { every, threshold, last_look: 0, latest: every }
    }

    /// Whether to check although lists are not rebuilt.
    pub fn is_overdue(&self, step: u64) -> bool {
        step - self.last_look >= self.latest
    }

    /// Begins to count steps at the first of a run, which has early checks.
    pub fn begin(&mut self, step: u64) {
        *self = Self { last_look: step, ..Self::new(self.every, self.threshold) };
    }

    /// Whether to check at this step, if lists are rebuilt.
    pub fn look(&mut self, step: u64) -> bool {
        let due = step - self.last_look >= self.every;
        if due {
            self.last_look = step;
            self.latest = (2 * self.latest).min(Self::LATEST * self.every);
        }
        due
    }

    /// Whether loads of this imbalance, largest over mean, are uneven enough for planes to move. If lists would be rebuilt for nothing
    /// else, the imbalance must cost more steps until the next check than new lists take.
    pub fn are_uneven(&self, imbalance: f64, rebuilt_anyway: bool) -> bool {
        let saved = (imbalance - 1.0) * self.latest as f64; // steps
        imbalance > self.threshold && (rebuilt_anyway || saved > Self::STEPS_FOR_LISTS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_look_neither_too_often_nor_too_rarely() {
        let mut balance = Balance::new(100, 1.1);
        balance.begin(5000);
        assert!(!balance.is_overdue(5099) && balance.is_overdue(5100));
        assert!(!balance.look(5099) && balance.look(5100) && !balance.look(5199));
        assert!(!balance.is_overdue(5299) && balance.is_overdue(5300));
    }

    #[test]
    fn a_run_begins_with_early_looks() {
        let mut balance = Balance::new(100, 1.1);
        balance.begin(5000);
        let looks = (5000..10_000).filter(|&step| balance.is_overdue(step) && balance.look(step));
        assert_eq!(looks.collect::<Vec<_>>(), [5100, 5300, 5700, 6500, 7500, 8500, 9500]);
    }

    #[test]
    fn lists_are_made_for_planes_alone_only_if_that_pays() {
        let mut balance = Balance::new(100, 1.01);
        assert!(balance.are_uneven(1.011, true) && !balance.are_uneven(1.009, true));
        assert!(balance.are_uneven(1.21, false) && !balance.are_uneven(1.19, false));
        assert!(balance.look(100) && balance.look(300) && balance.look(700) && balance.look(1500));
        assert!(balance.are_uneven(1.021, false) && !balance.are_uneven(1.019, false));
        let lenient = Balance { threshold: 1.3, ..balance };
        assert!(!lenient.are_uneven(1.29, false) && lenient.are_uneven(1.31, false));
    }
}
