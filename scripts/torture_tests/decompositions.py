"""Random cuts, ranks, skins, balancing and restarts: one digest a case."""

from __future__ import annotations

import shutil

from .program import Broken, Context, SMOKE, reference, run

CASES = {"walls": 0.1, "rank-equality": 0.1, "polydisperse": 0.05, "fluidised": 0.002, "open-top": 0.05, "si": 2.0e-5,
         "staged": 0.05, "periodic-weight": 0.05}  # fmt: skip


def decompositions(context: Context) -> dict[str, int]:
    """A run in a random decomposition, stopped and restarted in another."""
    random = context.random
    case = random.choice(sorted(CASES))
    until = CASES[case]
    expected = reference(context, case, until).digest
    folder = context.new_folder()
    arguments = ["run", str(SMOKE / f"{case}.toml"), "--output", str(folder)]

    def layout() -> tuple[int, list[str]]:
        ranks = random.choice([0, 1, 2, 3, 4])
        options = ["--set", f"parallel.skin={random.choice(['0.03', '0.08', '0.2', '0.31'])}"]
        if ranks > 1:
            options += ["--set", f"parallel.axis={random.choice('xyz')}"]
        if random.random() < 0.5:
            options += ["--set", random.choice(['parallel.balance="off"', "parallel.balance={every=5, threshold=1.01}"])]
        return ranks, options

    restart, refused = 0, False
    for end, how in ((until * random.uniform(0.2, 0.8), []), (until, ["--resume"])):
        ranks, options = layout()
        ended = run(context, ranks, [*arguments, "--until", repr(end), *options, *how])
        if ended.code == 1 and ("cut the box" in ended.errors or "use at most" in ended.errors):
            refused = True
            ended = run(context, 0, [*arguments, "--until", repr(end), *how])
        if ended.code != 0:
            raise Broken(f"{case} on {ranks} ranks, {options}: {ended.errors}")
        restart += 1
    if ended.digest != expected:
        raise Broken(f"{folder}: {case}: digest {ended.digest} instead of {expected}; {options} on {ranks} ranks")
    shutil.rmtree(folder)
    return {"decompositions refused with a message" if refused else "random decompositions and restarts": 1}
