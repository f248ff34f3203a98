"""Two contact pairs in one scene: windows, events and ledger of each."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import PAIR, Path, StaticPath, prescribed_pair, roller_body
from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings, find_equilibrium, run

GRAVITY = 9.81


def add_stack(
    scene: Scene, first: ReducedBody, second: ReducedBody, name: str, x: float, *, gap: float, load: float
) -> Contact:
    """A clamped roller at (x, 0, 0) and one above it on a vertical guide, `gap` [m] apart, pressed by `load` [N]."""
    radii = sum(b.contact_surfaces["rim"].shape.radius for b in (first, second))
    below = scene.add_body(first, name=f"{name} below", position=(x, 0.0, 0.0))
    above = scene.add_body(second, name=f"{name} above", position=(x, 0.0, radii))
    contact = scene.add(Contact(below["rim"], above["rim"], name=name))
    scene.close_gap(contact, along=(0.0, 0.0, 1.0), gap=gap)
    scene.add(joints.Fixed(scene.ground, below["bore"], name=f"{name} clamp"))
    scene.add(joints.Prismatic(scene.ground, above["bore"], axis=(0, 0, 1), name=f"{name} guide"))
    scene.add(forces.PointForce(above["bore"], (0.0, 0.0, -load)))
    return contact


def test_each_pair_carries_its_own_load(plain_body: ReducedBody, other_body: ReducedBody) -> None:
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    loads = {"left": 200e3, "right": 50e3}
    add_stack(scene, plain_body, plain_body, "left", 0.0, gap=0.0, load=loads["left"])
    add_stack(scene, plain_body, other_body, "right", 1.0, gap=0.0, load=loads["right"])
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    for name, second in (("left", plain_body), ("right", other_body)):
        expected = -(loads[name] + GRAVITY * second.mass)
        assert rest.contacts[name].force[0, 2] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("swap", [False, True])
def test_a_wide_window_of_one_pair_reaches_the_surface_of_the_other(
    plain_body: ReducedBody, other_body: ReducedBody, swap: bool
) -> None:
    """All pairs share the widest window; of each, every node of the window that has something opposite must see it."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    wide = add_stack(scene, plain_body, plain_body, "wide", 0.0, gap=1e-6, load=0.0)
    bodies = (other_body, plain_body) if swap else (plain_body, other_body)
    narrow = add_stack(scene, *bodies, "narrow", 1.0, gap=1e-6, load=0.0)
    wide.capacity, narrow.capacity = 160, 12
    model = Engine(scene).compiled.model
    assert model.window.half >= 20
    a, b = narrow.a.surface, narrow.b.surface
    side = a.shape.radius * np.sin(min((model.window.half + 1) * a.grid.pitch, 0.5 * np.pi))
    opposite = np.arcsin(min(side / b.shape.radius, 1.0)) / b.grid.pitch
    assert model.window.second_half >= opposite


def test_an_impact_is_noticed_while_another_pair_is_in_contact(plain_body: ReducedBody) -> None:
    """The ledger of a drop at a long step: its step is halved although the other pair never parts."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    add_stack(scene, plain_body, plain_body, "pressed", 0.0, gap=0.0, load=100e3)
    add_stack(scene, plain_body, plain_body, "dropped", 1.0, gap=1e-3, load=0.0)
    pressed = scene.body("pressed above")
    pressed.position = pressed.position - np.array([0.0, 0.0, 30e-6])
    history = run(scene, 0.03, step=1e-3, progress=False)
    assert history.status == "completed", history.message
    force = np.linalg.norm(history.contacts["pressed"].force, axis=1)
    assert force.min() > 0.0
    hits = np.linalg.norm(history.contacts["dropped"].force, axis=1) > 0.0
    speed = history.bodies["dropped above"].velocity[:, 2]
    assert hits.any() or (np.diff(speed) > 0.05).any()  # it lands within the run
    assert any("energy" in note for note in history.notes), history.notes


def test_a_coarse_large_roller_first_on_a_small_one(plain_body: ReducedBody) -> None:
    """Hats at the edge of its window face a small roller's flank, spread over many of its columns: they are far from
    the patch, and no reason to fail. The force is that of gaps taken at points."""
    small = roller_body(
        96, layers=5, axial=3, grading=1.2, order=1, outer_radius=0.012, inner_radius=0.004, max_frequency=15e3,
        cache=False,
    )  # fmt: skip
    force = []
    for points in (False, True):
        scene = prescribed_pair(plain_body, small, Path.of([200e-6], 0.01, 0.02))
        found = StaticPath(scene, settings=Settings(force_points=points)).solve(1)
        assert found.status == "completed", found.message
        force.append(float(np.linalg.norm(found.contacts[PAIR].force[0])))
    assert force[0] == pytest.approx(force[1], rel=0.02)  # (half-width/radius)^2 of the small one, 2 mm of 12 mm
