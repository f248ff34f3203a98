"""The error budget of a run: what each source of error does to its results, found without a run to compare with."""
