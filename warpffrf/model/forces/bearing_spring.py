"""Bearing: stiffness across, along and against tilting of an axis that spins freely.

Coordinates of the second port's marker (axes w) against the first's (axes u), z along the bearing's axis:

    d = A_a^T (x_b - x_a),      theta_x = -u_y . w_z,      theta_y = u_x . w_z.

theta is the sine of the tilt of b's axis about a's x and y axes; unlike a rotation vector it does not feel the spin, so
any number of turns leaves the law as it was. A bushing would not do: its rotation is that of the whole frame. The spin
is the twist (`warpffrf.model.joints.rows`), which no choice of x axes enters.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.errors import InputError, require_direction, require_number
from warpffrf.model.forces.bushing import TwoPorts
from warpffrf.model.forces.laws import Coordinate, SpringLaw
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import reference_direction

# theta_x carries a sign that the coordinate u_y . w_z has not; the law's matrices are turned accordingly
_COORDINATES = (
    Coordinate("translation", 0),
    Coordinate("translation", 1),
    Coordinate("translation", 2),
    Coordinate("direction", 1, 2),
    Coordinate("direction", 0, 2),
    Coordinate("twist", 2),
)
_SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0])


@named_arguments
class BearingSpring(TwoPorts):
    """A bearing between two ports a and b, described by its stiffness and damping; b spins freely about `axis`.

    axis: direction (3,), world, at the initial pose; the law's axes stay with the first port. radial [N/m], axial
    [N/m], tilt [N m/rad], radial_tilt [N/rad] (force per tilt, moment per displacement, in the planes x-z and y-z:
    d_x with theta_y, -d_y with theta_x), cross [N/m] (skew, as of an oil film:
    displacement along x pushes along +y, one along y pushes along -x, which drives forward whirl about the axis; its
    work is booked as work of forces). radial_damping, axial_damping [N s/m], tilt_damping, spin_damping
    [N m s/rad]; the last brakes the spin. point as in `Bushing`. Moments follow the sine of the tilt. Raises
    `InputError`.
    """

    kind = "bearing_spring"
    quantities = (
        "radial", "axial", "tilt", "radial_tilt", "cross", "radial_damping", "axial_damping", "tilt_damping",
        "spin_damping",
    )  # fmt: skip

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        radial: float,
        axial: float = 0.0,
        tilt: float = 0.0,
        radial_tilt: float = 0.0,
        cross: float = 0.0,
        radial_damping: float = 0.0,
        axial_damping: float = 0.0,
        tilt_damping: float = 0.0,
        spin_damping: float = 0.0,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, point, name)
        label = self.label
        self.axis = require_direction(axis, f"{label}: axis")
        self.radial = require_number(radial, f"{label}: radial", positive=True)
        self.axial = require_number(axial, f"{label}: axial", non_negative=True)
        self.tilt = require_number(tilt, f"{label}: tilt", non_negative=True)
        self.radial_tilt = require_number(radial_tilt, f"{label}: radial_tilt")
        self.cross = require_number(cross, f"{label}: cross")
        self.radial_damping = require_number(radial_damping, f"{label}: radial_damping", non_negative=True)
        self.axial_damping = require_number(axial_damping, f"{label}: axial_damping", non_negative=True)
        self.tilt_damping = require_number(tilt_damping, f"{label}: tilt_damping", non_negative=True)
        self.spin_damping = require_number(spin_damping, f"{label}: spin_damping", non_negative=True)
        if self.radial_tilt and self.radial_tilt**2 >= self.radial * self.tilt:
            limit = np.sqrt(self.radial * self.tilt)
            raise InputError(
                f"{label}: radial_tilt {self.radial_tilt:g} must be below the root of radial times tilt, {limit:g} "
                "N/rad, or some motion meets negative stiffness"
            )

    def law(self) -> SpringLaw:
        """Coordinates and law, from the initial pose as it is now."""
        K = np.diag([self.radial, self.radial, self.axial, self.tilt, self.tilt, 0.0])
        K[0, 4] = K[4, 0] = self.radial_tilt
        K[1, 3] = K[3, 1] = -self.radial_tilt
        K[0, 1], K[1, 0] = self.cross, -self.cross
        D = np.diag([self.radial_damping] * 2 + [self.axial_damping] + [self.tilt_damping] * 2 + [self.spin_damping])
        K, D = (_SIGNS[:, None] * A * _SIGNS for A in (K, D))
        sprung = np.flatnonzero(np.diag(K))
        damped = np.flatnonzero((np.diag(K) == 0.0) & (np.diag(D) > 0.0))
        use = np.concatenate([sprung, damped])
        e_x = reference_direction(self.axis)
        world = np.stack([e_x, np.cross(self.axis, e_x), self.axis], axis=1)
        zero = np.zeros(len(use))
        return SpringLaw(
            tuple(_COORDINATES[i] for i in use), K[np.ix_(use, use)], D[np.ix_(use, use)], zero, zero, len(sprung),
            **self.markers(world), expand=np.diag(_SIGNS)[:, use],
        )  # fmt: skip

    def describe(self) -> dict[str, Any]:
        values = {q: getattr(self, q) for q in self.quantities}
        return {**super().describe(), "axis": self.axis.tolist(), **values}
