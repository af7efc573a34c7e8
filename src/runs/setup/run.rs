//! A bed in motion.

use super::Snapshot;
use talcum_engine::grid::ColumnGrid;
use talcum_engine::parallel::{Communicator, ParticleRecord};
use talcum_engine::particles::ContactHistories;
use talcum_engine::state::{
    Domain, EnergyBalance, EnergyLedger, Models, SizeRange, State, StoredEnergy, Workspace,
};
use talcum_engine::time_step::{
    Staggered, StepError, advance, confirm, refresh_ghosts, stored_energy,
};
use talcum_results::analysis::{BedProfile, Digest, RunView, WallForce, series_row, wall_forces};
use talcum_results::instruments::{Instrument, Readings, View};

/// Solids fraction at the limits of the bed, for instruments.
const BED_THRESHOLD: f64 = 0.3;

/// A bed between two steps, on this rank. [`Setup::start`](super::Setup::start) makes it.
///
/// Methods described as collective must be called by all ranks in the same order.
pub struct Run<'a> {
    /// Particles, contacts and gas, all at the time of the clock.
    pub state: State,
    /// Box and walls.
    pub domain: Domain,
    /// The models that act on the particles.
    pub models: Models,
    /// Lists and buffers, sums of the last step, timers.
    pub work: Workspace,
    /// The ranks.
    pub ranks: &'a dyn Communicator,
}

impl Run<'_> {
    /// Advances the bed by one step of length `models.physics.time_step`. Collective.
    ///
    /// # Errors
    /// If a force or a speed is not meaningful, or a particle passes a face of kind
    /// [`Stop`](talcum_engine::domain::Face::Stop). The run cannot continue.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.steps(1)
    }

    /// Advances the bed by `count` steps. Collective.
    ///
    /// # Errors
    /// The errors of [`Run::step`].
    pub fn steps(&mut self, count: u64) -> Result<(), StepError> {
        let Self { state, domain, models, work, ranks } = self;
        let mut state = Staggered::new(state);
        for _ in 0..count {
            advance(&mut state, domain, models, work, *ranks)?;
        }
        Ok(())
    }

    /// Simulated time since the start of the run.
    pub fn time(&self) -> f64 {
        self.state.clock.time()
    }

    /// Number of particles in the box. Collective.
    pub fn particle_count(&self) -> usize {
        self.ranks.total(self.state.particles.owned_count())
    }

    /// The particles of this rank, with positions wrapped into the box, in an order that may change from step to step.
    pub fn particles(&self) -> impl Iterator<Item = ParticleRecord> {
        let (particles, bounds) = (&self.state.particles, &self.domain.bounds);
        (0..particles.owned_count()).map(move |index| ParticleRecord {
            position: bounds.wrap(particles.body[index].position).into(),
            ..ParticleRecord::of(particles, index)
        })
    }

    /// The particle with this id, if this rank owns it; its position is wrapped into the box.
    pub fn particle(&self, id: u64) -> Option<ParticleRecord> {
        let particles = &self.state.particles;
        let owned = &particles.id[..particles.owned_count()];
        let index = owned.iter().position(|&other| other == id)?;
        let position = self.domain.bounds.wrap(particles.body[index].position).into();
        Some(ParticleRecord { position, ..ParticleRecord::of(particles, index) })
    }

    /// The force of the particles on every wall, at the last step. Collective.
    pub fn wall_forces(&self) -> Vec<WallForce> {
        let Self { state, domain, models, work, ranks } = self;
        wall_forces(RunView { state, domain, models, work }, *ranks)
    }

    /// Opens a new energy ledger, which replaces any earlier one: from now on the work of every mechanism is summed at
    /// each step. Collective.
    pub fn keep_energy_ledger(&mut self) {
        let start = self.stored_energy();
        self.state.energy = Some(Box::new(EnergyLedger::opened(start)));
    }

    /// The totals of the ledger, compared with the present stored energy; `None` if no ledger is kept. Collective.
    pub fn energy_balance(&self) -> Option<EnergyBalance> {
        let ledger = self.state.energy.as_ref()?;
        Some(ledger.balance(&self.stored_energy(), self.ranks))
    }

    /// Energy of motion, attraction and springs. Collective.
    pub fn stored_energy(&self) -> StoredEnergy {
        let Self { state, domain, models, work, ranks } = self;
        stored_energy(state, domain, models, work).total(*ranks)
    }

    /// Takes a sample of the run for an instrument, which does not change the run. Collective.
    ///
    /// # Errors
    /// If the forces of the last step are not meaningful.
    pub fn look(&mut self, looking: &mut dyn Instrument) -> Result<Readings, StepError> {
        let Self { state, domain, models, work, ranks } = self;
        confirm(state, work, *ranks)?;
        let needs = looking.needs();
        if needs.contact_forces {
            refresh_ghosts(state, work, *ranks);
        }
        let gas_cells = if needs.gas_cells {
            work.gas.sample(&state.gas, &state.particles, *ranks)
        } else {
            None
        };
        let SizeRange { smallest_diameter, largest_diameter, .. } = state.sizes;
        let grid = ColumnGrid::new(&domain.bounds, 1.5 * largest_diameter, 1.0)
            .within(domain.cross_section());
        let diameters = [smallest_diameter, largest_diameter];
        let mut profile = BedProfile::new(grid, models.limits.speed, diameters, BED_THRESHOLD);
        let run = RunView { state, domain, models, work };
        let series = needs.series.then(|| series_row(run, &mut profile, None, *ranks));
        let view = View::new(run, &profile, series.as_ref(), gas_cells.as_deref());
        Ok(looking.look(&view, *ranks))
    }

    /// Hash of the whole state; it does not depend on the number of ranks. Collective.
    ///
    /// # Errors
    /// If the forces of the last step are not meaningful.
    pub fn digest(&mut self) -> Result<Digest, StepError> {
        let here = self.part()?;
        Ok(Digest::of(&here.clock, &here.records(), self.ranks))
    }

    /// The whole state, sorted by ids, on all ranks: for small beds. Collective.
    ///
    /// # Errors
    /// If the forces of the last step are not meaningful.
    pub fn snapshot(&mut self) -> Result<Snapshot, StepError> {
        Ok(self.part()?.gathered(self.ranks))
    }

    /// This rank's part of the state, each record on one rank. Collective.
    fn part(&mut self) -> Result<Snapshot, StepError> {
        confirm(&self.state, &mut self.work, self.ranks)?;
        let State { particles, contacts, clock, departed, sizes, gas, looked_at, .. } = &self.state;
        let ContactHistories { pairs, walls, .. } = contacts.histories(particles);
        Ok(Snapshot {
            clock: *clock,
            departed: *departed,
            sizes: *sizes,
            particles: self.particles().collect(),
            custom: particles.custom_fields(),
            pairs,
            walls,
            cells: self.work.gas.records(gas, self.ranks),
            gas_report: gas.report(),
            looked_at: looked_at.clone(),
        })
    }
}
