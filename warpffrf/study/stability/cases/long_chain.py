"""A chain of 200 links that hangs, disturbed a little at its end."""

from __future__ import annotations

import numpy as np
from scipy.special import j0, jn_zeros

from warpffrf.model import joints
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

LINKS, LENGTH, MASS, G, SWING = 200, 0.05, 0.1, 9.81, 1e-3  # links, m, kg, m/s2, rad of the first mode at the end
HANGS = LINKS * LENGTH
ZERO = float(jn_zeros(0, 1)[0])
RATE = 0.5 * ZERO * np.sqrt(G / HANGS)  # rad/s, of the first mode of a hanging rope


def build() -> Scene:
    """Links in the shape of the first mode of a hanging rope, x = A J0(z_1 root(s/L)), s from the free end."""
    scene = Scene(gravity=(0, 0, -G))
    ends = np.array([shape(HANGS - i * LENGTH) for i in range(LINKS + 1)])
    at, before = np.zeros(3), None
    for i in range(LINKS):
        across = ends[i + 1] - ends[i]
        link = np.array([across, 0.0, -np.sqrt(LENGTH**2 - across**2)])
        body = scene.add_rigid_body(MASS, (MASS * LENGTH**2 / 12.0,) * 3, name=f"link {i}", position=at + 0.5 * link)
        held = scene.ground if before is None else before
        scene.add(joints.Revolute(held, body.at(-0.5 * link), axis=(0, 1, 0), name=f"pin {i}"))
        before, at = body.at(0.5 * link), at + link
    return scene


def shape(s: float) -> float:
    """Way [m] across of the rope at s [m] from its free end."""
    return SWING * HANGS * float(j0(ZERO * np.sqrt(s / HANGS)))


def error(_scene: Scene, result: Result) -> float:
    """Of the last link's way across beside that of the rope, over its amplitude; links of 1/200 err by 1 %."""
    x = result.body(f"link {LINKS - 1}").position[:, 0]
    return float(np.abs(x - x[0] * np.cos(RATE * result.time)).max() / abs(x[0]))


CASE = Case("chain of 200 links", "first mode of a hanging rope", build, 0.2, error, 1e-3, 1e-2, most=200)
