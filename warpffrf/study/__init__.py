"""Measurements on scenes: static sweeps, Hertz, convergence, rolling ripple, impact, step times."""
