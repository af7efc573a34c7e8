"""Whether the peers compute the same physics: the same bed without contact histories, the same steps, compared."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import peers
from .beds import BEDS, RESULTS, TIME_STEP, Bed, ContactLaw
from .runs import BenchmarkError, execute, on_cores
from .states import Particles, read_particles, state, write_case, write_csv
from .tables import table
from .talcum import PROGRAM

STEPS = 2_000
BED = "24,000 agitated"
# Rounding errors grow until collisions have forgotten where they began: sums over 24,000 particles then agree
# within their fluctuations, 1 / sqrt(24,000) = 0.6 % at most. Without friction they differ by some 20 %.
TOLERANCE = 0.01
CONTROL = "LAMMPS without friction (control)"


@dataclass(frozen=True)
class Sums:
    """The quantities that are compared: energies and heights of the bed."""

    kinetic_energy: float
    energy_of_spin: float
    centre: float
    top: float

    def differs_from(self, other: Sums) -> float:
        """The largest relative difference."""
        pairs = zip(vars(self).values(), vars(other).values())
        return max(abs(ours - theirs) / abs(theirs) for ours, theirs in pairs)


def sums_of(bed: Particles) -> Sums:
    """Energies and heights of particles of density 1, with moments of inertia (2/5) m r^2."""
    mass = np.pi / 6.0 * bed.diameter**3
    inertia = 0.1 * mass * bed.diameter**2
    energies = [0.5 * float(np.sum(m * np.sum(v * v, axis=1))) for m, v in ((mass, bed.velocity), (inertia, bed.spin))]
    heights = bed.position[:, 2]
    return Sums(*energies, float(np.average(heights, weights=mass)), float(heights.max()))


def last_thermo_row(words: str) -> Sums:
    """The last row of step, energies and heights that LAMMPS or LIGGGHTS printed."""
    rows = re.findall(r"^\s*\d+((?:\s+-?\d[\d.e+-]*){4})\s*$", words, re.MULTILINE)
    if not rows:
        raise BenchmarkError(f"no row of energies in what the program said:\n{words[-2000:]}")
    return Sums(*map(float, rows[-1].split()))


def by_talcum(bed: Particles) -> Sums:
    """Energies and heights after the steps, from a file without contact memories."""
    folder = RESULTS / "agreement"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_csv(bed, folder / "bed.csv")
    write_case(bed, folder / "bed.csv", folder / "bed.toml")
    until = repr(STEPS * TIME_STEP)
    execute([str(PROGRAM), "run", str(folder / "bed.toml"), "--until", until, "--output", str(folder / "output")])
    return sums_of(read_particles(sorted((folder / "output").glob("checkpoint-*.h5"))[-1]))


def by_peer(peer: peers.Peer, bed: Bed, start: Path, friction: bool = True) -> Sums:
    """Energies and heights of a peer; without friction as a control."""
    path = RESULTS / "agreement" / peer.template
    law = ContactLaw() if friction else ContactLaw(friction=0.0)
    path.write_text(peers.deck(peer, bed, peers.data_file(peer, bed, start), 0.1, law), encoding="utf-8")
    return last_thermo_row(execute(on_cores([peer.program, "-in", str(path), "-log", "none"], 1)).words)


def agreement() -> str:
    """A table of energies and heights of all programs; an error if they differ, or if the control does not."""
    bed = next(bed for bed in BEDS if bed.name == BED)
    start = state(bed.state, execute, PROGRAM)
    ours = by_talcum(read_particles(start))
    found = {"Talcum": ours}
    bed = replace(bed, steps=STEPS, warm_up=0)
    for peer in peers.peers_here():
        found[peer.name] = by_peer(peer, bed, start)
        if peer.name == "LAMMPS":
            found[CONTROL] = by_peer(peer, bed, start, friction=False)
    for name, sums in found.items():
        if (sums.differs_from(ours) > TOLERANCE) != (name == CONTROL):
            raise BenchmarkError(f"{name}: {sums}, Talcum: {ours}; allowed is a difference of {TOLERANCE}")
    rows = [
        [name, *(f"{value:.6g}" for value in vars(sums).values()), f"{100.0 * sums.differs_from(ours):.3f} %"]
        for name, sums in found.items()
    ]
    return table(["program", "kinetic energy", "of spin", "centre's height", "highest centre", "difference"], rows)
