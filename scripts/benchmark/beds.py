"""The beds that are measured, and the contact law that all programs are given."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "results" / "bench"
TIME_STEP = 2.5e-4


@dataclass(frozen=True)
class ContactLaw:
    """Linear spring and dashpot with friction history, of one size of particles; as in cases/benchmark."""

    normal_stiffness: float = 2.0e5
    poisson_ratio: float = 0.3
    restitution: float = 0.9
    friction: float = 0.1
    particle_mass: float = math.pi / 6.0

    @property
    def tangential_stiffness(self) -> float:
        """k_t = 2 k_n (1 - nu) / (2 - nu)."""
        return 2.0 * self.normal_stiffness * (1.0 - self.poisson_ratio) / (2.0 - self.poisson_ratio)

    def damping(self, reduced_mass: float) -> float:
        """The peers' gamma_n: dashpot over reduced mass, 2 sqrt(k_n / m*) |ln e| / sqrt(pi^2 + ln^2 e)."""
        log = abs(math.log(self.restitution))
        return 2.0 * math.sqrt(self.normal_stiffness / reduced_mass) * log / math.hypot(math.pi, log)

    @property
    def pair_damping(self) -> float:
        """gamma_n of two particles: m* = m / 2."""
        return self.damping(0.5 * self.particle_mass)

    @property
    def wall_damping(self) -> float:
        """gamma_n of a particle and a wall: m* = m."""
        return self.damping(self.particle_mass)


@dataclass(frozen=True)
class Vibration:
    """Gravity in the frame of the plate: 1 + Gamma sin(2 pi f t), t from the start of the run."""

    gamma: float = 3.0
    frequency: float = 0.16


@dataclass(frozen=True)
class Bed:
    """One row of the table: which state, how many steps, on how many ranks."""

    name: str
    state: str
    particles: int
    steps: int
    # Steps of the peers before they are measured: they begin without contact histories.
    warm_up: int
    ranks: int = 1
    vibration: Vibration | None = None
    # Keys of the stage that are changed, in Talcum alone.
    settings: tuple[str, ...] = ()
    # Skins tried with each peer; lists of settled beds are hardly ever rebuilt, so small ones are best there.
    skins: tuple[float, ...] = (0.02, 0.05)
    # Least ratio to LAMMPS compiled for the processor, and to another bed of Talcum, that is aimed at.
    aim: float | None = None
    beside: str | None = None

    @property
    def with_peers(self) -> bool:
        """Whether the peers can run it."""
        return not self.settings and not self.state.startswith("adhesive")


BEDS = (
    Bed("3,000 settled", "settled-3000", 3_000, 6_000, 2_000, aim=2.5),
    Bed("3,000 settled, gas and cohesion", "settled-3000", 3_000, 6_000, 0,
        settings=("gas=on", "cohesion=on"), beside="3,000 settled"),
    Bed("3,000 settled, adhesive elastic-plastic", "adhesive-3000", 3_000, 6_000, 0, beside="3,000 settled"),
    Bed("24,000 settled", "settled-24000", 24_000, 1_000, 500, aim=2.5),
    Bed("216,000 settled", "settled-216000", 216_000, 400, 50, aim=2.4),
    Bed("3,000 shaken", "settled-3000", 3_000, 25_000, 0, vibration=Vibration(), skins=(0.04, 0.08, 0.15), aim=2.2),
    Bed("24,000 agitated", "agitated-24000", 24_000, 8_000, 0, skins=(0.08, 0.15, 0.25), aim=1.7),
    Bed("24,000 settled, 2 ranks", "settled-24000", 24_000, 1_000, 500, ranks=2, aim=2.4,
        beside="24,000 settled"),
)


def beds_named(words: list[str]) -> list[Bed]:
    """The beds whose names contain all of some words ("24000 2 ranks"); without words, all."""
    if not words:
        return list(BEDS)
    wanted = [phrase.replace(",", "").split() for phrase in words]
    plain = {bed: bed.name.replace(",", "").split() for bed in BEDS}
    found = [bed for bed in BEDS if any(set(phrase) <= set(plain[bed]) for phrase in wanted)]
    if not found:
        raise ValueError(f"no bed is called {' or '.join(words)}; there are {', '.join(bed.name for bed in BEDS)}")
    return found
