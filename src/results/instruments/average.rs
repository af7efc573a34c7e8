//! Averages over the samples of an interval, one row for each interval.

use super::registered::InstrumentValues;
use super::stored::Stored;
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Allowed, Key, Value};

/// `average`: the duration over which samples are averaged.
pub(super) const AVERAGE: Key = Key::number(
    "average",
    Allowed::POSITIVE,
    "Samples over this interval are averaged to one row; a whole multiple of `every`",
)
.unit("time")
.default(Value::Derived("`every`: each sample is a row"));

/// Number of samples averaged in one row.
pub(super) fn looks_per_row(values: &dyn InstrumentValues) -> Option<u64> {
    let every = values.number("every")?;
    if !values.is_given("average") {
        return Some(1);
    }
    let looks = values.number("average")? / every;
    if looks < 0.999 || (looks - looks.round()).abs() > 1.0e-6 * looks {
        values.fail("average", format!("must be a whole multiple of every, {every}"));
        return None;
    }
    Some(looks.round() as u64)
}

/// Sums of the samples of the present interval. All ranks have the same numbers, so plain sums in the order of the
/// samples are equal on all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Average {
    looks_per_row: u64,
    looks: u64,
    /// Time of the first sample of the interval.
    from: f64,
    sums: Vec<f64>,
    squares: Vec<f64>,
}

/// Means and standard deviations of one interval.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Averaged {
    /// Number of samples.
    pub(super) looks: u64,
    /// Time of the first sample.
    pub(super) from: f64,
    pub(super) means: Vec<f64>,
    /// Standard deviation between samples, with n - 1; 0 for one sample.
    pub(super) deviations: Vec<f64>,
}

impl Average {
    pub(super) fn new(looks_per_row: u64) -> Self {
        Self { looks_per_row, ..Self::default() }
    }

    /// Adds a sample; returns the averages if it was the last of its interval.
    pub(super) fn add(&mut self, time: f64, values: &[f64]) -> Option<Averaged> {
        if self.looks == 0 {
            self.from = time;
            self.sums = vec![0.0; values.len()];
            self.squares = vec![0.0; values.len()];
        }
        self.looks += 1;
        for ((sum, square), value) in self.sums.iter_mut().zip(&mut self.squares).zip(values) {
            *sum += value;
            *square += value * value;
        }
        (self.looks >= self.looks_per_row).then(|| self.take())
    }

    fn take(&mut self) -> Averaged {
        let n = self.looks as f64;
        let means: Vec<f64> = self.sums.iter().map(|sum| sum / n).collect();
        let deviation = |(square, mean): (&f64, &f64)| match self.looks {
            1 => 0.0,
            _ => ((square - n * mean * mean).max(0.0) / (n - 1.0)).sqrt(),
        };
        let deviations = self.squares.iter().zip(&means).map(deviation).collect();
        let averaged = Averaged { looks: self.looks, from: self.from, means, deviations };
        self.looks = 0;
        averaged
    }

    /// Stores the sums under a name.
    pub(super) fn store(&self, name: &str, stored: &mut Stored, ranks: &dyn Communicator) {
        let head = [self.looks as f64, self.from];
        let present = self.looks > 0;
        let sums = self.sums.iter().chain(&self.squares).filter(|_| present);
        let numbers: Vec<f64> = head.iter().chain(sums).copied().collect();
        stored.add_numbers(name, &numbers, ranks);
    }

    /// Continues from stored sums. Collective.
    pub(super) fn restore(
        &mut self,
        name: &str,
        stored: &Stored,
        ranks: &dyn Communicator,
    ) -> Option<()> {
        let numbers = stored.numbers(name, ranks)?;
        let [looks, from, sums @ ..] = &numbers[..] else { return None };
        let (sums, squares) = sums.split_at(sums.len() / 2);
        (self.looks, self.from) = (*looks as u64, *from);
        (self.sums, self.squares) = (sums.to_vec(), squares.to_vec());
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::parallel::OneRank;

    #[test]
    fn an_interrupted_average_is_that_of_all_looks() {
        let looks: Vec<[f64; 2]> = (0..4).map(|k| [0.1 * f64::from(k), 3.0]).collect();
        let mut whole = Average::new(4);
        let mut parts = Average::new(4);
        let (mut found, mut of_parts) = (None, None);
        for (k, values) in looks.iter().enumerate() {
            found = whole.add(k as f64, values);
            let mut stored = Stored::default();
            parts.store("sums", &mut stored, &OneRank);
            parts = Average::new(4);
            parts.restore("sums", &stored, &OneRank).unwrap();
            of_parts = parts.add(k as f64, values);
        }
        assert_eq!(found, of_parts);
        let found = found.unwrap();
        assert_eq!((found.looks, found.from), (4, 0.0));
        assert!((found.means[0] - 0.15).abs() < 1e-15);
        // For 0, 0.1, 0.2, 0.3: sqrt(0.05 / 3).
        assert!((found.deviations[0] - (0.05_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(found.deviations[1], 0.0);
        // The next interval starts with empty sums.
        let mut next = whole;
        (0..3).for_each(|_| assert_eq!(next.add(9.0, &[1.0, 1.0]), None));
        assert_eq!(next.add(9.0, &[1.0, 1.0]).unwrap().means, [1.0, 1.0]);
    }
}
