"""LIGGGHTS and LAMMPS on the same beds: decks, skins, runs."""

from __future__ import annotations

import json
import math
import shutil
from dataclasses import dataclass
from pathlib import Path

from .beds import RESULTS, ROOT, TIME_STEP, Bed, ContactLaw
from .runs import Measured, measured, on_cores, read_peer
from .states import Particles, read_particles, write_lammps_data

TEMPLATES = ROOT / "scripts" / "peers"
NATIVE = RESULTS / "lammps-native" / "build" / "lmp"
SKINS = RESULTS / "skins.json"
# Room above the bed, in diameters: little for a bed at rest, so that slabs share it evenly between ranks.
ROOM_AT_REST, ROOM_IN_MOTION = 1.0, 40.0


@dataclass(frozen=True)
class Peer:
    """A program that runs the same bed."""

    name: str
    program: str
    template: str
    types: int


PEERS = (
    Peer("LIGGGHTS", "liggghts", "liggghts.in", 2),
    Peer("LAMMPS", "lmp", "lammps.in", 1),
    # Debian's source, compiled for this processor.
    Peer("LAMMPS native", str(NATIVE), "lammps.in", 1),
)


def peers_here() -> list[Peer]:
    """The peers that are installed."""
    return [peer for peer in PEERS if shutil.which(peer.program)]


def fill(template: str, values: dict[str, object]) -> str:
    """Puts values into a deck; every @name@ must have one."""
    for name, value in values.items():
        template = template.replace(f"@{name}@", str(value))
    left = template.find("@")
    if left >= 0:
        raise ValueError(f"the deck has no value for {template[left:].split()[0]}")
    return template


def deck(peer: Peer, bed: Bed, data: Path, skin: float, law: ContactLaw = ContactLaw()) -> str:
    """The input of a peer for a bed."""
    vibration = bed.vibration
    gravity, weight = "1.0", "1.0"
    if vibration:
        angular = 2.0 * math.pi * vibration.frequency * TIME_STEP
        gravity, weight = f"1.0+{vibration.gamma}*sin({angular!r}*step)", "v_weight"
    values = {
        "data": data, "skin": skin, "kn": law.normal_stiffness, "kt": law.tangential_stiffness,
        "pair_damping": law.pair_damping, "wall_damping": law.wall_damping, "friction": law.friction,
        "time_step": TIME_STEP, "gravity": gravity, "weight": weight, "warm_up": bed.warm_up,
        "steps": bed.steps,
    }  # fmt: skip
    return fill((TEMPLATES / peer.template).read_text(encoding="utf-8"), values)


def data_file(peer: Peer, bed: Bed, state: Path) -> Path:
    """The bed as the peer reads it."""
    at_rest = bed.vibration is None and bed.state.startswith("settled")
    path = state.with_name(f"{state.stem}-{peer.types}-types-{'at-rest' if at_rest else 'in-motion'}.data")
    if not path.is_file() or path.stat().st_mtime < state.stat().st_mtime:
        particles: Particles = read_particles(state)
        room = ROOM_AT_REST if at_rest else ROOM_IN_MOTION
        write_lammps_data(particles, peer.types, math.ceil(particles.top + room), path)
    return path


def run_peer(peer: Peer, bed: Bed, state: Path, skin: float, first: bool) -> Measured:
    """One measured run."""
    name = "".join(letter if letter.isalnum() else "-" for letter in f"{peer.name} {bed.name}")
    path = RESULTS / f"{name}.in"
    path.write_text(deck(peer, bed, data_file(peer, bed, state), skin), encoding="utf-8")
    command = [peer.program, "-in", str(path), "-log", "none"]
    return measured(read_peer, on_cores(command, bed.ranks, first), bed.ranks)


def best_skin(peer: Peer, bed: Bed, state: Path, first: bool) -> float:
    """The skin with which the peer is fastest on the bed; tried once, then remembered."""
    known = json.loads(SKINS.read_text(encoding="utf-8")) if SKINS.is_file() else {}
    # The 2-rank bed and the largest are as the settled bed on one rank.
    key = f"{peer.name}: {bed.state.replace('216000', '24000')}{' shaken' if bed.vibration else ''}"
    if key not in known:
        rates = {skin: run_peer(peer, bed, state, skin, first).rate for skin in bed.skins}
        print(f"  {peer.name}, {bed.name}: " + ", ".join(f"skin {s}: {r:.2f}" for s, r in rates.items()), flush=True)
        known[key] = max(rates, key=lambda skin: rates[skin])
        SKINS.write_text(json.dumps(known, indent=1), encoding="utf-8")
    return float(known[key])
