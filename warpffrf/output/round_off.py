"""Sizes below which results are round-off, and no figures of a report."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

LENGTH = 1e-14  # m: far below an atom; round-off of lengths of 0.1 m is about 1e-17
FORCE = 1e-15  # N or N m: below any real load, above the round-off of sums that vanish
SHARE = 1e-12  # of the largest force of the machine, and of that force times 1 m: round-off of sums
AT_REST = 1e-9  # of force times length: smaller energies are residuals of the iteration


def without_round_off(value: Any, least: float) -> Any:
    """`value`, numbers of any shape, with those below `least` set to zero."""
    return np.where(np.abs(value) < least, 0.0, value)[()]


def idle_energy(result: Any) -> float:
    """Energy [J] below which energies are round-off: the largest force of the run times the largest distance of a body
    from the origin, times `AT_REST`."""
    return AT_REST * largest_force(result.history) * _largest(b.position for b in result.history.bodies.values())


def largest_force(history: Any) -> float:
    """The largest force component [N] of the run, over contacts, joints and force elements."""
    return _largest(one.force for kind in _KINDS for one in getattr(history, kind).values())


def _largest(arrays: Iterable[Any]) -> float:
    return max((float(np.nanmax(np.abs(array), initial=0.0)) for array in arrays), default=0.0)


_KINDS = ("contacts", "lumped_contacts", "films", "joints", "forces")
