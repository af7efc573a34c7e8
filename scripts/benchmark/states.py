"""The states that all programs begin from: settled once by Talcum, kept, and converted for the peers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import h5py
import numpy as np

from .beds import RESULTS, ROOT, TIME_STEP
from .runs import BenchmarkError

Array = np.ndarray
Run = Callable[[list[str]], object]
CASES = ROOT / "cases" / "benchmark"
STATES = RESULTS / "states"
STRETCH = 1.10
GRANULAR_TEMPERATURE = 0.1
# Settled beds made of that of 24,000: how often it is repeated along x and y.
TILES = {"settled-48000": (2, 1), "settled-216000": (3, 3), "settled-1944000": (9, 9)}
# The adhesive elastic-plastic law, as stiff as the linear one.
ADHESIVE = """[contact]
law = "adhesive_elastic_plastic"
unloading_stiffness = 2.0e5
plasticity_index = 0.2
restitution = 0.9
friction = 0.1
adhesion_over_weight = 20
primary_diameter = 5.0e-4
[contact.wall]
adhesion_over_weight = 0
"""


@dataclass
class Particles:
    """The data taken from a checkpoint, in the order of ids, and the box."""

    box: Array
    position: Array
    velocity: Array
    spin: Array
    diameter: Array

    @property
    def count(self) -> int:
        """How many."""
        return len(self.diameter)

    @property
    def top(self) -> float:
        """Height of the highest surface."""
        return float((self.position[:, 2] + 0.5 * self.diameter).max())


def read_particles(checkpoint: Path) -> Particles:
    """The particles of a checkpoint of Talcum."""
    with h5py.File(checkpoint, "r", locking=False) as file:
        rows = file["particles"]
        box = box_lengths(str(file.attrs["case"]))
        names = ("position", "velocity", "angular_velocity")
        return Particles(box, *(rows[name][:] for name in names), 2.0 * rows["radius"][:])


def box_lengths(case: str) -> Array:
    """The edge lengths of the box in the text of a case."""
    found = re.search(r"^\s*lengths\s*=\s*\[([^]]*)\]", case, re.MULTILINE)
    if not found:
        raise ValueError("the case has no box.lengths")
    return np.array([float(number) for number in found[1].split(",")])


def tiled(bed: Particles, tiles: tuple[int, int]) -> Particles:
    """A periodic bed repeated along x and y."""
    shifts = [np.array([i, j, 0]) * bed.box for j in range(tiles[1]) for i in range(tiles[0])]
    repeat = lambda rows: np.concatenate([rows] * len(shifts))  # noqa: E731
    position = np.concatenate([bed.position + shift for shift in shifts])
    box = bed.box * np.array([*tiles, 1])
    return Particles(box, position, repeat(bed.velocity), repeat(bed.spin), repeat(bed.diameter))


def agitated(bed: Particles) -> Particles:
    """A bed stretched along z, with normal velocities of a granular temperature."""
    random = np.random.default_rng(1)
    velocity = random.normal(0.0, np.sqrt(GRANULAR_TEMPERATURE), bed.position.shape)
    position = bed.position * np.array([1.0, 1.0, STRETCH])
    # The lowest layer touched the plate: it keeps touching it.
    position[:, 2] += 0.5 * (1.0 - STRETCH) * bed.diameter
    return Particles(bed.box, position, velocity - velocity.mean(axis=0), 0.0 * bed.spin, bed.diameter)


def write_csv(bed: Particles, path: Path) -> None:
    """The file that a case with `start.kind = "file"` reads; numbers keep their bits."""
    columns = np.column_stack([bed.position, bed.velocity, bed.spin, bed.diameter])
    with open(path, "w", encoding="utf-8") as file:
        file.write("id,x,y,z,vx,vy,vz,wx,wy,wz,d\n")
        for number, row in enumerate(columns.tolist()):
            file.write(f"{number},{','.join(map(repr, row))}\n")


def usual_contact() -> str:
    """The section [contact] of cases/benchmark."""
    text = (CASES / "bed-24000.toml").read_text(encoding="utf-8")
    contact = re.search(r"^\[contact\].*?(?=^\[)", text, re.MULTILINE | re.DOTALL)
    if not contact:
        raise ValueError("cases/benchmark/bed-24000.toml has no [contact]")
    return contact[0]


def case_text(title: str, box: Array, start: str, end: float = 1000.0, contact: str | None = None) -> str:
    """A case of a bed in such a box, without gas and cohesion; `start` are the keys of [particles.start]."""
    return f"""title = "{title}"
units = "dimensionless"
[box]
lengths = [{", ".join(map(repr, box.tolist()))}]
x = "periodic"
y = "periodic"
z = {{ lower = "wall", upper = "wall" }}
[particles]
density = 1.0
[particles.start]
{start}
[gravity]
magnitude = 1.0
{contact or usual_contact()}[time]
step = {TIME_STEP}
end = {end}
[output]
series = 1000.0
"""


def write_case(bed: Particles, csv: Path, path: Path, contact: str | None = None) -> None:
    """A case that begins with such a file."""
    start = f'kind = "file"\nformat = "csv"\npath = "{csv.name}"'
    text = case_text(f"Benchmark: {bed.count} particles from a file", bed.box, start, contact=contact)
    path.write_text(text, encoding="utf-8")


def write_lammps_data(bed: Particles, types: int, height: float, path: Path) -> None:
    """A data file of LAMMPS and LIGGGHTS (atom style sphere): diameter, density 1, positions, velocities, spins."""
    length_x, length_y, _ = bed.box.tolist()
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"bed\n\n{bed.count} atoms\n{types} atom types\n\n")
        file.write(f"0 {length_x!r} xlo xhi\n0 {length_y!r} ylo yhi\n0 {height!r} zlo zhi\n\nAtoms\n\n")
        for number, (diameter, row) in enumerate(zip(bed.diameter.tolist(), bed.position.tolist()), 1):
            file.write(f"{number} 1 {diameter!r} 1.0 {' '.join(map(repr, row))}\n")
        file.write("\nVelocities\n\n")
        motion = np.column_stack([bed.velocity, bed.spin])
        for number, row in enumerate(motion.tolist(), 1):
            file.write(f"{number} {' '.join(map(repr, row))}\n")


def state(name: str, run: Run, talcum: Path) -> Path:
    """The checkpoint of a state, made if it is not there; `run` starts a command and waits for it.

    It is made again if this version of Talcum cannot read it.
    """
    path = STATES / f"{name}.h5"
    if is_kept(path, run, talcum):
        return path
    kind, _, count = name.partition("-")
    if kind == "settled" and name not in TILES:
        case = CASES / f"bed-{count}.toml"
        until = settled_time(case)
    else:
        bed = read_particles(state("settled-3000" if kind == "adhesive" else "settled-24000", run, talcum))
        # Springs of contacts are not in the file; they find themselves in a thousand steps, an adhesive bed in ten.
        until = {"settled": 0.25, "agitated": 0.0, "adhesive": 2.5}[kind]
        bed = agitated(bed) if kind == "agitated" else tiled(bed, TILES.get(name, (1, 1)))
        csv, case = STATES / f"{name}.csv", STATES / f"{name}.toml"
        write_csv(bed, csv)
        write_case(bed, csv, case, ADHESIVE if kind == "adhesive" else None)
    return run_to(path, case, until, run, talcum)


def is_kept(path: Path, run: Run, talcum: Path) -> bool:
    """Whether a state is there, of a version that this one can read; if not, its folder is."""
    STATES.mkdir(parents=True, exist_ok=True)
    if not path.is_file():
        return False
    try:
        run([str(talcum), "info", str(path)])
    except BenchmarkError:
        print(f"{path} is of another version and is made again", flush=True)
        return False
    return True


def run_to(path: Path, case: Path, until: float, run: Run, talcum: Path) -> Path:
    """Runs a case until a time and keeps its last checkpoint as a state."""
    output = STATES / f"making-{path.stem}"
    run([str(talcum), "run", str(case), "--force", "--output", str(output), "--until", repr(until)])
    newest = sorted(output.glob("checkpoint-*.h5"))[-1]
    newest.replace(path)
    return path


def settled_time(case: Path) -> float:
    """The end of a case's first stage, in which the bed settles."""
    found = re.search(r'^name = "settle"\s*^duration\s*=\s*(\S+)', case.read_text(encoding="utf-8"), re.MULTILINE)
    if not found:
        raise ValueError(f"{case} has no stage \"settle\"")
    return float(found[1])
