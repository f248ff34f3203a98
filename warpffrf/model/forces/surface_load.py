r"""Pressure on a contact surface of a flexible body.

The pressure `s(t) p(theta, z)`, `p = sum_i p_i psi_i` on the hats of the surface's contact grid, pushes inwards along
the undeformed normal n and turns with the body. What it does to the body is kept as constants in body axes,

    force = -int p n dA,      torque = -int p x cross n dA,      f_m = -sum_ij p_i M_ij (mode_normal)_jm,

force and torque by Gauss points in every cell of the grid, the modal forces exactly: `mode_normal` of `ContactSurface`
holds the outward normal displacement of the global modes as coefficients of the hats and M is their Gram matrix. The
body's global modes and interfaces answer as they do to the true pressure; the local dent under the pressure, which
moves no interface, is left out.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.arguments import Matrix
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import BodyLoad
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import SignalLike, as_signal

GAUSS = 4  # points a direction in a cell: hats times the normal, of which a crown's is not polynomial; 1e-12 left


@named_arguments
class SurfaceLoad(Force):
    """A pressure on a contact surface of a flexible body, in body axes.

    surface: `body['name of the surface']`. pressure: a number or signal [Pa], positive pushing inwards. distribution:
    None for the same everywhere, else what multiplies it: coefficients (columns, rows) of the hats of the surface's
    grid, or a function of points (..., 3) [m, user frame] that is taken at the grid's nodes. Raises `InputError`.
    """

    kind = "surface_load"

    def __init__(
        self,
        surface: SurfacePort,
        pressure: SignalLike,
        *,
        distribution: Callable[[np.ndarray], np.ndarray] | Matrix | None = None,
        name: str | None = None,
    ) -> None:
        label = f"surface load {name!r}" if name else "surface load"
        if not isinstance(surface, SurfacePort) or surface.rigid:
            raise InputError(
                f"{label}: a contact surface of a flexible body is needed, body['name'], got "
                f"{getattr(surface, 'label', surface)!r}; for the "
                "nodes of a free interface use NodalLoad, for a resultant at an interface PointForce and PointTorque"
            )
        self.name = name
        self.surface = surface
        self.pressure = as_signal(pressure, f"{label}: pressure")
        grid = surface.surface.grid
        if distribution is None:
            distribution = np.ones((grid.columns, grid.rows))
        elif callable(distribution):
            theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
            distribution = distribution(surface.surface.shape.point(theta, z))
        self.distribution = require_array(distribution, f"{label}: distribution", (grid.columns, grid.rows))

    @property
    def ports(self) -> tuple[SurfacePort, ...]:
        return (self.surface,)

    def load(self) -> BodyLoad:
        """Resultants and modal forces of a unit pressure, body axes, about the user origin."""
        surface, p = self.surface.surface, self.distribution
        grid = surface.grid
        force, torque = _resultant(surface, p)
        along = p @ surface.gram_z  # (columns, rows): M_z first, then M_theta
        weighted = grid.along_theta(along)
        modal = -weighted.ravel() @ np.asarray(surface.mode_normal, dtype=np.float64)
        return BodyLoad(self.surface.body, force, torque, modal, self.pressure)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {
            "kind": self.kind, "name": self.name, "body": self.surface.body.name, "surface": self.surface.name,
            "pressure": self.pressure.describe(), "distribution": self.distribution.tolist(),
        }  # fmt: skip


def _resultant(surface: Any, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """-int p n dA [m2] and -int p x cross n dA [m3] of the hat coefficients p (columns, rows)."""
    grid, shape = surface.grid, surface.shape
    padded = p if not grid.periodic else np.vstack([p, p[:1]])
    theta0 = grid.theta_start + grid.pitch * np.arange(len(padded))
    if not grid.periodic:  # the outermost hats end a pitch beyond the outermost nodes
        padded = np.vstack([0.0 * p[:1], p, 0.0 * p[:1]])
        theta0 = grid.theta_start + grid.pitch * np.arange(-1, grid.columns + 1)
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    z0, dz = grid.z[:-1], np.diff(grid.z)
    theta = theta0[:-1, None] + grid.pitch * x  # (cells, GAUSS)
    z = z0[:, None] + dz[:, None] * x
    along = np.stack([1.0 - x, x])  # (2, GAUSS)
    corner = np.stack([padded[:-1], padded[1:]])  # (2, cells, rows)
    corner = np.stack([corner[..., :-1], corner[..., 1:]])  # (2 z, 2 theta, cells, cells z)
    value = np.einsum("batc,ag,bh->tgch", corner, along, along)
    T, Z = np.broadcast_arrays(theta[:, :, None, None], z[None, None])
    measure = shape.radius_at(Z) * np.sqrt(1.0 + shape.slope_at(Z) ** 2)
    weight = value * measure * grid.pitch * w[:, None, None] * (dz[:, None] * w)
    n, point = shape.normal(T, Z), shape.point(T, Z)
    force = -np.einsum("tgch,tgchi->i", weight, n)
    torque = -np.einsum("tgch,tgchi->i", weight, np.cross(point, n))
    return force, torque
