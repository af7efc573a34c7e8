//! Exchange of quantities other than momentum between touching particles: heat, charge, or any other quantity of a
//! custom law.
//!
//! Each particle has a value of the law's field; ghosts have its value at the beginning of each step. While two
//! particles touch, an amount flows from one to the other; the sums of these flows change the field at the end of the
//! step. Flows are rounded to a quantum before they are added, so that neither the order of contacts nor the rank that
//! evaluates one changes a bit.

use crate::fields::{Field, Travel};
use crate::numbers::Quantum;
use crate::particles::{Body, Contacts, PairGroup, Particles};
use std::fmt::Debug;
use std::sync::Arc;
use thiserror::Error;

/// A law of the exchange between touching particles. `examples/custom_field.rs` contains one: conduction of heat.
pub trait ContactExchange: Debug + Send + Sync {
    /// The exchanged field, one number for each particle.
    fn field(&self) -> Field;

    /// Flow from the first particle to the second; amount per time. The first has the lower id.
    fn flow(&self, contact: &TouchingParticles, values: [f64; 2]) -> f64;

    /// The largest flow between two particles, by magnitude; amount per time. Flows are rounded to a fraction of about
    /// 10^-15 of it; a larger flow ends the run.
    fn largest_flow(&self) -> f64;

    /// The rate at which a particle's value changes through the total inflow from all contacts; the field's unit per
    /// time.
    fn rate(&self, particle: &Body, inflow: f64) -> f64;
}

/// Two particles that touch.
#[derive(Clone, Copy, Debug)]
pub struct TouchingParticles<'a> {
    /// The particles; the one with the lower id is first.
    pub bodies: [&'a Body; 2],
    /// Sum of the radii less the distance of the centres; may be negative if the law lets contacts last beyond
    /// touching.
    pub overlap: f64,
    /// r_1 r_2 / (r_1 + r_2); length.
    pub reduced_radius: f64,
}

/// The laws of exchange of a run.
#[derive(Clone, Debug, Default)]
pub struct Exchanges(Vec<Arc<dyn ContactExchange>>);

/// Reason why the flows of a law cannot be added.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum ExchangeError {
    /// A flow above the limit of its law.
    #[error(
        "{flow:.3e} of \"{field}\" flows between the particles {lower} and {higher} (limit {limit:.3e})"
    )]
    FlowOutOfRange { field: &'static str, lower: u64, higher: u64, flow: f64, limit: f64 },
    /// A law of a field that the particles do not have.
    #[error("touching particles exchange \"{0}\", which is not a custom field of the particles")]
    NoField(&'static str),
}

/// Two are equal if their laws are the same objects; laws that merely compute the same are not equal.
impl PartialEq for Exchanges {
    fn eq(&self, other: &Self) -> bool {
        self.0.len() == other.0.len()
            && self.0.iter().zip(&other.0).all(|(one, other)| Arc::ptr_eq(one, other))
    }
}

impl Exchanges {
    /// Adds a law.
    pub fn add(&mut self, law: impl ContactExchange + 'static) {
        self.0.push(Arc::new(law));
    }

    /// The exchanged fields, with the travel that ghosts need.
    pub fn fields(&self) -> impl Iterator<Item = Field> + '_ {
        self.0.iter().map(|law| law.field().travels(Travel::EachStep))
    }

    /// Adds the columns of flows to the particles, in addition to those of the fields.
    pub fn add_flow_columns(&self, particles: &mut Particles) {
        self.fields().for_each(|field| particles.columns.add(field.travels(Travel::Returned)));
    }
}

/// Adds the flows of the touching pairs of a group to both their particles.
///
/// # Errors
/// If a flow exceeds the limit of its law or is undefined, or if the particles do not have the field.
pub(crate) fn add_flows(
    particles: &mut Particles,
    contacts: &Contacts,
    exchanges: &Exchanges,
    group: PairGroup,
) -> Result<(), ExchangeError> {
    exchanges.0.iter().try_for_each(|law| add_flows_of(&**law, particles, contacts, group))
}

fn add_flows_of(
    law: &dyn ContactExchange,
    particles: &mut Particles,
    contacts: &Contacts,
    group: PairGroup,
) -> Result<(), ExchangeError> {
    let no_field = || ExchangeError::NoField(law.field().name);
    let [value, inflow] = columns_of(law, particles).ok_or_else(no_field)?;
    let limit = law.largest_flow();
    let quantum = Quantum::spanning(limit);
    for (_, [first, second], state) in contacts.inner.active_pairs(group) {
        if state.is_none() {
            continue;
        }
        let mut pair = [first as usize, second as usize];
        pair.sort_by_key(|&index| particles.id[index]);
        let bodies = pair.map(|index| &particles.body[index]);
        let values = pair.map(|index| particles.columns.at(value).get::<f64>(index));
        let flow = law.flow(&TouchingParticles::of(bodies), values);
        if flow.is_nan() || flow.abs() > limit {
            let (field, [lower, higher]) =
                (law.field().name, pair.map(|index| particles.id[index]));
            return Err(ExchangeError::FlowOutOfRange { field, lower, higher, flow, limit });
        }
        let [from, to] = pair.map(|index| particles.owned_original(index).unwrap_or(index));
        let sums = particles.columns.at_mut(inflow).hold::<f64>();
        sums[from] -= quantum.round(flow);
        sums[to] += quantum.round(flow);
    }
    Ok(())
}

/// Advances the fields by the flows of a step of this length, and sets the flows to zero.
pub(crate) fn advance_fields(particles: &mut Particles, exchanges: &Exchanges, dt: f64) {
    for law in &exchanges.0 {
        let Some([value, inflow]) = columns_of(&**law, particles) else { continue };
        for index in 0..particles.owned_count() {
            let flow = particles.columns.at(inflow).get(index);
            let change = dt * law.rate(&particles.body[index], flow);
            let before: f64 = particles.columns.at(value).get(index);
            particles.columns.at_mut(value).set(index, before + change);
        }
        particles.columns.at_mut(inflow).reset();
    }
}

/// The columns of the field of a law, and of its flows.
fn columns_of(law: &dyn ContactExchange, particles: &Particles) -> Option<[usize; 2]> {
    let name = law.field().name;
    let [value, inflow] = [Travel::EachStep, Travel::Returned]
        .map(|travel| particles.columns.number_of_own(name, travel));
    Some([value?, inflow?])
}

impl<'a> TouchingParticles<'a> {
    fn of(bodies: [&'a Body; 2]) -> Self {
        let [one, other] = bodies;
        let radii = one.radius + other.radius;
        let overlap = radii - (other.position - one.position).norm();
        Self { bodies, overlap, reduced_radius: one.radius * other.radius / radii }
    }
}
