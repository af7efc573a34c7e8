"""Compares runs with the experiments that they repeat: `scripts/report van-wachem2001`, `scripts/report yue2020`."""
