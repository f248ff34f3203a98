"""Bearings of rigid rings and rigid rolling elements in lumped contact, and the same by the equations of bearings.

The outer ring is the ground; the inner one slides along the load, z; each rolling element slides along its radius, as
in a pocket of a cage at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene

STEEL = Material(206e9, 0.3, 7800.0)
MM = 1e-3
AXIS, ORIGIN = (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Bearing:
    """`count` elements of radius `radius`, raceways of radii `inner` and `outer` [m] under `load` [N] along +z; element
    0 is under the load. `inner_force`, `outer_force`: force [N] against approach [m] of one contact."""

    count: int
    radius: float
    inner: float
    outer: float
    load: float
    inner_force: Callable[[float], float]
    outer_force: Callable[[float], float]
    surfaces: tuple[Any, Any, Any]  # of an element, of the inner and of the outer ring
    laws: tuple[Any, Any]  # on the inner and on the outer ring

    @property
    def angles(self) -> np.ndarray:
        return 2.0 * np.pi * np.arange(self.count) / self.count

    def scene(self, friction: Any = 0.0) -> Scene:
        scene = Scene()
        element, inner, outer = self.surfaces
        housing = scene.ground.surface(outer, name="raceway")
        ring = scene.add_rigid_body(0.3, (1e-4,) * 3, name="ring", surfaces={"raceway": inner})
        scene.add(joints.Prismatic(scene.ground, ring.at(ORIGIN), axis=(0, 0, 1), name="slide"))
        scene.add(forces.PointForce(ring.at(ORIGIN), (0.0, 0.0, self.load), name="load"))
        mass = 7800.0 * 4.0 / 3.0 * np.pi * self.radius**3
        for i, angle in enumerate(self.angles):
            out = np.array([np.sin(angle), 0.0, np.cos(angle)])
            ball = scene.add_rigid_body(
                mass, (0.4 * mass * self.radius**2,) * 3, name=f"element {i}",
                position=0.5 * (self.inner + self.outer) * out, surfaces={"skin": element},
            )  # fmt: skip
            scene.add(joints.Prismatic(scene.ground, ball.at(ORIGIN), axis=tuple(out), name=f"pocket {i}"))
            for name, port, law in (("in", ring["raceway"], self.laws[0]), ("out", housing, self.laws[1])):
                scene.add(LumpedContact(ball["skin"], port, law=law, friction=friction, name=f"{name} {i}"))
        return scene

    def solved(self) -> tuple[float, np.ndarray]:
        """Deflection [m] of the inner ring and outer forces (count,) [N], by root finding for each element."""

        def element(shift: float, angle: float) -> tuple[float, float]:
            """Its outer force, and the force on the inner ring along -z."""

            def inner_contact(r: float) -> tuple[float, np.ndarray]:
                away = np.array([r * np.sin(angle), r * np.cos(angle) - shift])
                distance = float(np.hypot(*away))
                return self.inner_force(self.inner + self.radius - distance), away / distance

            def unbalanced(r: float) -> float:
                F, n = inner_contact(r)
                return F * float(n @ (np.sin(angle), np.cos(angle))) - self.outer_force(r + self.radius - self.outer)

            middle = 0.5 * (self.inner + self.outer)
            r: Any = brentq(unbalanced, middle - 3e-4, middle + 3e-4, xtol=1e-18, rtol=np.float64(1e-15))
            F, n = inner_contact(r)
            return self.outer_force(r + self.radius - self.outer), F * float(n[1])

        def lacking(shift: float) -> float:
            return sum(element(shift, angle)[1] for angle in self.angles) - self.load

        shift: Any = brentq(lacking, 0.0, 3e-4, xtol=1e-15)
        return shift, np.array([element(shift, angle)[0] for angle in self.angles])


def power(stiffness: float, exponent: float) -> Callable[[float], float]:
    return lambda a: stiffness * max(a, 0.0) ** exponent


def hertz(R_across: float, R_along: float) -> float:
    """K [N/m^1.5] by integrals over the half-space's influence, from relative radii [m]."""
    from references.closed_forms.elliptic import EllipticContact

    modulus = 0.5 * STEEL.plane_strain_modulus
    contact = EllipticContact(1000.0, max(R_across, R_along), min(R_across, R_along), modulus)
    return 1000.0 / contact.approach**1.5


def ball_209() -> Bearing:
    """209 ball bearing (P8 of the cases with published values): clearance 15 um between the raceways and the balls."""
    d, inner, outer, groove = 12.7 * MM, 0.5 * 52.291 * MM, 0.5 * 77.706 * MM, 6.6 * MM
    across = 1.0 / (2.0 / d - 1.0 / groove)
    K_i = hertz(1.0 / (2.0 / d + 1.0 / inner), across)
    K_o = hertz(1.0 / (2.0 / d - 1.0 / outer), across)
    shapes = (
        surfaces.Sphere(radius=0.5 * d, axis_point=ORIGIN, axis_direction=AXIS),
        surfaces.Groove(radius=inner, groove_radius=groove, axis_point=ORIGIN, axis_direction=AXIS),
        surfaces.Ring(radius=outer, groove_radius=groove, axis_point=ORIGIN, axis_direction=AXIS),
    )
    law = laws.HertzPoint(STEEL, STEEL)
    return Bearing(9, 0.5 * d, inner, outer, 8900.0, power(K_i, 1.5), power(K_o, 1.5), shapes, (law, law))


def roller_209(laminae: int = 1) -> Bearing:
    """209 cylindrical roller bearing (P10): Palmgren's law at each of the two contacts of a roller."""
    d, length, clearance = 10.0 * MM, 9.6 * MM, 40.6e-6
    inner = 27.0 * MM
    outer = inner + d + 0.5 * clearance

    def palmgren(a: float) -> float:
        return (max(a, 0.0) / MM * (length / MM) ** 0.8 / 3.84e-5) ** (1.0 / 0.9)

    shapes = (
        surfaces.Cylinder(radius=0.5 * d, axis_point=ORIGIN, axis_direction=AXIS),
        surfaces.Cylinder(radius=inner, axis_point=ORIGIN, axis_direction=AXIS),
        surfaces.Bore(radius=outer, axis_point=ORIGIN, axis_direction=AXIS),
    )
    law = laws.PalmgrenLine(length, laminae)
    return Bearing(14, 0.5 * d, inner, outer, 4450.0, palmgren, palmgren, shapes, (law, law))
