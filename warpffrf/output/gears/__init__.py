"""Gear pairs of a run."""
