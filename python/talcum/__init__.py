"""Talcum from Python: check and run cases, and read and draw their results.

    import talcum

    bed = talcum.run("case.toml", threads=4, set={"gas.superficial_velocity": 0.12})
    bed = talcum.open("results/case")
    bed.series["bed_top"], bed.profiles.solids_fraction, bed.particles(20.0).position

docs/python.md of the repository describes it. The modules that draw are also programs, `python -m talcum.NAME`:

| module | what it draws |
| --- | --- |
| `talcum.series` | numbers over time |
| `talcum.spacetime` | the solids fraction over height and time, with the rays of the waves |
| `talcum.minimum_fluidisation` | the pressure drop over the gas velocity, and U_mf |
| `talcum.cycle` | a vibrated bed over a cycle of its plate |
| `talcum.particles` | the bed from the side: particles coloured by speed, size or agglomerate; an animation on request |
| `talcum.fluidised_bed` | a section through particles and gas |
| `talcum.contact_loop` | what `talcum contact` prints |

`talcum.spacetime` is `scripts/spacetime.py` of the repository, and so on; they share the module `talcum_results`.
"""

from __future__ import annotations

from .bed import Bed
from .bed import open_bed as open
from .checkpoint import Checkpoint, read_checkpoint
from .fields import Fields
from .instrument import Instrument
from .program import TalcumError, check, restart, run
from .snapshots import Contacts, Particles
from .studies import Study, read_study, run_study
from .tables import Analysis, Profiles, ResultsError, Table

__all__ = [
    "Analysis",
    "Bed",
    "Checkpoint",
    "Contacts",
    "Fields",
    "Instrument",
    "Particles",
    "Profiles",
    "ResultsError",
    "Study",
    "Table",
    "TalcumError",
    "check",
    "open",
    "read_checkpoint",
    "read_study",
    "restart",
    "run",
    "run_study",
]
