//! The contents of a checkpoint.

use super::{Clock, EnergyLedger, SizeRange};
use crate::fields::counters;
use crate::gas::GasState;
use crate::particle_sets::Pair;
use crate::particles::{Contacts, Particles};

counters! {
    /// Particles that left through an open face.
    pub struct Departed in "/departed" {
        count: Integer, One, "particles that have left";
        volume: Number, Volume, "their volume, summed in the order of departure and of ids";
    }
}

/// The contents of a checkpoint: together with the models, the complete state of the simulation. All of it belongs to
/// the time of the clock; between two steps it is held by [`Staggered`](crate::time_step::Staggered).
#[derive(Clone, Debug)]
pub struct State {
    /// Owned particles and ghosts.
    pub particles: Particles,
    /// Near pairs, and the histories of the touching ones.
    pub contacts: Contacts,
    /// Time.
    pub clock: Clock,
    /// Particles that have left the box.
    pub departed: Departed,
    /// Sizes of the particles with which the run began: limits and quanta follow from them.
    pub sizes: SizeRange,
    /// Work by mechanism since the ledger was opened, if an energy balance is kept. It changes no result.
    pub energy: Option<Box<EnergyLedger>>,
    /// State of the gas, on this rank's cells.
    pub gas: GasState,
    /// Pairs that touched at the last search for agglomerates, where drag depends on them; each pair is on the rank
    /// that owned its lower id at that time. `None` before the first search.
    pub looked_at: Option<Vec<Pair>>,
}
