//! A column of numbers of owned particles that most runs do not need.

use bytemuck::Pod;

/// A value for each owned particle, in memory only once one of them is not zero, or [`OptionalColumn::hold`] asks for them.
#[derive(Clone, Debug, Default)]
pub struct OptionalColumn<T> {
    count: usize,
    /// All `count` values, or none while all are zero.
    held: Vec<T>,
}

impl<T: Pod> OptionalColumn<T> {
    /// The value of a particle.
    #[inline(always)]
    pub fn get(&self, index: usize) -> T {
        debug_assert!(index < self.count, "an owned particle has the value");
        self.held.get(index).copied().unwrap_or_else(T::zeroed)
    }

    /// Sets the value of a particle.
    pub fn set(&mut self, index: usize, value: T) {
        // By its bits: the digest of a state tells -0 from +0.
        let is_zero = bytemuck::bytes_of(&value).iter().all(|&byte| byte == 0);
        if !(is_zero && self.held.is_empty()) {
            self.hold()[index] = value;
        }
    }

    /// The values of all particles, to be changed.
    pub fn hold(&mut self) -> &mut [T] {
        self.held.resize(self.count, T::zeroed());
        &mut self.held
    }

    /// The values of all particles, or nothing while all are zero.
    pub fn held(&self) -> &[T] {
        &self.held
    }

    /// The values of all particles.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        (0..self.count).map(|index| self.get(index))
    }

    /// Sets all values to zero.
    pub fn reset(&mut self) {
        self.held = Vec::new();
    }

    /// Adds a particle, with the value zero.
    pub(super) fn push(&mut self) {
        self.count += 1;
        if !self.held.is_empty() {
            self.held.push(T::zeroed());
        }
    }

    /// Removes all particles. The memory stays, for those that come next.
    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.held.clear();
    }

    /// Keeps the particles `order[0], order[1], ...`, in that order.
    pub(super) fn select(&mut self, order: &[u32]) {
        self.count = order.len();
        if !self.held.is_empty() {
            self.held = order.iter().map(|&index| self.held[index as usize]).collect();
        }
    }
}

impl<T: Pod + PartialEq> PartialEq for OptionalColumn<T> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: &[f64]) -> OptionalColumn<f64> {
        let mut column = OptionalColumn::default();
        for (index, &value) in values.iter().enumerate() {
            column.push();
            column.set(index, value);
        }
        column
    }

    #[test]
    fn zeros_take_no_memory_and_are_as_those_that_do() {
        let mut zeros = column(&[0.0, 0.0]);
        assert_eq!(zeros.held.capacity(), 0);
        let before = zeros.clone();
        zeros.hold();
        assert_eq!((zeros.held.len(), &zeros), (2, &before));
        zeros.reset();
        assert_eq!((zeros.held.capacity(), zeros), (0, before));
    }

    #[test]
    fn values_are_found_again() {
        let mut values = column(&[0.0, 2.0, 0.0, 4.0]);
        assert!(values.iter().eq([0.0, 2.0, 0.0, 4.0]));
        values.push();
        values.select(&[3, 4, 1]);
        assert!(values.iter().eq([4.0, 0.0, 2.0]));
        assert!(column(&[1.0]) != column(&[0.0]), "the comparison sees values");
        values.clear();
        assert_eq!(values.iter().count(), 0);
    }

    #[test]
    fn the_sign_of_a_zero_is_kept() {
        let values = column(&[0.0, -0.0]);
        let signs = values.iter().map(f64::is_sign_negative);
        assert!(signs.eq([false, true]));
    }
}
