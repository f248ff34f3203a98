"""The comparison of few points: its rules beside training and hats, and what it says of symmetry and energy."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import STEEL
from studies.contact import point_choice as pc
from warpffrf.model.mesh import roller
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.offline.contact.cubature import choose_sampling

ROUND_OFF = 1e-12  # of sums of some hundred numbers
CLOSED = 1e-4  # of the work in a cycle of 400 steps: forces linear by pieces, errors of 1/400^2 and some kinks


@pytest.fixture(scope="module")
def surface():
    mesh = roller(0.05, 0.015, 0.02, sectors=90, layers=3, axial=4, order=1)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=0,
        grid=ContactGrid(contact_fixed=False), progress=False,
    ).contact_surfaces["rim"]  # fmt: skip


@pytest.fixture(scope="module")
def every(surface):
    return pc.every_point(surface)


def test_all_points_integrate_hats(surface, every) -> None:
    """Forces of a constant are the areas; the tangent of a pressed surface is the Gram matrix of the hats."""
    strips = 5
    areas = every.forces(np.ones((strips, len(every.places.x))))[1:-1]
    gram_z = np.asarray(surface.grid.gram_z(surface.shape))
    np.testing.assert_allclose(areas, np.tile(surface.grid.pitch * gram_z.sum(axis=1), (strips - 1, 1)), rtol=1e-10)
    K = every.tangent(np.ones((strips, len(every.places.x)), dtype=bool))
    rows = surface.grid.rows
    middle = slice(2 * rows, 3 * rows)
    np.testing.assert_allclose(K[middle, middle], 2.0 / 3.0 * surface.grid.pitch * gram_z, rtol=1e-10)


def test_errors_of_least_squares_are_those_of_its_training(surface, every) -> None:
    sampling = choose_sampling(surface, 0.02)
    found = pc.error(surface, pc.by_sampling(surface, sampling), every, pc.TRAINED)
    assert 0.0 < found <= sampling.training_error * (1.0 + ROUND_OFF)  # which counts more families


@pytest.mark.parametrize("name", pc.CHOICES)
def test_all_modes_of_the_training_set_interpolate_it(name: str, surface, every) -> None:
    U = pc.modes_of(surface, every)
    rule = pc.by_interpolation(every, U, name)
    assert pc.error(surface, rule, every, pc.TRAINED) < 1e-9  # modes above round-off times the number of points
    assert pc.error(surface, rule, every, pc.HELD_OUT) < 0.05


def test_positive_weights_have_an_energy_and_interpolation_has_none(surface, every) -> None:
    ours = pc.measured(surface, pc.by_sampling(surface, choose_sampling(surface, 0.02)), every)
    assert ours.asymmetry < ROUND_OFF and ours.eigenvalue > -ROUND_OFF and ours.energy < CLOSED
    U = pc.modes_of(surface, every)[:, : ours.points]
    theirs = pc.measured(surface, pc.by_interpolation(every, U, "Q-DEIM"), every)
    assert theirs.asymmetry > 100.0 * ROUND_OFF and theirs.eigenvalue < -100.0 * ROUND_OFF
    assert theirs.energy > 10.0 * ours.energy


def test_the_fewest_modes_keep_the_wanted_error(surface, every) -> None:
    U = pc.modes_of(surface, every)
    rule = pc.fewest(surface, every, U, "DEIM", 0.02)
    assert rule is not None and pc.error(surface, rule, every, pc.TRAINED) <= 0.02
    fewer = pc.by_interpolation(every, U[:, : len(rule.places.x) - 1], "DEIM")
    assert pc.error(surface, fewer, every, pc.TRAINED) > 0.02
