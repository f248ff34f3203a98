"""Films between rough walls in the engine, compared with the dense reference, smooth walls and the ledger."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from film_scenes import CLEARANCE, LENGTH, RADIUS, SHEAR, SPEED, VISCOSITY, bearing, place, reference, turning_load

from references.films.rough_walls import RoughWalls
from warpffrf.model.films import MixedLubrication, Roughness
from warpffrf.model.films.roughness import flow_factors
from warpffrf.model.laws import GreenwoodTripp
from warpffrf.online import run
from warpffrf.online.run import find_equilibrium

STEP = 2.0 * np.pi / SPEED / 60.0
ACROSS, AROUND = Roughness(0.7e-6, 1 / 3), Roughness(0.4e-6, 6.0)
Walls = tuple[Roughness | None, Roughness | None]


def named(walls: Walls) -> dict[str, Any]:
    return {"mixed": MixedLubrication(roughness_a=walls[0], roughness_b=walls[1])}


def as_functions(walls: Walls) -> RoughWalls:
    """The model's factors, in the form of the reference."""
    a, b = walls
    return RoughWalls(
        lambda h: flow_factors(a, b, h).flow[:, 0], lambda h: flow_factors(a, b, h).flow[:, 1],
        lambda h: flow_factors(a, b, h).lag[:, 0],
    )  # fmt: skip


@pytest.mark.parametrize(
    ("walls", "given"),
    [
        ((Roughness(1e-6), None), RoughWalls.isotropic(1e-6)),
        ((None, Roughness(1e-6)), RoughWalls.isotropic(0.0, 1e-6)),
        ((Roughness(2e-6), Roughness(1e-6)), RoughWalls.isotropic(2e-6, 1e-6)),
        ((ACROSS, AROUND), as_functions((ACROSS, AROUND))),
    ],
    ids=["bore", "shaft", "both", "patterns"],
)
def test_a_steady_bearing_is_that_of_the_dense_reference(walls: Walls, given: RoughWalls) -> None:
    """Its fits are written apart, but for the patterns; and slopes of the factors are exact: no more iterations than
    between smooth walls."""
    found = find_equilibrium(bearing((20e3, 0.0), **named(walls)))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference()
    expected.walls = given
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([20e3, 0.0]))
    assert np.abs(place(found) - settled.state.place / CLEARANCE).max() < SHEAR
    assert film.largest_pressure[-1] == pytest.approx(settled.state.pressure.max(), rel=SHEAR)
    assert film.smallest_gap[-1] == pytest.approx(expected.gap(settled.state).min(), rel=3.0 * SHEAR)
    smooth = find_equilibrium(bearing((20e3, 0.0)))
    assert abs(film.smallest_gap[-1] / smooth.films["film"].smallest_gap[-1] - 1.0) > 0.01
    most = smooth.counters["mean_iterations"] * smooth.counters["steps"] + 2
    assert found.counters["mean_iterations"] * found.counters["steps"] <= most


def test_walls_that_are_hardly_rough_are_smooth() -> None:
    smooth, found = (find_equilibrium(bearing((20e3, 0.0), **named((r, None)))) for r in (None, Roughness(1e-9)))
    np.testing.assert_allclose(place(found), place(smooth), rtol=1e-9)
    np.testing.assert_allclose(found.films["film"].pressure, smooth.films["film"].pressure, rtol=1e-7, atol=1.0)


@pytest.mark.parametrize("quadrature", ["full", "reduced"])
def test_what_bodies_are_done_is_what_is_lost(quadrature: str) -> None:
    """Where the shaft stands: drag on it, as the flow, the sliding and the groove take it, to round-off; and in motion,
    within what steps leave between smooth walls."""
    for walls in ((ACROSS, AROUND), (None, Roughness(1e-6, 1 / 9))):
        found = find_equilibrium(bearing((20e3, 0.0), quadrature=quadrature, **named(walls)))
        film = found.films["film"]
        assert film.friction_power[-1] > 0.0 and film.pressure_loss[-1] > 0.0
        lost = film.friction_power[-1] + film.pressure_loss[-1]
        assert -film.torque_second[-1][1] * SPEED == pytest.approx(lost, rel=1e-9)
    left = []
    for walls in ((None, None), (ACROSS, AROUND)):
        scene = bearing(
            turning_load(STEP, 60), at=(0.4 * CLEARANCE, 0.4 * CLEARANCE), quadrature=quadrature, **named(walls)
        )
        found = run(scene, 60 * STEP, step=STEP, start="equilibrium", progress=False)
        assert found.status == "completed", found.message
        left.append(np.abs(found.energy["numerical"]).max())
        assert left[-1] < 1e-4 * found.energy["drive_work"][-1]
        assert np.all(np.diff(found.energy["friction"]) < 0.0) and np.all(np.diff(found.energy["damping"]) > 0.0)
    assert left[1] < 2.0 * left[0]


@pytest.mark.parametrize("pattern", [1.0, 1 / 3])
def test_a_centred_shaft_is_dragged_as_rough_walls_are(pattern: float) -> None:
    """Petroff's bearing, Phi mu (omega R)^2/c, three deviations thick: Phi of the fits as they are printed."""
    wall = Roughness(CLEARANCE / 3.0, pattern)
    found = find_equilibrium(
        bearing((1.0, 0.0), **named((wall, None)), cavitation="full_sommerfeld", feeds=[], ambient_pressure=1.0)
    )
    assert found.status == "completed", found.message
    A, a, b, c = {1.0: (11.1, 2.31, 2.38, 0.11), 1 / 3: (12.3, 2.32, 2.30, 0.10)}[pattern]
    factor = 7.0 / 6.0 + A * 3.0**a * np.exp(-3.0 * b + 9.0 * c)  # phi_f = 35/32 16/15 at three deviations
    smooth = VISCOSITY * (SPEED * RADIUS) ** 2 / CLEARANCE * 2.0 * np.pi * RADIUS * LENGTH
    assert found.films["film"].friction_power[-1] == pytest.approx(factor * smooth, rel=3e-3)  # c/R, and the table


@pytest.mark.parametrize("speed", [300.0, 30.0, 3.0])
def test_rough_walls_and_their_asperities(speed: float) -> None:
    """Both of one roughness, compared with the dense reference, down to where walls are closer than factors are
    known."""
    law, wall = GreenwoodTripp.from_products(0.8e-6, 0.08, 0.02, 115e9), Roughness(0.8e-6)
    found = find_equilibrium(bearing((60e3, 0.0), speed=speed, mixed=MixedLubrication(law, roughness_a=wall)))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference(asperities=law.curve, speed=speed)
    expected.walls = RoughWalls.isotropic(0.8e-6)
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([60e3, 0.0]))
    largest = settled.state.asperity.max()
    np.testing.assert_allclose(film.asperity[-1].ravel(), settled.state.asperity, atol=0.02 * largest)
    assert np.abs(film.eccentricity[-1] - settled.state.place).max() < 0.02 * CLEARANCE
    assert found.counters["mean_iterations"] * found.counters["steps"] <= 60
    told = [note for note in found.notes if "flow factors are known from 0.5 on" in note]
    assert len(told) == int(film.smallest_gap[-1] < 0.5 * wall.deviation)
    assert bool(told) == (speed == 3.0)


def test_heights_that_the_law_states_otherwise_are_named() -> None:
    law = GreenwoodTripp.from_products(0.8e-6, 0.08, 0.02, 115e9)
    found = find_equilibrium(bearing((20e3, 0.0), mixed=MixedLubrication(law, roughness_a=Roughness(0.5e-6))))
    assert any("standard deviation 5e-07 m, those of its law of asperities 8e-07 m" in note for note in found.notes)
