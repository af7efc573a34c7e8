//! The numbers of one row of the series: balances, pressure drops, and motion of the bed. Name, kind and formula of
//! each are defined in one place.

use super::observation::Observation;
use super::{BedProfile, MomentumProbe, RunView};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;

/// A column of the series; its `values` take the number from a row.
pub type SeriesColumn = Column<fn(&SeriesRow) -> f64>;

/// Defines [`SeriesRow`], its columns, and their computation from an [`Observation`], by one entry for each number.
macro_rules! series_columns {
    ($($(#[doc = $meaning:literal])* $name:ident: $unit:ident = $formula:expr;)*) => {
        /// The state of the bed at one instant. "Over weight" means divided by the bed's weight at rest, M g.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct SeriesRow {
            $($(#[doc = $meaning])* pub $name: f64,)*
        }

        impl SeriesRow {
            /// All numbers, in the order of the file.
            pub const COLUMNS: &[SeriesColumn] = &[$(Column::with(
                stringify!($name),
                Unit::$unit,
                &[],
                concat!($($meaning),*).trim_ascii(),
                |row| row.$name,
            ),)*];

            fn of(observation: &Observation) -> Self {
                $(let $name: fn(&Observation) -> f64 = $formula;)*
                Self { $($name: $name(observation),)* }
            }
        }
    };
}

series_columns! {
    /// Time.
    time: Time = |it| it.time;
    /// U_s; for a compressible column gas that at the plate, as volume at the pressure above the bed; for a
    /// volume-averaged gas its mean over the bottom; 0 without gas.
    superficial_velocity: Speed = |it| it.gas.superficial_velocity;
    /// Integral of beta (U_s - u_s) / (1 - phi)^2 over the height, times the cross-section, over weight; for a
    /// volume-averaged gas its mean pressure at the bottom less that at the top, without the hydrostatic head.
    grid_pressure_drop: One = |it| it.over_weight(it.pressure_force);
    /// Pressure of the plenum from which a column gas comes, less that above the bed; 0 without a plenum.
    plenum_pressure: Pressure = |it| it.gas.plenum_pressure;
    /// Vertical gas force on all particles, over weight; for a column gas on a plate it is the pressure there less that
    /// above the bed.
    gas_force: One = |it| it.over_weight(it.gas_force);
    /// Force on the base plate, downwards, over weight.
    plate_stress: One = |it| it.over_weight(it.plate_force);
    /// The bed's weight at rest, M g.
    weight: Force = |it| it.weight;
    /// g_eff / g.
    effective_gravity: One = |it| ratio(it.effective_gravity, it.gravity);
    /// Height of the centre of mass.
    centre_height: Length = |it| ratio(it.particles.moment, it.particles.mass);
    /// Vertical velocity of the centre of mass.
    centre_velocity: Speed = |it| ratio(it.particles.vertical_momentum, it.particles.mass);
    /// Height of the bottom of the bed.
    bed_bottom: Length = |it| it.bed_bottom;
    /// Height of the top of the bed.
    bed_top: Length = |it| it.bed_top;
    /// Kinetic energy of the mean motion, M V^2 / 2.
    kinetic_energy_of_mean_motion: Energy = |it| it.mean_energy;
    /// Kinetic energy of translation about the mean motion.
    fluctuating_kinetic_energy: Energy = |it| it.particles.energy - it.mean_energy;
    /// Mean number of touching particles per particle.
    coordination_number: One = |it| ratio(it.particles.neighbours, it.particles.count);
    /// Largest component of d(momentum)/dt less the external forces, over the last step, over weight.
    momentum_error: One = |it| it.over_weight(it.momentum_imbalance);
    /// Volume of solids on the grid over that of the particles, less 1.
    mass_error: One = |it| {
        let volume = it.particles.volume;
        if volume > 0.0 { it.volume_on_grid / volume - 1.0 } else { 0.0 }
    };
    /// Number of particles.
    particles: One = |it| it.particles.count;
    /// Number of particles that have left.
    departed: One = |it| it.departed as f64;
    /// Iterations of the pressure equation in the last step of a volume-averaged gas.
    gas_iterations: One = |it| it.gas.report.iterations as f64;
    /// Courant number of that gas.
    gas_courant: One = |it| it.gas.report.courant;
    /// Number of cells whose voidage was below the smallest one in that step and was raised to it.
    raised_cells: One = |it| it.gas.report.raised_cells as f64;
    /// Largest component of the difference between the momentum gained by particles in that step and that lost by the
    /// gas, over weight.
    exchange_error: One = |it| it.over_weight(it.gas.report.momentum_error);
    /// Mean over the particles of xi, the ratio of the drag to that of the law, in that step, if it depends on their
    /// agglomerates; 0 otherwise.
    drag_factor: One = |it| ratio(it.particles.drag_factors, it.particles.count);
}

/// A number divided by another; 0 if the latter is 0.
fn ratio(value: f64, total: f64) -> f64 {
    if total > 0.0 { value / total } else { 0.0 }
}

/// Computes all numbers. Collective.
///
/// Before: `view` is of the end of a step; `probe` was taken before that step, if there was one.
pub fn series_row(
    view: RunView<'_>,
    profile: &mut BedProfile,
    probe: Option<MomentumProbe>,
    ranks: &dyn Communicator,
) -> SeriesRow {
    SeriesRow::of(&Observation::of(view, profile, probe, ranks))
}
