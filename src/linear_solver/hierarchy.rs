//! The levels, and one cycle over them.

use super::coarsening::{LevelGrid, undivided_halo};
use super::direct::DirectSolver;
use super::gathering::Gathering;
use super::operator::{Coefficients, residual};
use super::smoothing::{System, smooth};
use super::step::Step;
use crate::domain::Subdomain;
use crate::grid::Field;
use crate::parallel::{Communicator, FieldHalo, OneRank};

/// Levels up to this many cells are factorised.
const FACTORISED: usize = 64;

/// How often a level is visited on the way through the one above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cycle {
    /// Once. Positive definite whatever the coarse grids say.
    V,
    /// Twice, but the coarsest: for the price of a sixth more, fewer iterations, and as many on fine grids as on
    /// coarse ones. Positive definite as long as no coarse grid answers more than twice too strongly.
    W,
}

/// A grid of the hierarchy, as one rank has it, and what is below.
#[derive(Clone, Debug)]
struct Level {
    smoother: Smoother,
    below: Below,
}

/// What a level needs for itself.
#[derive(Clone, Debug)]
struct Smoother {
    whole: bool,
    halo: FieldHalo,
    inverse_diagonal: Field,
    /// The solution between two steps of smoothing.
    middle: Field,
    /// With a halo of two cells, which restriction needs.
    residual: Field,
}

/// What is below a level.
#[derive(Clone, Debug)]
enum Below {
    Coarser(Box<Step>),
    Nothing(DirectSolver),
}

/// The equation of the first level, if that is small and held whole by every rank.
#[derive(Clone, Debug)]
struct Whole {
    gathering: Gathering,
    coefficients: Coefficients,
    right: Field,
    solution: Field,
}

/// All levels. The first is that of the equation to be solved.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    whole: Option<Whole>,
    levels: Vec<Level>,
}

impl Hierarchy {
    pub(super) fn new(finest: &LevelGrid, subdomain: Subdomain) -> Self {
        let whole = finest.is_held_whole().then(|| {
            let part = finest.whole().local_cells(subdomain);
            Whole {
                gathering: Gathering::new(finest.local_cells(subdomain), finest.periodic()),
                coefficients: Coefficients::new(&part),
                right: Field::new(&part, 1),
                solution: Field::new(&part, 1),
            }
        });
        let mut levels: Vec<Level> = Vec::new();
        let mut held_whole = whole.is_some();
        let mut next = Some(if held_whole { finest.whole() } else { finest.clone() });
        while let Some(grid) = next {
            held_whole |= grid.is_held_whole();
            let (level, coarser) = Level::new(&grid, subdomain, held_whole);
            levels.push(level);
            next = coarser;
        }
        Self { whole, levels }
    }

    /// Sets the coefficients of all levels from those of the first, whose halos are current. Collective.
    pub(super) fn set_coefficients(&mut self, finest: &Coefficients, ranks: &dyn Communicator) {
        let mut coefficients = finest;
        if let Some(whole) = &mut self.whole {
            whole.gathering.gather_coefficients(finest, &mut whole.coefficients, ranks);
            self.levels[0].smoother.halo.refresh(&mut whole.coefficients.fields(), &OneRank);
            coefficients = &whole.coefficients;
        }
        for level in &mut self.levels {
            let Level { smoother, below } = level;
            coefficients.inverse_diagonal_into(&mut smoother.inverse_diagonal);
            let ranks = smoother.ranks(ranks);
            coefficients = match below {
                Below::Nothing(direct) => return direct.factorise(coefficients),
                Below::Coarser(step) => step.coarsen(coefficients, &mut smoother.halo, ranks),
            };
        }
    }

    /// z = M r, M being symmetric. Collective; halos are neither needed nor filled.
    pub(super) fn cycle(
        &mut self,
        coefficients: &Coefficients,
        (right, solution): (&Field, &mut Field),
        kind: Cycle,
        ranks: &dyn Communicator,
    ) {
        let Some(whole) = &mut self.whole else {
            let displacement = Way { kind, ranks };
            return displacement.through(&mut self.levels, coefficients, (right, solution), true);
        };
        whole.gathering.gather(right, &mut whole.right, ranks);
        let displacement = Way { kind, ranks: &OneRank };
        let equation = (&whole.right, &mut whole.solution);
        displacement.through(&mut self.levels, &whole.coefficients, equation, true);
        whole.gathering.take_part(&whole.solution, solution);
    }
}

impl Level {
    /// A level, and the grid of the next coarser one, in the parts in which it will be.
    fn new(grid: &LevelGrid, subdomain: Subdomain, whole: bool) -> (Self, Option<LevelGrid>) {
        let part = grid.local_cells(subdomain);
        let (below, coarser) = if grid.cells() <= FACTORISED {
            (Below::Nothing(DirectSolver::new(grid.cells())), None)
        } else {
            let (step, coarser) = Step::new(grid, subdomain, whole);
            (Below::Coarser(Box::new(step)), Some(coarser))
        };
        let smoother = Smoother {
            whole,
            halo: if whole { undivided_halo(subdomain) } else { FieldHalo::new(subdomain) },
            inverse_diagonal: Field::new(&part, 1),
            middle: Field::new(&part, 1),
            residual: Field::new(&part, 2),
        };
        (Self { smoother, below }, coarser)
    }
}

impl Smoother {
    /// Those that share the level.
    fn ranks<'a>(&self, ranks: &'a dyn Communicator) -> &'a dyn Communicator {
        if self.whole { &OneRank } else { ranks }
    }

    /// Smooths from zero, or from what `solution` holds, its halo being current; it is so afterwards too.
    fn smooth(
        &mut self,
        coefficients: &Coefficients,
        (right, solution): (&Field, &mut Field),
        from_zero: bool,
        ranks: &dyn Communicator,
    ) {
        let Self { halo, inverse_diagonal, middle, .. } = self;
        let system = System { coefficients, inverse_diagonal, right };
        smooth(system, [solution, middle], from_zero, |field| halo.refresh(&mut [field], ranks));
    }
}

/// How levels are gone through.
#[derive(Clone, Copy)]
struct Way<'a> {
    kind: Cycle,
    ranks: &'a dyn Communicator,
}

impl Way<'_> {
    /// One cycle on the first of the levels, from zero or from what `solution` holds.
    fn through(
        self,
        levels: &mut [Level],
        coefficients: &Coefficients,
        (right, solution): (&Field, &mut Field),
        from_zero: bool,
    ) {
        let Some((level, coarser)) = levels.split_first_mut() else { return };
        let Level { smoother, below } = level;
        let step = match below {
            Below::Nothing(direct) => return direct.solve(right, solution),
            Below::Coarser(step) => step,
        };
        let ranks = smoother.ranks(self.ranks);
        smoother.smooth(coefficients, (right, solution), from_zero, ranks);
        residual(coefficients, solution, right, &mut smoother.residual);
        smoother.halo.refresh(&mut [&mut smoother.residual], ranks);
        self.below(step, coarser, &smoother.residual);
        step.correct(solution);
        smoother.halo.refresh(&mut [&mut *solution], ranks);
        smoother.smooth(coefficients, (right, solution), false, ranks);
    }

    /// Brings the residual down, solves there, with current halo, as often as the cycle says.
    fn below(self, step: &mut Step, coarser: &mut [Level], residual: &Field) {
        step.restrict(residual, self.ranks);
        let last = coarser.len() == 1;
        let visits = if self.kind == Cycle::W && !last { 2 } else { 1 };
        for visit in 0..visits {
            let (coefficients, equation) = step.equation();
            self.through(coarser, coefficients, equation, visit == 0);
        }
        if last {
            let (_, (_, solution)) = step.equation();
            coarser[0].smoother.halo.refresh(&mut [solution], &OneRank);
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

    fn drawn(stream: f64, number: usize) -> f64 {
        let x = (number as f64 + 1.0) * 0.754_877_666 + stream;
        x - x.floor()
    }

    /// A closed or open box, coefficients between 10^-6 and 1 at random.
    fn hierarchy(outlet: f64) -> (Hierarchy, Coefficients, LocalCells) {
        let periodic = [Face::Periodic; 2];
        let lengths = Vector3::new(19.0, 16.0, 23.0);
        let bounds = Bounds::new(lengths, [[Face::Wall; 2], periodic, [Face::Wall; 2]]);
        let grid = BoxGrid::new(&bounds, COUNTS);
        let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
        let subdomain = decomposition.subdomain(&bounds, 0);
        let part = grid.local_cells(subdomain);
        let mut coefficients = Coefficients::new(&part);
        for (axis, face) in coefficients.faces.iter_mut().enumerate() {
            let number = |cell: usize| 10.0_f64.powf(-6.0 * drawn(0.1 * axis as f64, cell));
            face.set_owned((0..).map(number));
            if axis != 1 {
                let rows: Vec<_> = face.slab(axis, (0, 1)).collect();
                rows.into_iter().for_each(|row| face.values_mut()[row].fill(0.0));
            }
        }
        *coefficients.diagonal.at_mut([3, 3, 22]) = outlet;
        let mut halo = FieldHalo::new(subdomain);
        halo.refresh(&mut coefficients.fields(), &OneRank);
        let finest = LevelGrid::finest(&grid, &decomposition);
        let mut hierarchy = Hierarchy::new(&finest, subdomain);
        hierarchy.set_coefficients(&coefficients, &OneRank);
        (hierarchy, coefficients, part)
    }

    fn dot(a: &Field, b: &Field) -> f64 {
        a.owned().zip(b.owned()).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn the_cycle_is_symmetric_and_positive_definite() {
        for (outlet, kind) in [(0.5, Cycle::V), (0.5, Cycle::W), (0.0, Cycle::V)] {
            let (mut hierarchy, coefficients, part) = hierarchy(outlet);
            assert!(hierarchy.levels.len() >= 4);
            let mut images = Vec::new();
            for stream in [0.3, 0.7] {
                let mut field = Field::new(&part, 1);
                field.set_owned((0..).map(|cell| drawn(stream, cell * cell) - 0.5));
                // A closed box answers only to sources of mean zero.
                let mean = field.owned().sum::<f64>() / part.cells() as f64;
                let balanced: Vec<f64> = field.owned().map(|value| value - mean).collect();
                field.set_owned(balanced.into_iter());
                let mut image = Field::new(&part, 1);
                hierarchy.cycle(&coefficients, (&field, &mut image), kind, &OneRank);
                images.push((field, image));
            }
            let [(x, mx), (y, my)] = &images[..] else { unreachable!("two fields were made") };
            let size = (dot(x, mx) * dot(y, my)).sqrt();
            // Rounding of 2^-53 in some hundred operations per cell, on levels whose coefficients differ by 10^6.
            let asymmetry = (dot(x, my) - dot(y, mx)).abs() / size;
            assert!(asymmetry < 1.0e-10, "{asymmetry}");
            assert!(dot(x, mx) > 0.0 && dot(y, my) > 0.0);
        }
    }

    #[test]
    fn smoothing_after_the_coarse_grid_only_would_not_be_symmetric() {
        // Control: a cycle without its first smoothing.
        let (mut hierarchy, coefficients, part) = hierarchy(0.5);
        let mut fields = [0.3, 0.7].map(|stream| {
            let mut field = Field::new(&part, 1);
            field.set_owned((0..).map(|cell| drawn(stream, cell * cell) - 0.5));
            field
        });
        let mut images = fields.clone();
        let (finest, coarser) = hierarchy.levels.split_at_mut(1);
        let Level { smoother, below } = &mut finest[0];
        let Below::Coarser(step) = below else { unreachable!("the grid has several levels") };
        for (field, image) in fields.iter_mut().zip(&mut images) {
            smoother.residual.set_owned(field.owned());
            smoother.halo.refresh(&mut [&mut smoother.residual], &OneRank);
            Way { kind: Cycle::V, ranks: &OneRank }.below(step, coarser, &smoother.residual);
            image.values_mut().fill(0.0);
            step.correct(image);
            smoother.halo.refresh(&mut [&mut *image], &OneRank);
            smoother.smooth(&coefficients, (field, image), false, &OneRank);
        }
        let size = (dot(&fields[0], &images[0]) * dot(&fields[1], &images[1])).abs().sqrt();
        let asymmetry = (dot(&fields[0], &images[1]) - dot(&fields[1], &images[0])).abs() / size;
        assert!(asymmetry > 1.0e-6, "{asymmetry}");
    }
}
