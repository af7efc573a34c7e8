//! Data that a contact carries from one step to the next, and the records of touching pairs and of particles that touch
//! a wall.

use crate::fields::{Field, Id, Kind, Record, Unit, records, seen_from_the_other_side};
use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;

records! {
    /// All data that a contact carries from one step to the next, seen from the first body; all zero if the bodies did
    /// not touch. A new optional quantity is a line at the end.
    #[derive(Default)]
    pub struct ContactState {
        tangential_spring: Vector, Length,
            "tangential displacement of the second body relative to the first since the contact began" => odd;
        largest_overlap: Number, Length, "largest overlap since the contact began";
        rolling_angle: Vector, Angle,
            "angle that the second body has rolled relative to the first, if a rolling spring holds it"
            => odd, comes_with("rolling springs");
        twisting_angle: Number, Angle,
            "angle that the second body has twisted relative to the first about the normal, if a twisting spring holds it"
            => comes_with("twisting springs");
    }
}

/// History of a contact as seen by its law: one record for all contact laws, which consists of numbers (`f64`) only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactHistory {
    /// Tangential displacement of the second body relative to the first since the contact began.
    pub tangential_spring: Vector3<f64>,
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
}

/// The touching pair of particles `lower` < `higher`, seen from the lower id.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactRecord {
    /// The lower global id.
    pub lower: u64,
    /// The higher global id.
    pub higher: u64,
    /// Data of the contact; the second body is the particle with the higher id.
    pub state: ContactState,
}

/// The contact of a particle and a wall.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WallContactRecord {
    /// The particle's global id.
    pub particle: u64,
    /// The index of the wall in the domain's list of walls.
    pub wall: u64,
    /// Data of the contact; the second body is the wall.
    pub state: ContactState,
    /// Number of the facet of a mesh that acts for the contact; 0 for other walls.
    pub facet: f64,
}

/// The contact histories of some particles: of the pairs that touch, and of the particles that touch a wall.
///
/// They outlive the slots of a neighbour list: they are kept when the list is rebuilt, and go to other ranks and
/// through checkpoints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactHistories {
    /// Touching pairs, in no particular order. A pair may occur twice, with the same contents.
    pub pairs: Vec<ContactRecord>,
    /// Particles that touch a wall, in no particular order.
    pub walls: Vec<WallContactRecord>,
    /// Ids and positions of the particles of other ranks that are in one of the pairs, as far as they are known.
    pub partners: Vec<(u64, Vector3<f64>)>,
}

impl Record for ContactRecord {
    const GROUP: &'static str = "/contacts";
    const IDS: &'static [Id] = &[
        Id { name: "lower", meaning: "lower id of a touching pair, ascending" },
        Id { name: "higher", meaning: "higher id of the pair, ascending for one lower id" },
    ];
    const FIELDS: &'static [Field] = ContactState::FIELDS;
}

impl Record for WallContactRecord {
    const GROUP: &'static str = "/wall_contacts";
    const IDS: &'static [Id] = &[
        Id { name: "particle", meaning: "id of a particle at a wall, ascending" },
        Id { name: "wall", meaning: "number of the wall: faces of the box, then the case's" },
    ];
    const FIELDS: &'static [Field] = &FIELDS_AT_WALL;
}

/// The fields of a contact, and the facet.
const FIELDS_AT_WALL: [Field; ContactState::FIELDS.len() + 1] = {
    let facet =
        Field::new("facet", Kind::Integer, Unit::One, "number of the facet of a mesh, from 0");
    let mut fields = [facet.comes_with("meshes"); ContactState::FIELDS.len() + 1];
    let (of_contact, _) = fields.split_at_mut(ContactState::FIELDS.len());
    of_contact.copy_from_slice(ContactState::FIELDS);
    fields
};

impl ContactHistory {
    /// The tangential spring, then the largest overlap.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[f64; 4] {
        bytemuck::cast_ref(self)
    }
}

impl ContactState {
    /// The part that the contact law sees.
    #[inline(always)]
    pub fn history(&self) -> ContactHistory {
        let Self { tangential_spring, largest_overlap, .. } = *self;
        ContactHistory { tangential_spring: tangential_spring.into(), largest_overlap }
    }

    /// The numbers of its fields, one after another.
    fn numbers_mut(&mut self) -> &mut [f64] {
        bytemuck::cast_slice_mut(std::slice::from_mut(self))
    }

    /// This contact seen from the other body. An angle about the normal is the same from both sides, since the normal
    /// and the spin both change their signs.
    #[must_use]
    pub fn seen_from_the_other_side(mut self) -> Self {
        seen_from_the_other_side(Self::FIELDS, self.numbers_mut());
        self
    }
}

impl ContactRecord {
    /// The contact of the particles `here` and `there`, with its state as seen from `here`.
    pub(super) fn of([here, there]: [u64; 2], state: ContactState) -> Self {
        let mut state = if here > there { state.seen_from_the_other_side() } else { state };
        // The difference of two equal numbers is +0 from both sides; the sign of a zero would only depend on the side
        // from which the pair was evaluated.
        state.numbers_mut().iter_mut().for_each(|number| *number += 0.0);
        Self { lower: here.min(there), higher: here.max(there), state }
    }

    /// The contact as seen from the particle `here`.
    pub(super) fn seen_from(&self, here: u64) -> ContactState {
        if here == self.lower { self.state } else { self.state.seen_from_the_other_side() }
    }
}

impl ContactHistories {
    /// Keeps the histories of contacts of the particles for whose global id `is_kept` holds.
    pub fn retain_particles(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.pairs.retain(|pair| is_kept(pair.lower) && is_kept(pair.higher));
        self.walls.retain(|contact| is_kept(contact.particle));
    }
}
