"""Contact laws of a user's program that return odd numbers: an error on all ranks, or the same digest on any number of them."""

from __future__ import annotations

from .case_reader import CaseReader
from .program import Broken, Context

RESULTS = ["normal", "tangential", "friction", "spring", "largest overlap", "touches", "range", "stiffness", "duration", "energy",
           "work", "largest force", "panic"]  # fmt: skip
NUMBERS = ["NaN", "inf", "-inf", "0.0", "-0.0", "-1.0", "1e-300", "1e300", "-1e300", "1e9", "5e-324", "0.5", "3.0"]


def laws(context: Context) -> dict[str, int]:
    """One law, on one rank and on others."""
    random = context.random
    request = {"law": random.choice(RESULTS), "number": random.choice(NUMBERS), "ledger": random.random() < 0.3,
               "beyond": random.choice(["-1e9", "0.0", "1e-4", "1e9"])}  # fmt: skip
    answers = []
    for ranks in (1, random.choice([2, 3])):
        asked = {**request, "ranks": ranks}
        try:
            answers.append(CaseReader.of(context).ask(asked))
        except Broken:
            # A law that panics ends all ranks, which is its own error.
            if request["law"] != "panic":
                raise
            answers.append(("panic", ""))
    outcomes = {outcome for outcome, _ in answers}
    if len(outcomes) > 1 or ("taken" in outcomes and len({digest for _, digest in answers}) > 1):
        raise Broken(f"another answer on {ranks} ranks: {request}: {answers}")
    return {f"laws with an odd {request['law']}, {answers[0][0]}": 1}
