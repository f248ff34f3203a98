r"""Local coordinates of the contact surfaces of a body: a diagonal system, and its trace on the grid nodes.

    quasi-static   D = V diag(l) V^T (nodal compliance): u = Tr xi, Tr = V |l|^1/2, kappa = sign l, no mass, so that
                   Tr kappa^-1 Tr^T = D. Directions of D without compliance (|l| below `NO_COMPLIANCE` of the largest)
                   are omitted. Negative ones exist only with slopes of normals (`warpffrf.model.reduced.local_modes`).
    hht            the M-orthonormal modes of `warpffrf.model.reduced.local_modes`: Tr = trace, mu = 1, kappa = omega^2,
                   c = 2 zeta omega, and the compliance of the truncated part as additional quasi-static coordinates.

Nodal forces f load them with Tr^T f. One coordinate per node, thousands per body: the conventional system on purpose.

With friction D is the compliance of pressures and of both tangential tractions together, [[D, D_nt], [D_nt^T, D_tt]]
(`warpffrf.model.reduced.contact_surface`), so that pressures displace the surface tangentially and tractions normally:
three coordinates per node, quasi-static, `trace` and `shear` the rows of Tr.

Several loaded surfaces of a body share quasi-static coordinates: D is then the compliance of all their functions,
[[D_11, D_12], [D_12^T, D_22]] for two (`warpffrf.model.reduced.contact_surface`), and each surface has
its rows of Tr. The coupling between the surfaces is included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from scipy.linalg import eigh

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.local_modes import dynamic_modes, leant

NO_COMPLIANCE = 1e-14  # of the largest eigenvalue of D: round-off of the decomposition
MOST_COORDINATES = 6000  # per body: the dense Jacobian of two such bodies takes more than 1 GB
TREATMENTS = ("quasi_static", "hht")
# eigenproblems of thousands, minutes long: by reduced body and its loaded surfaces
_KNOWN: WeakKeyDictionary[Any, dict[tuple[Loaded, ...], list[LocalCoordinates]]] = WeakKeyDictionary()


@dataclass(frozen=True)
class Loaded:
    """A contact surface of a reduced body as a scene loads it: its name, with friction or without, and the slope of its
    normals (`warpffrf.model.reduced.local_modes`)."""

    name: str
    friction: bool
    lean: float = 0.0


@dataclass(frozen=True, eq=False)
class LocalCoordinates:
    """trace (nodes, n): nodal coefficients of the outward normal displacement per coordinate; mass, damping, stiffness
    (n,); shear (2, nodes, n): displacements along both tangents, empty without friction."""

    trace: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    shear: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)))

    @property
    def count(self) -> int:
        """Number of coordinates."""
        return len(self.mass)


def static_coordinates(reduced: Any, loaded: Sequence[Loaded], label: str) -> list[LocalCoordinates]:
    """Quasi-static coordinates shared by the `loaded` surfaces of a body: of each its traces, with friction also those
    of its tangents. Raises `InputError` for surfaces too large to be treated in this way."""
    surfaces = [reduced.contact_surfaces[one.name] for one in loaded]
    _refuse_many(
        sum((3 if one.friction else 1) * s.local_modes for one, s in zip(loaded, surfaces, strict=True)), label
    )
    known = _KNOWN.setdefault(reduced, {})
    if (key := tuple(loaded)) not in known:
        own = [_own(leant(s, one.lean), one.friction) for one, s in zip(loaded, surfaces, strict=True)]
        trace, kappa = _root(np.block([
            [own[i] if i == j else _between(reduced, one, other) for j, other in enumerate(loaded)]
            for i, one in enumerate(loaded)
        ]))  # fmt: skip
        diagonal, found, first = (np.zeros_like(kappa), np.zeros_like(kappa), kappa), [], 0
        for one, surface, D in zip(loaded, surfaces, own, strict=True):
            rows, grid_nodes = trace[first : first + len(D)], surface.local_modes
            shear = (rows[grid_nodes:].reshape(2, grid_nodes, -1),) if one.friction else ()
            found.append(LocalCoordinates(rows[:grid_nodes], *diagonal, *shear))
            first += len(D)
        known[key] = found
    return known[key]


def dynamic_coordinates(surface: Any, modes: Any, zeta: float, label: str) -> LocalCoordinates:
    """Coordinates of `surface` with inertia: its dynamic `modes` (None: all), of damping ratio `zeta`.
    Raises `InputError` for surfaces too large to be treated in this way, and for a body that was reduced without the
    mass of its local modes."""
    _refuse_many(surface.local_modes, label)
    if modes is None:  # raises InputError where the body was reduced without their mass
        modes = dynamic_modes(surface)
    omega, trace = np.asarray(modes.omega), np.asarray(modes.trace)
    if trace.shape != (surface.local_modes, len(omega)):
        raise InputError(
            f"{label}: the trace of its local modes must have shape ({surface.local_modes}, {len(omega)}), "
            f"got {trace.shape}"
        )
    dynamic = LocalCoordinates(trace, np.ones(len(omega)), 2.0 * zeta * omega, omega**2)
    if getattr(modes, "residual_lags", None) is None:
        return dynamic
    rest, kappa = _root(_own(replace(surface, lags=modes.residual_lags), False))
    none = np.zeros_like(kappa)
    return LocalCoordinates(
        np.hstack([dynamic.trace, rest]),
        np.concatenate([dynamic.mass, none]),
        np.concatenate([dynamic.damping, none]),
        np.concatenate([dynamic.stiffness, kappa]),
    )


def _refuse_many(count: int, label: str) -> None:
    if count > MOST_COORDINATES:
        raise InputError(
            f"{label}: the monolithic reference would need {count} local coordinates, at most {MOST_COORDINATES} "
            "per body are possible; use warpffrf.simulate, or reduce with a coarser contact grid, ContactGrid(spacing=)"
        )


def _own(surface: Any, friction: bool) -> np.ndarray:
    """Compliance of a surface's grid nodes, with friction of pressures and tractions together."""
    columns = np.arange(surface.grid.columns)
    D = surface.compliance(columns)
    if not friction:
        return D
    coupling = surface.tangential.coupling(columns, columns)
    return np.block([[D, coupling], [coupling.T, surface.tangential.compliance(columns)]])


def _between(reduced: Any, target: Loaded, source: Loaded) -> np.ndarray:
    """The same for loads on one surface and displacements of another."""
    cross = reduced.cross_compliance(target.name, source.name)
    blocks = [["lags", "lags_nt"][: 1 + source.friction], ["lags_tn", "lags_tt"][: 1 + source.friction]]
    return np.block([[cross.whole(key) for key in row] for row in blocks[: 1 + target.friction]])


def _root(D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """V |l|^1/2 and the signs of l of D = V diag(l) V^T, without directions of zero compliance."""
    eigenvalues, V = eigh(0.5 * (D + D.T))
    keep = np.abs(eigenvalues) > NO_COMPLIANCE * max(float(eigenvalues[-1]), 0.0)
    return V[:, keep] * np.sqrt(np.abs(eigenvalues[keep])), np.sign(eigenvalues[keep])
