"""The state that a run begins with: equilibrium, consistent velocities, accelerations."""
