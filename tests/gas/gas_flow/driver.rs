//! Runs of gas alone: a box, a gas, and a bed given as functions of place and time.

use nalgebra::Vector3;
use talcum::domain::{Bounds, Decomposition, Face, RankGrid, WallMotion};
use talcum::gas::NavierStokesError;
use talcum::gas::volume_averaged::{
    BedOnGrid, Boundary, GAS_HALO, GasFields, Inlet, NavierStokesReport, NavierStokesSolver,
    NavierStokesStep, Profile, VolumeAveragedGas,
};
use talcum::grid::{BoxGrid, Field, LocalCells, RoundColumn};
use talcum::linear_solver::Tolerance;
use talcum::numbers::Schedule;
use talcum::parallel::{Communicator, OneRank};

pub(crate) const PERIODIC: [Boundary; 2] = [Boundary::Periodic, Boundary::Periodic];
pub(crate) const FREE_SLIP: [Boundary; 2] = [Boundary::FreeSlip, Boundary::FreeSlip];

pub(crate) fn no_slip() -> [Boundary; 2] {
    [wall(Vector3::zeros()), wall(Vector3::zeros())]
}

pub(crate) fn wall(velocity: Vector3<f64>) -> Boundary {
    Boundary::NoSlip { motion: WallMotion { velocity, ..WallMotion::REST } }
}

/// A superficial velocity into the box.
pub(crate) fn inlet(velocity: f64, profile: Profile) -> Boundary {
    Boundary::Inlet(Inlet { velocity: Schedule::Constant(velocity), profile, jet: None })
}

pub(crate) const OUTLET: Boundary = Boundary::Outlet { pressure: 0.0 };

/// A box of gas.
#[derive(Clone)]
pub(crate) struct Problem {
    pub(crate) gas: VolumeAveragedGas,
    pub(crate) lengths: Vector3<f64>,
    pub(crate) counts: [usize; 3],
    /// Axis and radius of a round column, if the gas flows in one.
    pub(crate) column: Option<([f64; 2], f64)>,
}

impl Problem {
    /// Gas of density and viscosity 1.
    pub(crate) fn new(
        lengths: [f64; 3],
        counts: [usize; 3],
        boundaries: [[Boundary; 2]; 3],
    ) -> Self {
        // Continuity to 1e-10 of what the pressure has to correct: far below every error that is measured.
        let tolerance = Tolerance { relative: 1.0e-10, absolute: 0.0 };
        let gas = VolumeAveragedGas { density: 1.0, viscosity: 1.0, boundaries, tolerance };
        Self { gas, lengths: Vector3::from(lengths), counts, column: None }
    }

    fn bounds(&self) -> Bounds {
        let face = |boundary: &Boundary| match boundary {
            Boundary::Periodic => Face::Periodic,
            _ => Face::Wall,
        };
        let faces =
            [0, 1, 2].map(|a: usize| [0, 1].map(|side: usize| face(&self.gas.boundaries[a][side])));
        Bounds::new(self.lengths, faces)
    }

    pub(crate) fn grid(&self) -> BoxGrid {
        BoxGrid::new(&self.bounds(), self.counts)
    }

    /// The whole box on one rank.
    pub(crate) fn start(&self) -> Flow<'static> {
        let decomposition = Decomposition::even(RankGrid([1; 3]), &self.bounds());
        self.start_on(&decomposition, &OneRank)
    }

    /// Cut into blocks of equal size.
    pub(crate) fn even_cut(&self, ranks: [usize; 3]) -> Decomposition {
        Decomposition::even(RankGrid(ranks), &self.bounds())
    }

    /// A rank's part of the box, cut near the planes of `cut`.
    pub(crate) fn start_on<'r>(
        &self,
        decomposition: &Decomposition,
        ranks: &'r dyn Communicator,
    ) -> Flow<'r> {
        let grid = self.grid();
        self.gas.check(&grid).unwrap();
        let decomposition = grid.aligned(decomposition, [GAS_HALO; 3]).unwrap();
        let bounds = self.bounds();
        let mut solver =
            NavierStokesSolver::new(&grid, decomposition.subdomain(&bounds, ranks.rank()));
        if let Some((centre, radius)) = self.column {
            let column = RoundColumn::new(&grid, centre, radius).unwrap();
            solver = solver.in_column(&grid, &column, self.gas.viscosity);
        }
        let part = *solver.part();
        let (state, bed) = (GasFields::at_rest(&part), BedOnGrid::empty(&part));
        let spacing = grid.spacing();
        Flow { gas: self.gas.clone(), solver, state, bed, time: 0.0, spacing, part, ranks }
    }
}

/// Gas on one rank.
pub(crate) struct Flow<'r> {
    pub(crate) gas: VolumeAveragedGas,
    pub(crate) solver: NavierStokesSolver,
    pub(crate) state: GasFields,
    pub(crate) bed: BedOnGrid,
    pub(crate) time: f64,
    pub(crate) spacing: Vector3<f64>,
    pub(crate) part: LocalCells,
    pub(crate) ranks: &'r dyn Communicator,
}

impl Flow<'_> {
    /// All cells of the part, as the field counts them.
    pub(crate) fn cells(&self) -> Vec<[isize; 3]> {
        let [x, y, z] = self.part.count.map(|count| count as isize);
        let rows = (0..z).flat_map(|k| (0..y).map(move |j| (j, k)));
        rows.flat_map(|(j, k)| (0..x).map(move |i| [i, j, k])).collect()
    }

    /// Centre of a cell, or of its lower face along an axis.
    pub(crate) fn place(&self, cell: [isize; 3], face: Option<usize>) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let half = if face == Some(axis) { 0.0 } else { 0.5 };
            ((self.part.start[axis] as isize + cell[axis]) as f64 + half) * self.spacing[axis]
        })
    }

    /// A field with the values of a function in cells, or in the lower faces along an axis; in owned cells and those
    /// above, whose lower faces may be the box's. The gas fills the rest of the halo.
    pub(crate) fn field(&self, face: Option<usize>, value: impl Fn([f64; 3]) -> f64) -> Field {
        let mut field = Field::new(&self.part, GAS_HALO);
        let range = |axis: usize| 0..self.part.count[axis] as isize + 1;
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    *field.at_mut([i, j, k]) = value(self.place([i, j, k], face));
                }
            }
        }
        field
    }

    /// Sets velocity, pressure and voidage of the start, at the time 0.
    pub(crate) fn set(
        &mut self,
        velocity: impl Fn([f64; 3]) -> [f64; 3],
        pressure: impl Fn([f64; 3]) -> f64,
        voidage: impl Fn([f64; 3]) -> f64,
    ) {
        for axis in 0..3 {
            self.state.velocity[axis] = self.field(Some(axis), |x| velocity(x)[axis]);
        }
        self.state.pressure = self.field(None, pressure);
        self.state.voidage = self.field(None, &voidage);
        self.bed.voidage = self.field(None, voidage);
        self.complete();
    }

    pub(crate) fn complete(&mut self) {
        self.solver.complete(&self.gas, &mut self.state, self.time, self.ranks);
    }

    /// One step with nothing but pressure, gas and bed.
    pub(crate) fn step(&mut self, dt: f64) -> Result<NavierStokesReport, NavierStokesError> {
        self.driven_step(dt, Vector3::zeros(), None)
    }

    pub(crate) fn driven_step(
        &mut self,
        dt: f64,
        driving: Vector3<f64>,
        source: Option<&[Field; 3]>,
    ) -> Result<NavierStokesReport, NavierStokesError> {
        let step = NavierStokesStep { time: self.time, dt, driving, source };
        let report =
            self.solver.advance(&self.gas, &mut self.state, &mut self.bed, &step, self.ranks)?;
        self.time += dt;
        Ok(report)
    }

    /// Steps until no velocity changes by more than `change` of the largest in a step.
    pub(crate) fn run_to_rest(&mut self, dt: f64, driving: Vector3<f64>, change: f64) {
        for _ in 0..200_000 {
            let before = self.state.velocity.clone();
            self.driven_step(dt, driving, None).unwrap();
            let mut largest = 0.0_f64;
            let mut moved = 0.0_f64;
            for (new, old) in self.state.velocity.iter().zip(&before) {
                for (new, old) in new.owned().zip(old.owned()) {
                    (largest, moved) = (largest.max(new.abs()), moved.max((new - old).abs()));
                }
            }
            if moved <= change * largest {
                return;
            }
        }
        panic!("the flow did not become steady");
    }

    /// Root mean square over owned faces of what the velocity along an axis differs from a function.
    pub(crate) fn velocity_error(&self, axis: usize, exact: impl Fn([f64; 3]) -> f64) -> f64 {
        let square = |cell: [isize; 3]| {
            let error = self.state.velocity[axis].at(cell) - exact(self.place(cell, Some(axis)));
            error * error
        };
        let cells = self.cells();
        (cells.iter().map(|&cell| square(cell)).sum::<f64>() / cells.len() as f64).sqrt()
    }

    /// The same for the pressure in cells; where nothing holds its level, without the mean.
    pub(crate) fn pressure_error(&self, exact: impl Fn([f64; 3]) -> f64) -> f64 {
        let cells = self.cells();
        let n = cells.len() as f64;
        let errors: Vec<f64> = cells
            .iter()
            .map(|&cell| self.state.pressure.at(cell) - exact(self.place(cell, None)))
            .collect();
        let held =
            self.gas.boundaries.iter().flatten().any(|b| matches!(b, Boundary::Outlet { .. }));
        let mean = if held { 0.0 } else { errors.iter().sum::<f64>() / n };
        (errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / n).sqrt()
    }

    /// The largest |div(eps u) + (eps - before) / dt| in a cell.
    pub(crate) fn continuity_error(&self, before: &Field, dt: f64) -> f64 {
        let eps = &self.state.voidage;
        let balance = |cell: [isize; 3]| {
            let flux = |axis: usize, cell: [isize; 3]| {
                let mut below = cell;
                below[axis] -= 1;
                0.5 * (eps.at(below) + eps.at(cell)) * self.state.velocity[axis].at(cell)
            };
            let outflow = |axis: usize| {
                let mut above = cell;
                above[axis] += 1;
                (flux(axis, above) - flux(axis, cell)) / self.spacing[axis]
            };
            outflow(0) + outflow(1) + outflow(2) + (eps.at(cell) - before.at(cell)) / dt
        };
        self.cells().into_iter().map(|cell| balance(cell).abs()).fold(0.0, f64::max)
    }
}

/// Observed orders between grids of so many cells along an axis.
pub(crate) fn orders(cells: &[usize], errors: &[f64]) -> Vec<f64> {
    let refined = cells.windows(2).map(|pair| (pair[1] as f64 / pair[0] as f64).ln());
    errors.windows(2).zip(refined).map(|(pair, by)| (pair[0] / pair[1]).ln() / by).collect()
}
