//! What stands where in a checkpoint.

use std::slice::{from_mut, from_ref};

use bytemuck::Pod;

use crate::analysis::Pair;
use crate::output::ColumnUnits;
use crate::parallel::{CellRecord, ContactRecord, ParticleRecord, WallContactRecord};

/// What the root's attribute `format` says.
pub(super) const FORMAT: &str = "talcum checkpoint";
/// Version of this schema. A change that older programs would misread raises it.
///
/// 2: rolling angles of contacts, and a gas in three dimensions; in files of version 1 there are none.
/// 3: the digest adds hashes by XXH3; those of earlier versions cannot be found again.
/// 4: twisting angles of contacts, and a ledger of energies; in older files there are none.
/// 5: species; written only where there are several, so that older programs read all other files.
/// 6: agglomerates of particles; written only where drag follows from them.
pub(super) const VERSION: u64 = 6;
/// Version of files of several species without them.
pub(super) const VERSION_OF_SPECIES: u64 = 5;
/// Version of files of one species.
pub(super) const VERSION_OF_ONE_SPECIES: u64 = 4;

/// The sums of a ledger of energies.
pub(super) const LEDGER: &str = "/energy/work";

/// A column of integers.
pub(super) struct IdColumn<R> {
    pub(super) name: &'static str,
    pub(super) description: &'static str,
    pub(super) get: fn(&R) -> u64,
    pub(super) get_mut: fn(&mut R) -> &mut u64,
}

/// A column of numbers or of vectors.
pub(super) struct NumberColumn<R> {
    pub(super) name: &'static str,
    pub(super) width: usize,
    pub(super) unit: fn(&ColumnUnits) -> &'static str,
    pub(super) description: &'static str,
    /// Version of the schema that brought it; zero in older files.
    pub(super) since: u64,
    pub(super) get: fn(&R) -> &[f64],
    pub(super) get_mut: fn(&mut R) -> &mut [f64],
}

/// Records of one kind: a dataset for each column, all with equally many rows. Rows are sorted by the
/// first column, then by the second.
pub(super) trait Table: Pod {
    const IDS: &'static [IdColumn<Self>];
    const NUMBERS: &'static [NumberColumn<Self>];
}

/// The columns of numbers that a file of this version has.
pub(super) fn columns_of<R: Table>(version: u64) -> impl Iterator<Item = &'static NumberColumn<R>> {
    R::NUMBERS.iter().filter(move |column| column.since <= version)
}

macro_rules! vector {
    ($name:literal, $field:ident, $unit:ident, $description:literal) => {
        vector!($name, $field, $unit, $description, 1)
    };
    ($name:literal, $field:ident, $unit:ident, $description:literal, $since:literal) => {
        NumberColumn {
            name: $name,
            width: 3,
            unit: |units| units.$unit,
            description: $description,
            since: $since,
            get: |record| &record.$field,
            get_mut: |record| &mut record.$field,
        }
    };
}

macro_rules! number {
    ($name:literal, $field:ident, $unit:ident, $description:literal) => {
        number!($name, $field, $unit, $description, 1)
    };
    ($name:literal, $field:ident, $unit:ident, $description:literal, $since:literal) => {
        NumberColumn {
            name: $name,
            width: 1,
            unit: |units| units.$unit,
            description: $description,
            since: $since,
            get: |record| from_ref(&record.$field),
            get_mut: |record| from_mut(&mut record.$field),
        }
    };
}

macro_rules! id {
    ($name:literal, $field:ident, $description:literal) => {
        IdColumn {
            name: $name,
            description: $description,
            get: |record| record.$field,
            get_mut: |record| &mut record.$field,
        }
    };
}

impl Table for ParticleRecord {
    const IDS: &'static [IdColumn<Self>] = &[id!("/particles/id", id, "global id, ascending")];
    const NUMBERS: &'static [NumberColumn<Self>] = &[
        vector!("/particles/position", position, length, "centre, wrapped into the box"),
        vector!("/particles/velocity", velocity, speed, "velocity of the centre"),
        vector!("/particles/angular_velocity", angular_velocity, angular_speed, "angular velocity"),
        vector!("/particles/force", force, force, "total force at the end of the last step"),
        vector!("/particles/torque", torque, torque, "total torque at the end of the last step"),
        number!("/particles/radius", radius, length, "radius"),
        number!("/particles/mass", mass, mass, "mass"),
        vector!(
            "/particles/gas_force",
            gas_force,
            force,
            "force of a gas in three dimensions as of its last step, which holds until the next",
            2
        ),
        number!("/particles/species", species, number, "number of the species, from 0", 5),
        number!(
            "/particles/agglomerate_diameter",
            agglomerate_diameter,
            length,
            "diameter of the particle's agglomerate as of the last look; 0: alone",
            6
        ),
        number!(
            "/particles/agglomerate_packing",
            agglomerate_packing,
            number,
            "volume of its members over that of a sphere of this diameter",
            6
        ),
        number!(
            "/particles/drag_factor",
            drag_factor,
            number,
            "drag over that of the law in the last step of the gas",
            6
        ),
    ];
}

impl Table for Pair {
    const IDS: &'static [IdColumn<Self>] = &[
        id!(
            "/looked_at/lower",
            lower,
            "lower id of a pair that touched at the last look at agglomerates"
        ),
        id!("/looked_at/higher", higher, "higher id of the pair"),
    ];
    const NUMBERS: &'static [NumberColumn<Self>] = &[];
}

impl Table for ContactRecord {
    const IDS: &'static [IdColumn<Self>] = &[
        id!("/contacts/lower", lower, "lower id of a touching pair, ascending"),
        id!("/contacts/higher", higher, "higher id of the pair, ascending for one lower id"),
    ];
    const NUMBERS: &'static [NumberColumn<Self>] = &[
        vector!(
            "/contacts/tangential_spring",
            tangential_spring,
            length,
            "tangential displacement of the higher relative to the lower since the contact began"
        ),
        number!(
            "/contacts/largest_overlap",
            largest_overlap,
            length,
            "largest overlap since the contact began"
        ),
        vector!(
            "/contacts/rolling_angle",
            rolling_angle,
            angle,
            "angle that the higher has rolled relative to the lower, if a rolling spring holds it",
            2
        ),
        number!(
            "/contacts/twisting_angle",
            twisting_angle,
            angle,
            "angle that the higher has twisted relative to the lower, if a twisting spring holds it",
            4
        ),
    ];
}

impl Table for WallContactRecord {
    const IDS: &'static [IdColumn<Self>] = &[
        id!("/wall_contacts/particle", particle, "id of a particle at a wall, ascending"),
        id!("/wall_contacts/wall", wall, "number of the wall: faces of the box, then the case's"),
    ];
    const NUMBERS: &'static [NumberColumn<Self>] = &[
        vector!(
            "/wall_contacts/tangential_spring",
            tangential_spring,
            length,
            "tangential displacement of the wall relative to the particle since the contact began"
        ),
        number!(
            "/wall_contacts/largest_overlap",
            largest_overlap,
            length,
            "largest overlap since the contact began"
        ),
        vector!(
            "/wall_contacts/rolling_angle",
            rolling_angle,
            angle,
            "angle that the wall has rolled relative to the particle, if a rolling spring holds it",
            2
        ),
        number!(
            "/wall_contacts/twisting_angle",
            twisting_angle,
            angle,
            "angle that the wall has twisted relative to the particle, if a twisting spring holds it",
            4
        ),
    ];
}

impl Table for CellRecord {
    const IDS: &'static [IdColumn<Self>] =
        &[id!("/gas/cell", cell, "number of the cell, x fastest, then y, then z, ascending")];
    const NUMBERS: &'static [NumberColumn<Self>] = &[
        vector!(
            "/gas/lower_velocity",
            lower_velocity,
            speed,
            "velocity at the lower face along x, y, z",
            2
        ),
        vector!(
            "/gas/upper_velocity",
            upper_velocity,
            speed,
            "velocity at the upper face along x, y, z",
            2
        ),
        number!("/gas/pressure", pressure, pressure, "pressure less the hydrostatic head", 2),
        number!("/gas/voidage", voidage, number, "volume of gas per volume", 2),
    ];
}
