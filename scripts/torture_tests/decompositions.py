"""Random cuts, ranks, skins, balancing and restarts: one digest a case."""

from __future__ import annotations

import shutil

from .program import SMOKE, Broken, Context, reference, run

CASES = {"walls": 0.1, "rank-equality": 0.1, "polydisperse": 0.05, "fluidised": 2.0e-4, "open-top": 0.05, "si": 2.0e-5,
         "staged": 0.05, "periodic-weight": 0.05}  # fmt: skip


def layout(context: Context) -> tuple[int, list[str]]:
    """Ranks, and options that say how they divide the box."""
    random = context.random
    ranks = random.choice([0, 2, 2, 3, 3, 4])
    options = ["--set", f"parallel.skin={random.choice(['0.03', '0.08', '0.2', '0.31'])}"]
    if ranks > 1:
        options += ["--set", f"parallel.axis={random.choice('xyz')}"]
    if random.random() < 0.5:
        options += ["--set", random.choice(['parallel.balance="off"', "parallel.balance={every=5, threshold=1.01}"])]
    return ranks, options


def decompositions(context: Context) -> dict[str, int]:
    """A run in a random decomposition, stopped and restarted in another."""
    random = context.random
    case = random.choice(sorted(CASES))
    until = CASES[case]
    expected = reference(context, case, until).digest
    folder = context.new_folder()
    arguments = ["run", str(SMOKE / f"{case}.toml"), "--output", str(folder)]
    counts: dict[str, int] = {}
    for end, how in ((until * random.uniform(0.2, 0.8), []), (until, ["--resume"])):
        ranks, options = layout(context)
        ended = run(context, ranks, [*arguments, "--until", repr(end), *options, *how])
        name = "decompositions, each with a restart in another" if how else "decompositions"
        if ended.code == 1 and ("the rank grid" in ended.errors or "cut the box" in ended.errors):
            name = "cuts refused with a message"
            ended = run(context, 0, [*arguments, "--until", repr(end), *how])
        if ended.code != 0:
            raise Broken(f"{case} on {ranks} ranks, {options}: {ended.errors}")
        counts[name] = counts.get(name, 0) + 1
    if ended.digest != expected:
        raise Broken(f"{folder}: {case}: digest {ended.digest} instead of {expected}; {options} on {ranks} ranks")
    shutil.rmtree(folder)
    return counts
