"""Inertia invariants of the modes, and their geometric stiffness due to prestress."""
