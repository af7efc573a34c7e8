//! The hierarchy of levels, and the V- and W-cycle over them, in single precision (Trottenberg, Oosterlee and Schüller,
//! "Multigrid", 2001, section 2.4).
//!
//! The cycle is a symmetric operator M: it starts from zero, the smoother before the coarse-grid correction is the same
//! as the one after it, and restriction is the transpose of prolongation.

use super::chebyshev_smoother::{System, smooth};
use super::direct_solver::DirectSolver;
use super::level_grid::{LevelGrid, replicated_halo};
use super::level_transfer::LevelTransfer;
use super::operator::{Coefficients, Equation, residual, set_inverse_diagonal};
use super::replication::Replication;
use crate::domain::Subdomain;
use crate::grid::Field;
use crate::parallel::{Communicator, FieldHalo, OneRank};

/// Largest number of cells of a level that is factorised.
const LARGEST_FACTORISED: usize = 64;

/// Number of visits of a level in each visit of the next finer one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cycle {
    /// Once. Always positive definite.
    V,
    /// Twice, except for the coarsest level. Each cycle takes a sixth more work, but fewer iterations are needed, and
    /// no more on fine grids than on coarse ones. Positive definite as long as no coarse-grid correction is more than
    /// twice too large.
    W,
}

/// A level, and the method that solves its equation.
#[derive(Clone, Debug)]
struct Level {
    smoother: Smoother,
    solver: LevelSolver,
}

/// Data for smoothing on a level.
#[derive(Clone, Debug)]
struct Smoother {
    replicated: bool,
    halo: FieldHalo,
    inverse_diagonal: Field<f32>,
    /// The approximation between two steps of the smoother.
    scratch: Field<f32>,
    /// The residual; its halo is two cells wide, as restriction requires.
    residual: Field<f32>,
}

/// The method that solves the equation of a level.
#[derive(Clone, Debug)]
enum LevelSolver {
    /// Approximately, by smoothing and correction from the next coarser level.
    Correction(Box<LevelTransfer>),
    /// Exactly, on the coarsest level.
    Direct(DirectSolver),
}

/// The equation of the finest level if it is so small that every rank holds all of it.
#[derive(Clone, Debug)]
struct ReplicatedFinest {
    replication: Replication,
    coefficients: Coefficients<f32>,
    right_hand_side: Field<f32>,
    solution: Field<f32>,
}

/// All levels, the finest first.
#[derive(Clone, Debug)]
pub(super) struct Multigrid {
    replicated: Option<ReplicatedFinest>,
    levels: Vec<Level>,
}

impl Multigrid {
    pub(super) fn new(finest: &LevelGrid, subdomain: Subdomain) -> Self {
        let replicated = finest.is_replicated().then(|| {
            let all = finest.replicated().local_cells(subdomain);
            ReplicatedFinest {
                replication: Replication::new(finest.local_cells(subdomain), finest.periodic()),
                coefficients: Coefficients::new(&all),
                right_hand_side: Field::new(&all, 1),
                solution: Field::new(&all, 1),
            }
        });
        let mut levels: Vec<Level> = Vec::new();
        let mut next = Some(match replicated {
            Some(_) => finest.replicated(),
            None => finest.clone(),
        });
        while let Some(grid) = next {
            let (level, coarser) = Level::new(&grid, subdomain);
            levels.push(level);
            next = coarser;
        }
        Self { replicated, levels }
    }

    /// Sets the coefficients of all levels from those of the finest, whose halos are current. This call is collective.
    pub(super) fn set_coefficients(
        &mut self,
        finest: &Coefficients<f32>,
        ranks: &dyn Communicator,
    ) {
        let mut coefficients = finest;
        if let Some(replicated) = &mut self.replicated {
            let ReplicatedFinest { replication, coefficients: all, .. } = replicated;
            replication.gather_coefficients(finest, all, ranks);
            self.levels[0].smoother.halo.refresh(&mut all.fields(), &OneRank);
            coefficients = all;
        }
        for level in &mut self.levels {
            let Level { smoother, solver } = level;
            set_inverse_diagonal(coefficients, &mut smoother.inverse_diagonal);
            let ranks = smoother.ranks(ranks);
            coefficients = match solver {
                LevelSolver::Direct(direct) => return direct.factorise(coefficients),
                LevelSolver::Correction(transfer) => {
                    transfer.coarsen(coefficients, &mut smoother.halo, ranks)
                }
            };
        }
    }

    /// z = M r with the right-hand side r and the solution z. Halos are neither needed nor filled. This call is
    /// collective.
    pub(super) fn cycle(
        &mut self,
        equation: &mut Equation<f32>,
        cycle: Cycle,
        ranks: &dyn Communicator,
    ) {
        let Some(replicated) = &mut self.replicated else {
            return cycle.visit(&mut self.levels, equation, true, ranks);
        };
        let ReplicatedFinest { replication, coefficients, right_hand_side, solution } = replicated;
        replication.gather([equation.right_hand_side], [right_hand_side], ranks);
        let mut gathered = Equation { coefficients, right_hand_side, solution };
        cycle.visit(&mut self.levels, &mut gathered, true, &OneRank);
        replication.take_local(solution, equation.solution);
    }
}

impl Level {
    /// A level, and the grid of the next coarser one if there is one.
    fn new(grid: &LevelGrid, subdomain: Subdomain) -> (Self, Option<LevelGrid>) {
        let (solver, coarser) = if grid.cells() <= LARGEST_FACTORISED {
            (LevelSolver::Direct(DirectSolver::new(grid.cells())), None)
        } else {
            let (transfer, coarser) = LevelTransfer::new(grid, subdomain);
            (LevelSolver::Correction(Box::new(transfer)), Some(coarser))
        };
        let cells = grid.local_cells(subdomain);
        let replicated = grid.is_replicated();
        let halo = if replicated { replicated_halo(subdomain) } else { FieldHalo::new(subdomain) };
        let smoother = Smoother {
            replicated,
            halo,
            inverse_diagonal: Field::new(&cells, 1),
            scratch: Field::new(&cells, 1),
            residual: Field::new(&cells, 2),
        };
        (Self { smoother, solver }, coarser)
    }
}

impl Smoother {
    /// The ranks among which the level is divided.
    fn ranks<'a>(&self, ranks: &'a dyn Communicator) -> &'a dyn Communicator {
        if self.replicated { &OneRank } else { ranks }
    }

    /// Smooths from zero, or from the solution, whose halo is then current. After: the halo of the solution is out of
    /// date.
    fn smooth(&mut self, equation: &mut Equation<f32>, from_zero: bool, ranks: &dyn Communicator) {
        let Self { halo, inverse_diagonal, scratch, .. } = self;
        let Equation { coefficients, right_hand_side, solution } = equation;
        let system = System { coefficients, inverse_diagonal, right_hand_side };
        smooth(system, [solution, scratch], from_zero, |field| halo.refresh(&mut [field], ranks));
    }
}

impl Cycle {
    /// One cycle on the first of the levels, from zero or from the present solution, whose halo is then current. After:
    /// the halo of the solution is out of date. This call is collective.
    fn visit(
        self,
        levels: &mut [Level],
        equation: &mut Equation<f32>,
        from_zero: bool,
        ranks: &dyn Communicator,
    ) {
        let Some((level, coarser)) = levels.split_first_mut() else { return };
        let Level { smoother, solver } = level;
        let transfer = match solver {
            LevelSolver::Direct(direct) => return direct.solve(equation),
            LevelSolver::Correction(transfer) => transfer,
        };
        let sharing = smoother.ranks(ranks);
        smoother.smooth(equation, from_zero, sharing);
        smoother.halo.refresh(&mut [&mut *equation.solution], sharing);
        residual(equation, &mut smoother.residual);
        smoother.halo.refresh(&mut [&mut smoother.residual], sharing);
        self.solve_coarser(transfer, coarser, &smoother.residual, ranks);
        transfer.correct(equation.solution);
        smoother.halo.refresh(&mut [&mut *equation.solution], sharing);
        smoother.smooth(equation, false, sharing);
    }

    /// Restricts the residual and solves the equation of the coarser level, as often as the cycle visits it. After: the
    /// halo of its solution is current. This call is collective.
    fn solve_coarser(
        self,
        transfer: &mut LevelTransfer,
        coarser: &mut [Level],
        residual: &Field<f32>,
        ranks: &dyn Communicator,
    ) {
        transfer.restrict(residual, ranks);
        let is_coarsest = coarser.len() == 1;
        let visits = if self == Self::W && !is_coarsest { 2 } else { 1 };
        for visit in 0..visits {
            self.visit(coarser, &mut transfer.equation(), visit == 0, ranks);
            let smoother = &mut coarser[0].smoother;
            let sharing = smoother.ranks(ranks);
            smoother.halo.refresh(&mut [transfer.equation().solution], sharing);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Bounds, Decomposition, Face, RankGrid};
    use crate::grid::{BoxGrid, LocalCells};
    use nalgebra::Vector3;

    const COUNTS: [usize; 3] = [19, 16, 23];

    /// Numbers from 0 to 1 of a low-discrepancy sequence.
    fn drawn(stream: f64, number: usize) -> f32 {
        let x = (number as f64 + 1.0) * 0.754_877_666 + stream;
        (x - x.floor()) as f32
    }

    /// A closed or open box, coefficients between 10^-6 and 1 at random.
    fn multigrid(outlet: f32) -> (Multigrid, Coefficients<f32>, LocalCells) {
        let periodic = [Face::Periodic; 2];
        let lengths = Vector3::new(19.0, 16.0, 23.0);
        let bounds = Bounds::new(lengths, [[Face::Wall; 2], periodic, [Face::Wall; 2]]);
        let grid = BoxGrid::new(&bounds, COUNTS);
        let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
        let subdomain = decomposition.subdomain(&bounds, 0);
        let cells = grid.local_cells(subdomain);
        let mut coefficients = Coefficients::new(&cells);
        for (axis, face) in coefficients.faces.iter_mut().enumerate() {
            let number = |cell: usize| 10.0_f32.powf(-6.0 * drawn(0.1 * axis as f64, cell));
            face.set_owned((0..).map(number));
            if axis != 1 {
                let rows: Vec<_> = face.slab(axis, 0..1).collect();
                rows.into_iter().for_each(|row| face.values_mut()[row].fill(0.0));
            }
        }
        *coefficients.diagonal.at_mut([3, 3, 22]) = outlet;
        let mut halo = FieldHalo::new(subdomain);
        halo.refresh(&mut coefficients.fields(), &OneRank);
        let finest = LevelGrid::finest(&grid, &decomposition);
        let mut multigrid = Multigrid::new(&finest, subdomain);
        multigrid.set_coefficients(&coefficients, &OneRank);
        (multigrid, coefficients, cells)
    }

    fn dot(a: &Field<f32>, b: &Field<f32>) -> f64 {
        a.owned().zip(b.owned()).map(|(a, b)| f64::from(a) * f64::from(b)).sum()
    }

    #[test]
    fn the_multigrid_cycle_is_symmetric_and_positive_definite() {
        for (outlet, cycle) in [(0.5, Cycle::V), (0.5, Cycle::W), (0.0, Cycle::V)] {
            let (mut multigrid, coefficients, cells) = multigrid(outlet);
            assert!(multigrid.levels.len() >= 4);
            let mut results = Vec::new();
            for stream in [0.3, 0.7] {
                let mut source = Field::new(&cells, 1);
                source.set_owned((0..).map(|cell| drawn(stream, cell * cell) - 0.5));
                // A closed box has a solution only if the mean of the sources is zero.
                let mean = source.owned().sum::<f32>() / cells.cells() as f32;
                let balanced: Vec<f32> = source.owned().map(|value| value - mean).collect();
                source.set_owned(balanced.into_iter());
                let mut solution = Field::new(&cells, 1);
                let mut equation = Equation {
                    coefficients: &coefficients,
                    right_hand_side: &source,
                    solution: &mut solution,
                };
                multigrid.cycle(&mut equation, cycle, &OneRank);
                results.push((source, solution));
            }
            let [(x, mx), (y, my)] = &results[..] else { unreachable!("two fields were made") };
            let size = (dot(x, mx) * dot(y, my)).sqrt();
            // Numbers are rounded by 2^-24, in some hundred operations per cell; most of it cancels in sums over 7,000
            // cells.
            let asymmetry = (dot(x, my) - dot(y, mx)).abs() / size;
            assert!(asymmetry < 1.0e-7, "{asymmetry}");
            assert!(dot(x, mx) > 0.0 && dot(y, my) > 0.0);
        }
    }

    #[test]
    fn a_cycle_without_its_first_smoothing_is_found_not_to_be_symmetric() {
        // Negative control of the test above.
        let (mut multigrid, coefficients, cells) = multigrid(0.5);
        let sources = [0.3, 0.7].map(|stream| {
            let mut source = Field::new(&cells, 1);
            source.set_owned((0..).map(|cell| drawn(stream, cell * cell) - 0.5));
            source
        });
        let mut solutions = sources.clone();
        let (finest, coarser) = multigrid.levels.split_at_mut(1);
        let Level { smoother, solver } = &mut finest[0];
        let LevelSolver::Correction(transfer) = solver else {
            unreachable!("the grid has several levels")
        };
        for (source, solution) in sources.iter().zip(&mut solutions) {
            smoother.residual.set_owned(source.owned());
            smoother.halo.refresh(&mut [&mut smoother.residual], &OneRank);
            Cycle::V.solve_coarser(transfer, coarser, &smoother.residual, &OneRank);
            solution.values_mut().fill(0.0);
            transfer.correct(solution);
            smoother.halo.refresh(&mut [&mut *solution], &OneRank);
            let mut equation =
                Equation { coefficients: &coefficients, right_hand_side: source, solution };
            smoother.smooth(&mut equation, false, &OneRank);
        }
        let [x, y] = &sources;
        let [mx, my] = &solutions;
        let size = (dot(x, mx) * dot(y, my)).abs().sqrt();
        let asymmetry = (dot(x, my) - dot(y, mx)).abs() / size;
        assert!(asymmetry > 1.0e-6, "{asymmetry}");
    }
}
