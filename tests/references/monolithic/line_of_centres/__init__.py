"""Contact on the line of centres: gaps and forces of tests, by hats or nodes of the first surface."""
