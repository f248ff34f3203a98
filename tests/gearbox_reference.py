"""The demo `gearbox_shaft` by full finite elements and rigid-ring laws, and its figures compared with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from demos import gearbox_shaft as demo
from references.closed_forms.ball_bearing import BallBearing
from references.finite_elements.shaft_in_housing import Elastic, balls, rollers, solve

AXIS, FIRST = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])
UM, MRAD = 1e6, 1e3


def reference(size: demo.Size) -> tuple[np.ndarray, list[np.ndarray]]:
    """Motions (6, 6) of the seats `locating`, `non-locating`, `gear` and the coupling of the shaft, then of both bores,
    m and rad, and the loads of balls and rollers [N]."""
    middles = {name: demo.PLACES[name] * AXIS for name in (*demo.BEARINGS, "gear")}
    bores = {name: middles[name] for name in demo.BEARINGS}
    shaft = Elastic.of(demo.shaft(size), demo.STEEL, {**middles, "end_high": 0.5 * demo.LENGTH * AXIS})
    housing = Elastic.of(demo.housing(size), demo.IRON, bores, fixed="feet")
    a, b = demo.BALL, demo.ROLLER
    inner, outer = (float(f) * a.ball_diameter for f in a.osculation)
    E = demo.STEEL.youngs_modulus
    ball = BallBearing(a.elements, a.ball_diameter, a.pitch_diameter, inner, outer, a.clearance, E)
    roller = rollers(b.elements, b.roller_diameter, b.roller_length, b.clearance, AXIS, FIRST)
    load, guess = np.zeros((4, 6)), np.zeros((6, 6))
    load[2] = [*demo.FORCE, *np.cross(demo.TOOTH, demo.FORCE)]
    guess[:4, 1:3], guess[:4, 4] = (1e-4, 1e-5), load[2, 4] / demo.COUPLING
    return solve(shaft, housing, [balls(ball, AXIS, FIRST), roller], load.ravel(), demo.COUPLING, guess.ravel())


def compared(result: Any, size: demo.Size) -> Iterator[tuple[str, float, float, float, str]]:
    """Quantity, its value, that of the reference, the size that matters and the unit."""
    q, loads = reference(size)
    y, moved = demo.bending(result)
    ours, theirs = moved[np.argmin(np.abs(y - demo.PLACES["gear"]))], q[2, :3]
    across = float(np.hypot(*theirs[[0, 2]]))
    yield "shaft at the gear, across", UM * float(np.hypot(*ours[[0, 2]])), UM * across, UM * across, "µm"
    yield "shaft at the gear, along", UM * float(ours[1]), UM * theirs[1], UM * theirs[1], "µm"
    for i, name in enumerate(demo.BEARINGS):
        found, apart = result.bearing(name), q[i] - q[4 + i]
        tilt = float(np.hypot(*apart[[3, 5]]))
        ring = result.body(f"{name} outer ring").position[-1] - demo.PLACES[name] * AXIS
        yield f"{name}: tilt", MRAD * float(np.hypot(*found.tilt[-1, :2])), MRAD * tilt, MRAD * tilt, "mrad"
        far = float(np.linalg.norm(q[4 + i, :3]))
        yield f"{name}: bore moves", UM * float(np.linalg.norm(ring)), UM * far, UM * far, "µm"
        heaviest = int(np.argmax(loads[i]))
        for k in (heaviest, heaviest + 1):
            Q = found.inner_load[-1, k]
            yield f"{name}: element {k + 1}", float(Q), float(loads[i][k]), float(loads[i].max()), "N"
