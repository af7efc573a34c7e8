//! What a checkpoint holds.

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

/// What a checkpoint holds: with the models, the complete state of the simulation. All of it is at the time of the clock;
/// between two steps it is in the hands of [`Staggered`](crate::time_step::Staggered).
#[derive(Clone, Debug)]
pub struct State {
    /// Owned particles and ghosts.
    pub particles: Particles,
    /// Near pairs, and what the touching ones remember.
    pub contacts: Contacts,
    /// Time.
    pub clock: Clock,
    /// What has left the box.
    pub departed: Departed,
    /// Sizes of the particles that the run began with: limits and lattices follow from them.
    pub sizes: SizeRange,
    /// Work by mechanism since the ledger was opened, if anybody keeps account of it. Changes nothing.
    pub energy: Option<Box<EnergyLedger>>,
    /// What the gas is, on this rank's cells.
    pub gas: GasState,
    /// Pairs that touched at the last search for agglomerates, where drag follows from them; each on the rank that owned its lower
    /// id then. None before the first search.
    pub looked_at: Option<Vec<Pair>>,
}
