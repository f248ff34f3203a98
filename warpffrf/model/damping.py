r"""Damping ratios of the global modes, from a number, a list, a function of the frequencies, or one of these rules.

A global mode of unit mass obeys `qddot + 2 zeta omega qdot + omega^2 q = f`; the damping of a body is defined by its
ratios zeta. Since the modes are M- and K-orthogonal, C = alpha M + beta K (Rayleigh) is diagonal in them too, `2 zeta
omega = alpha + beta omega^2`. A rule is a function of the frequencies [Hz] that returns ratios; scene files support
those of DAMPINGS.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError, require_array, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = ["DAMPINGS", "NAMED", "DampingBands", "Rayleigh", "default_damping"]


def __dir__() -> list[str]:
    return __all__


# ratio on the highest modes: they oscillate against the massless contact compliance after a load step
CHATTER_DAMPING = 0.10
CHATTER_FRACTION = 0.5  # of the highest retained frequency, above which the default damping acts


@named_arguments
@dataclass(frozen=True)
class DampingBands:
    """Ratios by frequency band: `bands` are pairs (upper limit [Hz], ratio) in order of increasing limits, the last
    limit infinite.

    A mode has the ratio of the first band whose limit is above its frequency. Raises InputError for limits that do not
    rise, a last one that is finite, or a negative ratio.
    """

    bands: Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        try:
            table: Any = np.array(self.bands, dtype=np.float64)
        except (TypeError, ValueError):
            table = np.zeros(0)
        if table.ndim != 2 or table.shape[1] != 2 or not len(table):
            raise InputError(
                "DampingBands: pairs (upper limit in Hz, ratio) are needed, [(100, 0.01), (inf, 0.1)], got "
                f"{self.bands!r}"
            )
        limits, ratios = table[:, 0], table[:, 1]
        if not np.all(np.diff(limits, prepend=0.0) > 0.0):  # also catches NaN
            raise InputError(f"DampingBands: the limits must rise from above 0 Hz, got {limits.tolist()}")
        if limits[-1] != np.inf:
            raise InputError(
                f"DampingBands: the last limit must be inf, got {limits[-1]:g} Hz: modes above have no ratio"
            )
        require_array(ratios, "DampingBands: ratios", (len(ratios),))
        if np.any(ratios < 0.0):
            raise InputError(f"DampingBands: ratios must not be negative, the smallest is {ratios.min():g}")

    def __call__(self, frequencies: Any) -> np.ndarray:
        """Ratios (m,) of modes with `frequencies` (m,) [Hz]."""
        table = np.array(self.bands, dtype=np.float64)
        limits, ratios = table[:, 0], table[:, 1]
        return ratios[np.searchsorted(limits, np.asarray(frequencies, float), side="right").clip(max=len(ratios) - 1)]


@named_arguments
@dataclass(frozen=True)
class Rayleigh:
    """Damping matrix alpha M + beta K (Lord Rayleigh, The Theory of Sound, 1877): zeta = alpha/(2 omega) + beta
    omega/2.

    alpha [1/s] damps motions relative to the body's rigid motion, mainly low frequencies; beta [s] mainly high ones.
    Neither may be negative (InputError).
    """

    alpha: float = 0.0
    beta: float = 0.0

    def __post_init__(self) -> None:
        for name in ("alpha", "beta"):
            object.__setattr__(self, name, require_number(getattr(self, name), f"Rayleigh: {name}", non_negative=True))

    def __call__(self, frequencies: Any) -> np.ndarray:
        """Ratios (m,) of modes with `frequencies` (m,) [Hz]."""
        omega = 2.0 * np.pi * np.asarray(frequencies, float)
        return self.alpha / (2.0 * omega) + 0.5 * self.beta * omega


# common assumption of vehicle and engine dynamics for assembled steel structures without measurements
ONE_TEN_HUNDRED = DampingBands(((100.0, 0.01), (1000.0, 0.1), (np.inf, 1.0)))
NAMED: dict[str, Callable[[np.ndarray], np.ndarray]] = {"1/10/100": ONE_TEN_HUNDRED}
DAMPINGS: dict[str, type] = {"damping_bands": DampingBands, "rayleigh": Rayleigh}


def default_damping(frequencies: np.ndarray) -> np.ndarray:
    """Damping ratios (m,) [-] of modes of these frequencies (m,) [Hz]: 10 % above half the highest retained frequency,
    none below.

    The highest retained modes oscillate against the massless contact compliance after a step load; the lower ones
    represent the motion of interest and remain undamped.
    """
    frequencies = np.asarray(frequencies, float)
    if not len(frequencies):
        return np.zeros(0)
    return np.where(frequencies > CHATTER_FRACTION * frequencies.max(), CHATTER_DAMPING, 0.0)


Damping: TypeAlias = Callable[[np.ndarray], np.ndarray] | str | float | Vector | None  # of the modes of a body


def damping_ratios(damping: Any, frequencies: np.ndarray, name: str) -> np.ndarray:
    """Ratios (m,) of body `name` from None (default), a number, an array (m,), a function of the frequencies [Hz], or a
    name of NAMED. Raises InputError for an unknown name, a wrong length, or a negative ratio."""
    if damping is None:
        return default_damping(frequencies)
    if isinstance(damping, str):
        if damping not in NAMED:
            raise unknown_name(f"body {name!r}: damping", damping, NAMED)
        damping = NAMED[damping]
    values: Any = damping(np.asarray(frequencies, float)) if callable(damping) else damping
    if np.ndim(values) == 0:
        values = np.full(len(frequencies), require_number(values, f"body {name!r}: damping"))
    ratios = require_array(values, f"body {name!r}: damping", (len(frequencies),))
    if np.any(ratios < 0.0):
        raise InputError(f"body {name!r}: damping ratios must not be negative, the smallest is {ratios.min():g}")
    return ratios
