r"""Two rollers whose axes are skewed and tilted by 0.3 mrad against each other, pressed together on a guide.

No closed form is at hand, but three things are known. Once the swing is over, the forces of contact, load and guide are
in balance. The same rollers skewed and tilted the other way are the mirror image: in a mirror across the axis a force
keeps its parts along x and z, a moment that along y, and the others change their signs. And the moment about the lower
axis is that of the force where the pressures are, on the surface: with their centroid at y, at the radius R,

    M_x = y F_z - R F_y.

Skewed by 2 mrad the program takes gaps along lines of centres, which leave out terms of the tilt squared; their
derivative is a moment R_B tilt F, a fortieth of the whole at any tilt, and a note says so. Skewed by 30 mrad it takes
gaps at points, which leave nothing out.
"""

from __future__ import annotations

from functools import lru_cache, partial

import numpy as np

from scenes.rollers import PAIR, roller_body
from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

TILT, LOAD, DAMPING = 3e-4, 20e3, 2e4  # rad, N, N s/m
RADIUS, ARM = 0.05, 0.01  # m: half of the width
SETTLED = 0.05  # s


@lru_cache
def _body() -> ReducedBody:
    return roller_body(180, layers=4, axial=8, grading=1.6, order=1, modes=4)


def scene_of(skew: float, way: float = 1.0) -> Scene:
    """The upper roller on a damped guide, its axis rotated by `skew` [rad]; `way` -1 in the mirror."""
    scene = Scene()
    turned = rot.quaternion(rot.rotation_vector_matrix(way * np.array([TILT, 0.0, skew])))
    lower = scene.add_body(_body(), name="lower")
    upper = scene.add_body(_body(), name="upper", position=(0.0, 0.0, 0.101), rotation=turned)
    contact = scene.add(Contact(lower["rim"], upper["rim"], name=PAIR))
    scene.close_gap(contact, along=(0.0, 0.0, 1.0))
    scene.add(joints.Fixed(scene.ground, lower["bore"], name="hold"))
    guide = scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1), name="guide"))
    scene.add(forces.JointSpringDamper(guide, stiffness=0.0, damping=DAMPING, name="damper"))
    scene.add(forces.PointForce(upper["bore"], (0.0, 0.0, -LOAD), name="load"))
    return scene


def check(result: Result) -> list[Finding]:
    """Action and reaction; once the swing is over the force, and the moment about the lower axis."""
    pair, t = result.history.contacts[PAIR], result.time
    reaction = float(np.abs(pair.force + pair.force_second).max()) / LOAD
    found = [Finding("reaction", reaction, 1e-5, 1e-3)]  # summed over either surface's own grid
    if t[-1] > SETTLED:
        F = pair.force[-1]
        found.append(Finding("force at rest", abs(abs(float(F[2])) / LOAD - 1.0), 1e-3, 1e-2))
        surface = result.history.scene.contacts[0].a.surface
        loads = surface.gram_z @ pair.pressure[-1].sum(axis=0)
        y = float(loads @ np.asarray(surface.grid.z) / loads.sum())
        moment = y * F[2] - RADIUS * F[1]
        found.append(Finding("moment of the pressures", abs(float(pair.torque[-1, 0] / moment) - 1.0), 1e-2, 5e-2))
    return found


def alike(result: Result, other: Result) -> list[Finding]:
    """Force, moment and pressures against those in the mirror, over the largest."""
    a, b = (r.history.contacts[PAIR] for r in (result, other))
    mirror = np.array([1.0, -1.0, 1.0])
    size = max(float(np.abs(a.force).max()), 1e-9 * LOAD)
    peak = max(float(a.pressure.max()), 1.0)
    return [
        Finding("force in the mirror", float(np.abs(a.force - mirror * b.force).max()) / size, 1e-6, 1e-3),
        Finding("moment in the mirror", float(np.abs(a.torque + mirror * b.torque).max()) / (size * ARM), 1e-6, 1e-3),
        Finding("peak in the mirror", abs(float(a.pressure.max() - b.pressure.max())) / peak, 1e-6, 1e-3),
    ]


def _case(name: str, skew: float, geometry: str) -> Case:
    return Case(
        name,
        f"Rollers skewed by {1e3 * skew:g} mrad and tilted by {1e3 * TILT:g} mrad are pressed together: {geometry}.",
        partial(scene_of, skew), 0.06, check, twin=partial(scene_of, skew, -1.0), alike=alike, most_steps=2000,
    )  # fmt: skip


CASE = _case("misaligned rollers", 2e-3, "a load that is larger at one end, gaps along lines of centres")
SKEWED = _case("skewed rollers", 3e-2, "gaps at points")
