"""Talcum's results in Python: what is drawn by `python -m talcum.NAME`.

| module | what it draws |
| --- | --- |
| `talcum.series` | numbers over time |
| `talcum.spacetime` | the solids fraction over height and time, with the rays of the waves |
| `talcum.minimum_fluidisation` | the pressure drop over the gas velocity, and U_mf |
| `talcum.cycle` | a vibrated bed over a cycle of its plate |
| `talcum.fluidised_bed` | a section through particles and gas |
| `talcum.contact_loop` | what `talcum contact` prints |

`talcum.spacetime` is `scripts/spacetime.py` of the repository, and so on; `talcum_results` has what they share.
"""
