//! A contact law from outside whose results are odd numbers at some contacts, for scripts/torture.

use serde_json::Value;
use talcum::contact::{
    Contact, ContactForce, ContactForceLaw, ContactLaw, ContactStep, ContactWork, FrictionCap,
    LinearSpringDashpot, StoredInContact,
};
use talcum::domain::{Face, RankGrid};
use talcum::parallel::{Communicator, start_on_threads};
use talcum::particles::ContactHistory;
use talcum::setup::{Layers, Setup};
use talcum::state::Physics;

const STEPS: u64 = 300;

/// A linear spring and dashpot with one odd result. Odd is a function of the contact alone, seen alike from both sides, so that
/// the answer must not depend on ranks.
#[derive(Debug)]
struct OddLaw {
    base: LinearSpringDashpot,
    /// The result that is odd.
    what: String,
    /// The number in its place.
    number: f64,
    /// Contacts are odd beyond this overlap.
    beyond: f64,
}

impl OddLaw {
    /// The number in place of a result, if it is the odd one and the overlap is large enough.
    fn odd(&self, what: &str, overlap: f64, otherwise: f64) -> f64 {
        if self.what == what && overlap > self.beyond { self.number } else { otherwise }
    }
}

impl ContactForceLaw for OddLaw {
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        let overlap = contact.overlap;
        assert!(self.what != "panic" || overlap <= self.beyond, "odd");
        let mut force = self.base.force(contact, history, dt);
        let factor = self.odd("spring", overlap, 1.0);
        history.tangential_spring *= factor;
        history.largest_overlap = self.odd("largest overlap", overlap, history.largest_overlap);
        force.normal = self.odd("normal", overlap, force.normal);
        force.tangential *= self.odd("tangential", overlap, 1.0);
        force.friction_normal = self.odd("friction", overlap, force.friction_normal);
        force
    }

    fn touches(&self, contact: &Contact, _: &ContactHistory) -> bool {
        if self.what == "touches" { self.number > 0.0 } else { contact.overlap > 0.0 }
    }

    fn contact_range(&self, _: f64) -> f64 {
        self.odd("range", f64::INFINITY, 0.0)
    }

    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.odd("stiffness", f64::INFINITY, self.base.stiffness(overlap, reduced_radius))
    }

    fn contact_duration(&self, mass: f64, radius: f64) -> f64 {
        self.odd("duration", f64::INFINITY, self.base.contact_duration(mass, radius))
    }

    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        let stored = self.base.stored_energy(contact, history);
        let normal = self.odd("energy", contact.overlap, stored.normal);
        StoredInContact { normal, ..stored }
    }

    fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        let work = self.base.work(step);
        ContactWork { dashpot: self.odd("work", f64::INFINITY, work.dashpot), ..work }
    }

    fn largest_force(&self, overlap: f64, radius: f64) -> f64 {
        self.odd("largest force", f64::INFINITY, self.base.largest_force(overlap, radius))
    }
}

/// A bed that falls onto its plate with such a law, on some ranks as threads: its digest, or the error of a rank.
pub(crate) fn try_law(request: &Value) -> Result<String, String> {
    let number = |name: &str| request[name].as_str().unwrap_or_default().parse::<f64>();
    let ranks = request["ranks"].as_u64().unwrap_or(1) as usize;
    let with_ledger = request["ledger"].as_bool().unwrap_or_default();
    let base = LinearSpringDashpot::new(2.0e4, 1.0e4, 0.7, 0.3, FrictionCap::Contact);
    let law = OddLaw {
        base: base.map_err(|error| error.to_string())?,
        what: request["law"].as_str().unwrap_or_default().to_owned(),
        number: number("number").map_err(|error| error.to_string())?,
        beyond: number("beyond").map_err(|error| error.to_string())?,
    };
    let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];
    let layers = Layers { count: 80, spacing: 0.998, jitter: 0.0, seed: 1, ..Layers::default() };
    let physics = Physics::new(ContactLaw::custom("odd", law), 4.0e-4);
    let setup = Setup::new([5.0, 5.0, 12.0], faces, physics).map_err(|error| error.to_string())?;
    let setup = setup.gravity(1.0).layers(&layers);
    let results = start_on_threads(ranks, |ranks| run(&setup, with_ledger, ranks));
    let results = results.map_err(|error| error.to_string())?;
    results.into_iter().next().unwrap_or_else(|| Err("no rank".to_owned()))
}

fn run(setup: &Setup, with_ledger: bool, ranks: &dyn Communicator) -> Result<String, String> {
    let grid = RankGrid::slabs(1, ranks.size());
    let mut run = setup.start(grid, ranks).map_err(|error| error.to_string())?;
    if with_ledger {
        run.keep_energy_ledger();
    }
    run.steps(STEPS).map_err(|error| error.to_string())?;
    run.digest().map(|digest| digest.to_string()).map_err(|error| error.to_string())
}
