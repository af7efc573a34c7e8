//! Conversion of particles to records and back: the place of each field in memory.

use super::columns::column_groups;
use super::{Body, ForceTorque, ParticleRecord, Particles};
use crate::fields::Record;
use bytemuck::Zeroable;
use std::ops::Range;
use std::sync::LazyLock;

/// Places in the record of the numbers of each built-in column.
static COLUMN_PLACES: LazyLock<Vec<Range<usize>>> = LazyLock::new(|| {
    let place_of = |field: usize| ParticleRecord::places().nth(field).map(|(place, _)| place);
    let end = size_of::<ParticleRecord>() / size_of::<u64>();
    let places = column_groups()
        .map(|fields| place_of(fields.start).unwrap_or(end)..place_of(fields.end).unwrap_or(end));
    places.collect()
});

impl ParticleRecord {
    /// The record of one owned particle. It is inlined, so that only the id is loaded if nothing else is used.
    #[inline(always)]
    pub fn of(particles: &Particles, index: usize) -> Self {
        let (body, load) = (&particles.body[index], &particles.forces[index]);
        let mut record = Self {
            id: particles.id[index],
            position: body.position.into(),
            velocity: body.velocity.into(),
            angular_velocity: body.angular_velocity.into(),
            force: load.force.into(),
            torque: load.torque.into(),
            radius: body.radius,
            mass: body.mass,
            species: body.species() as f64,
            ..Self::zeroed()
        };
        record.set_columns(particles, index);
        record
    }

    fn set_columns(&mut self, particles: &Particles, index: usize) {
        let words = self.words_mut();
        for (number, places) in COLUMN_PLACES.iter().enumerate() {
            if let row @ [_, ..] = particles.columns.at(number).row(index) {
                words[places.clone()].copy_from_slice(bytemuck::cast_slice(row));
            }
        }
    }

    /// Adds the particle to the owned ones. Before: there are no ghosts.
    pub fn push_to(&self, particles: &mut Particles) {
        let index = particles.count();
        let (position, velocity) = (self.position.into(), self.velocity.into());
        particles.push(self.id, position, velocity, self.radius, self.mass);
        let body: &mut Body = &mut particles.body[index];
        *body = body.of_species(self.species as usize);
        body.angular_velocity = self.angular_velocity.into();
        particles.forces[index] = ForceTorque::new(self.force.into(), self.torque.into());
        for (number, places) in COLUMN_PLACES.iter().enumerate() {
            let row = bytemuck::cast_slice(&self.words()[places.clone()]);
            particles.columns.at_mut(number).set_row(index, row);
        }
    }
}
