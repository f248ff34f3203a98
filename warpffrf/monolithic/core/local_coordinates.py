r"""Local coordinates of a contact surface: a diagonal system, and its trace on the hats.

    quasi-static   D = V diag(l) V^T (hat compliance): u = Tr xi, Tr = V l^1/2, kappa = 1, no mass, so that
                   Tr kappa^-1 Tr^T = D. Directions of D without compliance (l below `NO_COMPLIANCE` of the largest)
                   are left out.
    hht            the M-orthonormal modes of `warpffrf.model.local_modes`: Tr = trace, mu = 1, kappa = omega^2,
                   c = 2 zeta omega, and the compliance of what was cut as quasi-static coordinates beside them.

Hat forces f load them with Tr^T f. One coordinate a hat, thousands a body: this is the conventional system on purpose.

With friction D is the compliance of hats and of both tangential tractions together, [[D, D_nt], [D_nt^T, D_tt]]
(`warpffrf.model.tangential`), so that pressures move the surface sideways and tractions lift it: three coordinates a
hat, quasi-static, `trace` and `shear` the rows of Tr.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from scipy.linalg import eigh

from warpffrf.model.errors import InputError
from warpffrf.model.local_modes import dynamic_modes

NO_COMPLIANCE = 1e-14  # of the largest eigenvalue of D: round-off of the decomposition
MOST_COORDINATES = 6000  # a surface: the dense Jacobian of two such bodies takes more than 1 GB
TREATMENTS = ("quasi_static", "hht")
# an eigenproblem of thousands, minutes long: by surface, without and with its tangential compliance
_KNOWN: WeakKeyDictionary[Any, dict[bool, LocalCoordinates]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class LocalCoordinates:
    """trace (hats, n): hat coefficients of the outward normal displacement per coordinate; mass, damping, stiffness
    (n,); shear (2, hats, n): displacements along both tangents, empty without friction."""

    trace: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    shear: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)))

    @property
    def count(self) -> int:
        """Number of coordinates."""
        return len(self.mass)


def local_coordinates(
    surface: Any, treatment: str, modes: Any, zeta: float, label: str, *, friction: bool = False
) -> LocalCoordinates:
    """Coordinates of `surface` for a treatment (one of `TREATMENTS`), those of its tangents too with `friction`;
    `modes` are its dynamic modes (None: all that there are), `zeta` their damping ratio. Raises `InputError` for
    surfaces too large to be treated in this way, for dynamics of a body that was reduced without the mass of its local
    modes, and for dynamics with friction.
    """
    count = (3 if friction else 1) * surface.local_modes
    if count > MOST_COORDINATES:
        raise InputError(
            f"surface {label}: method 'monolithic' would need {count} local coordinates, at most "
            f"{MOST_COORDINATES} a surface are possible; use method 'separated', or reduce with a coarser "
            "traction_spacing"
        )
    if treatment == "quasi_static":
        known = _KNOWN.setdefault(surface, {})
        if friction not in known:
            known[friction] = _sheared(surface) if friction else _static(surface, surface.lags)
        return known[friction]
    if friction:
        raise InputError(
            f"surface {label}: friction is there for quasi-static local modes only; use local='quasi_static', or "
            "friction=0.0"
        )
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
    trace = _root(replace(surface, lags=lags).compliance(np.arange(surface.grid.columns)))
    n = trace.shape[1]
    return LocalCoordinates(trace, np.zeros(n), np.zeros(n), np.ones(n))


def _sheared(surface: Any) -> LocalCoordinates:
    """Coordinates of pressures and tractions together."""
    columns, hats = np.arange(surface.grid.columns), surface.local_modes
    coupling = surface.tangential.coupling(columns, columns)
    trace = _root(np.block([
        [surface.compliance(columns), coupling], [coupling.T, surface.tangential.compliance(columns)]
    ]))  # fmt: skip
    n = trace.shape[1]
    shear = trace[hats:].reshape(2, hats, n)
    return LocalCoordinates(trace[:hats], np.zeros(n), np.zeros(n), np.ones(n), shear)


def _root(D: np.ndarray) -> np.ndarray:
    """V l^1/2 of D = V diag(l) V^T, without directions that have no compliance."""
    eigenvalues, V = eigh(0.5 * (D + D.T))
    keep = eigenvalues > NO_COMPLIANCE * max(float(eigenvalues[-1]), 0.0)
    return V[:, keep] * np.sqrt(eigenvalues[keep])
