"""Figures of a report without what rounding leaves: nothing that is 1e-16 m deserves five digits."""

from __future__ import annotations

from typing import Any

import numpy as np

LENGTH = 1e-14  # m: far below an atom; round-off of lengths of 0.1 m is some 1e-17
FORCE = 1e-15  # N or N m: no machine has less, sums of zeros have
SHARE = 1e-12  # of what a figure is a part of, a torque of force times 1 m: round-off of sums
AT_REST = 1e-9  # of force times length: energies up to there are what the iteration leaves of the balance


def without_round_off(value: Any, least: float) -> Any:
    """`value`, numbers of any shape, with those below `least` as zero."""
    return np.where(np.abs(value) < least, 0.0, value)[()]


def idle_energy(result: Any) -> float:
    """What energies [J] are no more than round-off below: the largest force of the run times the farthest place of a
    body, times `AT_REST`."""
    history = result.history
    forces = [one.force for kind in _KINDS for one in getattr(history, kind).values()]
    places = [body.position for body in history.bodies.values()]
    force, place = (max((float(np.nanmax(np.abs(v), initial=0.0)) for v in of), default=0.0) for of in (forces, places))
    return AT_REST * force * place


_KINDS = ("contacts", "lumped_contacts", "films", "joints", "forces")
