//! Sources and sinks of energy, by mechanism.

use crate::numbers::ExactSum;
use crate::parallel::Communicator;

/// A mechanism that does work on the particles, other than the springs, whose energy is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mechanism {
    /// Normal and tangential dashpots.
    Dashpot,
    /// Sliding friction.
    Friction,
    /// Plastic deformation: the hysteresis loops of springs.
    Plasticity,
    /// Cohesion, unless its energy is counted as stored: necks that form at once.
    Cohesion,
    /// The gas: drag and pressure gradient.
    Gas,
    /// Walls that move.
    Walls,
    /// Weight, unless its energy is counted as stored.
    Gravity,
    /// Changes of the models: a ramped attraction, a stage with other laws.
    Models,
    /// Kinetic energy of particles that leave through open faces.
    Departed,
}

impl Mechanism {
    /// All mechanisms, in the order of the ledger.
    pub const ALL: [Self; 9] = [
        Self::Dashpot,
        Self::Friction,
        Self::Plasticity,
        Self::Cohesion,
        Self::Gas,
        Self::Walls,
        Self::Gravity,
        Self::Models,
        Self::Departed,
    ];

    /// The name of a column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dashpot => "dashpot",
            Self::Friction => "friction",
            Self::Plasticity => "plasticity",
            Self::Cohesion => "cohesion",
            Self::Gas => "gas",
            Self::Walls => "walls",
            Self::Gravity => "gravity",
            Self::Models => "models",
            Self::Departed => "departed",
        }
    }
}

/// The energy of the particles at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StoredEnergy {
    /// Energy of translation and rotation.
    pub kinetic: f64,
    /// Potential energy of the weight and of attraction.
    pub potential: f64,
    /// Energy stored in springs.
    pub elastic: f64,
}

impl StoredEnergy {
    /// Sum of the three energies.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential + self.elastic
    }
}

/// Energy of the particles of this rank at an instant, in exact sums: each pair is counted on one rank.
#[derive(Clone, Debug, Default)]
pub struct StoredSums {
    /// Energy of translation and rotation.
    pub kinetic: ExactSum,
    /// Potential energy of attraction.
    pub potential: ExactSum,
    /// Energy stored in springs.
    pub elastic: ExactSum,
}

impl StoredSums {
    /// Sums over all ranks. Collective.
    pub fn total(&self, ranks: &dyn Communicator) -> StoredEnergy {
        let sums = [&self.kinetic, &self.potential, &self.elastic];
        let mut integers: Vec<i64> = sums.into_iter().flat_map(ExactSum::to_integers).collect();
        ranks.sum_integers(&mut integers);
        let mut sums = integers.chunks_exact(ExactSum::INTEGERS).map(ExactSum::from_integers);
        let mut next = || sums.next().map_or(0.0, |sum| sum.value());
        StoredEnergy { kinetic: next(), potential: next(), elastic: next() }
    }
}

/// Work done on the particles of this rank, summed exactly: totals do not depend on the number of ranks.
#[derive(Clone, Debug, Default)]
pub struct EnergyLedger {
    work: [ExactSum; Mechanism::ALL.len()],
    /// Power times the step at the last evaluation of forces; half of it belongs to the step that follows.
    last: [ExactSum; Mechanism::ALL.len()],
    /// Energy stored by the particles of all ranks when the ledger was opened.
    start: StoredEnergy,
}

/// The totals of a ledger, and the change of energy that they do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyBalance {
    /// Work by mechanism, in the order of [`Mechanism::ALL`]. Negative where energy is lost.
    pub work: [f64; Mechanism::ALL.len()],
    /// Change of the stored energy.
    pub change: f64,
    /// Change of the stored energy less the sum of the work. It is zero except for errors of the integrator and of
    /// rounding, unless a mechanism is missing.
    pub closure_error: f64,
}

/// The energies of an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyRow {
    /// Energy stored by all particles.
    pub stored: StoredEnergy,
    /// Work by mechanism since the ledger was opened, and the change that it does not explain.
    pub balance: EnergyBalance,
}

impl EnergyLedger {
    /// An empty ledger of particles that now store this energy.
    pub fn opened(start: StoredEnergy) -> Self {
        Self { start, ..Self::default() }
    }

    /// Opens the ledger with the energy stored now; work that it already holds is kept.
    pub fn open_at(&mut self, start: StoredEnergy) {
        self.start = start;
    }

    /// Energy stored when the ledger was opened.
    pub fn start(&self) -> StoredEnergy {
        self.start
    }

    /// Adds work done on particles: force times displacement; negative if energy is lost.
    pub fn add(&mut self, mechanism: Mechanism, work: f64) {
        self.work[mechanism as usize].add(work);
    }

    /// Adds a change of the stored energy that is not due to the work of forces.
    pub fn add_change(&mut self, mechanism: Mechanism, before: &StoredSums, after: &StoredSums) {
        let sum = &mut self.work[mechanism as usize];
        for (before, after) in [
            (&before.kinetic, &after.kinetic),
            (&before.potential, &after.potential),
            (&before.elastic, &after.elastic),
        ] {
            sum.add_sum(after);
            sum.add_sum(&before.negated());
        }
    }

    /// Begins a new evaluation of forces: the previous one now belongs entirely to the past.
    pub fn next_evaluation(&mut self) {
        for (sum, last) in self.work.iter_mut().zip(&mut self.last) {
            sum.add_sum(&std::mem::take(last));
        }
    }

    /// Adds the power of a force at this evaluation, times the step. By the trapezoidal rule half of it belongs to the
    /// previous step and half to the next.
    pub fn add_power(&mut self, mechanism: Mechanism, power_times_step: f64) {
        self.last[mechanism as usize].add(power_times_step);
    }

    /// This rank's sums as integers, to be stored.
    pub fn stored(&self) -> Vec<i64> {
        self.work.iter().chain(&self.last).flat_map(ExactSum::to_integers).collect()
    }

    /// A ledger from the sums, integer by integer, that the ranks have stored. Missing sums are zero.
    pub fn restore(stored: &[i64], start: StoredEnergy) -> Self {
        let mut sums = stored.chunks_exact(ExactSum::INTEGERS).map(ExactSum::from_integers);
        let mut next = || [(); Mechanism::ALL.len()].map(|()| sums.next().unwrap_or_default());
        Self { work: next(), last: next(), start }
    }

    /// Compares the totals over ranks with the change of the energy stored by the particles of all ranks since the
    /// ledger was opened. Collective.
    pub fn balance(&self, now: &StoredEnergy, ranks: &dyn Communicator) -> EnergyBalance {
        let mut integers = self.stored();
        ranks.sum_integers(&mut integers);
        let whole = Self::restore(&integers, self.start);
        let work = std::array::from_fn(|k| whole.work[k].value() + 0.5 * whole.last[k].value());
        let before = &self.start;
        let change = now.total() - before.total();
        // The error is computed in the exact sum too, since large gains and losses cancel here.
        let mut error = ExactSum::default();
        work.iter().for_each(|&work: &f64| error.add(-work));
        let stored = [now.kinetic, now.potential, now.elastic];
        let at_start = [before.kinetic, before.potential, before.elastic];
        stored.iter().for_each(|&energy| error.add(energy));
        at_start.iter().for_each(|&energy| error.add(-energy));
        EnergyBalance { work, change, closure_error: error.value() }
    }
}

impl EnergyBalance {
    /// Work of one mechanism.
    pub fn of(&self, mechanism: Mechanism) -> f64 {
        self.work[mechanism as usize]
    }

    /// The closure error over the sum of the magnitudes of all work; zero without work and error.
    pub fn relative_error(&self) -> f64 {
        let magnitude: f64 = self.work.iter().map(|work| work.abs()).sum();
        let error = self.closure_error.abs();
        if error > 0.0 { error / magnitude } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    /// A ball with a spring and a dashpot, dropped: its stored energy and the ledger after some velocity Verlet steps.
    fn bounce(step: f64, dashpot_in_ledger: bool) -> (StoredEnergy, EnergyLedger) {
        let (stiffness, damping) = (400.0, 1.5);
        let energy = |x: f64, v: f64| StoredEnergy {
            kinetic: 0.5 * v * v,
            potential: 9.81 * x,
            elastic: 0.5 * stiffness * x.min(0.0).powi(2),
        };
        let spring = |x: f64| -stiffness * x.min(0.0) - 9.81;
        let dashpot = |x: f64, v: f64| if x < 0.0 { -damping * v } else { 0.0 };
        let (mut x, mut v) = (0.2, 0.0);
        let mut ledger = EnergyLedger::opened(energy(x, v));
        for _ in 0..(1.0 / step) as usize {
            let half = v + 0.5 * step * (spring(x) + dashpot(x, v));
            let displacement = step * half;
            if dashpot_in_ledger {
                let middle = x + 0.5 * displacement;
                ledger.add(Mechanism::Dashpot, dashpot(middle, half) * displacement);
            }
            x += displacement;
            // The dashpot at the new velocity: implicit in v.
            let damping = if x < 0.0 { damping } else { 0.0 };
            v = (half + 0.5 * step * spring(x)) / (1.0 + 0.5 * step * damping);
        }
        (energy(x, v), ledger)
    }

    #[test]
    fn a_ledger_closes_to_the_order_of_the_integrator() {
        let balance = |step: f64, complete: bool| {
            let (after, ledger) = bounce(step, complete);
            run_on_threads(1, |ranks| ledger.balance(&after, ranks))[0]
        };
        let coarse = balance(1e-3, true);
        let fine = balance(1e-4, true);
        assert!(coarse.of(Mechanism::Dashpot) < -0.5, "{coarse:?}");
        // The dashpot's force jumps where the contact begins, so the integrator is of first order there.
        assert!(coarse.relative_error() < 1e-2, "{coarse:?}");
        assert!(fine.relative_error() < 1e-3, "{fine:?}");
        // Control: without the dashpot all of its work is unexplained.
        let incomplete = balance(1e-4, false);
        assert!((incomplete.closure_error / fine.of(Mechanism::Dashpot) - 1.0).abs() < 1e-3);
        assert_eq!(incomplete.relative_error(), f64::INFINITY);
    }

    #[test]
    fn totals_have_the_same_bits_on_any_ranks_and_through_a_restart() {
        let work = |k: usize| (k as f64 * 0.7).sin() * 10.0_f64.powi((k % 19) as i32 - 9);
        let on = |n: usize| {
            let made = run_on_threads(n, |ranks| {
                let mut ledger = EnergyLedger::default();
                for k in (0..5000).filter(|k| k * k % 13 % n == ranks.rank()) {
                    if k == 2000 {
                        ledger = EnergyLedger::restore(&ledger.stored(), StoredEnergy::default());
                    }
                    ledger.add(Mechanism::ALL[k % 7], work(k));
                }
                let after = StoredEnergy { kinetic: 1e9, ..StoredEnergy::default() };
                ledger.balance(&after, ranks)
            });
            assert!(made.iter().all(|balance| *balance == made[0]));
            made[0]
        };
        let expected = on(1);
        let plain: f64 = (0..5000).filter(|k| k % 7 == 4).map(work).sum();
        assert!((expected.of(Mechanism::Gas) / plain - 1.0).abs() < 1e-12);
        assert_eq!(expected.change, 1e9);
        (2..=4).for_each(|n| assert_eq!(on(n), expected));
    }

    #[test]
    fn power_counts_by_halves_until_the_next_evaluation() {
        run_on_threads(1, |ranks| {
            let mut ledger = EnergyLedger::default();
            let gas = |ledger: &EnergyLedger| {
                ledger.balance(&StoredEnergy::default(), ranks).of(Mechanism::Gas)
            };
            ledger.add_power(Mechanism::Gas, 2.0);
            assert_eq!(gas(&ledger), 1.0);
            ledger.next_evaluation();
            ledger.add_power(Mechanism::Gas, 4.0);
            assert_eq!(gas(&ledger), 4.0);
        });
    }

    #[test]
    fn every_mechanism_has_its_own_place_and_name() {
        for (place, mechanism) in Mechanism::ALL.into_iter().enumerate() {
            assert_eq!(mechanism as usize, place);
        }
        let mut names = Mechanism::ALL.map(Mechanism::name).to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 9);
    }
}
