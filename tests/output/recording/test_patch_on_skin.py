"""Tractions on the skins of both bodies: action and reaction, places, and the displacement that they cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rubbing_run import make_rubbing_history
from synthetic_run import COLUMNS, HALF_WIDTH, ROWS, R, make_history, roller

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import Recovery, Tangential
from warpffrf.output.bodies.patch_on_skin import cell_areas, tangential_forces
from warpffrf.output.geometry.places import grid_theta_offset, rotate, tangents
from warpffrf.output.result import Result

SOFT = 1e-9  # m/N, of a rim node under the force of its cell


@pytest.fixture
def rubbing(body) -> Result:
    return Result(make_rubbing_history(body))


def tangential_roller() -> ReducedBody:
    """The roller whose rim nodes move along the force of their own cell."""
    body = roller()
    rim = body.contact_surfaces["rim"]
    n = COLUMNS * ROWS
    theta, z = (v.ravel() for v in np.meshgrid(rim.grid.theta, rim.grid.z, indexing="ij"))
    axes = tangents(rim.shape, theta, z)  # (2, n, 3)
    transfer = np.zeros((2 * n, 3, 2 * n), dtype=np.float32)
    for d in range(2):
        transfer[np.arange(n), :, d * n + np.arange(n)] = SOFT * axes[d]
    recovery = Recovery(transfer.reshape(1, -1, 2 * n), 1, np.eye(3))
    none = np.zeros((1, 1, 1))
    tangential = Tangential(
        replace(rim.grid, kind="cells", columns_per_sector=COLUMNS), none, none, np.zeros((2, n, 2)), recovery
    )
    return replace(body, contact_surfaces={"rim": replace(rim, tangential=tangential)})


def world_wrench(result: Result, forces: np.ndarray, name: str, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque about the world's origin of tangential forces (2, columns, rows) on the rim of a body."""
    surface = result.view.bodies[name].surface("rim")
    theta, z = (v.ravel() for v in np.meshgrid(surface.grid.theta, surface.grid.z, indexing="ij"))
    theta = theta + grid_theta_offset(surface)
    e_theta, t_z = tangents(surface.shape, theta, z)
    f = forces[0].reshape(-1, 1) * e_theta + forces[1].reshape(-1, 1) * t_z
    motion = result.body(name)
    world = rotate(motion.rotation[i], f)
    points = motion.position[i] + rotate(motion.rotation[i], surface.shape.point(theta, z))
    return world.sum(axis=0), np.cross(points, world).sum(axis=0)


@pytest.mark.parametrize("i", [0, 3, 8])
def test_forces_on_both_surfaces_are_opposite(rubbing: Result, i: int) -> None:
    pair, contact = rubbing.view.pairs["lower-upper"], rubbing.history.contacts["lower-upper"]
    contact.friction.traction[:, 1] = 0.3 * contact.friction.traction[:, 0]  # type: ignore[union-attr]
    bodies = rubbing.history.bodies
    own = tangential_forces(pair, contact, bodies, i, first=True)
    other = tangential_forces(pair, contact, bodies, i, first=False)
    force, torque = world_wrench(rubbing, own, "lower", i)
    back, twist = world_wrench(rubbing, other, "upper", i)
    assert force[0] > 0.0 and force[1] != 0.0
    # the surfaces part by x^2/R at the rim of the patch; their tangents turn by x/R away from each other, which leaves
    # a force between the axles and a torque of it
    angle, size = HALF_WIDTH / R, float(np.linalg.norm(force))
    assert back[:2] == pytest.approx(-force[:2], abs=angle**2 * size)
    assert back[2] == pytest.approx(-force[2], abs=angle * size)
    assert twist == pytest.approx(-torque, abs=angle**2 * R * size)
    assert other[1].sum() == pytest.approx(-own[1].sum(), rel=1e-9)  # t_z is the same axis on both


def test_first_surface_carries_traction_times_area(rubbing: Result) -> None:
    i = 2
    pair, contact = rubbing.view.pairs["lower-upper"], rubbing.history.contacts["lower-upper"]
    forces = tangential_forces(pair, contact, rubbing.history.bodies, i, first=True)
    sums = rubbing.contact("lower-upper").friction.tangential_force[i]
    assert forces.sum(axis=(1, 2)) == pytest.approx(sums)
    assert cell_areas(pair.first).sum() * COLUMNS == pytest.approx(2.0 * np.pi * R * 0.02, rel=1e-12)


def test_tractions_on_the_skins_point_against_each_other(rubbing: Result) -> None:
    i = 4
    worlds = {}
    for name, skin in rubbing.skins().items():
        motion = rubbing.body(name)
        tau = rotate(motion.rotation[i], skin.traction(i))
        strongest = np.argmax(np.linalg.norm(tau, axis=1))
        place = motion.position[i] + rotate(motion.rotation[i], skin.points[strongest][None])[0]
        assert place[2] == pytest.approx(R, abs=0.02 * R)  # at the patch, also on the upper roller
        worlds[name] = tau[strongest]
    assert worlds["lower"][0] > 0.0 and worlds["upper"][0] < 0.0
    assert worlds["upper"] == pytest.approx(-worlds["lower"], rel=0.15, abs=0.1 * np.abs(worlds["lower"]).max())


def test_fields_on_the_skin(rubbing: Result) -> None:
    i = 4
    contact = rubbing.contact("lower-upper")
    for skin in rubbing.skins().values():
        assert skin.contact_fields == ("pressure", "traction", "slip", "state", "wear")
        states = skin.contact_field("state", i)
        on_rim = np.hypot(skin.points[:, 0], skin.points[:, 2]) > 0.9 * R
        assert set(np.unique(states[on_rim])) == {0, 1, 2} and np.all(states[~on_rim] == 0)
        assert skin.contact_field("slip", i).max() <= contact.friction.slip_speed[i].max() * (1.0 + 1e-12)
        assert np.all(skin.contact_field("slip", i)[~on_rim] == 0.0)
        size = skin.contact_field("traction", i).max()
        assert 0.8 * contact.friction.traction_magnitude[i].max() < size
        with pytest.raises(InputError, match="contact field 'heat' does not exist; known: 'pressure', 'traction'"):
            skin.contact_field("heat", i)
    # at the nodes of the first surface's grid the fields are those of the cells
    lower = rubbing.skins()["lower"].slip_speed(i)[: COLUMNS * ROWS].reshape(COLUMNS, ROWS)
    assert np.sort(lower[lower > 0.0]) == pytest.approx(
        np.sort(contact.friction.slip_speed[i][contact.friction.slip_speed[i] > 0.0])
    )


def test_without_friction_there_is_only_pressure(result: Result) -> None:
    skin = result.skins()["lower"]
    assert skin.contact_fields == ("pressure",) and np.all(skin.traction(0) == 0.0)
    with pytest.raises(InputError, match="'traction' does not exist; known: 'pressure'"):
        skin.contact_field("traction", 0)


def test_tangential_forces_move_the_skin() -> None:
    body = tangential_roller()
    plain, rubbing = Result(make_history(body)), Result(make_rubbing_history(body))
    i = 3
    areas = cell_areas(body.contact_surfaces["rim"])
    for name, sign in (("lower", 1.0), ("upper", -1.0)):
        moved = rubbing.skins()[name].displacement(i) - plain.skins()[name].displacement(i)
        world = rotate(rubbing.body(name).rotation[i], moved)
        rim = world[: COLUMNS * ROWS].reshape(COLUMNS, ROWS, 3)
        assert np.all(world[COLUMNS * ROWS :] == 0.0)
        assert sign * rim[:, 1, 0].sum() > 0.0
        total = np.abs(rubbing.contact("lower-upper").friction.tangential_force[i, 0])
        assert np.linalg.norm(rim, axis=2).sum() == pytest.approx(SOFT * total, rel=0.01)
        assert areas.shape == (ROWS,)
