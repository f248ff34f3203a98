"""Points of the unit cube that a sample of a sweep is made of; a new kind is a function here and a line in `SAMPLES`.

latin      Latin hypercube: each parameter is spread evenly by itself (McKay, Beckman and Conover, 1979)
sobol      Sobol's sequence, scrambled: all parameters together are spread evenly; best for powers of two
random     independent points, for tolerances
saltelli   for Sobol indices: N points A, N points B, and for each parameter A with its column from B (Saltelli and
           others, 2010), N (d + 2) rows in this order
"""

from __future__ import annotations

import inspect
import logging
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name

MOST_ROWS = 1_000_000  # of a sweep: its table is made in memory

log = logging.getLogger("warpffrf")


def latin(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    from scipy.stats import qmc

    return qmc.LatinHypercube(dimensions, **_drawn_with(qmc.LatinHypercube, seed)).random(count)


def sobol(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    from scipy.stats import qmc

    if count & (count - 1):
        log.warning("sweep: a Sobol sample of %d points is less even than one of a power of two", count)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties")  # said above
        return qmc.Sobol(dimensions, **_drawn_with(qmc.Sobol, seed)).random(count)


def random(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    return np.random.default_rng(seed).random((count, dimensions))


def saltelli(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count (dimensions + 2), dimensions)."""
    both = sobol(count, 2 * dimensions, seed)
    A, B = both[:, :dimensions], both[:, dimensions:]
    mixed = []
    for column in range(dimensions):
        AB = A.copy()
        AB[:, column] = B[:, column]
        mixed.append(AB)
    return np.concatenate([A, B, *mixed])


def _drawn_with(kind: Any, seed: int) -> dict[str, Any]:
    """The seed, by the name that this version of SciPy has for it."""
    name = "rng" if "rng" in inspect.signature(kind).parameters else "seed"
    return {name: np.random.default_rng(seed)}


SAMPLES: dict[str, Callable[[int, int, int], np.ndarray]] = {
    made.__name__: made for made in (latin, sobol, random, saltelli)
}


def sampled(sample: str, dimensions: int, seed: int) -> np.ndarray:
    """The points (n, dimensions) in (0, 1) of a sample as "latin:64". Raises `InputError` for another text."""
    kind, colon, number = str(sample).partition(":")
    if kind not in SAMPLES:
        raise unknown_name("sweep: sample", kind, SAMPLES)
    if not colon or not number.isdecimal() or int(number) < 1:
        raise InputError(f"sweep: sample {sample!r} says no number of points; write {kind}:64")
    count, rows = int(number), int(number)
    if kind == saltelli.__name__:
        rows = count * (dimensions + 2)
        if count & (count - 1):
            power = 1 << (count - 1).bit_length()
            raise InputError(f"sweep: sample {sample!r}: Sobol indices need a power of two; write {kind}:{power}")
    if rows > MOST_ROWS:
        raise InputError(f"sweep: sample {sample!r} has {rows} rows, more than {MOST_ROWS}; make several sweeps")
    points = SAMPLES[kind](count, dimensions, seed)
    tiny = np.finfo(float).eps  # a distribution without ends has none at 0 and 1
    return np.clip(points, tiny, 1.0 - tiny)
