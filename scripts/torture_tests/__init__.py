"""Hostile tests of Talcum; called by scripts/torture."""
