"""The readable report of a run."""
