//! The way from a level to the next coarser one: axis by axis, the last first.

use super::coarsening::{LevelGrid, undivided_halo};
use super::gathering::Gathering;
use super::operator::Coefficients;
use super::pairs::Pairs;
use super::transfer::Transfer;
use crate::domain::Subdomain;
use crate::grid::Field;
use crate::parallel::{Communicator, FieldHalo, OneRank};

/// What is handed between two levels, and the equation of the coarser one.
#[derive(Clone, Debug)]
pub(super) struct Step {
    stages: Vec<Stage>,
    /// If the coarser level is the first that is held whole.
    gathered: Option<Gathered>,
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

/// What is brought together on every rank.
#[derive(Clone, Debug)]
struct Gathered {
    gathering: Gathering,
    halo: FieldHalo,
    coefficients: Coefficients,
    right: Field,
}

impl Step {
    /// From a level, held whole or not; and the grid of the next.
    pub(super) fn new(grid: &LevelGrid, subdomain: Subdomain, whole: bool) -> (Self, LevelGrid) {
        let mut stages = Vec::new();
        let mut fine = grid.clone();
        for axis in grid.axes_to_coarsen().into_iter().rev() {
            let coarse = fine.coarsened(axis);
            let pairs = Pairs {
                axis,
                fine: fine.local_cells(subdomain),
                coarse: coarse.local_cells(subdomain),
                periodic: grid.periodic()[axis],
            };
            stages.push(Stage {
                coefficients: Coefficients::new(&pairs.coarse),
                numbers: Field::new(&pairs.coarse, 2),
                transfer: Transfer::new(pairs),
            });
            fine = coarse;
        }
        let part = fine.local_cells(subdomain);
        let gathers = !whole && fine.is_held_whole();
        let next = if gathers { fine.whole() } else { fine };
        let next_part = next.local_cells(subdomain);
        let gathered = gathers.then(|| Gathered {
            gathering: Gathering::new(part, grid.periodic()),
            halo: undivided_halo(subdomain),
            coefficients: Coefficients::new(&next_part),
            right: Field::new(&next_part, 1),
        });
        (Self { stages, gathered, solution: Field::new(&next_part, 1) }, next)
    }

    /// Sets weights, and the coefficients of the coarser level, which are returned. Collective.
    pub(super) fn coarsen<'a>(
        &'a mut self,
        finest: &'a Coefficients,
        halo: &mut FieldHalo,
        ranks: &dyn Communicator,
    ) -> &'a Coefficients {
        let mut fine = finest;
        let last = self.stages.len() - 1;
        for (number, stage) in self.stages.iter_mut().enumerate() {
            stage.transfer.set_inside(fine);
            halo.refresh(&mut [&mut stage.transfer.inside], ranks);
            stage.transfer.set_lean(fine);
            halo.refresh(&mut [&mut stage.transfer.lean], ranks);
            stage.transfer.coarsen(fine, &mut stage.coefficients);
            if number < last || self.gathered.is_none() {
                halo.refresh(&mut stage.coefficients.fields(), ranks);
            }
            fine = &stage.coefficients;
        }
        let Some(Gathered { gathering, halo, coefficients, .. }) = &mut self.gathered else {
            return fine;
        };
        gathering.gather_coefficients(fine, coefficients, ranks);
        halo.refresh(&mut coefficients.fields(), &OneRank);
        coefficients
    }

    /// Restricts the residual, whose halo is current, to the right-hand side of the coarser level.
    pub(super) fn restrict(&mut self, residual: &Field, ranks: &dyn Communicator) {
        let mut fine = residual;
        for stage in &mut self.stages {
            stage.transfer.restrict(fine, &mut stage.numbers);
            fine = &stage.numbers;
        }
        if let Some(gathered) = &mut self.gathered {
            gathered.gathering.gather(fine, &mut gathered.right, ranks);
        }
    }

    /// Coefficients, right-hand side and solution of the coarser level.
    pub(super) fn equation(&mut self) -> (&Coefficients, (&Field, &mut Field)) {
        let last = self.stages.last().expect("a step coarsens along an axis");
        let (coefficients, right) = match &self.gathered {
            Some(gathered) => (&gathered.coefficients, &gathered.right),
            None => (&last.coefficients, &last.numbers),
        };
        (coefficients, (right, &mut self.solution))
    }

    /// Adds to the finer level's solution what the coarser one's, whose halo is current, says.
    pub(super) fn correct(&mut self, solution: &mut Field) {
        let last = self.stages.len() - 1;
        let mut coarse = &self.solution;
        let (finer, coarsest) = self.stages.split_at_mut(last);
        let Stage { transfer, numbers, .. } = &mut coarsest[0];
        if let Some(gathered) = &self.gathered {
            gathered.gathering.take_part(coarse, numbers);
            coarse = numbers;
        }
        let mut transfer = &*transfer;
        for stage in finer.iter_mut().rev() {
            transfer.prolong(coarse, &mut stage.numbers);
            (coarse, transfer) = (&stage.numbers, &stage.transfer);
        }
        transfer.correct(coarse, solution);
    }
}
