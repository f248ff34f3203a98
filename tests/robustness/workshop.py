"""Mistakes of a first hour: what one is, and the scene that they are made in.

A mistake is a call that a user makes by mistake; the answer is the message of the error that it raises, or the warnings
that it logs where the input is valid and only hardly meant. `words` are parts of it: the name of the thing and what to
do. Mistakes that show only in a run are in `tests/online/run/test_forgotten_items.py` and
`tests/online/lumped/test_unloaded_contacts.py`; those of result files in `tests/output/files/test_results_file.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import warpffrf as wf

DATA = Path(__file__).resolve().parents[1] / "data"
STEEL = wf.Material(210e9, 0.3, 7850, name="steel")
ORIGIN = (0.0, 0.0, 0.0)
BOLT = """*NODE
1, 0, 0, 0
2, 10, 0, 0
3, 10, 10, 0
4, 0, 10, 0
5, 0, 0, 10
6, 10, 0, 10
7, 10, 10, 10
8, 0, 10, 10
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
*SURFACE, NAME=BOTTOM
1, S1
"""


@dataclass(frozen=True)
class Mistake:
    """What a user means to do (`name`), the call, and words of the answer."""

    name: str
    call: Callable[[Workshop], Any]
    words: tuple[str, ...]


@cache
def roller_mesh() -> wf.mesh.Mesh:
    return wf.mesh.roller(0.05, 0.015, 0.02, sectors=12, layers=1, axial=1, order=1)


@cache
def reduced() -> Any:
    """A steel roller, coarse, with a bore and a rim."""
    return reduce_roller(modes=0)


def reduce_roller(material: Any = STEEL, mesh: Any = None, **options: Any) -> Any:
    given: dict[str, Any] = {"interfaces": {"bore": "rigid"}, "contact": {"rim": wf.surfaces.Cylinder()}}
    given |= {"cache": False, "progress": False, **options}
    return wf.reduce(roller_mesh() if mesh is None else mesh, material, **given)


class Workshop:
    """A scene of a user: a flexible roller `lower`, a rigid `slider` on a prismatic joint, a floor; and a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
        self.lower = self.scene.add_body(reduced(), name="lower", position=(0.0, 0.0, 0.2))
        self.slider = self.scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="slider")
        self.guide = wf.joints.Prismatic(self.scene.ground, self.slider.at(ORIGIN), axis=(0, 0, 1), name="guide")
        self.scene.add(self.guide)
        self.floor = self.scene.ground.surface(
            wf.surfaces.Plane(origin=(0.0, 0.0, 0.1), outward=(0.0, 0.0, 1.0)), name="floor"
        )

    def file(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text)
        return path

    def run(self, **options: Any) -> Any:
        return wf.simulate(self.scene, **{"duration": 0.01, "step": 1e-3, "progress": False, **options})


def other_scene_body() -> Any:
    return wf.Scene().add_rigid_body(1.0, (1, 1, 1), name="crank")


def untyped(call: Any) -> Any:
    """A callable of which a type checker knows nothing, to be called wrongly."""
    return call
