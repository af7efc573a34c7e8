//! The levels, and one V-cycle over them.

use super::coarsening::LevelGrid;
use super::direct::DirectSolver;
use super::gathering::Gathering;
use super::operator::{Coefficients, copy, residual};
use super::smoothing::{
    System, first_step, first_step_from_zero, second_step, second_step_from_zero,
};
use super::transfer::Transfer;
use crate::domain::{Bounds, Decomposition, RankGrid};
use crate::grid::{Field, GridPart};
use crate::parallel::{Communicator, FieldHalo, OneRank};

/// Levels up to this many cells are held whole by every rank: messages would take longer than the work.
const HELD_WHOLE: usize = 1024;

/// Levels up to this many cells are factorised.
const FACTORISED: usize = 64;

/// A grid of the hierarchy, as one rank has it.
#[derive(Clone, Debug)]
struct Level {
    whole: bool,
    halo: FieldHalo,
    coefficients: Coefficients,
    inverse_diagonal: Field,
    /// The solution between two steps of smoothing.
    middle: Field,
    residual: Field,
    below: Below,
}

/// What is below a level.
#[derive(Clone, Debug)]
enum Below {
    Coarser(Step),
    Nothing(DirectSolver),
}

/// The way from a level to the next coarser one: axis by axis, the last first.
#[derive(Clone, Debug)]
struct Step {
    stages: Vec<Stage>,
    /// Between parts and the whole, if the next level is the first that is held whole.
    gathering: Option<Gathering>,
    right: Field,
    solution: Field,
}

/// The way along one axis.
#[derive(Clone, Debug)]
struct Stage {
    transfer: Transfer,
    coefficients: Coefficients,
    /// Residual on the way down, correction on the way up.
    numbers: Field,
}

/// All levels. The first is that of the equation to be solved, in the same parts, or whole if it is small.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    gathering: Option<Gathering>,
    right: Field,
    solution: Field,
    levels: Vec<Level>,
}

/// Where a rank is, for building levels.
#[derive(Clone, Copy)]
struct Place<'a> {
    cut: &'a Decomposition,
    bounds: &'a Bounds,
    rank: usize,
}

impl Place<'_> {
    fn halo(self, whole: bool) -> FieldHalo {
        if whole {
            let uncut = Decomposition::even(RankGrid([1; 3]), self.bounds);
            FieldHalo::new(&uncut, self.bounds, 0)
        } else {
            FieldHalo::new(self.cut, self.bounds, self.rank)
        }
    }

    fn part(self, grid: &LevelGrid, whole: bool) -> GridPart {
        let block = if whole { [0; 3] } else { self.cut.grid().block_of(self.rank) };
        grid.part(block)
    }
}

/// Whether a level is held whole: it is small, or too narrow on some rank to be coarsened.
fn is_held_whole(grid: &LevelGrid) -> bool {
    let narrow = |axis: usize| grid.is_cut(axis) && grid.narrowest(axis) < 2;
    grid.cells() <= HELD_WHOLE || (0..3).any(narrow)
}

impl Hierarchy {
    pub(super) fn new(
        finest: &LevelGrid,
        cut: &Decomposition,
        bounds: &Bounds,
        rank: usize,
    ) -> Self {
        let place = Place { cut, bounds, rank };
        let part = place.part(finest, false);
        let whole = is_held_whole(finest);
        let mut grid = if whole { finest.whole() } else { finest.clone() };
        let first = place.part(&grid, whole);
        let mut levels: Vec<Level> = Vec::new();
        loop {
            let whole = levels.last().is_some_and(|level| level.whole) || is_held_whole(&grid);
            let (level, coarser) = Level::new(&grid, place, whole);
            levels.push(level);
            match coarser {
                Some(coarser) => grid = coarser,
                None => break,
            }
        }
        Self {
            gathering: whole.then(|| Gathering::new(part, finest.periodic())),
            right: Field::new(&first, 1),
            solution: Field::new(&first, 1),
            levels,
        }
    }

    /// Sets the coefficients of all levels from those of the first, whose halos are current. Collective.
    pub(super) fn set_coefficients(&mut self, finest: &Coefficients, ranks: &dyn Communicator) {
        let mut above = finest;
        let mut gathering = self.gathering.as_mut();
        for level in &mut self.levels {
            level.take_coefficients(above, gathering.as_deref_mut(), ranks);
            level.coarsen(ranks);
            let Below::Coarser(step) = &mut level.below else { break };
            gathering = step.gathering.as_mut();
            above = &step.stages.last().expect("a step coarsens along an axis").coefficients;
        }
    }

    /// z = M r, M being symmetric and positive definite. Collective; halos are neither needed nor filled.
    pub(super) fn cycle(&mut self, right: &Field, solution: &mut Field, ranks: &dyn Communicator) {
        let Some(gathering) = &mut self.gathering else {
            return cycle(&mut self.levels, right, solution, ranks);
        };
        gathering.gather(right, &mut self.right, ranks);
        cycle(&mut self.levels, &self.right, &mut self.solution, ranks);
        gathering.take_part(&self.solution, solution);
    }

    #[cfg(test)]
    pub(super) fn depth(&self) -> usize {
        self.levels.len()
    }
}

impl Level {
    /// A level, and the grid of the next coarser one, in the parts in which it will be.
    fn new(grid: &LevelGrid, place: Place, whole: bool) -> (Self, Option<LevelGrid>) {
        let part = place.part(grid, whole);
        let (below, coarser) = if grid.cells() <= FACTORISED {
            (Below::Nothing(DirectSolver::new(grid.cells())), None)
        } else {
            let (step, coarser) = Step::new(grid, place, whole);
            (Below::Coarser(step), Some(coarser))
        };
        let zero = || Field::new(&part, 1);
        let level = Self {
            whole,
            halo: place.halo(whole),
            coefficients: Coefficients::new(&part),
            inverse_diagonal: zero(),
            middle: zero(),
            residual: zero(),
            below,
        };
        (level, coarser)
    }

    fn take_coefficients(
        &mut self,
        above: &Coefficients,
        gathering: Option<&mut Gathering>,
        ranks: &dyn Communicator,
    ) {
        match gathering {
            None => self.coefficients.copy_from(above),
            Some(gathering) => {
                let [x, y, z] = &above.faces;
                for (own, above) in
                    self.coefficients.fields().into_iter().zip([x, y, z, &above.diagonal])
                {
                    gathering.gather(above, own, ranks);
                }
                self.halo.refresh(&mut self.coefficients.fields(), &OneRank);
            }
        }
        self.coefficients.inverse_diagonal_into(&mut self.inverse_diagonal);
    }

    /// Sets weights and coefficients on the way to the next level, or factorises.
    fn coarsen(&mut self, ranks: &dyn Communicator) {
        let ranks: &dyn Communicator = if self.whole { &OneRank } else { ranks };
        match &mut self.below {
            Below::Nothing(direct) => direct.factorise(&self.coefficients),
            Below::Coarser(step) => {
                let mut fine = &self.coefficients;
                for stage in &mut step.stages {
                    stage.transfer.set_weights(fine);
                    let [lower, upper] = &mut stage.transfer.weights;
                    self.halo.refresh(&mut [lower, upper], ranks);
                    stage.transfer.coarsen(fine, &mut stage.coefficients);
                    self.halo.refresh(&mut stage.coefficients.fields(), ranks);
                    fine = &stage.coefficients;
                }
            }
        }
    }
}

impl Step {
    fn new(grid: &LevelGrid, place: Place, whole: bool) -> (Self, LevelGrid) {
        let mut stages = Vec::new();
        let mut fine = grid.clone();
        for axis in grid.axes_to_coarsen().into_iter().rev() {
            let coarse = fine.coarsened(axis);
            let part = place.part(&coarse, whole);
            let periodic = grid.periodic()[axis];
            stages.push(Stage {
                transfer: Transfer::new(axis, place.part(&fine, whole), part, periodic),
                coefficients: Coefficients::new(&part),
                numbers: Field::new(&part, 1),
            });
            fine = coarse;
        }
        let part = place.part(&fine, whole);
        let gathering =
            (!whole && is_held_whole(&fine)).then(|| Gathering::new(part, grid.periodic()));
        let next = if gathering.is_some() { fine.whole() } else { fine };
        let next_part = place.part(&next, whole || gathering.is_some());
        let (right, solution) = (Field::new(&next_part, 1), Field::new(&next_part, 1));
        (Self { stages, gathering, right, solution }, next)
    }

    /// Restricts the residual, whose halo is current, to the right-hand side of the next level.
    fn restrict(&mut self, residual: &Field, ranks: &dyn Communicator) {
        let mut fine = residual;
        for stage in &mut self.stages {
            stage.transfer.restrict(fine, &mut stage.numbers);
            fine = &stage.numbers;
        }
        match &mut self.gathering {
            Some(gathering) => gathering.gather(fine, &mut self.right, ranks),
            None => copy(fine, &mut self.right),
        }
    }

    /// Adds to `solution` what the next level's solution, whose halo is current, says.
    fn correct(&mut self, solution: &mut Field) {
        let last = self.stages.len() - 1;
        match &self.gathering {
            Some(gathering) => gathering.take_part(&self.solution, &mut self.stages[last].numbers),
            None => copy(&self.solution, &mut self.stages[last].numbers),
        }
        for number in (1..=last).rev() {
            let (finer, coarser) = self.stages.split_at_mut(number);
            coarser[0].transfer.prolong(&coarser[0].numbers, &mut finer[number - 1].numbers);
        }
        self.stages[0].transfer.correct(&self.stages[0].numbers, solution);
    }
}

/// One V-cycle from zero on the first of the levels.
fn cycle(levels: &mut [Level], right: &Field, solution: &mut Field, ranks: &dyn Communicator) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    let Level { whole, halo, coefficients, inverse_diagonal, middle, residual: rest, below } =
        level;
    let step = match below {
        Below::Nothing(direct) => return direct.solve(right, solution),
        Below::Coarser(step) => step,
    };
    let own: &dyn Communicator = if *whole { &OneRank } else { ranks };
    let system = System { coefficients, inverse_diagonal, right };

    first_step_from_zero(system, middle);
    halo.refresh(&mut [middle], own);
    second_step_from_zero(system, middle, solution);
    halo.refresh(&mut [solution], own);
    residual(coefficients, solution, right, rest);
    halo.refresh(&mut [rest], own);

    step.restrict(rest, ranks);
    cycle(coarser, &step.right, &mut step.solution, ranks);
    let next = coarser.first_mut().expect("a step leads to a level");
    let next_ranks: &dyn Communicator = if next.whole { &OneRank } else { ranks };
    next.halo.refresh(&mut [&mut step.solution], next_ranks);
    step.correct(solution);

    halo.refresh(&mut [solution], own);
    first_step(system, solution, middle);
    halo.refresh(&mut [middle], own);
    second_step(system, middle, solution);
}
