"""Talcum's speed on known beds, beside that of LIGGGHTS and LAMMPS: what scripts/bench calls."""
