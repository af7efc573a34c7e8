//! The schedule by which cut planes move.

/// Schedule by which cut planes move. Ranks check their loads when lists are rebuilt anyway, but only after a least
/// number of steps since the last check. Where lists are kept for long, ranks first check after this number of steps of
/// a run, when no loads have been measured yet. After that they wait twice as long each time, up to [`Balance::LATEST`]
/// times the least number. Lists are then rebuilt only if the loads are so uneven that this saves more time than it
/// takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Least number of steps between checks.
    pub every: u64,
    /// Ratio of the largest to the mean time that ranks spend on their particles; planes move above it.
    pub threshold: f64,
    last_look: u64,
    /// Largest number of steps between the last check and the next.
    latest: u64,
}

impl Balance {
    /// Ratio of the largest to the least number of steps between checks.
    pub const LATEST: u64 = 10;

    /// Cost of new lists, in steps: 10 to 15 in settled beds, 30 to 40 in agitated ones.
    const STEPS_FOR_LISTS: f64 = 20.0;

    /// Default threshold. Planes that lie on faces of the gas's cells can only move by a layer of cells. Each layer
    /// takes a part of the gas with it, whose time is not counted. Such planes therefore need a larger imbalance to
    /// move.
    pub fn usual_threshold(on_cells: bool) -> f64 {
        if on_cells { 1.05 } else { 1.01 }
    }

    /// A schedule with this least number of steps between checks, and this largest imbalance that is tolerated.
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

    /// Whether to check at this step, provided that lists are rebuilt.
    pub fn look(&mut self, step: u64) -> bool {
        let due = step - self.last_look >= self.every;
        if due {
            self.last_look = step;
            self.latest = (2 * self.latest).min(Self::LATEST * self.every);
        }
        due
    }

    /// Whether loads of this imbalance, largest over mean, are uneven enough for planes to move. If lists would be
    /// rebuilt for this purpose only, the imbalance must cost more time until the next check than new lists take.
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
