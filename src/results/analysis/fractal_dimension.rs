//! Fractal dimension of a population of agglomerates, and of single large ones.

use super::LineFit;
use nalgebra::{Matrix3, Vector3};
use talcum_engine::parallel::Communicator;
use talcum_engine::particle_sets::agglomerates::Agglomerate;

/// Fit of n = k (R / r_a)^D to agglomerates with n members, radius of gyration R and member radius r_a.
///
/// ln(R / r_a) is fitted as a line in ln n, with equal weights for all agglomerates: n is exact, and R differs among
/// agglomerates with the same n. D is 1 / slope, and its error is that of the slope over slope^2. (The paper gives each
/// agglomerate a dimension of its own with k = 1: [`Agglomerate::fractal_dimension`].)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PopulationFit {
    /// D_f.
    pub dimension: f64,
    /// Its standard error, if agglomerates are independent.
    pub error: f64,
    /// k.
    pub prefactor: f64,
    /// Standard deviation of ln(R / r_a) about the line.
    pub deviation: f64,
    /// Number of agglomerates.
    pub agglomerates: u64,
}

impl PopulationFit {
    /// The fit over the agglomerates of all ranks. Those without extension are left out; those with fewer than some ten
    /// members should be left out by the caller, since they follow no power law. `None` for fewer than three
    /// agglomerates, or if all are of one size. Collective.
    pub fn of(found: &[Agglomerate], ranks: &dyn Communicator) -> Option<Self> {
        let extended = found.iter().filter(|agglomerate| agglomerate.radius_of_gyration > 0.0);
        let points: Vec<[f64; 2]> = extended
            .map(|agglomerate| {
                let ratio = agglomerate.radius_of_gyration / agglomerate.member_radius();
                [libm::log(agglomerate.members as f64), libm::log(ratio)]
            })
            .collect();
        let line = LineFit::through(&points, ranks).ok()?;
        Some(Self {
            dimension: 1.0 / line.slope.value,
            error: line.slope.error / (line.slope.value * line.slope.value),
            prefactor: libm::exp(-line.intercept.value / line.slope.value),
            deviation: line.residual,
            agglomerates: line.points,
        })
    }
}

/// Mass within a radius inside one agglomerate: M(r) ~ r^D, the mean number of members within r of a member.
///
/// The fitted quantity is Q(r) = integral of M from 0 to r = mean over members i of sum_j max(r - |x_j - x_i|, 0). It
/// grows as r^(D + 1), and the shells of neighbours are smoothed in it:
///
/// ```math
/// \ln Q = c + (D + 1) \ln r - b\, \frac{r}{R}
/// ```
///
/// by least squares over radii from 5 r_a to 0.9 R in steps of a factor of 1.25, where R is the radius of gyration. The
/// last term accounts for members near the surface, which have fewer neighbours.
///
/// Dimensions of rods, discs and balls of touching spheres are found to within 0.05; those of aggregates of 512 spheres
/// of known dimension to within 0.05 in the mean, with a scatter of 0.1. The method follows the sandbox method of Tel,
/// Fulop & Vicsek, Physica A 159 (1989) 155.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassRadius {
    /// D_f.
    pub dimension: f64,
    /// Smallest and largest radius, in units of the member radius.
    pub radii: [f64; 2],
    /// Number of members from which distances were taken.
    pub origins: usize,
}

/// Smallest radius, in units of the member radius: at smaller ones, the neighbours reflect the packing, not a fractal.
const SMALLEST_RADIUS: f64 = 5.0;
/// Ratio of the largest radius to the radius of gyration: beyond it, the surface affects all members.
const REACH: f64 = 0.9;
const STEP: f64 = 1.25;
/// Largest number of origins: with more members, every second, third ... is an origin.
const MOST_ORIGINS: usize = 2000;

impl MassRadius {
    /// The dimension from the unwrapped members of one agglomerate in order of their ids, as returned by
    /// [`Agglomerates::members`]. `None` if it is too small, with fewer than four radii.
    ///
    /// [`Agglomerates::members`]: talcum_engine::particle_sets::agglomerates::Agglomerates::members
    pub fn of(positions: &[Vector3<f64>], member_radius: f64) -> Option<Self> {
        let n = positions.len() as f64;
        let centre = positions.iter().sum::<Vector3<f64>>() / n;
        let square = positions.iter().map(|x| (x - centre).norm_squared()).sum::<f64>() / n;
        let gyration = square.sqrt();
        let steps =
            std::iter::successors(Some(SMALLEST_RADIUS * member_radius), |r| Some(STEP * r));
        let inside = |r: &f64| *r > 0.0 && *r <= REACH * gyration;
        let radii: Vec<f64> = steps.take_while(inside).collect();
        if radii.len() < 4 {
            return None;
        }
        let stride = positions.len().div_ceil(MOST_ORIGINS);
        let masses = integrated_mass(positions, stride, &radii);
        let points = radii
            .iter()
            .zip(&masses)
            .map(|(&r, &mass)| [libm::log(r), r / gyration, libm::log(mass)]);
        let power = power_with_edge(&points.collect::<Vec<_>>())?;
        Some(Self {
            dimension: power - 1.0,
            radii: [radii[0], radii[radii.len() - 1]].map(|radius| radius / member_radius),
            origins: positions.len().div_ceil(stride),
        })
    }
}

/// Q(r) for each ascending radius, up to a factor.
fn integrated_mass(positions: &[Vector3<f64>], stride: usize, radii: &[f64]) -> Vec<f64> {
    // Number and sum of the distances between a radius and the one below.
    let mut shells = vec![[0.0; 2]; radii.len()];
    for origin in positions.iter().step_by(stride) {
        for position in positions {
            let distance = (position - origin).norm();
            let first = radii.partition_point(|&radius| radius < distance);
            if let Some([count, sum]) = shells.get_mut(first) {
                *count += 1.0;
                *sum += distance;
            }
        }
    }
    let mut within = [0.0; 2];
    let integrals = radii.iter().zip(shells).map(|(radius, [count, sum])| {
        within = [within[0] + count, within[1] + sum];
        radius * within[0] - within[1]
    });
    integrals.collect()
}

/// The coefficient of the first variable in z = c + p x + b y for points [x, y, z], by least squares.
fn power_with_edge(points: &[[f64; 3]]) -> Option<f64> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &[x, y, z] in points {
        let row = Vector3::new(1.0, x, y);
        matrix += row * row.transpose();
        right += z * row;
    }
    Some((matrix.try_inverse()? * right).y)
}

#[cfg(test)]
#[path = "fractal_dimension_tests.rs"]
mod tests;
