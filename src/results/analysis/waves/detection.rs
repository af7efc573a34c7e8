//! Detection of a pattern that travels through a window of heights and times, and its speed.

use super::correlation::{LaggedCovariance, NearRange, SlownessGrid, Window};
use super::field::Rows;
use crate::analysis::numerics::distributions::upper_gamma;
use crate::analysis::numerics::interpolation::broad_peak_near;

/// Smallest ratio of the covariance in a pattern's own direction to that in the opposite one: a standing wave travels
/// in both.
const LEAST_CONTRAST: f64 = 1.5;

/// A pattern in a window, with the data that show whether it travels.
#[derive(Clone, Debug)]
pub(super) struct Detection {
    pub(super) covariance: LaggedCovariance,
    /// Slowness of the stack's peak, in intervals per node.
    pub(super) slowness: f64,
    /// Fraction of the variance that travels.
    pub(super) share: f64,
    /// Probability of this covariance along one ray if the heights had independent noise.
    ray_chance: f64,
    /// Number of independent rays per unit of slowness, and in total.
    rays_per_slowness: f64,
    rays: f64,
    /// Whether the slowness of the peak can be distinguished from that of a bed that moves as a whole, and from its
    /// opposite.
    pub(super) directed: bool,
}

/// Criterion for a wave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Criterion {
    /// Greatest probability of the peak in noise.
    pub(super) greatest_chance: f64,
    /// Smallest fraction of the variance that travels.
    pub(super) least_share: f64,
    /// Slowness of waves that are known to be in the bed: a pattern with between half and twice this slowness is then
    /// tested against only the rays in this range.
    pub(super) expected: Option<f64>,
}

impl Detection {
    /// Stacks a window over a grid of slownesses; `None` if nothing varies or no ray has a positive covariance.
    ///
    /// Significance: if n heights had independent noise with the same spectrum, the ratio of the power of their sum
    /// along a ray to its mean, x = 1 + (n - 1) S / C_0 (S is the mean covariance of pairs, C_0 the variance), would be
    /// distributed as chi-square over its degrees of freedom, 2 B = N / sum_l (1 - |l|/N) rho(l)^2. The probability of
    /// the highest of M independent rays is 1 - (1 - Q(B, B x))^M, at most M Q(B, B x).
    pub(super) fn of(
        rows: &Rows,
        window: Window,
        grid: &SlownessGrid,
        most: usize,
    ) -> Option<Self> {
        let covariance = LaggedCovariance::of(rows, window, most);
        let variance = covariance.variance();
        // Below this value the solids fraction is constant up to round-off.
        if variance < 1e-16 {
            return None;
        }
        let stack = grid.stack(&covariance);
        let index = stack.peak()?;
        let coarse = grid.slowness(index as f64);
        let range = NearRange::new(&covariance, coarse, 0.1, grid);
        let near = covariance.near(&range);
        let highest = NearRange::highest(&near);
        let slowness = range.slowness(broad_peak_near(&near, highest, 0.7));
        let peak = near[highest];
        let share = peak / variance;
        let opposite = stack.covariances[2 * grid.half - index];
        let half_time = covariance.half_time();
        let span = slowness.abs() * covariance.separations() as f64;
        let directed = span.min(grid.longest) > half_time && peak > LEAST_CONTRAST * opposite;
        let freedom = covariance.freedom(window.times);
        let power = beam_power(share, stack.pairs[index]);
        let rays_per_slowness = covariance.separations() as f64 / (2.0 * half_time);
        Some(Self {
            ray_chance: upper_gamma(freedom, freedom * power),
            rays_per_slowness,
            rays: 2.0 * grid.slowness((2 * grid.half) as f64) * rays_per_slowness,
            covariance,
            slowness,
            share,
            directed,
        })
    }

    /// Probability of this peak if the heights had independent noise.
    pub(super) fn chance(&self, expected: Option<f64>) -> f64 {
        let known = expected.filter(|&known| (0.5..2.0).contains(&(self.slowness / known)));
        let rays = known.map_or(self.rays, |known| 1.5 * known.abs() * self.rays_per_slowness);
        (rays.max(1.0) * self.ray_chance).min(1.0)
    }

    /// Whether this is a wave by a criterion.
    pub(super) fn travels(&self, criterion: Criterion) -> bool {
        self.directed
            && self.chance(criterion.expected) < criterion.greatest_chance
            && self.share > criterion.least_share
    }
}

/// Ratio of the power of the sum of n heights to its mean in noise, where n follows from its n (n - 1) / 2 pairs.
fn beam_power(share: f64, pairs: f64) -> f64 {
    let heights = 0.5 * (1.0 + (1.0 + 8.0 * pairs).sqrt());
    1.0 + (heights - 1.0) * share
}
