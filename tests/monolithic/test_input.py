"""What the monolithic solver refuses, and how it fails."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pytest
from mass_point_body import mass_point_body

from references import monolithic
from references.monolithic.core import local_coordinates
from scenes.rollers import PAIR, guided_pair
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce

STEEL = Material(210e9, 0.3, 7850.0)
PLANE = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))


def falling() -> Scene:
    scene = Scene(gravity=(0, 0, -9.81))
    scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="stone")
    return scene


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"variant": "fast"}, "variant"),
        ({"law": "points"}, "law"),
        ({"local": "exponential"}, "local"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"layer_stiffness": -1.0}, "layer_stiffness"),
        ({"layer_stiffness": 1e12}, "law='nodes'"),
        ({"step": 2.0}, "longer"),
        ({"save_every": 0}, "save_every"),
        ({"start": "rest"}, "start"),
        ({"integrator": 7}, "integrator"),
        ({"local_damping": -0.1}, "local_damping"),
    ],
)
def test_wrong_arguments(more: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word):
        monolithic.run(falling(), 1.0, **{"step": 0.1, "progress": False, **more})


def test_wrong_scenes(roller, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="no bodies"):
        monolithic.run(Scene(), 1.0, step=0.1)
    scene = falling()
    hinge = scene.add(joints.Fixed(scene.ground, scene.bodies[0].at((0, 0, 0)), name="hold"))
    slide = scene.add(joints.Prismatic(scene.ground, scene.bodies[0].at((0, 0, 0)), axis=(0, 0, 1), name="slide"))
    scene.add(joints.Drive(slide, signals.Ramp(0.0, 1.0, duration=1.0)))
    with pytest.raises(InputError, match="fixed already"):
        monolithic.run(scene, 1.0, step=0.1)
    assert hinge.name == "hold"
    scene = guided_pair(roller, roller)
    with pytest.raises(InputError, match="local_dynamics"):
        monolithic.run(scene, 1e-3, step=1e-4, local="hht")
    wrong = type("Modes", (), {"omega": np.ones(3), "trace": np.ones((5, 3)), "residual_lags": None})()
    with pytest.raises(InputError, match="trace"):
        monolithic.run(scene, 1e-3, step=1e-4, local="hht", local_modes={("lower", "rim"): wrong})
    monkeypatch.setattr(local_coordinates, "MOST_COORDINATES", 100)
    with pytest.raises(InputError, match="lower.*local coordinates"):
        monolithic.run(scene, 1e-3, step=1e-4)


def test_inertia_that_the_body_lacks() -> None:
    scene, body = Scene(), mass_point_body(3)
    scene.add_body(body, name="a", inertia="full", stiffening=True)
    with pytest.raises(InputError, match="stiffening=True"):
        monolithic.run(scene, 1.0, step=0.1)
    object.__setattr__(body, "inertia_terms", None)
    scene = Scene()
    scene.add_body(body, name="a", inertia="full")
    with pytest.raises(InputError, match="needs inertia terms"):
        monolithic.run(scene, 1.0, step=0.1)


def test_a_history_of_another_scene_is_refused() -> None:
    history = monolithic.run(falling(), 0.2, step=0.1, progress=False)
    other = falling()
    other.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="second")
    with pytest.raises(InputError, match="another scene"):
        monolithic.run(other, 0.2, step=0.1, start=history, progress=False)


def test_a_layer_is_not_covered(roller) -> None:
    scene = guided_pair(roller, roller, load=1e3)
    scene.contacts[0].law = laws.LinearLayer(1e12)
    with pytest.raises(InputError, match="has no linear_layer"):
        monolithic.run(scene, 1e-3, step=1e-4, progress=False)


def test_what_it_does_not_have() -> None:
    """Friction in joints, lumped contacts and small-sliding contacts are refused, with the cure."""
    scene = falling()
    pin = scene.add(joints.Revolute(scene.ground, scene.bodies[0].at((0, 0, 0)), axis=(0, 1, 0), name="pin"))
    scene.add(forces.RevoluteFriction(pin, 0.3, pin_radius=0.01, name="rub"))
    with pytest.raises(InputError, match="'rub'.*has no friction in joints; use warpffrf.simulate"):
        monolithic.run(scene, 1.0, step=0.1)
    scene = Scene()
    floor = scene.ground.surface(PLANE, name="floor")
    ball = surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    body = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="ball", position=(0, 0, 0.01), surfaces={"skin": ball})
    scene.add(LumpedContact(body["skin"], floor, law=laws.HertzPoint(STEEL, STEEL), name="spot"))
    with pytest.raises(InputError, match="lumped contact 'spot': .*has no lumped contacts; use warpffrf.simulate"):
        monolithic.run(scene, 1.0, step=0.1)
    block = reduce(
        box((0.02, 0.02, 0.02), (2, 2, 2), order=1), STEEL, contact={"foot": Matched(first="z_min")}, modes=4,
        cache=False, progress=False,
    )  # fmt: skip
    scene = Scene()
    held = scene.add_body(block, name="block", position=(0.0, 0.0, 0.01))
    scene.add(Contact(held["foot"], scene.ground.surface(PLANE, name="floor"), sliding="small", name="lap"))
    with pytest.raises(InputError, match="contact 'lap': .*has no small sliding; use warpffrf.simulate"):
        monolithic.run(scene, 1.0, step=0.1)


def test_a_mechanism_without_a_load_path_has_no_equilibrium() -> None:
    history = monolithic.run(falling(), 0.2, step=0.1, start="equilibrium", progress=False)
    assert history.status == "no_equilibrium" and "rest" in history.message


def test_an_interrupted_run_keeps_what_was_found(roller, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in the fourth step leaves the start and three steps."""
    scene = guided_pair(roller, roller, load=1e3)
    run_module = importlib.import_module("references.monolithic.run")
    real = run_module.solve_step

    def broken(*args: Any) -> Any:
        if args[3] > 3.5e-4:
            raise KeyboardInterrupt
        return real(*args)

    monkeypatch.setattr(run_module, "solve_step", broken)
    history = monolithic.run(scene, 1e-3, step=1e-4, progress=False, variant="low_rank")
    assert history.status == "interrupted" and len(history.time) == 4
    assert len(history.contacts[PAIR].force) == len(history.energy["kinetic"]) == 4


def test_a_step_that_fails_says_why_and_keeps_the_rest() -> None:
    """A torque that no step of this size can follow."""
    scene = falling()
    torque = signals.Table([0.0, 0.15, 0.2], [0.0, 0.0, 1e12])
    scene.add(forces.PointTorque(scene.bodies[0].at((0, 0, 0)), (torque, (1.0, 2.0, 3.0))))
    history = monolithic.run(scene, 1.0, step=0.05, progress=False)
    # what a diverging iteration meets first is a matter of its numbers
    assert history.status in ("not_converged", "not_finite", "singular") and "at 0." in history.message
    assert len(history.time) >= 4
