//! The choices made before a run, and its start.

use super::{Layers, Layout, Run, SetupError, Snapshot, Sphere};
use talcum_engine::balance::Balance;
use talcum_engine::contact::{ByPair, BySpecies, ContactExchange, ContactModel, VanDerWaals};
use talcum_engine::domain::{Bounds, Face, RankGrid, Vibration, Wall};
use talcum_engine::fields::{Field, Travel};
use talcum_engine::gas::GasModel;
use talcum_engine::parallel::{Communicator, OneRank, ParticleRecord};
use talcum_engine::particles::{CustomFields, ListRange, Skin};
use talcum_engine::state::{Domain, Models, Physics, SizeRange, Workspace};
use talcum_engine::time_step::{begin, find_first_forces};

/// A bed before its start: the box, the models that act on the particles, and the particles. It must be equal on all
/// ranks.
#[derive(Clone, Debug)]
pub struct Setup {
    pub(super) domain: Domain,
    pub(super) physics: Physics,
    pub(super) particles: Vec<ParticleRecord>,
    /// Custom fields of the first particles; those added later have zeros.
    pub(super) custom: CustomFields,
    pub(super) sizes: Option<SizeRange>,
    pub(super) skin: Option<f64>,
    pub(super) force_limit: Option<f64>,
    balance: Option<Balance>,
}

impl Setup {
    /// An empty box from the origin to `lengths`, with faces `[axis][lower, upper]`; a wall lies in each face of kind
    /// wall.
    ///
    /// # Errors
    /// If a length is not above 0, or only one of two opposite faces is periodic.
    pub fn new(
        lengths: [f64; 3],
        faces: [[Face; 2]; 3],
        physics: Physics,
    ) -> Result<Self, SetupError> {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let length = lengths[axis];
            if !(length.is_finite() && length > 0.0) {
                return Err(SetupError::BoxLength { axis: name, length });
            }
            let [lower, upper] = faces[axis].map(|face| face == Face::Periodic);
            if lower != upper {
                return Err(SetupError::PeriodicFaces { axis: name });
            }
        }
        Ok(Self::in_domain(Domain::of_box(Bounds::new(lengths.into(), faces)), physics))
    }

    /// An empty domain.
    pub fn in_domain(domain: Domain, physics: Physics) -> Self {
        let particles = Vec::new();
        let (sizes, skin, force_limit, balance) = (None, None, None, None);
        let custom = CustomFields::default();
        Self { domain, physics, particles, custom, sizes, skin, force_limit, balance }
    }

    /// Adds a wall, after those in the faces of the box.
    #[must_use]
    pub fn wall(mut self, wall: Wall) -> Self {
        self.domain.walls.push(wall);
        self
    }

    /// Sets the contact models of particles and walls, by the numbers of the walls; walls beyond these behave like
    /// particles.
    #[must_use]
    pub fn walls(mut self, models: impl IntoIterator<Item = ContactModel>) -> Self {
        self.physics.at_walls = models.into_iter().map(BySpecies::of_all).collect();
        self
    }

    /// Sets the attraction of particles, and of particles and walls.
    #[must_use]
    pub fn cohesion(mut self, cohesion: VanDerWaals) -> Self {
        self.physics.cohesion = Some(ByPair::of_all(cohesion));
        self
    }

    /// Sets the gas between the particles.
    #[must_use]
    pub fn gas(mut self, gas: impl Into<GasModel>) -> Self {
        self.physics.gas = gas.into();
        self
    }

    /// Sets gravity along -z; length per time squared.
    #[must_use]
    pub fn gravity(mut self, magnitude: f64) -> Self {
        self.physics.gravity.magnitude = magnitude;
        self
    }

    /// Lets the plate vibrate along z; the box is its frame.
    #[must_use]
    pub fn vibration(mut self, vibration: Vibration) -> Self {
        self.physics.gravity.vibration = Some(vibration);
        self
    }

    /// Adds a particle. Its id is the number of particles before it.
    #[must_use]
    pub fn particle(mut self, sphere: Sphere) -> Self {
        let id = self.particles.len() as u64;
        self.particles.push(sphere.record(id));
        self
    }

    /// Adds layers of particles. Their ids continue from the number of particles before them.
    #[must_use]
    pub fn layers(self, layers: &Layers) -> Self {
        let spheres: Vec<Sphere> = layers.spheres(&self.domain.bounds).collect();
        spheres.into_iter().fold(self, Self::particle)
    }

    /// Adds particles, whose ids must differ from all others.
    #[must_use]
    pub fn particles(mut self, records: impl IntoIterator<Item = ParticleRecord>) -> Self {
        self.particles.extend(records);
        self
    }

    /// A custom field, with its numbers for each of the particles that have been added before; zero for others. It goes with the
    /// particles from rank to rank, into snapshots and checkpoints, and is part of the digest where it is not zero.
    #[must_use]
    pub fn field<const WIDTH: usize>(
        mut self,
        field: Field,
        numbers: impl Fn(&ParticleRecord) -> [f64; WIDTH],
    ) -> Self {
        assert_eq!(field.width(), WIDTH, "the numbers of \"{}\"", field.name);
        let numbers: Vec<f64> = self.particles.iter().flat_map(numbers).collect();
        self.custom.push(field, &numbers);
        self
    }

    /// Adds a law by which touching particles exchange a field; the field has these numbers at the start, as in
    /// [`Setup::field`].
    #[must_use]
    pub fn exchange(
        mut self,
        law: impl ContactExchange + 'static,
        number: impl Fn(&ParticleRecord) -> f64,
    ) -> Self {
        let field = law.field().travels(Travel::EachStep);
        self.physics.exchanges.add(law);
        self.field(field, |record| [number(record)])
    }

    /// Sets the sizes from which the limits of forces and speeds follow; by default these are the sizes of the
    /// particles.
    #[must_use]
    pub fn sizes(mut self, sizes: SizeRange) -> Self {
        self.sizes = Some(sizes);
        self
    }

    /// Sets the skin of the neighbour lists, [`Skin::FromSpeeds`] by default; length. It changes how often lists are
    /// rebuilt, but no result.
    #[must_use]
    pub fn skin(mut self, skin: f64) -> Self {
        self.skin = Some(skin);
        self
    }

    /// Lets cut planes follow the load of the ranks. This changes no result.
    #[must_use]
    pub fn balance(mut self, balance: Balance) -> Self {
        self.balance = Some(balance);
        self
    }

    /// Sets the largest component of one contact's force; by default it is the force at an overlap of half the smallest
    /// diameter. Forces are rounded to a fraction of about 10^-15 of it.
    #[must_use]
    pub fn force_limit(mut self, force: f64) -> Self {
        self.force_limit = Some(force);
        self
    }

    /// Starts the bed on this rank of a grid of all ranks, at time zero, and computes its forces. Collective.
    ///
    /// # Errors
    /// If the setup is not valid, or the ranks cannot divide it; the same error on all ranks.
    pub fn start<'a>(
        &self,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Result<Run<'a>, SetupError> {
        self.check()?;
        let quantum = self.domain.bounds.position_quantum();
        let on_lattice = |record: &ParticleRecord| ParticleRecord {
            position: quantum.round_vector(record.position.into()).into(),
            ..*record
        };
        let particles = self.particles.iter().map(on_lattice).collect();
        let bed = Snapshot {
            custom: self.custom.extended(self.particles.len()),
            ..Snapshot::new_bed(particles, self.size_range()?, self.physics.time_step)
        };
        let mut run = self.run_from(&bed, grid, ranks)?;
        let Run { state, domain, models, work, .. } = &mut run;
        find_first_forces(state, domain, models, work, ranks);
        Ok(run)
    }

    /// Starts the bed on one rank, at time zero.
    ///
    /// # Errors
    /// The errors of [`Setup::start`].
    pub fn start_alone(&self) -> Result<Run<'static>, SetupError> {
        self.start(RankGrid([1, 1, 1]), &OneRank)
    }

    /// Continues a run from its snapshot, on this rank of any grid of ranks; or starts another run from the particles
    /// of the snapshot, with the physics of this setup. Collective.
    ///
    /// # Errors
    /// The errors of [`Setup::start`].
    pub fn resume<'a>(
        &self,
        snapshot: &Snapshot,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Result<Run<'a>, SetupError> {
        self.check()?;
        let custom = self.custom_of(snapshot)?;
        self.run_from(&Snapshot { custom, ..snapshot.clone() }, grid, ranks)
    }

    /// Makes lists and ghosts for a state that all ranks have completely. Collective.
    fn run_from<'a>(
        &self,
        whole: &Snapshot,
        grid: RankGrid,
        ranks: &'a dyn Communicator,
    ) -> Result<Run<'a>, SetupError> {
        let (domain, models) = (self.domain.clone(), self.models(&whole.sizes)?);
        let diameter = whole.sizes.largest_diameter;
        let skin = self.skin.map_or(Skin::FromSpeeds { diameter }, Skin::Fixed);
        let (interaction, narrowest) = (models.range(&whole.sizes), skin.narrowest());
        let ghost_width = ListRange { interaction, skin: narrowest }.ghost_width(diameter);
        self.check_width(ghost_width)?;
        let gas = &models.physics.gas;
        let layout = Layout { bounds: &domain.bounds, gas, ghost_width };
        let decomposition = layout.even(grid, ranks.size())?;
        let share = whole.share_of(ranks);
        let distributed = share.distribute(&domain.bounds, gas, &decomposition, ranks);
        let (mut state, histories) = (distributed.state, distributed.histories);
        self.physics.exchanges.add_flow_columns(&mut state.particles);
        state.clock = state.clock.with_time_step(models.physics.time_step);
        let mut work = Workspace::new(decomposition, skin, ghost_width, self.balance);
        work.prepare(&domain, &models, &state.sizes);
        begin(&mut state, &domain, &models, &mut work, histories, ranks)?;
        Ok(Run { state, domain, models, work, ranks })
    }

    /// The custom fields of a snapshot in the form registered in this setup; a field that the snapshot lacks is zero.
    ///
    /// # Errors
    /// If the snapshot has a field that this setup does not know.
    fn custom_of(&self, snapshot: &Snapshot) -> Result<CustomFields, SetupError> {
        let has_name = |name| move |field: &&Field| field.name == name;
        let known = |field: &&Field| self.custom.fields.iter().find(has_name(field.name)).is_none();
        if let Some(unknown) = snapshot.custom.fields.iter().find(known) {
            return Err(SetupError::UnknownField { name: unknown.name });
        }
        let mut custom = CustomFields::default();
        for &field in &self.custom.fields {
            let place = snapshot.custom.fields.iter().position(|other| other.name == field.name);
            let zeros = || vec![0.0; snapshot.particles.len() * field.width()];
            custom.push(field, &place.map_or_else(zeros, |place| snapshot.custom.column(place)));
        }
        Ok(custom)
    }

    /// The models for particles of these sizes.
    fn models(&self, sizes: &SizeRange) -> Result<Models, SetupError> {
        let mut limits = self.physics.limits(sizes);
        limits.force = self.force_limit.unwrap_or(limits.force);
        let torque = limits.force * sizes.largest_diameter;
        if !(limits.force * torque).is_finite() || limits.force * torque <= 0.0 {
            return Err(SetupError::ForceRange { force: limits.force });
        }
        Ok(Models::new(self.physics.clone(), limits, sizes))
    }
}
