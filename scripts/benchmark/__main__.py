"""Measures Talcum, and if asked its peers, on the benchmark beds; called by scripts/bench."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from . import agreement, peers, tables
from .beds import RESULTS, Bed, beds_named
from .runs import BenchmarkError, execute
from .states import state
from .talcum import PROGRAM, run_talcum
from .tables import TALCUM, Runs

LATEST = RESULTS / "latest.json"


def options() -> argparse.Namespace:
    """What the user asked for."""
    parser = argparse.ArgumentParser(prog="scripts/bench", description=__doc__)
    parser.add_argument("beds", nargs="*", help='words of names, such as "24000 settled"; all without')
    parser.add_argument("--peers", action="store_true", help="LIGGGHTS and LAMMPS too, installed if missing")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each program on each bed (5)")
    parser.add_argument("--first", action="store_true", help="before others on a shared machine, where permitted")
    parser.add_argument("--agreement", action="store_true", help="only whether the peers compute the same bed")
    parser.add_argument("--write", type=Path, metavar="FILE", help="put the tables between the markers of this file")
    return parser.parse_args()


def measure(beds: list[Bed], wanted: argparse.Namespace) -> dict[str, Runs]:
    """All runs, interleaved: in each round one of each program on each bed."""
    others = peers.peers_here() if wanted.peers else []
    prepare = lambda command: execute(command)  # noqa: E731
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
        same = digests.setdefault((bed.state, bed.steps, bed.vibration, bed.models), set())
        same |= {run["digest"] for run in results[bed.name][TALCUM]}
    if any(len(same) != 1 for same in digests.values()):
        raise BenchmarkError(f"runs that must agree have different digests: {digests}")


def report(beds: list[Bed], results: dict[str, Runs]) -> str:
    """All tables, with the machine above them."""
    here = tables.machine()
    least = min(run["share_of_cores"] for runs in results.values() for found in runs.values() for run in found)
    head = (
        f"Million particle-steps per second; medians of {len(results[beds[0].name][TALCUM])} interleaved runs on "
        f"{here['cores']} cores of {here['processor']} ({here['vectors']}), {here['rust']}, commit {here['commit']}. "
        f"Each run had at least {100 * least:.0f} % of its cores."
    )
    parts = [head, tables.rate_table(beds, results), "How Talcum's step divides, in per cent:",
             tables.stage_table(beds, results)]  # fmt: skip
    memory = tables.memory_table(results)
    if memory:
        parts += ["Memory, from 24,000 to 216,000 particles:", memory]
    return "\n\n".join(parts)


def main() -> None:
    """From the command line."""
    wanted = options()
    RESULTS.mkdir(parents=True, exist_ok=True)
    try:
        if wanted.agreement:
            words = agreement.agreement()
            print(words)
            if wanted.write:
                tables.write_between_markers(wanted.write, "agreement", words)
            return
        beds = beds_named(wanted.beds)
        results = measure(beds, wanted)
        LATEST.write_text(json.dumps({"machine": tables.machine(), "beds": results}, indent=1), encoding="utf-8")
        check_one_answer(beds, results)
        words = report(beds, results)
        print(words)
        if wanted.write:
            tables.write_between_markers(wanted.write, "beds", words)
    except (BenchmarkError, ValueError) as error:
        sys.exit(f"error: {error}")


main()
