//! Particles in the volume-averaged gas, compared with closed forms, and the same bits on any ranks.

mod agglomerates;
mod column;
mod cooling;
mod drifting;
mod force_balance;
mod lone_particle;
mod moving_wall;
mod one_answer;
mod packed_bed;
mod round_column;
mod settling;
mod shallow_bed;
mod vortex;

use crate::beds::Bench;
use nalgebra::Vector3;
use talcum::domain::Face;
use talcum::gas::volume_averaged::{
    Boundary, CouplingModel, Inlet, Profile, VolumeAveragedGas, VolumeAveragedModel,
};
use talcum::gas::{DragLaw, DragShare, ParticleDrag};
use talcum::grid::BoxGrid;
use talcum::linear_solver::Tolerance;
use talcum::numbers::Schedule;

/// No-slip where the box has walls, an inlet of this velocity below and an outlet above.
fn boundaries(bench: &Bench, inflow: f64) -> [[Boundary; 2]; 3] {
    let bounds = &bench.domain.bounds;
    let inlet =
        Inlet { velocity: Schedule::Constant(inflow), profile: Profile::Uniform, jet: None };
    let vertical = [Boundary::Inlet(inlet), Boundary::Outlet { pressure: 0.0 }];
    std::array::from_fn(|axis| match bounds.faces(axis)[0] {
        Face::Periodic => [Boundary::Periodic, Boundary::Periodic],
        _ if axis == 2 => vertical.clone(),
        _ => [(); 2].map(|()| Boundary::NO_SLIP),
    })
}

/// A gas on cells of the bench's box.
fn gas_on_cells(
    bench: &Bench,
    cells: [usize; 3],
    (density, viscosity): (f64, f64),
    law: DragLaw,
    inflow: f64,
) -> VolumeAveragedModel {
    let tolerance = Tolerance::relative(1.0e-8);
    let boundaries = boundaries(bench, inflow);
    VolumeAveragedModel {
        grid: BoxGrid::new(&bench.domain.bounds, cells),
        column: None,
        gas: VolumeAveragedGas { density, viscosity, boundaries, tolerance },
        coupling: CouplingModel {
            drag: ParticleDrag {
                law,
                factor: 1.0,
                share: DragShare::default(),
                viscosity,
                density,
                parcel_size: 1.0,
            },
            agglomerates: None,
            filter_width: 0.0,
            undisturbed: false,
            local_voidage: None,
            least_voidage: 0.2,
        },
        substeps: 5,
        driving: Vector3::zeros(),
    }
}
