//! A state as records, and its distribution over the ranks.

use talcum_engine::domain::{Bounds, Decomposition};
use talcum_engine::gas::{GasModel, GasState};
use talcum_engine::parallel::{
    CellRecord, Communicator, ContactRecord, ParticleRecord, WallContactRecord,
    send_histories_to_owners, send_to_owners, share_with_all,
};
use talcum_engine::particle_sets::Pair;
use talcum_engine::particles::{
    AGGLOMERATE, ContactHistories, Contacts, CustomFields, GAS_FORCE, Particles,
};
use talcum_engine::state::{Clock, Departed, GasReport, SizeRange, State};
use talcum_results::analysis::StateRecords;

/// A state as records: of all particles, or of those that one rank has. A run that continues from it gives the same
/// bits as one that was never stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Time.
    pub clock: Clock,
    /// Particles that have left the box.
    pub departed: Departed,
    /// Sizes of the particles at the start of the run.
    pub sizes: SizeRange,
    /// Particles.
    pub particles: Vec<ParticleRecord>,
    /// Custom fields of these particles, in the same order.
    pub custom: CustomFields,
    /// Histories of touching pairs.
    pub pairs: Vec<ContactRecord>,
    /// Histories of contacts with walls.
    pub walls: Vec<WallContactRecord>,
    /// Cells of a volume-averaged gas; empty without such a gas, or for a gas that starts from rest.
    pub cells: Vec<CellRecord>,
    /// Report on the last step of that gas.
    pub gas_report: GasReport,
    /// Pairs that touched at the last search for agglomerates, if drag depends on them and there was a search.
    pub looked_at: Option<Vec<Pair>>,
}

/// This rank's part of a state, before there are lists and ghosts.
pub struct DistributedState {
    /// The state.
    pub state: State,
    /// Histories of its contacts.
    pub histories: ContactHistories,
}

impl Snapshot {
    /// A new bed of these particles at time zero.
    pub fn new_bed(particles: Vec<ParticleRecord>, sizes: SizeRange, time_step: f64) -> Self {
        Self {
            clock: Clock::new(time_step),
            departed: Departed::default(),
            sizes,
            particles,
            custom: CustomFields::default(),
            pairs: Vec::new(),
            walls: Vec::new(),
            cells: Vec::new(),
            gas_report: GasReport::default(),
            looked_at: None,
        }
    }

    /// This rank's share of a snapshot that all ranks have completely.
    pub fn share_of(&self, ranks: &dyn Communicator) -> Self {
        fn share<T: Copy>(all: &[T], ranks: &dyn Communicator) -> Vec<T> {
            all.iter().copied().skip(ranks.rank()).step_by(ranks.size()).collect()
        }
        let here = (ranks.rank()..self.particles.len()).step_by(ranks.size());
        Self {
            particles: share(&self.particles, ranks),
            custom: self.custom.select(here),
            pairs: share(&self.pairs, ranks),
            walls: share(&self.walls, ranks),
            cells: share(&self.cells, ranks),
            looked_at: self.looked_at.as_ref().map(|pairs| share(pairs, ranks)),
            ..*self
        }
    }

    /// This snapshot with the records of all ranks on every rank, sorted by their ids. Collective.
    pub fn gathered(self, ranks: &dyn Communicator) -> Self {
        let particles = share_with_all(self.particles, ranks);
        let custom =
            CustomFields { numbers: share_with_all(self.custom.numbers, ranks), ..self.custom };
        let mut order: Vec<usize> = (0..particles.len()).collect();
        order.sort_by_key(|&index| particles[index].id);
        let custom = custom.select(order.iter().copied());
        let particles: Vec<ParticleRecord> = order.iter().map(|&index| particles[index]).collect();
        let mut pairs = share_with_all(self.pairs, ranks);
        let mut walls = share_with_all(self.walls, ranks);
        let mut cells = share_with_all(self.cells, ranks);
        let mut looked_at = self.looked_at.map(|pairs| share_with_all(pairs, ranks));
        pairs.sort_by_key(|pair| (pair.lower, pair.higher));
        walls.sort_by_key(|contact| (contact.particle, contact.wall));
        cells.sort_by_key(|record| record.cell);
        looked_at.iter_mut().for_each(|pairs| pairs.sort_unstable());
        Self { particles, custom, pairs, walls, cells, looked_at, ..self }
    }

    /// Sends the records, each of which is on one rank, to the ranks that own them. Collective.
    pub fn distribute(
        self,
        bounds: &Bounds,
        gas: &GasModel,
        decomposition: &Decomposition,
        ranks: &dyn Communicator,
    ) -> DistributedState {
        let Self { clock, departed, sizes, gas_report, looked_at, .. } = self;
        let (records, custom) = send_to_owners(self.particles, self.custom, decomposition, ranks);
        let mut particles = Particles::with_room_for(records.len());
        custom.fields.iter().for_each(|&field| particles.columns.add(field));
        for (index, record) in records.iter().enumerate() {
            record.push_to(&mut particles);
            particles.set_custom_row(index, custom.row(index));
        }
        let histories = send_histories_to_owners(self.pairs, self.walls, &particles.id, ranks);
        let subdomain = decomposition.subdomain(bounds, ranks.rank());
        let gas = GasState::from_records(gas, &self.cells, gas_report, subdomain, ranks);
        if gas == GasState::None {
            particles.columns.at_mut(GAS_FORCE).reset();
        }
        if looked_at.is_none() {
            particles.columns.at_mut(AGGLOMERATE).reset();
        }
        let contacts = Contacts::default();
        DistributedState {
            state: State {
                particles,
                contacts,
                clock,
                departed,
                sizes,
                energy: None,
                gas,
                looked_at,
            },
            histories,
        }
    }

    /// The records, for a digest.
    pub fn records(&self) -> StateRecords<'_, [ParticleRecord]> {
        let Self { particles, custom, pairs, walls, cells, looked_at, .. } = self;
        let looked_at = looked_at.as_deref().unwrap_or_default();
        StateRecords { particles, custom, contacts: pairs, wall_contacts: walls, cells, looked_at }
    }

    /// All its bits, which are equal only for equal states.
    pub fn bits(&self) -> Vec<u8> {
        let Self { clock, departed, .. } = self;
        let mut bytes = bytemuck::cast_slice::<_, u8>(&self.particles).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&self.pairs));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.walls));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.cells));
        let looked_at = self.looked_at.as_deref().unwrap_or_default();
        bytes.extend_from_slice(bytemuck::cast_slice(looked_at));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.custom.numbers));
        bytes.extend_from_slice(&clock.step.to_le_bytes());
        departed.bits().for_each(|bits| bytes.extend_from_slice(&bits.to_le_bytes()));
        bytes
    }
}
