r"""Bearings of which some elements are flexible, with distributed contact, and the others rigid, with lumped contact of
the same stiffness.

At the force F the middle of a contact approaches the centre of a flexible element by

    delta = h(F) + c F,      c = sum over e of [S(0, e) + phi(0) omega^-2 phi(e)^T],      e = 0, pi,

h Hertz's approach of its half-space, c the difference of the body from it under two opposite forces, on its far field S
(`warpffrf.model.reduced.far_field`) and its global modes phi: half of it belongs to each contact. Of balls, and of
lines of the length L with the half-width a,

    h = (F/K)^(2/3),      h = 2 F/(pi E L) (ln(4 L/a) - 1/2),      a^2 = 4 F/(pi E kappa L),

E = E/(1 - nu^2) of the element, kappa the relative curvature; the images of free ends, of which L h is without, are in
c. On a flexible ring all contacts are distributed. There a rigid element lacks the part of the element of

    h_12(F) - h_2(F) + c F,      index 1 the element and 2 the ring,

which its lumped contact on the other ring then has: both carry the same force, up to the inertia of the element. That
is why one ring has to be rigid.

**Choice by load.** Rings are rigid and move in parallel by u. Elements are compressed by delta_j(u) (balls: by the
distance of the groove centres less A) and carry Q_j = K delta_j^n, n = 3/2 or 10/9, K the stiffness at the load of the
bearing; u minimises the potential. Elements with less than `SHARE` of the largest load are lumped.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import minimize

from warpffrf.model.bearings.bearing import Bearing
from warpffrf.model.bearings.elements import Cage, Elements, FlexibleElements, PrescribedCage
from warpffrf.model.bearings.geometry import SIDES, BallGeometry
from warpffrf.model.bearings.parts import RollingContact
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.laws.lumped import Approach, HertzPoint, TabulatedForce
from warpffrf.model.laws.lumped.base import Meeting
from warpffrf.model.laws.lumped.hertz_point import laminae
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.far_field import FarField
from warpffrf.model.signals import Constant

SHARE = 0.5  # of the largest load: 0.7 of the largest pressure of rollers, 0.8 of balls
POINTS, LEAST = 120, 1e-5  # of a table; its first force over the last: straight pieces err by 3e-4
LAMINAE = 11  # of a rigid roller, against tilting
BALANCED = 0.01  # of the load
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class TabulatedLine(TabulatedForce):
    """`TabulatedForce` of a roller of the effective `length` [m], whose laminae have an equal part each."""

    length: float = 0.0
    kind: ClassVar[str] = "tabulated_line"
    by_laminae: ClassVar[bool] = True

    def approach(self, meeting: Meeting) -> Approach:
        return replace(super().approach(meeting), z=laminae(self.length, LAMINAE), drop=np.zeros(LAMINAE))


def mixed(
    label: str, elements: Elements, bearing: Bearing, contact: RollingContact, rings: tuple[Any, Any], cage: Cage | None
) -> tuple[Elements, Any]:
    """The elements of the bearing of which those that `contact.distributed` does not name are rigid, and their law:
    that of `contact`, or one of the same stiffness. rings: as given, inner and outer. Raises `InputError`."""
    name = f"{label}: RollingContact: distributed"
    if not isinstance(elements, FlexibleElements):
        raise InputError(
            f"{name}: the elements are rigid; give the body of those with distributed contact, "
            "materials=Materials(element_body=...)"
        )
    moduli = [_modulus(ring, bearing.materials[1]) for ring in rings]
    if all(np.isfinite(moduli)):
        raise InputError(
            f"{name}: both rings are flexible, where all contacts are distributed and rigid elements would be too "
            'stiff; make one ring rigid, or leave distributed="all"'
        )
    if contact.load is not None and contact.distributed != "auto":
        raise InputError(f'{label}: RollingContact: load is of distributed="auto"; leave it out')
    law, tables = contact.law, None
    if law is None or contact.distributed == "auto":
        tables = _tables(label, elements, bearing, moduli)
        law = tables if law is None else law
    if contact.distributed == "auto":
        if cage is None or not isinstance(cage, PrescribedCage) or not _stands(cage):
            raise InputError(
                f'{name}="auto" is of elements that stay at their places, and these pass through the load zone; name '
                "those whose pressure is wanted, distributed=(1,)"
            )
        assert tables is not None
        chosen, bearing.load = _most_loaded(name, bearing, contact.load, tables)
    else:
        chosen = _named(name, contact.distributed, len(bearing.geometry.places))
    bearing.distributed = chosen
    return replace(elements, distributed=frozenset(chosen), end=bool(np.isfinite(moduli).any())), law


def _stands(cage: PrescribedCage) -> bool:
    speed = cage.speed.value if isinstance(cage.speed, Constant) else cage.speed
    return isinstance(speed, (int, float)) and speed == 0.0


def _named(name: str, given: Any, count: int) -> tuple[int, ...]:
    numbers = np.asarray(given)
    if numbers.dtype.kind != "i" or numbers.ndim != 1 or np.any((numbers < 1) | (numbers > count)):
        raise InputError(
            f'{name} must be "all", "auto" or numbers of elements from 1 to {count}, distributed=(1, 2), got {given!r}'
        )
    return tuple(np.unique(numbers).tolist())


def _modulus(ring: Any, material: Material) -> float:
    """E/(1 - nu^2) [Pa] of a ring, infinite of a rigid one."""
    port = ring[0] if isinstance(ring, (tuple, list)) else ring
    return material.plane_strain_modulus if isinstance(port, SurfacePort) and not port.rigid else np.inf


def _plane_strain(far: FarField) -> float:
    return far.youngs_modulus / (1.0 - far.poisson_ratio**2)


@dataclass(frozen=True, eq=False)
class Softness:
    """Approach of a flexible element with the `far` field on one ring; length [m] of its line, 0 of a ball."""

    far: FarField
    bearing: Bearing
    length: float
    body: float  # c [m/N]

    def approach(self, side: str, force: np.ndarray, ring: float) -> np.ndarray:
        """[m] at the forces [N] on the ring of a side with the modulus `ring` [Pa]; of a flexible one what a rigid
        element lacks there."""
        own = _plane_strain(self.far)
        both = 1.0 / (1.0 / own + 1.0 / ring)
        geometry = self.bearing.geometry
        if isinstance(geometry, BallGeometry):
            at = sorted(float(k) for k in geometry.curvatures(side, geometry.free_angle))
            one = HertzPoint(Material(self.far.youngs_modulus, self.far.poisson_ratio, 1.0))
            K = one.approach(Meeting(self.bearing.name, (at[0], at[1]), 0.0)).stiffness / own
            found = (force / (K * both)) ** (2.0 / 3.0) - (force / (K * ring)) ** (2.0 / 3.0)
        else:
            half = np.sqrt(4.0 * force / (np.pi * both * geometry.curvature(side) * self.length))
            logs = (np.log(4.0 * self.length / half) - 0.5) / own
            if np.isfinite(ring):
                logs += 0.5 * np.log(both / ring) / ring
            found = 2.0 * force / (np.pi * self.length) * logs
        return found + self.body * force


def _tables(label: str, elements: FlexibleElements, bearing: Bearing, moduli: list[float]) -> tuple[Any, Any]:
    """Laws on the inner and on the outer ring."""
    surface: Any = elements.body.contact_surfaces[elements.surface]
    geometry = bearing.geometry
    length = 0.0 if isinstance(geometry, BallGeometry) else float(np.ptp(surface.grid.z))
    beyond = _beyond_half_space(label, elements.body, surface, length)
    soft, nu = Softness(surface.far, bearing, length, beyond), surface.far.poisson_ratio
    force = np.geomspace(LEAST, 1.0, POINTS) * geometry.static_rating
    parts = [soft.approach(side, force, E) for side, E in zip(SIDES, moduli, strict=True)]
    made = []
    for own, other, E in zip(parts, parts[::-1], moduli[::-1], strict=True):
        whole = own + other if np.isfinite(E) else own  # with what the other, flexible one lacks
        table: dict[str, Any] = {"approaches": (0.0, *whole.tolist()), "forces": (0.0, *force.tolist())}
        shear = 2.0 * (1.0 - nu) / (2.0 - nu)
        made.append(
            TabulatedLine(**table, shear=shear, length=length) if length else TabulatedForce(**table, shear=shear)
        )
    return made[0], made[1]


def _beyond_half_space(label: str, body: ReducedBody, surface: Any, length: float) -> float:
    """c [m/N] of the module docstring, along a line of the length [m], or at a point in the middle."""
    far, splines, z = surface.far, surface.splines, np.asarray(surface.grid.z)
    if far is None:
        raise InputError(
            f"{label}: element_body: {body} has no far field, from which the stiffness of rigid elements follows; "
            "reduce it with grid=ContactGrid(contact_fixed=True), or give law="
        )
    x, w = np.polynomial.legendre.leggauss(8 * len(z))
    along = 0.5 * w @ splines.along(0.5 * (z[0] + z[-1] + length * x))
    at, opposite = (
        np.outer(splines.around(theta)[0], along) for theta in surface.grid.theta_start + np.array([0, np.pi])
    )
    modes = splines.of_nodes(surface.mode_normal) / (2.0 * np.pi * body.frequencies)
    moved = replace(surface, lags=far.lags).compliance(np.arange(surface.grid.columns)) @ (at + opposite).ravel()
    found = at.ravel() @ moved + (at.ravel() @ modes) @ ((at + opposite).ravel() @ modes)
    return float(found) + _at_ends(far, length)


def _at_ends(far: Any, length: float) -> float:
    """Mean displacement [m/N] of a line due to its free ends: mirror images and quarter spaces."""
    if not length or far.quarter is None:
        return 0.0
    x, w = np.polynomial.legendre.leggauss(24)
    x, w = 0.25 * (x + 1.0) ** 2, 0.5 * (x + 1.0) * w  # distances from an end, finer towards it
    image = (1.0 - far.poisson_ratio**2) / np.pi / (x[:, None] + x)
    moved = w @ (image + far.quarter.displacement(0.0, x[:, None], x[None, :])) @ w
    return len(far.ends) * float(moved) / (length * far.youngs_modulus)


def _most_loaded(
    name: str, bearing: Bearing, load: Any, tables: tuple[TabulatedForce, TabulatedForce]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Numbers, from 1, of the elements that carry `SHARE` of the largest load or more, and the load [N]. Raises
    `InputError`."""
    geometry = bearing.geometry
    if load is None:
        raise InputError(f'{name}="auto" requires load=, the force (3,) [N] on the inner ring, world axes')
    given = require_array(load, f"{name}: load [N]", (3,))
    force = bearing.place.axes @ given
    balls = isinstance(geometry, BallGeometry)
    angle, rows = geometry.contact_angle, [geometry.tracks[row] for _, row in geometry.contacts]
    around = np.array([geometry.places[i][0] for i, _ in geometry.contacts])
    sense = np.array([track.sense for track in rows])
    along = np.stack(
        [np.cos(angle) * np.cos(around), np.cos(angle) * np.sin(around), np.sin(angle) * sense], axis=1
    )  # (n, 3) from the outer to the inner groove centre, or of the force of a roller on the outer ring
    if not balls:  # rollers do not carry along what their raceways do not
        _, sizes, directions = np.linalg.svd(along)
        force = directions[sizes > ROUND_OFF * sizes[0]].T @ (directions[sizes > ROUND_OFF * sizes[0]] @ force)
    size = float(np.linalg.norm(force))
    deep = sum(float(np.interp(size, table.forces, table.approaches)) for table in tables)
    if not size > 0.0:
        raise InputError(f"{name}: load= has no part that the elements carry; give the force on the inner ring")
    power, slack = (1.5, 0.5 * geometry.clearance) if balls else (10.0 / 9.0, 0.5 * geometry.clearance * np.cos(angle))
    outward = np.stack([np.cos(around), np.sin(around), 0.0 * around], axis=1)

    def compressed(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """In `deep`, and its gradient (n, 3)."""
        if not balls:
            return along @ u - slack / deep, along
        reach = geometry.reach / deep  # pyright: ignore[reportAttributeAccessIssue]
        between = reach * along - slack / deep * outward + u
        apart = np.linalg.norm(between, axis=1)
        return apart - reach, between / apart[:, None]

    def potential(u: np.ndarray) -> tuple[float, np.ndarray]:
        a, slope = compressed(u)
        a = np.maximum(a, 0.0)
        energy = float((a ** (power + 1.0)).sum()) / (power + 1.0) - float(u @ force) / size
        return energy, a**power @ slope - force / size

    found = minimize(potential, force / size * (1.0 + slack / deep), jac=True, method="BFGS")
    if not np.linalg.norm(potential(found.x)[1]) < BALANCED:
        raise InputError(
            f"{name}: rigid rings that move in parallel have no equilibrium under load=; give the axial force of a "
            "bearing with a contact angle, too, or name the elements, distributed=(1, 2)"
        )
    loads = np.zeros(len(geometry.places))
    np.maximum.at(loads, [i for i, _ in geometry.contacts], np.maximum(compressed(found.x)[0], 0.0) ** power)
    return tuple((np.flatnonzero(loads >= SHARE * loads.max()) + 1).tolist()), tuple(given.tolist())
