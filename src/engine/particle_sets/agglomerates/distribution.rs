//! Distributions and means over the agglomerates of all ranks.

use super::Agglomerate;
use crate::numbers::ExactSum;
use crate::parallel::Communicator;
use crate::particle_sets::exact_sums::totals;

/// Number and mass of agglomerates by bins of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeDistribution {
    /// Ascending limits: bin k holds `limits[k] <= x < limits[k + 1]`.
    pub limits: Vec<f64>,
    /// Number of agglomerates in each bin.
    pub number: Vec<u64>,
    /// Mass of the agglomerates in each bin.
    pub mass: Vec<f64>,
    /// Number of agglomerates in no bin: outside the limits, or with an undefined quantity.
    pub outside: u64,
}

impl SizeDistribution {
    /// The distribution of a quantity, such as [`Agglomerate::diameter`] or the number of members, over the
    /// agglomerates of all ranks. Collective.
    pub fn of(
        found: &[Agglomerate],
        quantity: impl Fn(&Agglomerate) -> f64,
        limits: &[f64],
        ranks: &dyn Communicator,
    ) -> Self {
        let bins = limits.len().saturating_sub(1);
        let mut number = vec![0; bins + 1];
        let mut mass = vec![ExactSum::default(); bins];
        for agglomerate in found {
            let bin = bin_of(quantity(agglomerate), limits);
            number[bin.unwrap_or(bins)] += 1;
            if let Some(bin) = bin {
                mass[bin].add(agglomerate.mass);
            }
        }
        ranks.sum_integers(&mut number);
        let mut integers: Vec<i64> = mass.iter().flat_map(ExactSum::to_integers).collect();
        ranks.sum_integers(&mut integers);
        let mass = integers.chunks(ExactSum::INTEGERS);
        let mass = mass.map(|integers| ExactSum::from_integers(integers).value()).collect();
        let outside = number.pop().unwrap_or(0) as u64;
        let number = number.into_iter().map(|count| count as u64).collect();
        Self { limits: limits.to_vec(), number, mass, outside }
    }
}

/// The bin with limits[k] <= x < limits[k + 1].
fn bin_of(x: f64, limits: &[f64]) -> Option<usize> {
    let above = limits.partition_point(|&limit| limit <= x);
    (above > 0 && above < limits.len() && !x.is_nan()).then(|| above - 1)
}

/// Means over agglomerates, each weighted by its mass: sum m x / sum m (the averages of the paper).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassWeightedMeans {
    /// N_agg, number of agglomerates.
    pub count: u64,
    /// Their mass.
    pub mass: f64,
    /// Number of members.
    pub members: f64,
    /// d_agg.
    pub diameter: f64,
    /// C_N of all contacts.
    pub coordination_number: f64,
    /// C_N of contacts within the agglomerate.
    pub coordination_within: f64,
    /// p.
    pub packing_fraction: f64,
    /// D_f of single agglomerates, over those for which it is defined.
    pub fractal_dimension: f64,
}

impl MassWeightedMeans {
    /// Means over the agglomerates of all ranks; `None` if there are none. Collective.
    pub fn of(found: &[Agglomerate], ranks: &dyn Communicator) -> Option<Self> {
        let moments = found.iter().map(|a| {
            let m = a.mass;
            let dimension = a.fractal_dimension();
            [
                1.0,
                m,
                m * a.members as f64,
                m * a.diameter(),
                m * a.coordination_number(),
                m * a.coordination_within(),
                m * a.packing_fraction(),
                dimension.map_or(0.0, |dimension| m * dimension),
                dimension.map_or(0.0, |_| m),
            ]
        });
        let [count, mass, sums @ .., dimension, with_dimension] = totals(moments, ranks);
        let [members, diameter, coordination, within, packing] = sums.map(|sum| sum / mass);
        (count > 0.0).then_some(Self {
            count: count as u64,
            mass,
            members,
            diameter,
            coordination_number: coordination,
            coordination_within: within,
            packing_fraction: packing,
            fractal_dimension: dimension / with_dimension,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_half_open() {
        let limits = [1.0, 2.0, 5.0];
        let bins = [0.9, 1.0, 1.99, 2.0, 5.0, f64::NAN].map(|x| bin_of(x, &limits));
        assert_eq!(bins, [None, Some(0), Some(0), Some(1), None, None]);
        assert_eq!(bin_of(1.0, &[]), None);
    }
}
