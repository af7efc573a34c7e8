//! Effect of a particle on the gas at its own place: the drag that it contributes to the cells around it moves the gas
//! there, and its own volume lowers their voidage. Drag laws need both values as they would be without the particle.
//!
//! A force F on the gas that passes the particle at a velocity U moves the gas at the particle by -kappa F. With the
//! Fourier modes k of the grid, of which there are N on cells of volume V,
//!
//! ```math
//! \kappa_a = \frac{1}{\mu V N} \sum_{k \ne 0} W^2(k)\, \frac{(1 - k_a^2 / k^2)\, k^2}{k^4 + (\rho U k_a / \mu)^2} ,
//! \qquad q = \frac{1}{N} \sum_k \hat{W}^2(k) ,
//! ```
//!
//! along axis a: this is Oseen's flow, with the differences of the grid in place of k. W is the factor by which hats,
//! means of faces and filter reduce a mode (its square is a mean over all places in a cell). The factor without the
//! means of faces gives q V_p / V, the mean solids fraction that the particle contributes to its own place; this
//! contribution varies with the place in the cell, in proportion to the sum of the squares of the particle's weights.
//! The undisturbed slip is then U_0 = U' / (1 - s), s = b kappa S, where b is the drag coefficient at U_0 and the
//! undisturbed voidage, and the force is b U_0. U' is the observed slip, times its voidage over the undisturbed one:
//! the gas flows faster where the particle takes room. The gas that sweeps the disturbance away is that of the
//! particle's own cells, which is slowed by the disturbance, so kappa is taken at U' (1 - s).
//!
//! In a bed each particle has others around it at places that are not random. The excess over the mean around a
//! particle is S times its own share, where S is the structure factor of hard spheres for long waves (Carnahan &
//! Starling, J. Chem. Phys. 51 (1969) 635):
//!
//! ```math
//! S(\phi) = \frac{(1 - \phi)^4}{1 + 4 \phi + 4 \phi^2 - 4 \phi^3 + \phi^4} ,
//! ```
//!
//! which is 1 for a lone particle, 0.2 at phi = 0.2 and 0.01 in a packed bed, where the gas velocity in cells is the
//! one that closures refer to. The drag of the others also retards the gas, with beta = b phi / V_p in addition to mu
//! k^2: kappa becomes kappa / (1 + kappa beta / omega), which is right in both limits; omega V is the mean of
//! W^2 (1 - k_a^2 / k^2).
//!
//! The correction holds for cells of 3 diameters and more, or with a filter of this width. On smaller cells the gas
//! around the particle is so much slower that the flow is no longer Oseen's, although the speed U' (1 - s) accounts for
//! most of this.
//!
//! On the need for this correction: Horwitz & Mani, J. Comput. Phys. 318 (2016) 85-109; Ireland & Desjardins, J.
//! Comput. Phys. 338 (2017) 405-430; on Oseen's flow around smoothed forces: Balachandar, Liu & Lakhote, J. Comput.
//! Phys. 376 (2019) 160-185.

use crate::coupling::CellTransfer;
use crate::grid::BoxGrid;
use crate::numbers::sine;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Number of modes along an axis; for boxes that are longer or not periodic this number of modes is taken in the middle
/// of equal intervals.
const MODES: usize = 48;
/// Mean over a cell of the sum of the squares of a point's weights.
const OF_HATS: f64 = 8.0 / 27.0;
/// Intervals of the tables over x / (1 + x), x = rho U dx / mu.
const INTERVALS: usize = 32;
/// Largest b kappa S: beyond it, cells are too small relative to the particle for a meaningful correction.
const LARGEST_SHARE: f64 = 0.75;
/// Drag coefficient and mobility depend little on the slip: the error falls by a factor of 3 or more each time.
const ITERATIONS: usize = 6;

/// Mobilities of the gas at the place of a force, on one grid; equal on all ranks.
#[derive(Clone, Debug)]
pub(super) struct OwnDisturbance {
    spacing: Vector3<f64>,
    /// rho / mu.
    inertia: f64,
    /// kappa along each axis over x / (1 + x), at equal intervals.
    mobility: [Vec<f64>; 3],
    /// omega: mobility by a force that only drag resists, the mean of W^2 (1 - k_a^2 / k^2) over modes and axes, over
    /// V.
    share_of_force: f64,
    /// 27 q / (8 V): the fraction of the unfiltered share that the filter leaves, per volume.
    share_of_volume: f64,
}

/// Values of the cells for the gas around a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenGas {
    /// Velocity of the gas less that of the particle.
    pub(super) slip: Vector3<f64>,
    pub(super) solids_fraction: f64,
    /// Volume of the particle.
    pub(super) volume: f64,
    /// The sum of the squares of its weights.
    pub(super) own_share: f64,
}

/// A mode along one axis: sin^2 of half its phase angle, and the number of such modes.
#[derive(Clone, Copy)]
struct Mode {
    square: f64,
    count: f64,
}

fn modes(cells: usize, periodic: bool) -> Vec<Mode> {
    let square = |angle: f64| sine(0.5 * angle) * sine(0.5 * angle);
    if cells > MODES || !periodic {
        let step = 2.0 * PI / MODES as f64;
        let mode = |j: usize| Mode { square: square((j as f64 + 0.5) * step), count: 2.0 };
        return (0..MODES / 2).map(mode).collect();
    }
    let mode = |j: usize| {
        let is_own_mirror = (2 * j).is_multiple_of(cells);
        let count = if is_own_mirror { 1.0 } else { 2.0 };
        Mode { square: square(2.0 * PI * j as f64 / cells as f64), count }
    };
    (0..=cells / 2).map(mode).collect()
}

/// Factor by which the hats of a point reduce a mode, squared and averaged over the places of the point in a cell.
fn of_hats(square: f64) -> f64 {
    1.0 - 2.0 / 3.0 * square
}

impl OwnDisturbance {
    /// Mobilities for a gas of this density and viscosity on a grid.
    pub(super) fn new(
        grid: &BoxGrid,
        transfer: &CellTransfer,
        [density, viscosity]: [f64; 2],
    ) -> Self {
        let axes = [0, 1, 2].map(|axis| modes(grid.counts()[axis], grid.is_periodic(axis)));
        let all: f64 =
            axes.iter().map(|modes| modes.iter().map(|m| m.count).sum::<f64>()).product();
        let mut waves = Vec::new();
        for z in &axes[2] {
            for y in &axes[1] {
                for x in &axes[0] {
                    waves.push(Wave::of([*x, *y, *z], grid, transfer));
                }
            }
        }
        let inertia = density / viscosity;
        let per_force = 1.0 / (viscosity * grid.cell_volume() * all);
        let table = |axis: usize| {
            let at = |entry: usize| {
                let part = entry as f64 / INTERVALS as f64;
                let speed = part / (1.0 - part) / grid.spacing()[axis];
                match entry {
                    INTERVALS => 0.0,
                    _ => {
                        per_force * waves.iter().map(|wave| wave.response(axis, speed)).sum::<f64>()
                    }
                }
            };
            (0..=INTERVALS).map(at).collect()
        };
        let share: f64 = waves.iter().map(|wave| wave.count * wave.of_volume).sum();
        let across: f64 = waves.iter().map(Wave::across).sum();
        Self {
            spacing: grid.spacing(),
            inertia,
            mobility: [table(0), table(1), table(2)],
            share_of_force: across / (all * grid.cell_volume()),
            share_of_volume: share / (all * OF_HATS * grid.cell_volume()),
        }
    }

    /// Drag coefficient that, with the observed slip, gives the force of the undisturbed gas, by the law `drag` of
    /// solids fraction and superficial slip.
    pub(super) fn coefficient(&self, seen: &SeenGas, drag: impl Fn(f64, f64) -> f64) -> f64 {
        let own = self.share_of_volume * seen.volume * seen.own_share;
        let around = (seen.solids_fraction - own).max(0.0);
        let structure = structure_factor(around);
        let solids_fraction = (seen.solids_fraction - own * structure).max(0.0);
        // The gas flows faster where the particle itself takes room.
        let widened = (1.0 - seen.solids_fraction) / (1.0 - solids_fraction);
        let speed = seen.slip.norm() * widened;
        let (mut share, mut coefficient) = (0.0_f64, 0.0);
        for _ in 0..ITERATIONS {
            let undisturbed = speed / (1.0 - share);
            coefficient = drag(solids_fraction, (1.0 - solids_fraction) * undisturbed);
            // The gas that sweeps the disturbance away is slowed once more by it.
            let mobility = self.mobility(&seen.slip, speed * (1.0 - share));
            // kappa phi / (V_p omega): contribution of the drag of the others to 1 / kappa, per drag coefficient.
            let screening = mobility * around / (seen.volume * self.share_of_force);
            let taken = coefficient * mobility * structure / (1.0 + coefficient * screening);
            share = taken.min(LARGEST_SHARE);
        }
        coefficient * widened / (1.0 - share)
    }

    /// Largest ratio of a coefficient to that of the drag law.
    pub(super) const LARGEST_FACTOR: f64 = 1.0 / (1.0 - LARGEST_SHARE);

    /// kappa along the slip, if the gas sweeps by at this speed.
    fn mobility(&self, slip: &Vector3<f64>, swept: f64) -> f64 {
        let along = |axis: usize| {
            let x = self.inertia * swept * self.spacing[axis];
            let place = x / (1.0 + x) * INTERVALS as f64;
            let below = (place as usize).min(INTERVALS - 1);
            let (table, part) = (&self.mobility[axis], place - below as f64);
            table[below] + part * (table[below + 1] - table[below])
        };
        let length = slip.norm();
        if length == 0.0 {
            return (along(0) + along(1) + along(2)) / 3.0;
        }
        let part = |axis: usize| (slip[axis] / length).powi(2);
        part(0) * along(0) + part(1) * along(1) + part(2) * along(2)
    }
}

/// A mode of the grid and its mirror images.
struct Wave {
    count: f64,
    /// k_a^2 by differences, over the squares of spacings.
    squares: [f64; 3],
    /// (sin(k_a dx) / dx)^2.
    central: [f64; 3],
    /// Factors by which hats, means of faces along each axis and filter reduce a force.
    of_force: [f64; 3],
    /// Factor by which hats and filter reduce a volume.
    of_volume: f64,
}

impl Wave {
    fn of(modes: [Mode; 3], grid: &BoxGrid, transfer: &CellTransfer) -> Self {
        let (halves, h) = (modes.map(|mode| mode.square), grid.spacing());
        let filter = transfer.part_of_wave(halves);
        let of_volume = halves.map(of_hats).iter().product::<f64>() * (filter * filter);
        let axes = [0, 1, 2];
        Self {
            count: modes.iter().map(|mode| mode.count).product(),
            squares: axes.map(|a| 4.0 * halves[a] / (h[a] * h[a])),
            central: axes.map(|a| 4.0 * halves[a] * (1.0 - halves[a]) / (h[a] * h[a])),
            of_force: halves.map(|half| of_volume * (1.0 - half)),
            of_volume,
        }
    }

    /// Its part of the sum for omega.
    fn across(&self) -> f64 {
        let square: f64 = self.squares.iter().sum();
        if square == 0.0 {
            return 0.0;
        }
        let along = |axis: usize| self.of_force[axis] * (1.0 - self.squares[axis] / square);
        self.count * (along(0) + along(1) + along(2)) / 3.0
    }

    /// Its part of the sum for kappa along an axis, at a speed rho U / mu.
    fn response(&self, axis: usize, speed: f64) -> f64 {
        let square: f64 = self.squares.iter().sum();
        if square == 0.0 {
            return 0.0;
        }
        let across = 1.0 - self.squares[axis] / square;
        let swept = speed * speed * self.central[axis];
        self.count * self.of_force[axis] * across * square / (square * square + swept)
    }
}

/// S(phi) of hard spheres for long waves.
pub(super) fn structure_factor(phi: f64) -> f64 {
    let square = phi * phi;
    let compressibility = 1.0 + 4.0 * phi + 4.0 * square - 4.0 * square * phi + square * square;
    (1.0 - phi).powi(4) / compressibility
}
