"""Skins: hat forces against quadrature, displacement against its parts, pressure at the nodes."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_run import COLUMNS, PITCH, ROWS, TURN, WIDTH, R

from warpffrf.output.bodies.normal_loads import node_areas, node_forces
from warpffrf.output.geometry.places import rotate, spread
from warpffrf.output.result import Result


def test_constant_pressure_gives_the_area(body) -> None:
    surface = body.contact_surfaces["rim"]
    forces = node_forces(surface, np.full((COLUMNS, ROWS), 3.0))
    assert forces.sum() == pytest.approx(3.0 * 2.0 * np.pi * R * WIDTH, rel=1e-12)
    assert forces == pytest.approx(3.0 * np.broadcast_to(node_areas(surface), (COLUMNS, ROWS)), rel=1e-12)


def test_node_forces_equal_the_gram_matrix(body) -> None:
    surface = body.contact_surfaces["rim"]
    values = np.random.default_rng(1).normal(size=(COLUMNS, ROWS))
    expected = surface.grid.gram_theta() @ values @ surface.gram_z
    assert node_forces(surface, values) == pytest.approx(expected, rel=1e-12)


def test_window_is_spread_modulo_the_turn(body) -> None:
    surface = body.contact_surfaces["rim"]
    whole = spread(surface, COLUMNS - 1, np.ones((2, ROWS)))
    assert np.all(whole[[-1, 0]] == 1.0) and whole.sum() == 2 * ROWS


def test_displacement_is_modes_plus_dimple(result: Result, body) -> None:
    i = 4
    skin = result.skins()["lower"]
    history = result.history
    modes = np.tensordot(history.bodies["lower"].modal[i], body.surface.modes, axes=1)
    local = skin.displacement(i) - modes
    contact = history.contacts["lower-upper"]
    surface = body.contact_surfaces["rim"]
    pressure = spread(surface, contact.first_column[i], contact.pressure[i])
    columns, rows = int(np.argmax(pressure[:, ROWS // 2])), ROWS // 2
    under = local[columns * ROWS + rows]
    assert under @ surface.shape.normal(PITCH * columns, surface.grid.z[rows]) < 0.0  # pushed inwards
    assert np.linalg.norm(under) == pytest.approx(np.linalg.norm(local, axis=1).max(), rel=0.05)
    assert np.all(local[COLUMNS * ROWS :] == 0.0)  # the bore feels none of it


def test_pressure_at_grid_nodes_is_the_coefficient(result: Result, body) -> None:
    i = 2
    contact = result.history.contacts["lower-upper"]
    expected = spread(body.contact_surfaces["rim"], contact.first_column[i], contact.pressure[i])
    pressure = result.skins()["lower"].pressure(i)
    assert pressure[: COLUMNS * ROWS].reshape(COLUMNS, ROWS) == pytest.approx(expected, rel=1e-9, abs=1.0)
    assert np.all(pressure[COLUMNS * ROWS :] == 0.0)


def test_second_surface_carries_the_same_force(result: Result, body) -> None:
    pressure = result.skins()["upper"].pressure(0)[: COLUMNS * ROWS].reshape(COLUMNS, ROWS)
    force = (pressure * node_areas(body.contact_surfaces["rim"])).sum()
    assert force == pytest.approx(result.history.contacts["lower-upper"].load_second[0].sum(), rel=1e-12)


def test_patches_of_both_bodies_meet_in_the_world(result: Result) -> None:
    """The node with the largest pressure of each body lies at the top of the lower roller, whatever the turn."""
    for i in (0, 3, 8):
        for name in ("lower", "upper"):
            skin, motion = result.skins()[name], result.body(name)
            node = int(np.argmax(skin.pressure(i)))
            place = motion.position[i] + rotate(motion.rotation[i], skin.points[node][None])[0]
            assert place[[0, 2]] == pytest.approx([0.0, R], abs=R * PITCH)


def test_rotate_matches_a_right_handed_turn() -> None:
    q = np.array([0.0, 0.0, np.sin(TURN / 2), np.cos(TURN / 2)])
    assert rotate(q, np.eye(3)[:1])[0] == pytest.approx([np.cos(TURN), np.sin(TURN), 0.0])
