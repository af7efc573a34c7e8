"""A model of the time of a step on many ranks, from measured rates and the messages between ranks.

The ranks are blocks of a bed over a plate, which is cut into columns or into cubes. With n particles per rank at number
density c, a ghost layer of width w and a block of sides l, a step has these parts:

    compute     n t_p, with t_p the time per particle-step of one rank when all cores of the machine are busy
    copies      packing, moving and adding the data of copies: a part of a particle's step for each copy in a pair, by the
                check with `perf` (processor.py)
    halo        velocities: one message from each of the blocks ahead, half of those around, with 48 bytes for each particle
                of their layer w that is in a pair; the part of the time that remains after decide. Forces: as many bytes
                the other way, while the rank computes the pairs of its own particles. The work of the processor for each
                message comes on top. A pair of two ranks' particles is computed by one of them; there are c z / 4 such pairs
                per area of a cut, with z the contacts of a particle, since a contact crosses the plane of a cut by half a
                diameter in the mean
    decide      one all-reduce of eight numbers: log2(P) latencies
    gas         one all-reduce of two fields over the column's nodes, which begins before decide: the part of the time that
                remains after decide, as if MPI continued it only while a rank waits for something else
    rebuild     every R steps: new ghosts along one axis after the other (112 bytes each), their originals (4 bytes), two
                reductions, and two sparse exchanges: messages to the blocks around, with the particles of a layer at the
                faces, half a skin thick, and their contacts, and a barrier of log2(P) latencies, after which all
                messages have arrived

Each message takes latency + bytes / bandwidth; messages are sent at once unless the text says otherwise. Ranks of a node are
blocks side by side, so that of the messages along an axis only those of the node's outermost blocks leave it. Loads are even.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from .tables import table

GHOST_BYTES, NEW_GHOST_BYTES = 48, 112
DECISION_BYTES, INDEX_BYTES = 8 * 8, 4
# Part of the particles of the layer that are in a pair of the list: for blocks of 1,000 in the settled bed of 24,000, 0.66 to 0.71.
PART_IN_PAIRS = 0.69
# Cost of a copy to its owner and its borrower together, in steps of a particle: docs/performance-tables.md, the check of the model.
COPY_COST = 0.6
# Part of a step that pairs take (docs/performance-tables.md, settled beds).
PART_OF_PAIRS = 0.75
# Whether no particle is too fast, and whether each contact has found its place.
REDUCTIONS_PER_REBUILD = 2
# A particle and its contacts, 2.64 for each of both sides; half a skin is the farthest way between two rebuilds.
MIGRANT_BYTES, LONGEST_WAY = 168 + 5.28 * 72, 0.04
SOLIDS_FRACTION = 0.6
LAYER = 1.08
BED_HEIGHT = 52.0


@dataclass(frozen=True)
class Network:
    """A network, as an MPI program sees it. Cray Aries as measured with the OSU benchmarks, one rank per node
    (gist.github.com/hppritcha/6a3acd0c192fcfd082bd543fc98e6fe6: 1.2 us for small messages, 114 us for 1 MiB);
    the bandwidth of a node is shared by its ranks."""

    latency: float = 1.2e-6
    node_bandwidth: float = 9.2e9
    ranks_per_node: int = 64
    # A rank sends and receives single messages one after another: about the latency's processor part.
    overhead: float = 0.5e-6

    # Within a node a message is copied twice through memory that all cores share.
    copy_bandwidth: float = 1.5e9

    def message(self, size: float, cut_axes: int = 2) -> float:
        """Seconds for one message while all ranks of the node, a block of `cut_axes` dimensions, send theirs."""
        leaving = self.ranks_per_node ** (1.0 - 1.0 / cut_axes)
        return self.latency + max(size * leaving / self.node_bandwidth, size / self.copy_bandwidth)

    def all_reduce(self, ranks: int, size: float) -> float:
        """Seconds, by recursive doubling."""
        return math.ceil(math.log2(ranks)) * self.message(size) if ranks > 1 else 0.0


def copies_around(sides: list[float], is_cut: list[bool], density: float) -> float:
    """Particles in the half that is ahead of the layer around a block, along the axes that are cut."""
    widened = [side + 2.0 * LAYER * cut for side, cut in zip(sides, is_cut)]
    return 0.5 * density * (math.prod(widened) - math.prod(sides))


@dataclass(frozen=True)
class Load:
    """The work of each rank."""

    particles: float
    # Cut along x and y only, over the whole height of the bed; or along all three axes.
    columns: bool = True
    particle_step: float = 1.0e-7
    steps_per_rebuild: float = 100.0
    gas_nodes: int = 0

    @property
    def sides(self) -> list[float]:
        """Lengths of the block along the axes that are cut, and then of the others."""
        volume = self.particles / self.density
        if self.columns:
            return [math.sqrt(volume / BED_HEIGHT)] * 2 + [BED_HEIGHT]
        return [volume ** (1.0 / 3.0)] * 3

    @property
    def density(self) -> float:
        """Particles per volume."""
        return SOLIDS_FRACTION * 6.0 / math.pi

    @property
    def cut_axes(self) -> int:
        """Along how many axes the bed is cut."""
        return 2 if self.columns else 3

    @property
    def blocks_around(self) -> int:
        """Blocks that touch it, also at edges and corners."""
        return 8 if self.columns else 26

    def blocks_ahead(self, ranks: int) -> int:
        """The blocks ahead: half of those around, but at most all other ranks."""
        return min(self.blocks_around // 2, ranks - 1)

    @property
    def copies(self) -> float:
        """Particles of other ranks within the layer around the block, in the half that is ahead."""
        is_cut = [axis < self.cut_axes for axis in range(3)]
        return copies_around(self.sides, is_cut, self.density)

    @property
    def copies_in_pairs(self) -> float:
        """The part of the neighbours' particles that is in a pair of the list."""
        return PART_IN_PAIRS * self.copies

    @property
    def shared_pairs(self) -> float:
        """Contacts with particles of other ranks over n z / 2, in which each of them counts half."""
        # Two faces along each cut axis; a contact's branch has the component 1/2 along their normal in the mean.
        return sum(2.0 * 0.5 / side for side in self.sides[: self.cut_axes])

    def ghosts_per_message(self) -> list[float]:
        """For each cut axis, in their order: what came along one axis is passed on along the next."""
        sides, ghosts = self.sides, []
        for axis in range(self.cut_axes):
            others = [side for other, side in enumerate(sides) if other != axis]
            ghosts.append(self.density * LAYER * others[0] * others[1])
            sides[axis] += 2.0 * LAYER
        return ghosts


def sparse_exchange(load: Load, ranks: int, network: Network, size: float) -> float:
    """Seconds of one: messages of a size are sent one after another and each is acknowledged; then the barrier."""
    messages = min(load.blocks_around, ranks - 1)
    there_and_back = network.message(size, load.cut_axes) + network.latency
    return there_and_back + 2.0 * network.overhead * messages + network.all_reduce(ranks, 0.0)


def rebuild(load: Load, ranks: int, network: Network) -> float:
    """Seconds of new lists, without the work on them."""
    ghosts = load.ghosts_per_message()
    made = sum(network.message(NEW_GHOST_BYTES * n, load.cut_axes) + network.overhead for n in ghosts)
    migrants = MIGRANT_BYTES * LONGEST_WAY / LAYER * max(ghosts)
    exchanges = [sparse_exchange(load, ranks, network, size) for size in (migrants, INDEX_BYTES * max(ghosts))]
    return made + sum(exchanges) + REDUCTIONS_PER_REBUILD * network.all_reduce(ranks, 8)


def travel(load: Load, network: Network) -> float:
    """Seconds until all velocities of copies have arrived, or all forces on them."""
    return network.message(GHOST_BYTES * load.copies_in_pairs, load.cut_axes)


def halo(load: Load, ranks: int, network: Network) -> float:
    """Seconds that messages of velocities and forces add to a step."""
    # The rank's own pairs and half of those that it shares are all that it computes.
    own = 1.0 - 0.5 * load.shared_pairs
    own_pairs = PART_OF_PAIRS * own * load.particles * load.particle_step
    way = travel(load, network)
    there = max(0.0, way - network.all_reduce(ranks, DECISION_BYTES))
    back = max(0.0, way - own_pairs)
    return there + back + 2.0 * network.overhead * load.blocks_ahead(ranks)


def gas_sum(load: Load, ranks: int, network: Network) -> float:
    """Seconds that the sum over the bed of a column gas takes beyond decide."""
    return max(0.0, network.all_reduce(ranks, 16 * load.gas_nodes) - network.all_reduce(ranks, DECISION_BYTES))


def step_parts(load: Load, ranks: int, network: Network) -> dict[str, float]:
    """Seconds of the parts of a step."""
    compute = load.particles * load.particle_step
    if ranks == 1:
        return {"compute": compute, "copies": 0.0, "halo": 0.0, "decide": 0.0, "gas": 0.0, "rebuild": 0.0}
    return {
        "compute": compute,
        "copies": COPY_COST * load.particle_step * load.copies_in_pairs,
        "halo": halo(load, ranks, network),
        "decide": network.all_reduce(ranks, DECISION_BYTES),
        "gas": gas_sum(load, ranks, network) if load.gas_nodes else 0.0,
        "rebuild": rebuild(load, ranks, network) / load.steps_per_rebuild,
    }


def efficiency(parts: dict[str, float]) -> str:
    """The part of a step that is computing."""
    return f"{100.0 * parts['compute'] / sum(parts.values()):.0f} %"


def model_table(load: Load, network: Network = Network()) -> str:
    """Microseconds of the parts of a step, and efficiency, on 64 to 100,000 ranks."""
    rows = []
    for particles in (1.0e3, 1.0e4, 1.0e5):
        for ranks in (64, 1_000, 100_000):
            parts = step_parts(replace(load, particles=particles), ranks, network)
            cells = [f"{1e6 * seconds:.1f}" for seconds in parts.values()]
            sizes = [f"{particles:,.0f}", f"{ranks:,}", f"{particles * ranks:.1e}"]
            rows.append([*sizes, *cells, efficiency(parts)])
    head = ["particles per rank", "ranks", "particles", "compute, us", "copies", "halo", "decide", "gas", "rebuild", "efficiency"]
    return table(head, rows)
