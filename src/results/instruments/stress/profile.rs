//! Averages of the layers over samples, by phase.

use super::{NUMBERS, numbers_of};
use crate::analysis::stress::CellStress;

/// Sums over samples of the numbers of each layer, phase by phase; equal on all ranks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profiles {
    layers: usize,
    looks: u64,
    /// Time of the first sample.
    from: f64,
    /// Number of samples of each phase.
    of_phase: Vec<f64>,
    /// Phase by phase, layer by layer.
    sums: Vec<[f64; NUMBERS]>,
}

/// Means of an interval.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeanProfiles {
    pub(super) looks: u64,
    pub(super) from: f64,
    /// Phase by phase, layer by layer; undefined in a phase without samples.
    pub(super) means: Vec<[f64; NUMBERS]>,
}

impl Profiles {
    pub(super) fn new(phases: usize, layers: usize) -> Self {
        let sums = vec![[0.0; NUMBERS]; phases * layers];
        Self { layers, looks: 0, from: 0.0, of_phase: vec![0.0; phases], sums }
    }

    /// Number of samples of the present interval.
    pub(super) fn looks(&self) -> u64 {
        self.looks
    }

    /// Adds the layers of a sample; each of them contains this number of waves.
    pub(super) fn add(&mut self, time: f64, phase: usize, cells: &[CellStress], waves: f64) {
        if self.looks == 0 {
            self.from = time;
        }
        self.looks += 1;
        self.of_phase[phase] += 1.0;
        for cell in cells {
            let place = phase * self.layers + cell.cell as usize;
            let numbers = numbers_of(cell, 1.0 / waves);
            self.sums[place].iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        }
    }

    /// The means of the interval, which then ends.
    pub(super) fn take(&mut self) -> MeanProfiles {
        let new = Self::new(self.of_phase.len(), self.layers);
        let Self { layers, looks, from, of_phase, sums } = std::mem::replace(self, new);
        let mean = |(place, sums): (usize, &[f64; NUMBERS])| {
            sums.map(|sum| sum / of_phase[place / layers])
        };
        MeanProfiles { looks, from, means: sums.iter().enumerate().map(mean).collect() }
    }

    /// All numbers, to be stored.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let head = [self.looks as f64, self.from];
        head.iter().chain(&self.of_phase).chain(self.sums.as_flattened()).copied().collect()
    }

    /// Continues from stored numbers.
    pub(super) fn restore(&mut self, numbers: &[f64]) -> Option<()> {
        let (head, rest) = numbers.split_at_checked(2)?;
        let (of_phase, sums) = rest.split_at_checked(self.of_phase.len())?;
        let flat = self.sums.as_flattened_mut();
        if sums.len() != flat.len() {
            return None;
        }
        flat.copy_from_slice(sums);
        self.of_phase.copy_from_slice(of_phase);
        (self.looks, self.from) = (head[0] as u64, head[1]);
        Some(())
    }
}
