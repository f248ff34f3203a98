"""Plates laid on each other come to rest under any load: places are known to round-off, which cells turn into forces
that no iteration takes away."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from small_sliding_scenes import STEEL

from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce
from warpffrf.online import find_equilibrium
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.outcome import finish

SIZE = (0.03, 0.016, 0.004)  # m
LARGE = 1e3  # N: round-off of places is nothing compared with it
PLACES = 1e-6  # N: round-off of places, 1e-15 of 0.03 m, times the stiffness of the faces, 4e10 N/m


@lru_cache(maxsize=2)
def plate(face: str, outside: str) -> ReducedBody:
    """Held at the face x_min, pressed on a part of the outside, with cells on the other side."""
    mesh = box(SIZE, (5, 3, 2), order=1).select("press", outside, lambda c: c[:, 0] > -0.005)
    return reduce(
        mesh, STEEL, interfaces={"x_min": "rigid", "press": "average"}, modes=3, contact={"face": Matched(first=face)},
        cache=False, progress=False,
    )  # fmt: skip


def plates(load: float) -> Scene:
    """Two plates held at one end, one on the other, pressed together by `load` [N]."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(plate("z_max", "z_min"), name="lower", position=(0.0, 0.0, -0.5 * SIZE[2]))
    upper = scene.add_body(plate("z_min", "z_max"), name="upper", position=(0.0, 0.0, 0.5 * SIZE[2]))
    for body, force in ((lower, load), (upper, -load)):
        scene.add(joints.Fixed(scene.ground, body["x_min"]))
        scene.add(forces.PointForce(body["press"], (0.0, 0.0, force)))
    scene.add(Contact(lower["face"], upper["face"], sliding="small", friction=0.3, name="lap"))
    return scene


def pressed(history: History) -> float:
    """Force [N] between the plates."""
    assert history.status == "completed", history.message
    return float(history.small_sliding["lap"].normal_force[0])


@pytest.mark.parametrize("load", [100.0, 5.0, 1.0, 0.01, 1e-4])
def test_plates_rest_on_each_other_under_any_load(load: float) -> None:
    """What touches, and the forces, are in proportion to small loads."""
    expected = pressed(find_equilibrium(plates(LARGE))) * load / LARGE
    rest = find_equilibrium(plates(load))
    assert pressed(rest) == pytest.approx(expected, rel=1e-4, abs=PLACES)  # plates turn by 1e-6 under LARGE
    assert not any(note.startswith("equilibrium:") for note in rest.notes)


def test_what_moves_no_more_is_not_called_a_mechanism() -> None:
    engine = Engine(plates(1.0))
    engine.scratch.dx.zero_()
    history = finish(engine, 0.0, 0.0, [], "equilibrium: ")
    assert history.status == "no_equilibrium"
    assert "no body moves any more" in history.message and "mechanism" not in history.message


def test_a_plate_that_nothing_holds_is_called_one() -> None:
    """Pulled along the other, which holds it by friction 0.3 of the pressure."""
    scene = plates(1.0)
    scene.joints.pop()
    scene.add(forces.PointForce(scene.bodies[1]["press"], (0.5, 0.0, 0.0), name="pull"))
    history = find_equilibrium(scene)
    assert history.status == "no_equilibrium"
    assert "friction of 'lap' holds" in history.message and "mechanism" in history.message
    assert np.all(np.isfinite(history.checkpoint["r"]))
