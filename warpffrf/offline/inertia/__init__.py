"""Inertia invariants of the modes, and the stiffness that prestress gives them."""
