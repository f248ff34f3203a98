"""Pictures of mode shapes: where deformed and undeformed skins are, which moment is drawn, bodies without a skin."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import warpffrf as wf
from warpffrf.model import joints
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.plots.modes import CORNERS, MovedSkin, draw_shape, eye_axes, outward, skins_of

SIZE = np.array([0.3, 0.02, 0.1])  # m
RADIUS, LENGTH, MASS, LEVEL = 0.03, 0.08, 2.0, -0.53  # m, m, kg, m: the bob and its floor
SIDES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def polygons(ax: Any) -> list[np.ndarray]:
    """Corners (t, 3, 2) of the undeformed and the deformed skin."""
    return [np.array([path.vertices[:3] for path in c.get_paths()]) for c in ax.collections]


def test_the_moment_at_which_it_is_farthest_is_drawn_over_the_undeformed_skin() -> None:
    """One corner goes by 2i along the middle extent, another by 1: at the first one's farthest the other is at rest."""
    points = CORNERS * SIZE
    u = np.zeros((8, 3), dtype=complex)
    u[3, 2], u[5, 1] = 2j, 1.0
    ax = Figure().add_subplot()
    draw_shape(ax, [MovedSkin(points, SIDES, u)], "one", drawn=0.1)
    still, moved = polygons(ax)
    seen = points @ eye_axes(points).T
    expected = seen.copy()
    expected[3] += eye_axes(points) @ [0.0, 0.0, 0.1 * SIZE[0]]

    def near(found: np.ndarray, corners: np.ndarray) -> float:
        away = np.linalg.norm(found.reshape(-1, 1, 2) - corners[:, :2], axis=2)
        return float(away.min(axis=1).max())

    assert near(still, seen) < 1e-12 and near(moved, expected) < 1e-12 and near(moved, seen) > 0.05 * SIZE[0]
    assert ax.get_title() == "one" and len(still) == 6  # three sides of a box are seen
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    assert np.all(moved.reshape(-1, 2) > low) and np.all(moved.reshape(-1, 2) < high)


def test_triangles_are_rotated_outwards() -> None:
    inside_out = MovedSkin(CORNERS, SIDES[:, ::-1], 0.0 * CORNERS)
    assert np.array_equal(outward(inside_out).triangles, SIDES)
    assert np.array_equal(outward(MovedSkin(CORNERS, SIDES, 0.0 * CORNERS)).triangles, SIDES)


def test_modes_of_a_scene_are_drawn(body: ReducedBody) -> None:
    """A pendulum with a rigid cylinder, clear of the floor, and a fixed roller: both are there, the swinging one moves
    about its hinge, and the cylinder has its radius and the length of its inertia."""
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    across = MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0
    skin = wf.surfaces.Cylinder(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    bob = scene.add_rigid_body(
        MASS, (across, 0.5 * MASS * RADIUS**2, across), name="bob", position=(0.3, 0.0, -0.5), surfaces={"skin": skin}
    )
    plane = wf.surfaces.Plane(origin=(0, 0, LEVEL - 1e-3), outward=(0, 0, 1))
    floor = scene.ground.surface(plane, name="floor")
    scene.add(wf.LumpedContact(bob["skin"], floor, law=wf.laws.PalmgrenLine(LENGTH), name="clear"))
    scene.add(joints.Revolute(scene.ground, bob.at((0, 0, 0.5)), axis=(0, 1, 0)))
    roller = scene.add_body(body, name="roller", position=(1.0, 0.0, 0.0))
    scene.add(joints.Fixed(scene.ground, roller["bore"]))
    modes = wf.eigenmodes(scene, 3, progress=False)
    swings = int(np.argmax([modes.energy_shares(i)["bob"] for i in range(len(modes))]))
    skin, solid = skins_of(modes, swings)
    assert skin.points == pytest.approx(body.surface.points + [1.0, 0.0, 0.0], abs=1e-6)
    away = solid.points - [0.3, 0.0, -0.5]
    round_ = away[away[:, 2] <= 0.0]  # a rod leads upwards, to the hinge
    assert np.hypot(round_[:, 0], round_[:, 2]).max() == pytest.approx(RADIUS, rel=1e-9)
    assert np.ptp(round_[:, 1]) == pytest.approx(LENGTH, rel=1e-9)
    from_hinge = solid.points - [0.3, 0.0, 0.0]
    turned = np.cross([0.0, 1.0, 0.0], from_hinge)
    rate = modes.shape(swings, "bob").rotation[1]
    assert solid.displacement == pytest.approx(rate * turned, abs=1e-9 * abs(rate))
    far = np.abs(solid.displacement).max()
    assert np.abs(skin.displacement).max() < 1e-6 * far
    ax = modes.plot_shape(swings)
    still, moved = polygons(ax)
    assert np.all(np.isfinite(moved)) and len(still) == len(moved) > len(SIDES) // 2
    assert f"{modes.frequencies[swings]:.5g} Hz" in ax.get_title()
    figure = modes.plot_shapes(2)
    assert [ax.get_title().partition(":")[0] for ax in figure.axes] == ["0", "1"]
    with pytest.raises(InputError, match="mode 9 does not exist"):
        modes.plot_shape(9)
    with pytest.raises(InputError, match="scale must be"):
        modes.plot_shapes(scale=0.0)


def test_modes_of_a_body_are_drawn(body: ReducedBody) -> None:
    figure = body.plot_modes(1)
    (ax,) = figure.axes
    still, moved = polygons(ax)
    assert ax.get_title() == "7: 5 kHz" and np.all(np.isfinite(moved)) and len(moved) > 50 and len(still) > 50
    with pytest.raises(InputError, match="count must be"):
        body.plot_modes(0)
