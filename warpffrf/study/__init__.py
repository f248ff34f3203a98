"""Speed against error: refinement, contact grids, bases, inertia levels, evaluations, step times, another program."""
