"""The error budget of a run: the effect of each source of error on its results, estimated without a reference run."""
