"""A contact pair of two surfaces, and the undeformed gap between their true shapes.

Gap. A point of the first true surface at chart coordinates (theta, z) is x_1(theta, z) in the world. In the second
body's user frame it has radius rho and axial position zeta about the second surface's axis, and the gap is its signed
normal distance from the second profile,

    g(theta, z) = d_2(rho, zeta),     for a cylinder rho - R, for a crown sqrt((rho - R + Rc)^2 + zeta^2) - Rc,

positive where the surfaces are apart. Its minimum over the part of the first surface that faces the second's width is
the initial gap of the pair. The minimum is found on a grid that is refined about the best point; since g is flat there,
an error e of the place costs only e^2/(2 R) of the value.

Closing. m(s), the smallest gap when the second body is moved by s along a direction, changes by at most ds when s does:
from an open gap a step of m(s) - gap never passes the first touch (sphere tracing). For a direction at angle phi to the
normal the distance left shrinks by the factor 1 - cos(phi) a step.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_count, require_direction, require_number
from warpffrf.model.laws import Unilateral, as_law

UNILATERAL = Unilateral()
ZOOM_POINTS = (73, 33)  # grid around and along: 5 degrees first, enough to bracket the one minimum of convex surfaces
ZOOM_FACTOR = 8.0  # each refinement shrinks the looked-at rectangle by this
ZOOM_ROUNDS = 9  # 8^8 below the first spacing: the place to 1e-8 rad, the value to round-off
CLOSE_TOLERANCE = 1e-13  # m; round-off of coordinates of order 0.1 to 1 m is 1e-16, times the condition of the distance
CLOSE_STEPS = 500  # 1 - cos(phi) <= 0.94 a step: reaches the tolerance for phi up to 85 degrees


class Contact:
    """Frictionless contact between two contact surfaces, `body['rim']` each.

    Forces are reported on the first body. law: what lies between the surfaces, see `warpffrf.model.laws`, nothing by
    default. friction must be 0. capacity: largest number of active stress modes, None to
    have it chosen. name: default "<first body>-<second body>".
    """

    scene_list = "contacts"
    kind = "contact"

    def __init__(
        self,
        a: Any,
        b: Any,
        *,
        law: Any = UNILATERAL,
        friction: float = 0.0,
        capacity: int | None = None,
        name: str | None = None,
    ) -> None:
        for port, place in ((a, "first"), (b, "second")):
            if not isinstance(port, SurfacePort):
                raise InputError(
                    f"contact: the {place} surface must be a contact surface, body['rim'] with 'rim' named in "
                    f"reduce(contact=...), got {getattr(port, 'label', None) or repr(getattr(port, 'name', port))}"
                )
            kind = port.surface.grid.kind
            if kind != "hats":
                raise InputError(
                    f"contact: the {place} surface, {port.label}, was reduced with traction={kind!r}; normal contact "
                    "is solved with hats: reduce the body with traction='hats'"
                )
        self.a, self.b = a, b
        self.name = f"{a.body.name}-{b.body.name}" if name is None else name
        if a.body is b.body:
            raise InputError(
                f"contact {self.name!r}: body {a.body.name!r} in contact with itself is not supported; name two bodies"
            )
        self.law = as_law(law, f"contact {self.name!r}")
        self.friction = require_number(friction, f"contact {self.name!r}: friction", non_negative=True)
        if self.friction != 0.0:
            raise InputError(f"contact {self.name!r}: friction is not available yet, only friction=0.0 (frictionless)")
        self.capacity = None if capacity is None else require_count(capacity, f"contact {self.name!r}: capacity", 1)

    @property
    def ports(self) -> tuple[SurfacePort, SurfacePort]:
        return self.a, self.b

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        surfaces = {"a": [self.a.body.name, self.a.name], "b": [self.b.body.name, self.b.name]}
        numbers = {"friction": self.friction, "capacity": self.capacity}
        return {"name": self.name, **surfaces, "law": self.law.describe(), **numbers}


def undeformed_gap(contact: Contact, theta: Any, z: Any, offset: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Gap [m] at chart coordinates theta [rad], z [m] of the first surface, at the initial pose; positive is open.

    `offset` (3,) [m] moves the second body in the world. NaN where a point lies beside the second surface's width.
    """
    first, second = contact.a.surface, contact.b.surface
    world = contact.a.body.to_world(first.shape.point(theta, z))
    local = contact.b.body.to_user(world - np.asarray(offset, float)) - second.shape.axis_point
    zeta = local @ second.shape.e_a
    rho = np.linalg.norm(local - zeta[..., None] * second.shape.e_a, axis=-1)
    lower, upper = second.grid.z[0], second.grid.z[-1]
    beside = (zeta < lower) | (zeta > upper)
    inside = np.clip(zeta, lower, upper)  # the crown's formula holds on the width only
    return np.where(beside, np.nan, second.shape.profile_distance(rho, inside))


def smallest_gap(contact: Contact, offset: Any = (0.0, 0.0, 0.0)) -> tuple[float, float, float]:
    """Smallest undeformed gap [m] and its place (theta [rad], z [m]) on the first surface; negative is interference.

    `offset` (3,) [m] moves the second body in the world. Raises `InputError` where the surfaces do not face each other.
    """
    grid = contact.a.surface.grid
    theta, z = 0.0, 0.5 * (grid.z[0] + grid.z[-1])
    half_theta, half_z = np.pi, 0.5 * (grid.z[-1] - grid.z[0])
    if not grid.periodic:
        half_theta = 0.5 * grid.pitch * (grid.columns - 1)
        theta = grid.theta_start + half_theta
    first, last = theta - half_theta, theta + half_theta
    best = np.nan
    for _ in range(ZOOM_ROUNDS):
        around = theta + half_theta * np.linspace(-1.0, 1.0, ZOOM_POINTS[0])
        if not grid.periodic:
            around = np.clip(around, first, last)
        along = np.clip(z + half_z * np.linspace(-1.0, 1.0, ZOOM_POINTS[1]), grid.z[0], grid.z[-1])
        gaps = undeformed_gap(contact, around[:, None], along[None, :], offset)
        if np.all(np.isnan(gaps)):
            raise InputError(
                f"contact {contact.name!r}: the surfaces {contact.a.label} and {contact.b.label} do not face each "
                "other anywhere along their width; move a body"
            )
        i, j = np.unravel_index(np.nanargmin(gaps), gaps.shape)
        best, theta, z = float(gaps[i, j]), float(around[i]), float(along[j])
        half_theta, half_z = half_theta / ZOOM_FACTOR, half_z / ZOOM_FACTOR
    return best, theta, z


def closing_distance(contact: Contact, along: Any, gap: float) -> float:
    """Distance [m] to move the second body along the direction `along` (3,), world, until the smallest gap is `gap`
    [m].

    Of several such places it is the one reached from far out on the side of `along`. Raises `InputError` where the
    second body passes the first without touching.
    """
    label = f"contact {contact.name!r}: close_gap"
    direction = require_direction(along, f"{label}: along")
    gap = require_number(gap, f"{label}: gap")
    reach = sum(_extent(port) for port in contact.ports)
    centers = [port.body.to_world(port.surface.shape.axis_point) for port in contact.ports]
    # start where the bodies are apart for certain, and stop when they are on the other side
    beside = float((centers[0] - centers[1]) @ direction)
    s, end = beside + reach + max(gap, 0.0), beside - reach - max(gap, 0.0)
    for _ in range(CLOSE_STEPS):
        step = smallest_gap(contact, s * direction)[0] - gap
        if abs(step) <= CLOSE_TOLERANCE:
            return s
        s -= step
        if s < end:
            break
    shown = ", ".join(f"{d:g}" for d in direction)
    raise InputError(
        f"{label}: moving {contact.b.body.name!r} along ({shown}) never brings the gap "
        f"to {gap:g} m; choose a direction that points from the first body to the second"
    )


def _extent(port: SurfacePort) -> float:
    """Radius [m] of a sphere about the axis point that holds the surface."""
    surface = port.surface
    z = max(abs(surface.grid.z[0]), abs(surface.grid.z[-1]))
    return float(np.hypot(surface.shape.radius, z))
