"""An elastic wheel S1002 pressed on a rigid rail, in a pose of its wheelset.

Two bodies of one material press like an elastic one of half its modulus and a rigid one. The wheel is a ring on a rigid
bore that carries a part of the profile: the tread, or the flange, whose narrow radii require smaller facets.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import warpffrf as wf
from references.wheel_rail import RUNNING_CIRCLE, Wheelset

RADIUS = 0.46  # m
SHEAR, POISSON = 82e9, 0.28  # Pa, -
HALF = wf.Material(SHEAR * (1.0 + POISSON), POISSON, 7850.0, name="half of the modulus of steel")
CONTACT = "wheel-rail"
TREAD = np.linspace(-24e-3, 46e-3, 13)  # boundaries of cells along the profile [m], from the running circle
FLANGE = 1e-3 * np.array([*range(-62, -25, 3), -20.0, -14.0, -8.0, -2.0])
# Rows along the profile for a wheel that touches in two places: both of the tread, tread and root of the flange
ROWS = {
    "tread": np.linspace(-14e-3, 12e-3, 66),
    "flange": 1e-3 * np.concatenate([np.arange(-33.0, -25.9, 0.25), np.arange(-25.5, -13.9, 0.4)]),
}
STRIPS = 13
SIZES = {"tread": (TREAD, 0.36, 240), "flange": (FLANGE, 0.40, 480)}  # cells along, bore [m], cells around


def profile(middle: float = 0.0) -> Any:
    """The wheel's surface, its axis y, the running circle at y = -`middle` [m]."""
    return wf.surfaces.wheel_s1002(radius=RADIUS, axis_point=(0, -middle, 0), axis_direction=(0, 1, 0))


@cache
def wheel(part: str) -> tuple[wf.ReducedBody, float]:
    """The reduced wheel with the `part` of the profile, and the s [m] of its middle."""
    s, bore, sectors = SIZES[part]
    middle = 0.5 * float(s[0] + s[-1])
    shape = profile(middle)
    mesh = wf.mesh.roller(
        RADIUS, bore, float(s[-1] - s[0]), profile=shape, sectors=sectors, layers=8, axial=s - middle, order=2
    )
    body = wf.reduce(
        mesh, HALF, interfaces={"bore": "rigid"}, contact={"rim": shape}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip
    return body, middle


def scene(
    part: str, wheelset: Wheelset, curve: Any, pose: tuple[float, float, float], load: float, cells: Any = None
) -> wf.Scene:
    """The wheel at y > 0 in the `pose` (y [m], roll, yaw [rad]) of its wheelset, held but for the height, on the rail
    with the section `curve`, under a vertical load [N]; at the height at which the profiles touch."""
    body, middle = wheel(part)
    y, roll, yaw = pose
    found, turn = wf.Scene(gravity=(0, 0, 0)), Rotation.from_euler("xz", [roll, yaw])
    place = {"axis_point": (0, wheelset.rail_at, -wheelset.top), "axis_direction": (1, 0, 0)}
    face = wf.surfaces.Extruded(curve=curve, x_direction=(0, 40, 1), **place)
    rail = found.ground.surface(face, name="rail")
    center = np.array([0.0, y, wheelset.touch(1, *pose).height]) + turn.apply([0.0, RUNNING_CIRCLE + middle, 0.0])
    moved = found.add_body(body, name="wheel", position=center, rotation=turn)
    found.add(wf.joints.Prismatic(found.ground, moved["bore"], axis=(0, 0, 1)))
    found.add(wf.forces.PointForce(moved["bore"], (0, 0, -load)))
    found.add(wf.Contact(moved["rim"], rail, grid="contact_fixed", cells=cells, name=CONTACT))
    return found


def pressed(*arguments: Any, **options: Any) -> Any:
    """The contact's result in the equilibrium of `scene`."""
    result = wf.equilibrium(scene(*arguments, **options), progress=False)
    if result.status != "completed":
        raise RuntimeError(result.message)
    return result.contact(CONTACT)
