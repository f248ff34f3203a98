"""A run as files and datasets, by one table of names, units and frames."""
