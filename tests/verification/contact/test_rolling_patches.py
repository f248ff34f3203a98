"""Friction on cells of the patch, by rollers on coarse meshes: Carter, CONTACT, Kalker, Cattaneo, energy, changes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references.closed_forms import CarterRolling
from references.closed_forms import rolling_tables as published
from references.half_space.unlike_rolling import free_rolling
from scenes.rolling_pairs import (
    FRICTION,
    PAIR,
    PLANE_STEEL,
    SPEED,
    STEEL,
    Drives,
    line_contact,
    pair,
    reduced,
    roll,
    roller,
    run,
)
from studies.rolling import rolling_bodies, rolling_changes, rolling_steady
from studies.rolling.rolling_bodies import ALUMINIUM
from warpffrf import laws
from warpffrf.model.friction import FrictionLaw
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.compile.patches.plan import span_of

Array = np.ndarray

CARTER = 0.01  # of mu N; 0.7 % is found from 11 strips on
TRANSIENT = 0.02  # of mu N, at any instant
CONTACT_FORCES, BESIDE_LAW = 0.015, 0.003  # of mu N; CONTACT's own error of about 0.8 % in the first
KALKER = 0.03  # relative
MESHES = 0.015  # of mu N
# relative, creepage without a force at one load against cells of 0.6 mm: linear cells of 6, 2 and 1 mm are 0.23, 0.11
# and 0.01 % off, quadratic ones of 4 mm 0.14 %; those of 6 mm alike with 15, 21 and 31 strips
FREE, FREE_6_MM = 0.002, 0.003
AS_THEY_ARE = (
    0.004  # the same at one approach: cells of 6 mm make the bodies 0.2 % softer, and xi goes as the half-width
)
GROSS, DIRECTION = 1e-3, 0.05  # of mu N, degrees
WAY, LOSS = 0.01, 0.03  # relative
LEDGER = 0.01  # of the work of the drives, at a strip a step
PASSING = 0.01  # of the elastic energy that passes
JUMP = 0.005  # of mu N
FINE_JUMP = 0.001  # of mu N, at a quarter of a strip per step: 0.18, 0.11 and 0.02 % at 1, 0.5 and 0.25
SOLVED = 1e-6  # of the pressure, to which stick and slip are solved; 2e-7 is found
QUICK = 0.015  # of mu N: eleven strips, eight elements around, twelve crossings


def test_rollers_follow_carter_roughly() -> None:
    body = reduced(roller(4e-3, order=1), PLANE_STEEL, cache=False)
    creepage = 1.5e-3
    scene = pair(body, body, 8e-6, Drives(creepage=creepage), cells=(11, 4))
    found = roll(scene, 2.6e-4, 11, 2.0, 12.0)
    carter = CarterRolling(line_contact(found.load, PLANE_STEEL, PLANE_STEEL), FRICTION, creepage)
    assert found.share[0] == pytest.approx(-carter.share, abs=QUICK)
    assert abs(found.share[1]) < 1e-6 and found.rejected == 0


def test_gross_slip_has_the_force_and_the_direction() -> None:
    body = reduced(roller(4e-3, order=1, crown_radius=0.14), STEEL, crowned=True, cache=False)
    scene = pair(body, body, 3e-6, Drives(creepage=0.1, lateral_creepage=0.05), cells=(9, 9))
    found = roll(scene, 2.5e-4, 9, 1.0, 3.0)
    assert np.linalg.norm(found.share) == pytest.approx(1.0, abs=GROSS)
    angle = np.degrees(np.arctan2(found.share[1], found.share[0]) - np.arctan2(-0.05, -0.1))
    assert abs(angle) < DIRECTION


SPEEDS = {  # slip in these patches is up to 6 mm/s
    "falls": laws.Stribeck(0.4, 0.2, 0.02, exponent=1.0),
    "rises": laws.TabulatedFriction((0.0, 1e-3, 3e-3), (0.1, 0.3, 0.5)),
}


@pytest.fixture(scope="module")
def roller_of_strain() -> ReducedBody:
    return reduced(roller(4e-3, order=1), PLANE_STEEL, cache=False)


def at_the_end(body: ReducedBody, law: FrictionLaw, creepage: float) -> tuple[Array, Array, Array, Array]:
    """Traction (2, cells), slip velocity, pressure and state of cells which the patch has not just reached: those
    slip by their share of the step in the law, by all of it in the record."""
    scene = pair(body, body, 8e-6, Drives(creepage=creepage), cells=(11, 4), friction=law)
    result = run(scene, 50, 2.0 * span_of(11) * 2.6e-4 / 11 / SPEED)
    contact: Any = result.history.contacts[PAIR]
    assert np.all(np.diff(result.energy["friction"]) <= 0.0)
    rubbing, there = contact.friction, slice(3, None)  # two strips outside of the patch, one reached
    return (
        rubbing.traction[-1][:, there], rubbing.slip_velocity[-1][:, there], contact.pressure[-1][there],
        rubbing.state[-1][there],
    )  # fmt: skip


@pytest.mark.parametrize("name", list(SPEEDS))
@pytest.mark.parametrize("creepage", [1.5e-3, 8e-3])
def test_a_coefficient_of_the_slip_speed(roller_of_strain: ReducedBody, name: str, creepage: float) -> None:
    law = SPEEDS[name]
    traction, slip, pressure, state = at_the_end(roller_of_strain, law, creepage)
    size, speed = np.linalg.norm(traction, axis=0), np.linalg.norm(slip, axis=0)
    bound = np.where(state == 2, law.coefficient_at(speed), law.static_coefficient) * pressure
    assert np.all(size <= bound + SOLVED * pressure.max())
    np.testing.assert_allclose(size[state == 2], bound[state == 2], atol=SOLVED * pressure.max(), rtol=0.0)
    assert np.any(state == 2) and speed.max() > 1e-3


def test_the_regularised_law_creeps(roller_of_strain: ReducedBody) -> None:
    traction, slip, pressure, state = at_the_end(roller_of_strain, laws.RegularisedCoulomb(FRICTION, 1e-3), 1.5e-3)
    size = np.linalg.norm(slip, axis=0)
    expected = -FRICTION * pressure * slip / np.maximum(size, 1e-3)
    np.testing.assert_allclose(traction, expected, atol=SOLVED * pressure.max(), rtol=0.0)
    assert np.any(state == 1) and np.any(state == 2)


def test_half_planes_that_differ_creep_without_a_force() -> None:
    """Of opposite signs with the bodies changed; 2/pi with continuous adhesion, which few cells do not reach."""
    forth, _ = free_rolling(STEEL, ALUMINIUM, 0.025, 1.9e5, 1.0, 6)
    back, _ = free_rolling(ALUMINIUM, STEEL, 0.025, 1.9e5, 1.0, 6)
    hertz = rolling_bodies.LineContact(1.9e5, 0.025, rolling_bodies.contact_modulus(STEEL, ALUMINIUM))
    assert forth == pytest.approx(-back, rel=1e-6)
    assert rolling_bodies.scaled(forth, hertz) == pytest.approx(2.0 / np.pi, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("advance", [0.5, 1.0, 1.37, 2.0])
@pytest.mark.parametrize("strips", [11, 15, 21])
def test_carter(strips: int, advance: float) -> None:
    for creepage in rolling_steady.CREEPAGES:
        error, found = rolling_steady.carter_error(strips, advance, creepage)
        print(f"{strips} strips, {advance} a step, {creepage}: {error:+.2%}")
        assert abs(error) < CARTER
        assert found.rejected == 0


@pytest.mark.slow
@pytest.mark.parametrize("advance", [0.5, 1.37, 2.0])
def test_from_cattaneo_to_carter(advance: float) -> None:
    assert rolling_steady.transient_error(11, advance) < TRANSIENT


@pytest.mark.slow
def test_eurosprinter() -> None:
    for creepage, wanted in published.EUROSPRINTER_FORCES:
        found, law = rolling_steady.eurosprinter(creepage, 13)
        assert found == pytest.approx(wanted, abs=CONTACT_FORCES)
        assert found == pytest.approx(law, abs=BESIDE_LAW)


@pytest.mark.slow
@pytest.mark.parametrize("poisson", [0.0, 0.25, 0.49])
@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_kalker(ratio: float, poisson: float) -> None:
    errors = rolling_steady.kalker(ratio, poisson, 21)
    print([f"{e:+.1%}" for e in errors])
    assert np.all(np.abs(errors) < KALKER)


@pytest.mark.slow
@pytest.mark.parametrize("crown", [None, rolling_steady.CROWN])
def test_meshes_agree(crown: float | None) -> None:
    found = [rolling_bodies.on_mesh(name, crown, 1.2e-3) for name in ("hex8, 4 mm", "tet10, 4 mm", "hex8, 2 mm")]
    shares = [abs(float(f.share[0])) for f in found]
    assert np.ptp(shares) < MESHES
    if crown is None:
        carter = CarterRolling(line_contact(found[0].load, STEEL, STEEL), FRICTION, 1.2e-3)
        assert shares[0] == pytest.approx(carter.share, abs=MESHES)


@pytest.mark.slow
def test_unlike_bodies_creep_alike_on_any_mesh() -> None:
    found = np.array([rolling_bodies.unlike_on(name) for name in rolling_bodies.UNLIKE_MESHES])
    print(found)
    errors = dict(zip(rolling_bodies.UNLIKE_MESHES, np.abs(found[:, 1] / found[-1, 1] - 1.0), strict=True))
    linear = [errors[f"hex8, {size} mm"] for size in (6, 2, 1)]
    assert linear[0] < FREE_6_MM
    assert errors["hex27, 4 mm"] < FREE
    assert linear[0] > 1.5 * linear[1] > 6.0 * linear[2]
    assert np.ptp(found[:, 0]) < AS_THEY_ARE * abs(found[-1, 0])


@pytest.mark.slow
def test_gross_slip() -> None:
    for error, angle in (rolling_bodies.gross(-0.05, 0.0866), rolling_bodies.slid(30.0), rolling_bodies.slid(-120.0)):
        assert abs(error) < GROSS
        assert abs(angle) < DIRECTION


@pytest.mark.slow
@pytest.mark.parametrize("point", [False, True])
def test_cattaneo(point: bool) -> None:
    found = rolling_changes.cattaneo(31, point=point)
    print(found)
    assert abs(found.way) < WAY
    assert abs(found.loss) < LOSS
    assert abs(found.stick) < found.cell


@pytest.mark.slow
def test_work() -> None:
    found = rolling_changes.locked()
    assert found.gained <= 0.0
    assert found.lost < PASSING * found.passing
    assert found.share < 0.01
    assert abs(rolling_changes.ledger(11, 1.0, 0.5)) < LEDGER


@pytest.mark.slow
@pytest.mark.parametrize("point", [False, True])
def test_patches_that_grow_and_shrink(point: bool) -> None:
    found = rolling_changes.swelling(15, 1.0, point=point)
    assert found.rejected == 0
    assert found.force < JUMP
    assert rolling_changes.parted(21, 1.0, point=point).force < JUMP


@pytest.mark.slow
def test_jumps_of_contact_lost_and_back_go_with_the_steps() -> None:
    assert rolling_changes.parted(21, 0.25, point=False).force < FINE_JUMP


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [0.0, rolling_changes.TILTED])
def test_patches_that_split(tilt: float) -> None:
    """Into two that stay, or one of which goes; rows that open or close carry no pressure then, so that no force jumps:
    what is found falls with the cells."""
    found = rolling_changes.split(15, 1.0, 21, tilt=tilt)
    print(found)
    assert found.changes == 2 * rolling_changes.SPLITS
    assert (found.open_rows > 2) == (tilt == 0.0)
    assert found.jumps.rejected == 0
    assert found.jumps.force < JUMP
    assert found.jumps.load < JUMP
    assert rolling_changes.split(15, 1.0, 21, tilt=tilt, friction=0.0).jumps.load < JUMP
