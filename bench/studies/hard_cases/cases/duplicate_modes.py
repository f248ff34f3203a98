r"""A cantilever whose global modes come from snapshots that are there twice, and nearly twice.

Its interfaces have their attachment modes; the snapshots, bending shapes s^2 to s^4 along the beam in two directions,
are repeated exactly, to 1e-6 and to 1e-10. As the beam is as stiff to either side, its frequencies come in pairs, too.
The basis has to leave out what is there already: the tip that is loaded at once swings as that of the beam with each
snapshot once, and comes to rest by the closed form, F L^3/(3 E I).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import bases, reduce
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
LENGTH, SIDE, FORCE, DAMPING = 0.4, 0.01, 10.0, 0.5  # m, m, N, ratio of the free beam's modes
STATIC = FORCE * LENGTH**3 / (3.0 * STEEL.youngs_modulus * SIDE**4 / 12.0)  # m
NEARLY = (0.0, 1e-6, 1e-10)
SETTLED = 0.25  # s: a hundredth of the swing is left


@lru_cache
def _beam(often: bool) -> ReducedBody:
    mesh = box((LENGTH, SIDE, SIDE), (10, 1, 1), center=(0.5 * LENGTH, 0.0, 0.0), order=2, name="beam")
    s, zero = mesh.points[:, 0] / LENGTH, np.zeros(len(mesh.points))
    shapes = [np.stack(f, axis=1) for n in (2, 3, 4) for f in ((zero, s**n, zero), (zero, zero, s**n))]
    if often:
        other = np.stack([zero, s**5, s**5], axis=1)
        shapes = [shape + near * other for near in NEARLY for shape in shapes]
    return reduce(
        mesh, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, cache=False, progress=False,
        basis=bases.POD(snapshots=np.stack(shapes, axis=2), tolerance=1e-5),
    )  # fmt: skip


def _scene(often: bool) -> Scene:
    scene = Scene()
    beam = scene.add_body(_beam(often), name="beam", damping=DAMPING)
    scene.add(joints.Fixed(scene.ground, beam["x_min"], name="root"))
    scene.add(forces.PointForce(beam["x_max"], (0.0, 0.0, -FORCE), name="load"))
    return scene


def build() -> Scene:
    """Each snapshot three times, or nearly."""
    return _scene(True)


def build_once() -> Scene:
    """Each snapshot once."""
    return _scene(False)


def tip(result: Result) -> np.ndarray:
    """How far the tip has come down (T,) [m] from the line that the root holds."""
    beam = result.history.scene.body("beam").reduced
    root, end = beam.interfaces["x_min"], beam.interfaces["x_max"]
    return -(result.body("beam").modal @ (end.modes[:, 2] - root.modes[:, 2] + LENGTH * root.modes[:, 4]))


def check(result: Result) -> list[Finding]:
    """The tip at rest."""
    if result.time[-1] < SETTLED:
        return []
    late = result.time > 0.9 * result.time[-1]
    return [Finding("tip at rest", abs(float(tip(result)[late].mean()) / STATIC - 1.0), 2e-2, 1e-1)]


def alike(result: Result, other: Result) -> list[Finding]:
    """The tips of the two beams, over the static deflection."""
    return [Finding("next to each snapshot once", float(np.abs(tip(result) - tip(other)).max()) / STATIC, 1e-4, 1e-2)]


CASE = Case(
    "duplicate modes",
    "A cantilever with modes from snapshots that are there three times, exactly and to 1e-10: as with each one once.",
    build, 0.3, check, twin=build_once, alike=alike, middle=1e-4, most_steps=4000,
)  # fmt: skip
