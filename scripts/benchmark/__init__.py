"""Measures Talcum's speed on known beds, and that of LIGGGHTS and LAMMPS; called by scripts/bench."""
