//! The three kinds of data: the contents of a checkpoint ([`State`]), the choices of the case ([`Models`]), and data
//! that can be dropped and rebuilt at any time ([`Workspace`]).

mod clock;
mod domain;
mod energy_ledger;
mod limits;
mod models;
mod physics;
mod run_state;
mod workspace;

pub use crate::gas::GasReport;
pub use clock::Clock;
pub use domain::Domain;
pub use energy_ledger::{
    EnergyBalance, EnergyLedger, EnergyRow, Mechanism, StoredEnergy, StoredSums,
};
pub use limits::{Limits, SizeRange};
pub use models::Models;
pub use physics::Physics;
pub use run_state::{Departed, State};
pub use workspace::{Requests, Workspace};
