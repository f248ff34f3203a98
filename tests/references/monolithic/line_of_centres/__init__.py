"""Contact with parallel-axes kinematics: gaps and forces of tests, by grid nodes or FE nodes of the first surface."""
