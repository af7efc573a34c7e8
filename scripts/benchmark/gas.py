"""A whole step of the volume-averaged gas, by the number of cells, on one rank."""

from __future__ import annotations

import re
from statistics import median

from .beds import RESULTS
from .runs import execute, on_cores
from .tables import table
from .talcum import PROGRAM

# Cells along an edge, and gas steps that are measured: those by which one run is longer than another, so that the start and the
# first touch of its memory do not count.
SIZES = {32: 200, 64: 30, 128: 6, 256: 4}
SECONDS = re.compile(r"^coarse-grain, gas\s+([\d.]+)", re.MULTILINE)
WHOLE = re.compile(r"^(\d+) steps in ", re.MULTILINE)
TIME_STEP = 1.0e-4


def case_text(edge: int, steps: int) -> str:
    """A box of edge^3 cells through which gas flows upwards for some steps, in its lowest eighth a particle in each cell."""
    width = 1.25 * edge
    return f"""title = "Benchmark: {edge}^3 cells of gas"
units = "dimensionless"
[box]
lengths = [{width}, {width}, {width}]
x = "periodic"
y = "periodic"
z = {{ lower = "wall", upper = "wall" }}
[particles]
count = {edge * edge * (edge // 8)}
diameter = 1.0
density = 1.0
seed = 1
[particles.start]
kind = "lattice"
spacing = 1.25
jitter = 0.5
[gravity]
magnitude = 1.0
[contact]
law = "linear_spring_dashpot"
normal_stiffness = 1.0e4
poisson_ratio = 0.3
restitution = 0.9
friction = 0.1
[gas]
kind = "volume_averaged"
cells = [{edge}, {edge}, {edge}]
density = 1.0e-3
viscosity = 2.0e-2
drag = "gidaspow"
drag_switch = "smooth"
substeps = 1
z = {{ lower = "inlet", upper = "outlet" }}
inlet_velocity = 0.1
[time]
step = {TIME_STEP}
end = {steps * TIME_STEP!r}
[output]
series = {steps * TIME_STEP!r}
"""


def seconds_of_gas(words: str, steps: int) -> float:
    """Time of all steps of the gas, from the output of a run."""
    seconds, done = SECONDS.search(words), WHOLE.search(words)
    if not seconds or not done or int(done[1]) != steps:
        raise ValueError(f"talcum did not print how the time of {steps} steps divides:\n{words[-2000:]}")
    return float(seconds[1])


def run(edge: int, steps: int, first: bool) -> float:
    """Seconds of a run, with coarse-graining and the drag on the particles."""
    case, output = RESULTS / f"gas-{edge}.toml", RESULTS / "gas"
    case.write_text(case_text(edge, steps), encoding="utf-8")
    command = [str(PROGRAM), "run", str(case), "--output", str(output), "--force"]
    return seconds_of_gas(execute(on_cores(command, 1, first)).words, steps)


def measure(edge: int, first: bool) -> float:
    """Seconds per cell and step."""
    steps = SIZES[edge]
    longer, shorter = (run(edge, n, first) for n in (2 * steps, steps))
    return (longer - shorter) / steps / edge**3


def gas(rounds: int, first: bool) -> str:
    """A table of microseconds per cell and step."""
    runs: dict[int, list[float]] = {}
    for _ in range(rounds):
        for edge in SIZES:
            runs.setdefault(edge, []).append(1.0e6 * measure(edge, first))
    rows = [[f"{edge}^3", f"{median(found):.3f}", f"{min(found):.3f} to {max(found):.3f}"] for edge, found in runs.items()]
    return table(["cells", "microseconds per cell and step", "lowest and highest"], rows)
