r"""A flat four-bar linkage of revolute joints in space, three of whose rows are redundant, driven at constant speed.

Crank a, coupler b, rocker c, frame d. With the crank's angle alpha, its end P = a (cos alpha, sin alpha), the rocker's
end is where circles about P and about (d, 0) meet: with D the distance and beta the direction from (d, 0) to P, the
rocker's angle is beta - arccos((c^2 + D^2 - b^2)/(2 c D)).
"""

from __future__ import annotations

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

CRANK, COUPLER, ROCKER, FRAME = 0.1, 0.35, 0.25, 0.3  # m: a crank-rocker
SPEED, START, MASS = 20.0, 0.7, 1.0  # rad/s, rad, kg


def rocker(alpha: np.ndarray) -> np.ndarray:
    """Angle of the rocker [rad] of crank angles."""
    x, y = CRANK * np.cos(alpha) - FRAME, CRANK * np.sin(alpha)
    D = np.hypot(x, y)
    return np.arctan2(y, x) - np.arccos((ROCKER**2 + D**2 - COUPLER**2) / (2.0 * ROCKER * D))


def linkage(points: list[np.ndarray], speeds: list[float], start_speed: float) -> Scene:
    """Bars from point to point (x, y) of a closed chain whose ends stand; `speeds` [rad/s] of the bars at the start."""
    scene = Scene()
    places = [np.array([*p, 0.0]) for p in points]
    v, before = np.zeros(3), scene.ground.at(tuple(places[0]))
    for i, (p, q, w) in enumerate(zip(places[:-1], places[1:], speeds, strict=True)):
        omega, arm = np.array([0.0, 0.0, w]), q - p
        length = float(np.linalg.norm(arm))
        turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, 0.0, np.arctan2(arm[1], arm[0])])))
        thin, long = 1e-4 * MASS, MASS * length**2 / 12.0
        bar = scene.add_rigid_body(
            MASS, (thin, long, long + thin), name=f"bar {i}", position=p + 0.5 * arm, rotation=turn,
            velocity=v + np.cross(omega, 0.5 * arm), angular_velocity=omega,
        )  # fmt: skip
        half = 0.5 * length
        joint = scene.add(joints.Revolute(before, bar.at((-half, 0.0, 0.0)), axis=(0, 0, 1), name=f"pin {i}"))
        if i == 0:
            scene.add(joints.Drive(joint, start_speed, name="crank"))
        v, before = v + np.cross(omega, arm), bar.at((half, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground.at(tuple(places[-1])), before, axis=(0, 0, 1), name="last pin"))
    return scene


def build() -> Scene:
    """The linkage in motion."""
    psi, d = float(rocker(np.array(START))), 1e-6
    end = CRANK * np.array([np.cos(START), np.sin(START)])
    tip = np.array([FRAME, 0.0]) + ROCKER * np.array([np.cos(psi), np.sin(psi)])
    rate = float(rocker(np.array(START + d)) - rocker(np.array(START - d))) / (2.0 * d) * SPEED
    tip_v = rate * ROCKER * np.array([-np.sin(psi), np.cos(psi)])
    end_v = SPEED * CRANK * np.array([-np.sin(START), np.cos(START)])
    arm = tip - end
    across = tip_v - end_v
    coupler = float(arm[0] * across[1] - arm[1] * across[0]) / COUPLER**2
    return linkage([np.zeros(2), end, tip, np.array([FRAME, 0.0])], [SPEED, coupler, rate], SPEED)


def check(result: Result) -> list[Finding]:
    """The rocker's angle at every saved step."""
    alpha = START + SPEED * result.time
    wanted = np.unwrap(rocker(alpha))
    found = result.joint("last pin").named("rotation")
    off = (found - found[0]) - (wanted - wanted[0])
    return [Finding("rocker's angle", float(np.abs(off).max()), 1e-7, 1e-4)]


CASE = Case(
    "redundant closed loop",
    "A flat four-bar linkage of revolute joints in space: three redundant rows are left out, and must stay satisfied.",
    build, 1.0, check, middle=1e-3, quick=True,
)  # fmt: skip
