//! Observations of a state, and evaluation of series, profiles, fields and contacts. This module never changes a state,
//! and does not handle files.
//!
//! * For a state during a run: [`series_row`], [`wall_forces`], [`BedProfile`], [`Digest`].
//! * For series, profiles and fields: [`waves`], [`spectrum`], [`phase_average`], [`minimum_fluidisation`],
//!   [`bed_height`], [`bubbles`], [`repose`], [`residence`], [`statistics`]. Arguments are plain slices, and results
//!   are plain structs, or a [`NoValue`] that gives the reason why there is none. Arithmetic is done in a fixed order
//!   and elementary functions are those of `libm`: the same input gives the same bits on any machine.
//! * For particles and contacts spread over ranks: [`components`], [`agglomerates`], [`PersistentContacts`],
//!   [`breakage`], [`PopulationFit`] and [`MassRadius`] (fractal dimension), [`mixing`], [`Coordination`], [`stress`],
//!   [`EnergyLedger`]. Results have the same bits for any distribution over ranks, if positions are multiples of the
//!   quantum of positions.
//!
//! Quantities have the units of the input.

mod bed_profile;
mod coordination;
mod digest;
mod fractal_dimension;
mod line_fit;
mod momentum;
mod no_value;
mod observation;
mod series_row;
mod sums;
mod wall_forces;

pub mod bed_height;
pub mod breakage;
pub mod bubbles;
pub mod minimum_fluidisation;
pub mod mixing;
pub mod numerics;
pub mod phase_average;
pub mod repose;
pub mod residence;
pub mod spectrum;
pub mod statistics;
pub mod stress;
pub mod waves;

pub use bed_profile::BedProfile;
pub use coordination::Coordination;
pub use digest::{Digest, StateRecords};
pub use fractal_dimension::{MassRadius, PopulationFit};
pub use line_fit::LineFit;
pub use momentum::MomentumProbe;
pub use no_value::{Estimate, NoValue};
pub use observation::RunView;
pub use series_row::{SeriesColumn, SeriesRow, series_row};
pub use talcum_engine::particle_sets::exact_sums::{Keyed, totals, totals_by_key};
pub use talcum_engine::particle_sets::rendezvous::send_to_rendezvous;
pub use talcum_engine::particle_sets::{
    Image, Ownership, Pair, Periodicity, Persistence, PersistentContacts, agglomerates, components,
};
pub use talcum_engine::state::{EnergyBalance, EnergyLedger, Mechanism, StoredEnergy};
pub use wall_forces::{WallForce, wall_forces};
