//! One step of the equations of the gas.

use super::advection::{Advection, courant_rate, set_fluxes};
use super::boundaries::{
    continue_correction, continue_pressure, continue_velocity, mirror, set_boundary_faces,
};
use super::faces::{Layers, Region};
use super::model::LocalGas;
use super::momentum::{Forces, Momentum, correct, predict, set_continuity_residual};
use super::round_wall::RoundWall;
use super::viscosity::{
    StressRows, ViscousFields, add_viscous_force, largest_viscous_rate, set_dilatation,
};
use super::{BedOnGrid, GAS_HALO, GasFields, VolumeAveragedGas};
use crate::domain::Subdomain;
use crate::gas::NavierStokesError;
use crate::grid::{BoxGrid, Field, LocalCells, RoundColumn};
use crate::linear_solver::{Convergence, LinearSolverError, PressureSolver, Tolerance};
use crate::numbers::vectorised;
use crate::parallel::{Communicator, FieldHalo};
use crate::rules::{LARGEST_STEP_NUMBER, step_number};
use nalgebra::Vector3;

/// Fraction of the largest step number from which the next step is checked: a flow that fails can double its speed
/// within a step only because of an inlet.
const NEAR_THE_LIMIT: f64 = 0.5;

/// Advances the gas on a rank's part of the grid. It holds no data on which the future depends.
#[derive(Clone, Debug)]
pub struct NavierStokesSolver {
    part: LocalCells,
    spacing: Vector3<f64>,
    halo: FieldHalo,
    pressure_solver: PressureSolver,
    /// The wall around the gas, in a round column.
    wall: Option<RoundWall>,
    explicit: ExplicitForces,
    predicted: [Field; 3],
    coefficients: [Field; 3],
    diagonal: Field,
    residual: Field,
    change: Field,
}

/// Number of roundings in the sum of a cell's flows: six products and their additions.
const ROUNDINGS: f64 = 8.0;

/// Advection and viscous force, which are explicit in time.
#[derive(Clone, Debug)]
struct ExplicitForces {
    /// eps u.
    flux: [Field; 3],
    /// div u.
    dilatation: Field,
    /// Force per volume on faces.
    rate: [Field; 3],
    /// Viscous force per open volume, in a round column.
    viscous: Option<Field>,
}

impl ExplicitForces {
    fn set_fluxes(&mut self, velocity: &[Field; 3], voidage: &Field, part: &LocalCells) {
        set_fluxes(&mut self.flux, velocity, voidage, part);
    }
}

vectorised!(
    /// Adds the forces of a velocity whose fluxes are set, at a voidage per open volume.
    fn add_forces(
        explicit: &mut ExplicitForces,
        velocity: &[Field; 3],
        voidage: &Field,
        local: LocalGas,
        wall: Option<&RoundWall>,
        spacing: Vector3<f64>,
    ) {
        let ExplicitForces { flux, dilatation, rate, viscous } = explicit;
        set_dilatation(dilatation, velocity, local.part, spacing);
        let fields = ViscousFields { velocity, dilatation, voidage };
        let mut advection = Advection::new(flux, local, spacing);
        let mut stresses = StressRows::default();
        for layers in Layers::blocks(local.part) {
            let at = (local, &layers);
            for (axis, rate) in rate.iter_mut().enumerate() {
                advection.add(rate, axis, &velocity[axis], &layers);
                if wall.is_none() {
                    add_viscous_force(rate, axis, fields, at, (spacing, &mut stresses));
                }
            }
        }
        if let Some((wall, viscous)) = wall.zip(viscous.as_mut()) {
            for (axis, rate) in rate.iter_mut().enumerate() {
                wall.add_viscous_force([rate, viscous], axis, fields, local, spacing);
            }
        }
    }
);

vectorised!(
    /// Number of cells whose voidage is not above 0 or exceeds 1.
    fn wrong_cells(voidage: &Field, part: &LocalCells) -> u64 {
        let mut wrong = 0;
        for row in Region::owned(part).rows(voidage) {
            for &eps in &voidage.values()[row] {
                wrong += u64::from(!(eps > 0.0 && eps <= 1.0));
            }
        }
        wrong
    }
);

/// A step and its forces, except those of pressure and particles.
#[derive(Clone, Copy, Debug)]
pub struct NavierStokesStep<'a> {
    /// Time at its beginning.
    pub time: f64,
    /// Its length.
    pub dt: f64,
    /// Driving force per volume of gas, minus a mean gradient of pressure: it moves gas through a periodic box.
    pub driving: Vector3<f64>,
    /// Another force per volume, on faces, in the middle of the step.
    pub source: Option<&'a [Field; 3]>,
}

/// Report on a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavierStokesReport {
    /// dt times the largest sum of |eps u| / (eps spacing) over the axes.
    pub courant: f64,
    /// dt times the largest damping rate of viscosity.
    pub viscous: f64,
    /// Convergence of the pressure equation.
    pub convergence: Convergence,
}

impl NavierStokesSolver {
    /// A solver for a decomposition whose planes lie on cell faces, with at least two cells between them
    /// ([`BoxGrid::aligned`]).
    pub fn new(grid: &BoxGrid, subdomain: Subdomain) -> Self {
        let part = grid.local_cells(subdomain);
        let zero = || Field::new(&part, GAS_HALO);
        let three = || [zero(), zero(), zero()];
        Self {
            wall: None,
            part,
            spacing: grid.spacing(),
            halo: FieldHalo::new(subdomain),
            pressure_solver: PressureSolver::new(grid, subdomain),
            explicit: ExplicitForces {
                flux: three(),
                dilatation: zero(),
                rate: three(),
                viscous: None,
            },
            predicted: three(),
            coefficients: three(),
            diagonal: zero(),
            residual: zero(),
            change: zero(),
        }
    }

    /// This solver for a gas of this viscosity in a round column on the same grid.
    pub fn in_column(mut self, grid: &BoxGrid, column: &RoundColumn, viscosity: f64) -> Self {
        self.wall = Some(RoundWall::new(grid, &self.part, column, viscosity));
        self.explicit.viscous = Some(Field::new(&self.part, GAS_HALO));
        self
    }

    /// This rank's part of the grid.
    pub fn part(&self) -> &LocalCells {
        &self.part
    }

    /// Sets the velocity in the faces of walls and inlets of a state at this time, and fills its halos; used at the
    /// start of the gas. Collective.
    pub fn complete(
        &mut self,
        gas: &VolumeAveragedGas,
        state: &mut GasFields,
        time: f64,
        ranks: &dyn Communicator,
    ) {
        self.halo.refresh(&mut [&mut state.voidage], ranks);
        mirror(&mut [&mut state.voidage], &self.part, gas);
        let local = LocalGas { part: &self.part, gas };
        set_boundary_faces(&mut state.velocity, (&state.voidage, self.wall.as_ref()), local, time);
        self.fill_halos(gas, state, ranks);
    }

    /// Fills the halos of a state that is known in owned cells and in the faces of the box; used after its cells have
    /// come from a checkpoint or other ranks. Collective.
    pub fn fill_halos(
        &mut self,
        gas: &VolumeAveragedGas,
        state: &mut GasFields,
        ranks: &dyn Communicator,
    ) {
        let GasFields { velocity, pressure, voidage } = state;
        let [x, y, z] = velocity;
        self.halo.refresh(&mut [voidage, pressure, x, y, z], ranks);
        mirror(&mut [voidage], &self.part, gas);
        continue_pressure(pressure, &self.part, gas);
    }

    /// Advances the gas by a step, in which the voidage changes from that of the state to that of the bed.
    ///
    /// 1. Two predictions with implicit drag and the old pressure, advection and viscosity from the beginning
    ///    of the step, then from the mean of beginning and first prediction (Heun).
    /// 2. The change of pressure p' from continuity,
    ///    div[eps^2 / (eps rho/dt + beta) grad p'] = div(eps u) + (eps - eps_old)/dt.
    /// 3. The velocity loses eps / (eps rho/dt + beta) grad p': it then obeys continuity to the tolerance of
    ///    the pressure equation.
    ///
    /// Before: owned cells of the bed, a complete state. After: halos of both are filled, except for the velocity
    /// beyond the box. This depends on the time through moving walls, and is set at the beginning of each step.
    ///
    /// # Errors
    /// See [`NavierStokesError`]; the state is then as before.
    pub fn advance(
        &mut self,
        gas: &VolumeAveragedGas,
        state: &mut GasFields,
        bed: &mut BedOnGrid,
        step: &NavierStokesStep,
        ranks: &dyn Communicator,
    ) -> Result<NavierStokesReport, NavierStokesError> {
        self.complete_bed(gas, bed, ranks);
        let mut wall = self.wall.take();
        if let Some(wall) = &mut wall {
            wall.set_bed(bed, &state.voidage);
        }
        let result = self.advance_in(wall.as_ref(), gas, (state, bed), step, ranks);
        self.wall = wall;
        result
    }

    /// Advances the gas with a bed whose halos are filled, within a round wall if there is one.
    fn advance_in(
        &mut self,
        wall: Option<&RoundWall>,
        gas: &VolumeAveragedGas,
        (state, bed): (&mut GasFields, &BedOnGrid),
        step: &NavierStokesStep,
        ranks: &dyn Communicator,
    ) -> Result<NavierStokesReport, NavierStokesError> {
        let (part, dt, spacing) = (&self.part.clone(), step.dt, self.spacing);
        let local = LocalGas { part, gas };
        continue_velocity(&mut state.velocity, local, step.time);
        let in_cells = wall.map_or(bed, |wall| &wall.bed);
        let momentum = Momentum { gas, part, spacing, bed: in_cells, wall, dt };
        let before = wall.map_or(&state.voidage, |wall| &wall.voidage_before);
        self.explicit.set_fluxes(&state.velocity, before, part);
        let (courant, viscous) = self.limits(&momentum, &bed.voidage, ranks)?;
        self.explicit.rate.iter_mut().for_each(|rate| rate.values_mut().fill(0.0));
        let explicit = &mut self.explicit;
        add_forces(explicit, &state.velocity, &state.voidage, local, wall, spacing);
        self.predict(&momentum, (state, &bed.voidage), (step, 1.0), ranks);
        self.explicit.set_fluxes(&self.predicted, &in_cells.voidage, part);
        let explicit = &mut self.explicit;
        add_forces(explicit, &self.predicted, &bed.voidage, local, wall, spacing);
        self.predict(&momentum, (state, &bed.voidage), (step, 0.5), ranks);
        let rounding = self.rounding_of_continuity(courant / dt);
        let convergence = self.solve_pressure(&momentum, before, rounding, ranks)?;
        self.finish(&momentum, (state, &bed.voidage), ranks);
        Ok(NavierStokesReport { courant, viscous, convergence })
    }

    /// Whether a step like the last one would be too long for the velocity after the last one, at the present voidage.
    /// It is checked only if the last step came near the limit, so that it costs nothing elsewhere. Collective.
    pub fn next_is_too_long(
        &mut self,
        state: &GasFields,
        last: &NavierStokesReport,
        dt: f64,
        ranks: &dyn Communicator,
    ) -> bool {
        if step_number(last.courant, last.viscous) < NEAR_THE_LIMIT * LARGEST_STEP_NUMBER {
            return false;
        }
        if let Some(wall) = &mut self.wall {
            wall.set_voidage(&state.voidage);
        }
        let voidage = self.wall.as_ref().map_or(&state.voidage, |wall| &wall.voidage_before);
        self.explicit.set_fluxes(&state.velocity, voidage, &self.part);
        let rate = courant_rate(&self.explicit.flux, voidage, &self.part, self.spacing);
        let mut courant = [dt * rate];
        ranks.maximum(&mut courant);
        step_number(courant[0], last.viscous) > LARGEST_STEP_NUMBER
    }

    fn complete_bed(
        &mut self,
        gas: &VolumeAveragedGas,
        bed: &mut BedOnGrid,
        ranks: &dyn Communicator,
    ) {
        let [x, y, z] = &mut bed.transferred_velocity;
        let mut fields = [&mut bed.voidage, &mut bed.momentum_transfer, x, y, z];
        self.halo.refresh(&mut fields, ranks);
        mirror(&mut fields, &self.part, gas);
    }

    /// Courant and viscous numbers; an error if the step is too long for them.
    fn limits(
        &self,
        momentum: &Momentum,
        voidage: &Field,
        ranks: &dyn Communicator,
    ) -> Result<(f64, f64), NavierStokesError> {
        let &Momentum { gas, part, spacing, bed, dt, .. } = momentum;
        let wrong = wrong_cells(voidage, part);
        let courant = courant_rate(&self.explicit.flux, &bed.voidage, part, spacing);
        let viscous = largest_viscous_rate(voidage, LocalGas { part, gas }, spacing);
        let mut numbers = [wrong as f64, courant, viscous];
        ranks.maximum(&mut numbers);
        let [wrong, courant, viscous] = numbers;
        if wrong > 0.0 {
            return Err(self.wrong_voidage(voidage, ranks));
        }
        if !(courant.is_finite() && viscous.is_finite()) {
            return Err(NavierStokesError::NotFinite);
        }
        let rate = step_number(courant, viscous);
        let (courant, viscous) = (dt * courant, dt * viscous);
        if dt * rate <= LARGEST_STEP_NUMBER {
            Ok((courant, viscous))
        } else {
            Err(NavierStokesError::StepTooLong { dt, courant, viscous, longest: 1.0 / rate })
        }
    }

    /// The error of an invalid voidage on some rank. Collective.
    fn wrong_voidage(&self, voidage: &Field, ranks: &dyn Communicator) -> NavierStokesError {
        let cells = Region::owned(&self.part).cells().map(|cell| voidage.at(cell));
        let (mut largest, mut least_negated, mut undefined) = (0.0_f64, -1.0_f64, false);
        for eps in cells {
            undefined |= !eps.is_finite();
            (largest, least_negated) = (largest.max(eps), least_negated.max(-eps));
        }
        let mut numbers = [largest, least_negated, f64::from(u8::from(undefined))];
        ranks.maximum(&mut numbers);
        match numbers {
            [largest, least_negated, 0.0] => {
                NavierStokesError::Voidage { least: -least_negated, largest }
            }
            _ => NavierStokesError::NotFinite,
        }
    }

    /// Predicts the velocity at the end of the step from advection, viscosity, drag and the old pressure. `of_rate` is
    /// the factor of the explicit forces: one half if those of two velocities were added.
    fn predict(
        &mut self,
        momentum: &Momentum,
        (state, voidage): (&GasFields, &Field),
        (step, of_rate): (&NavierStokesStep, f64),
        ranks: &dyn Communicator,
    ) {
        let forces = Forces {
            rate: &self.explicit.rate,
            of_rate,
            pressure: &state.pressure,
            driving: step.driving,
            source: step.source,
        };
        predict(momentum, &state.velocity, forces, &mut self.predicted);
        let local = LocalGas { part: &self.part, gas: momentum.gas };
        let end = step.time + step.dt;
        set_boundary_faces(&mut self.predicted, (voidage, momentum.wall), local, end);
        self.halo.refresh(&mut self.predicted.each_mut(), ranks);
        continue_velocity(&mut self.predicted, local, end);
    }

    /// Norm of the rounding errors in the right-hand side of the pressure equation, which are those of the flows
    /// through the faces of each cell. A steady uniform flow has no other right-hand side, and no solver can reduce it.
    /// `rate` is the largest sum over the axes of flow over cell size.
    fn rounding_of_continuity(&self, rate: f64) -> f64 {
        let cells = self.part.counts.iter().product::<usize>() as f64;
        ROUNDINGS * f64::EPSILON * rate * cells.sqrt()
    }

    /// The change of pressure that makes the predicted velocity satisfy continuity, halo included.
    fn solve_pressure(
        &mut self,
        momentum: &Momentum,
        voidage_before: &Field,
        rounding: f64,
        ranks: &dyn Communicator,
    ) -> Result<Convergence, LinearSolverError> {
        momentum.set_coefficients(&mut self.coefficients, &mut self.diagonal);
        set_continuity_residual(momentum, &mut self.residual, &self.predicted, voidage_before);
        let solver = &mut self.pressure_solver;
        let [x, y, z] = &self.coefficients;
        solver.set_coefficients([x, y, z], Some(&self.diagonal), ranks)?;
        self.change.values_mut().fill(0.0);
        let Tolerance { relative, absolute } = momentum.gas.tolerance;
        let tolerance = Tolerance { relative, absolute: absolute.max(rounding) };
        let convergence = solver.solve(&mut self.change, &self.residual, tolerance, ranks)?;
        self.halo.refresh(&mut [&mut self.change], ranks);
        continue_correction(&mut self.change, &self.part, momentum.gas);
        Ok(convergence)
    }

    /// Advances the state to the end of the step.
    fn finish(
        &mut self,
        momentum: &Momentum,
        (state, voidage): (&mut GasFields, &Field),
        ranks: &dyn Communicator,
    ) {
        correct(momentum, &mut self.predicted, &self.change);
        std::mem::swap(&mut state.velocity, &mut self.predicted);
        let changes = self.change.values();
        let pressures = state.pressure.values_mut().iter_mut();
        pressures.zip(changes).for_each(|(pressure, change)| *pressure += change);
        state.voidage.values_mut().copy_from_slice(voidage.values());
        self.halo.refresh(&mut state.velocity.each_mut(), ranks);
        continue_pressure(&mut state.pressure, &self.part, momentum.gas);
    }
}
