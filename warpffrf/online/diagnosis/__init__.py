"""Diagnosis of a run: why it failed, and how accurate its results are."""
