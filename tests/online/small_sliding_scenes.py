"""Two blocks of steel, one on the other, that a small-sliding contact joins: 60 x 20 mm, each 20 mm high, the lower one
on the ground."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800.0)
SIZE = (0.06, 0.02, 0.02)  # m, of a block
HIGHEST = 1.2e5  # Hz, of the modes of a block
LOAD = 2000.0  # N, presses both together


@lru_cache(maxsize=16)
def block(cells: tuple[int, int, int], by: str, ends: tuple[str, str]) -> ReducedBody:
    """A block held at the face `ends[0]`, with a small-sliding contact face "face" at `ends[1]`."""
    held, free = ends
    return reduce(
        box(SIZE, cells, order=1), STEEL, interfaces={held: "rigid"}, contact={"face": Matched(first=free, by=by)},
        max_frequency=HIGHEST, cache=False, progress=False,
    )  # fmt: skip


@lru_cache(maxsize=4)
def whole(cells: tuple[int, int, int]) -> ReducedBody:
    """Both blocks in one, of the same elements."""
    mesh = box((SIZE[0], SIZE[1], 2.0 * SIZE[2]), (cells[0], cells[1], 2 * cells[2]), order=1)
    return reduce(
        mesh, STEEL, interfaces={"z_min": "rigid", "z_max": "rigid"}, max_frequency=HIGHEST, cache=False,
        progress=False,
    )  # fmt: skip


def two_blocks(
    cells: tuple[int, int, int] = (6, 2, 2), by: str = "facets", friction: float = 0.3, pull: Any = 0.0
) -> Scene:
    """The blocks pressed together at the top by `LOAD`, and pulled along x by `pull` [N or a signal]."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    base = scene.add_body(block(cells, by, ("z_min", "z_max")), name="base", position=(0.0, 0.0, 0.01))
    top = scene.add_body(block(cells, by, ("z_max", "z_min")), name="top", position=(0.0, 0.0, 0.03))
    scene.add(joints.Fixed(scene.ground, base["z_min"]))
    scene.add(Contact(top["face"], base["face"], sliding="small", friction=friction, name="lap"))
    scene.add(forces.PointForce(top["z_max"], (pull, 0.0, -LOAD)))
    return scene


def one_block(cells: tuple[int, int, int] = (6, 2, 2)) -> Scene:
    """The same without a joint."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(whole(cells), name="whole", position=(0.0, 0.0, 0.02))
    scene.add(joints.Fixed(scene.ground, body["z_min"]))
    scene.add(forces.PointForce(body["z_max"], (0.0, 0.0, -LOAD)))
    return scene
