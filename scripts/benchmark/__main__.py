"""Measures Talcum, and if asked its peers, on the benchmark beds; called by scripts/bench."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from statistics import median
from typing import Any, Callable

from . import agreement, coupled, floor, gas, instructions, instruments, kernels, peers, processor, ranks, scaling, tables
from .beds import RESULTS, Bed, beds_named
from .runs import BenchmarkError, execute, on_cores
from .states import state
from .tables import LARGE, TALCUM, Runs
from .talcum import PROGRAM, run_talcum

LATEST = RESULTS / "latest.json"


def measure(beds: list[Bed], wanted: argparse.Namespace) -> dict[str, Runs]:
    """All runs, interleaved: in each round one of each program on each bed."""
    others = peers.peers_here() if wanted.peers else []
    prepare = lambda command: execute(on_cores(command, 1, wanted.first))  # noqa: E731
    states = {bed: state(bed.state, prepare, PROGRAM) for bed in beds}
    skins = {
        (peer, bed): peers.best_skin(peer, bed, states[bed], wanted.first)
        for bed in beds if bed.with_peers for peer in others
    }  # fmt: skip
    results: dict[str, Runs] = {bed.name: {} for bed in beds}
    for number in range(wanted.rounds):
        for bed in beds:
            runs = results[bed.name]
            runs.setdefault(TALCUM, []).append(run_talcum(bed, states[bed], wanted.first).as_dict())
            for peer in others if bed.with_peers else []:
                run = peers.run_peer(peer, bed, states[bed], skins[peer, bed], wanted.first)
                runs.setdefault(peer.name, []).append(run.as_dict())
            said = ", ".join(f"{name} {found[-1]['rate']:.2f}" for name, found in runs.items())
            print(f"round {number + 1}, {bed.name}: {said}", flush=True)
    return results


def check_one_answer(beds: list[Bed], results: dict[str, Runs]) -> None:
    """Runs of the same steps from the same state must end with the same digest, on one rank or two."""
    digests: dict[tuple[object, ...], set[str]] = {}
    for bed in beds:
        same = digests.setdefault((bed.state, bed.steps, bed.vibration, bed.settings), set())
        same |= {run["digest"] for run in results[bed.name][TALCUM]}
    if any(len(same) != 1 for same in digests.values()):
        raise BenchmarkError(f"runs that must agree have different digests: {digests}")


def measure_beds(wanted: argparse.Namespace) -> str:
    """Measures the beds and keeps the runs; all tables, with the machine above them."""
    beds = beds_named(wanted.beds)
    results = measure(beds, wanted)
    LATEST.write_text(json.dumps({"machine": tables.machine(), "beds": results}, indent=1), encoding="utf-8")
    check_one_answer(beds, results)
    here = tables.machine()
    least = min(run["share_of_cores"] for runs in results.values() for found in runs.values() for run in found)
    head = (
        f"Million particle-steps per second; medians of {wanted.rounds} interleaved runs on "
        f"{here['cores']} cores of {here['processor']} ({here['vectors']}), {here['rust']}, commit {here['commit']}. "
        f"Runs had at least {100 * least:.0f} % of their cores; a rate on one rank is per second of the core's time."
    )
    parts = [head, tables.rate_table(beds, results), "How Talcum's step divides, in per cent:",
             tables.stage_table(beds, results)]  # fmt: skip
    memory = tables.memory_table(results)
    if memory:
        parts += ["Memory, from 24,000 to 216,000 particles:", memory]
    return "\n\n".join(parts)


def latest_rate(name: str) -> float:
    """Talcum's rate per rank on a bed, as last measured."""
    if not LATEST.is_file():
        raise BenchmarkError(f"measure the bed \"{name}\" first: scripts/bench \"{name}\"")
    found: dict[str, Any] = json.loads(LATEST.read_text(encoding="utf-8"))["beds"]
    if name not in found:
        raise BenchmarkError(f"the last call did not measure the bed \"{name}\": scripts/bench \"{name}\"")
    return median(tables.rates(found[name], TALCUM))


def model() -> str:
    """The scaling model, with the rate of a rank while both cores are busy."""
    rate = 0.5 * latest_rate("24,000 settled, 2 ranks") * 1.0e6
    load = scaling.Load(particles=1.0, particle_step=1.0 / rate)
    tall = scaling.model_table(load)
    cubes = scaling.model_table(scaling.replace(load, columns=False, gas_nodes=75))
    words = f"Each rank computes {rate * 1e-6:.1f} million particle-steps per second."
    return f"{words} Columns of a bed 52 d high:\n\n{tall}\n\nCubes of a bed with a column gas:\n\n{cubes}"


# What can be measured, by the name of its place in docs/performance-tables.md.
PARTS: dict[str, Callable[[argparse.Namespace], str]] = {
    "beds": measure_beds,
    "agreement": lambda _: agreement.agreement(),
    "instructions": lambda wanted: instructions.instructions(beds_named(wanted.beds)),
    "floor": lambda _: floor.floor(latest_rate(LARGE)),
    "kernels": lambda _: kernels.kernels(),
    "messages": lambda _: kernels.messages(),
    "machines": lambda _: kernels.machines(),
    "coupled": lambda wanted: coupled.coupled(wanted.rounds, wanted.first),
    "gas": lambda wanted: gas.gas(wanted.rounds, wanted.first),
    "scaling": lambda wanted: ranks.scaling(wanted.rounds, wanted.first, wanted.peers),
    "processor": lambda wanted: processor.processor(wanted.rounds, wanted.first),
    "model": lambda _: model(),
    "instruments": lambda wanted: instruments.instruments(wanted.rounds, wanted.first),
}


def options() -> argparse.Namespace:
    """The command-line arguments."""
    parser = argparse.ArgumentParser(prog="scripts/bench", description=__doc__)
    parser.add_argument("beds", nargs="*", help='words of names of beds, such as "24000 settled"; all without')
    parser.add_argument("--peers", action="store_true", help="LIGGGHTS and LAMMPS too, installed if missing")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each program on each bed (5)")
    parser.add_argument("--first", action="store_true", help="before others on a shared machine, where permitted")
    words = f"what is measured: all, or some of {', '.join(PARTS)} (beds)"
    parser.add_argument("--parts", default="beds", metavar="PART,...", help=words)
    parser.add_argument("--write", type=Path, metavar="FILE", help="put the tables between the markers of this file")
    return parser.parse_args()


def main() -> None:
    """Runs the parts named on the command line."""
    wanted = options()
    RESULTS.mkdir(parents=True, exist_ok=True)
    try:
        names = list(PARTS) if wanted.parts == "all" else wanted.parts.split(",")
        unknown = [name for name in names if name not in PARTS]
        if unknown:
            raise BenchmarkError(f"there is no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
        for name in names:
            words = PARTS[name](wanted)
            print(f"{words}\n", flush=True)
            if wanted.write:
                tables.write_between_markers(wanted.write, name, words)
    except (BenchmarkError, ValueError) as error:
        sys.exit(f"error: {error}")


main()
