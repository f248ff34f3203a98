"""A block that slides along a guide under a load: on a floor, or on a belt with the block attached to a spring."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.rollers import STEEL
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online.history.history import History

RADIUS, MASS, LOAD, STIFFNESS, SPEED = 0.05, 4.0, 200.0, 2e4, 0.1  # m, kg (of the slide), N, N/m, m/s


def wheel_body(sectors: int = 720) -> ReducedBody:
    """A wheel, used as a block that does not rotate."""
    mesh = roller(RADIUS, 0.015, 0.01, sectors=sectors, layers=4, axial=1, grading=1.8, order=1)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, max_frequency=12e3,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def block(body: ReducedBody, speed: float, load: float = LOAD) -> tuple[Scene, Any, Any]:
    """A scene with a block under a load [N] that slides along x at `speed` [m/s], and its sliding joint."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    start: dict[str, Any] = {"position": (0.0, 0.0, RADIUS), "velocity": (speed, 0.0, 0.0)}
    wheel = scene.add_body(body, name="block", **start)
    slide = scene.add_rigid_body(MASS, (0.01,) * 3, name="slide", **start)
    along = scene.add(joints.Prismatic(scene.ground, slide.at((0.0, 0.0, 0.0)), axis=(1, 0, 0), name="along"))
    scene.add(joints.Prismatic(slide.at((0.0, 0.0, 0.0)), wheel["bore"], axis=(0, 0, 1), name="down"))
    scene.add(forces.PointForce(wheel["bore"], (0.0, 0.0, -load)))
    return scene, wheel, along


def on_belt(body: ReducedBody, friction: Any, *, stiffness: float = STIFFNESS, load: float = LOAD) -> Scene:
    """The block moves with the belt at the start, its spring [N/m] slack."""
    scene, wheel, along = block(body, SPEED, load)
    top = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))
    belt = scene.add_rigid_body(1.0, (1.0,) * 3, name="belt", velocity=(SPEED, 0.0, 0.0), surfaces={"top": top})
    guide = scene.add(joints.Prismatic(scene.ground, belt.at((0.0, 0.0, 0.0)), axis=(1, 0, 0), name="guide"))
    scene.add(joints.Drive(guide, SPEED, quantity="velocity"))
    scene.add(forces.JointSpringDamper(along, stiffness=stiffness))
    scene.add(Contact(wheel["rim"], belt["top"], friction=friction, name="pair"))
    return scene


def maxima(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Times and values (n, 2) of the maxima of x, by parabolas through three points."""
    i = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    bend, rise = x[i + 1] - 2.0 * x[i] + x[i - 1], 0.5 * (x[i + 1] - x[i - 1])
    return np.column_stack([t[i] - (t[1] - t[0]) * rise / bend, x[i] - 0.5 * rise**2 / bend])


def cycle(history: History, step: float, since: float) -> tuple[float, float]:
    """Mean amplitude [m] and period [s] after the time `since` [s], from rows at whole steps [s]."""
    whole = np.flatnonzero(np.isclose(history.time / step, np.round(history.time / step)))
    t, x = history.time[whole], history.bodies["slide"].position[whole, 0]
    tops, bottoms = maxima(t[t > since], x[t > since]), maxima(t[t > since], -x[t > since])
    return float(0.5 * (tops[:, 1].mean() + bottoms[:, 1].mean())), float(np.diff(tops[:, 0]).mean())
