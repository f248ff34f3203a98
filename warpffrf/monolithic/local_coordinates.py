r"""Local coordinates of a contact surface: a diagonal system, and its trace on the hats.

    quasi-static   D = V diag(l) V^T (hat compliance): u = Tr xi, Tr = V l^1/2, kappa = 1, no mass, so that
                   Tr kappa^-1 Tr^T = D. Directions of D without compliance (l below `NO_COMPLIANCE` of the largest)
                   are left out.
    hht            the M-orthonormal modes of `warpffrf.model.local_modes`: Tr = trace, mu = 1, kappa = omega^2,
                   c = 2 zeta omega, and the compliance of what was cut as quasi-static coordinates beside them.

Hat forces f load them with Tr^T f. One coordinate a hat, thousands a body: this is the conventional system on purpose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from scipy.linalg import eigh

from warpffrf.model.errors import InputError
from warpffrf.model.local_modes import dynamic_modes

NO_COMPLIANCE = 1e-14  # of the largest eigenvalue of D: round-off of the decomposition
MOST_COORDINATES = 6000  # a surface: the dense Jacobian of two such bodies takes more than 1 GB
TREATMENTS = ("quasi_static", "hht")
_KNOWN: WeakKeyDictionary[Any, LocalCoordinates] = WeakKeyDictionary()  # an eigenproblem of thousands, minutes long


@dataclass(frozen=True, eq=False)
class LocalCoordinates:
    """trace (hats, n): hat coefficients of the outward normal displacement per coordinate; mass, damping, stiffness
    (n,)."""

    trace: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray

    @property
    def count(self) -> int:
        """Number of coordinates."""
        return len(self.mass)


def local_coordinates(surface: Any, treatment: str, modes: Any, zeta: float, label: str) -> LocalCoordinates:
    """Coordinates of `surface` for a treatment (one of `TREATMENTS`); `modes` are its dynamic modes (None: all that
    there are), `zeta` their damping ratio. Raises `InputError` for surfaces too large to be treated in this way, and
    for dynamics of a body that was reduced without the mass of its local modes.
    """
    if surface.local_modes > MOST_COORDINATES:
        raise InputError(
            f"surface {label}: method 'monolithic' would need {surface.local_modes} local coordinates, at most "
            f"{MOST_COORDINATES} a surface are possible; use method 'separated', or reduce with a coarser "
            "traction_spacing"
        )
    if treatment == "quasi_static":
        if surface not in _KNOWN:
            _KNOWN[surface] = _static(surface, surface.lags)
        return _KNOWN[surface]
    if modes is None:  # raises InputError where the body was reduced without their mass
        modes = dynamic_modes(surface)
    omega, trace = np.asarray(modes.omega), np.asarray(modes.trace)
    if trace.shape != (surface.local_modes, len(omega)):
        raise InputError(
            f"surface {label}: the trace of its local modes must have shape ({surface.local_modes}, {len(omega)}), "
            f"got {trace.shape}"
        )
    dynamic = LocalCoordinates(trace, np.ones(len(omega)), 2.0 * zeta * omega, omega**2)
    if getattr(modes, "residual_lags", None) is None:
        return dynamic
    rest = _static(surface, modes.residual_lags)
    return LocalCoordinates(
        np.hstack([dynamic.trace, rest.trace]),
        np.concatenate([dynamic.mass, rest.mass]),
        np.concatenate([dynamic.damping, rest.damping]),
        np.concatenate([dynamic.stiffness, rest.stiffness]),
    )


def _static(surface: Any, lags: np.ndarray) -> LocalCoordinates:
    D = replace(surface, lags=lags).compliance(np.arange(surface.grid.columns))
    eigenvalues, V = eigh(0.5 * (D + D.T))
    keep = eigenvalues > NO_COMPLIANCE * max(float(eigenvalues[-1]), 0.0)
    n = int(np.sum(keep))
    return LocalCoordinates(V[:, keep] * np.sqrt(eigenvalues[keep]), np.zeros(n), np.zeros(n), np.ones(n))
