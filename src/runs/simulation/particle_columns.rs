//! Columns of particles in snapshots in addition to the standard ones: those that a case requests, and their numbers.

use super::instruments::Instruments;
use crate::case::{Case, ParticleField};
use talcum_engine::fields::{Column, Kind, Unit};
use talcum_engine::parallel::{Communicator, ParticleRecord};
use talcum_engine::particles::{AGGLOMERATE, AgglomerateOfParticle, Body};
use talcum_results::analysis::RunView;
use talcum_results::output::{PointColumn, SnapshotFormat, SnapshotStorage};

/// The snapshot format of a case.
pub(super) fn snapshot_format(case: &Case) -> SnapshotFormat {
    let plan = &case.output;
    let mut columns: Vec<PointColumn> =
        plan.particle_fields.iter().map(|&field| column_of(field)).collect();
    if plan.agglomerates.is_some() {
        let meaning = "smallest id of the particle's agglomerate as of the last sample; -1: none";
        columns.push(whole("agglomerate", meaning));
    }
    let storage =
        SnapshotStorage { single_precision: plan.single_precision, compression: plan.compression };
    SnapshotFormat { columns, storage }
}

/// The numbers of each column, particle after particle. Collective.
pub(super) fn values(
    case: &Case,
    run: RunView<'_>,
    instruments: &Instruments,
    ranks: &dyn Communicator,
) -> Vec<Vec<f64>> {
    let fields = case.output.particle_fields.iter();
    let mut columns: Vec<Vec<f64>> =
        fields.map(|&field| numbers_of(field, case, run, ranks)).collect();
    if let Some(instrument) = &case.output.agglomerates {
        let particles = &run.state.particles;
        let ids = &particles.id[..particles.owned_count()];
        let labels = instruments.agglomerates(instrument, ids, ranks);
        let labels = labels.unwrap_or_else(|| vec![None; ids.len()]);
        columns.push(labels.into_iter().map(|label| label.map_or(-1.0, |id| id as f64)).collect());
    }
    columns
}

fn column_of(field: ParticleField) -> PointColumn {
    let force = |name, meaning| Column::of_kind(name, Kind::Vector, Unit::Force, meaning);
    let of_field = |name: &str| {
        let mut fields = ParticleRecord::FIELDS.iter();
        let field = fields.find(|field| field.name == name);
        Column::of_field(field.expect("the list has it"))
    };
    match field {
        ParticleField::Mass => of_field("mass"),
        ParticleField::Class => whole("class", "number of the size class, from 0; -1: none"),
        ParticleField::Species => of_field("species"),
        ParticleField::Force => force("force", "all forces, gravity included"),
        ParticleField::GasForce => force("gas_force", "forces of the gas"),
        ParticleField::Coordination => whole("coordination", "number of touching particles"),
        ParticleField::DragFactor => of_field("drag_factor"),
    }
}

fn whole(name: &'static str, meaning: &'static str) -> PointColumn {
    Column::of_kind(name, Kind::Integer, Unit::One, meaning)
}

/// The numbers of one column. Collective.
fn numbers_of(
    field: ParticleField,
    case: &Case,
    run: RunView<'_>,
    ranks: &dyn Communicator,
) -> Vec<f64> {
    let particles = &run.state.particles;
    let owned = particles.owned_count();
    let bodies = || particles.body[..owned].iter();
    match field {
        ParticleField::Mass => bodies().map(|body| body.mass).collect(),
        ParticleField::Class => {
            let number = |body: &Body| {
                case.particles.class_number(2.0 * body.radius, body.mass, body.species())
            };
            let classes = bodies().map(number);
            classes.map(|class| class.map_or(-1.0, |number| number as f64)).collect()
        }
        ParticleField::Species => bodies().map(|body| body.species() as f64).collect(),
        ParticleField::Force => {
            particles.forces[..owned].iter().flat_map(|load| <[f64; 3]>::from(load.force)).collect()
        }
        ParticleField::GasForce => {
            run.work.gas.forces_on(particles).into_iter().flat_map(<[f64; 3]>::from).collect()
        }
        ParticleField::DragFactor => {
            let found = particles.columns.at(AGGLOMERATE).iter::<AgglomerateOfParticle>();
            found.map(|of| of.drag_factor).collect()
        }
        ParticleField::Coordination => {
            run.coordination_numbers(ranks).into_iter().map(f64::from).collect()
        }
    }
}
