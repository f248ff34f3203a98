"""Compliance of slopes: both paths, the direct formula, what a scene takes of it, files."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.flat_settings import reduce_flat
from warpffrf.model.reduced.local_modes import leaning, leanings, leant
from warpffrf.offline.contact.local_mass import slope_lags

RUBBER, STEEL = wf.Material(5e6, 0.49, 1100.0), wf.Material(210e9, 0.3, 7850.0)
R = 0.05
PATHS = 1e-6  # of the largest entry: the two paths share no solver


def roll(material: wf.Material, **options) -> wf.ReducedBody:
    mesh = wf.mesh.roller(R, 0.04, 0.02, sectors=24, layers=3, axial=2, order=1)
    contact = {"rim": wf.surfaces.Cylinder()}
    return reduce_flat(
        mesh, material, interfaces={"bore": "rigid"}, contact=contact, modes=0, cache=False, progress=False, **options
    )


@pytest.fixture(scope="module")
def soft() -> wf.ReducedBody:
    return roll(RUBBER)


def test_both_paths_agree(soft) -> None:
    cyclic, general = (b.contact_surfaces["rim"] for b in (soft, roll(RUBBER, periodic=False)))
    columns = np.arange(24)
    table = leant(cyclic, 1.0).compliance(columns) - cyclic.compliance(columns)
    assert general.slope_lags is not None
    dense = general.slope_lags[0]
    first = np.argmin(np.abs(np.angle(np.exp(1j * (general.grid.theta_start - cyclic.grid.theta_start)))))
    assert first == 0 and general.grid.columns == 24
    assert np.abs(table - dense).max() < PATHS * np.abs(dense).max()


def test_turning_neighbours_apart_by_hand() -> None:
    """S_ij = -(theta_i - theta_j)(D_ij - D_ji)/2 of a dense operator on an arc."""
    along, theta = np.random.default_rng(2).standard_normal((6, 6)), 0.1 * np.repeat(np.arange(3), 2)
    expected = -0.5 * (theta[:, None] - theta) * (along - along.T)
    assert np.allclose(slope_lags(along[None], 0.1, 2)[0], expected, rtol=1e-14)


def test_the_compliance_stays_symmetric_and_positive(soft) -> None:
    rim = soft.contact_surfaces["rim"]
    D = leant(rim, 1.0).compliance(np.arange(6))
    assert np.abs(D - D.T).max() < 1e-12 * np.abs(D).max()
    assert np.linalg.eigvalsh(D)[0] > 0.0


def test_stiff_bodies_have_none_and_cost_nothing() -> None:
    assert roll(STEEL).contact_surfaces["rim"].slope_lags is None


def test_how_much_a_scene_takes(soft) -> None:
    """1 on a rigid plane and between equal rollers, 2 on a rigid roller of the same radius."""
    scene = wf.Scene()
    one, two = (scene.add_body(soft, name=name, position=(0, 0, z)) for name, z in (("one", 0.0), ("two", 2.0 * R)))
    plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, -R), outward=(0, 0, 1)), name="plane")
    form = wf.surfaces.Cylinder(radius=R, axis_point=(2.0 * R, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
    roller = scene.ground.surface(form, name="roller")
    pairs = [(one, plane, 1.0), (one, two["rim"], 1.0), (one, roller, 2.0)]
    for number, (body, partner, expected) in enumerate(pairs):
        contact = scene.add(wf.Contact(body["rim"], partner, name=f"pair {number}"))
        assert leaning(contact, contact.a) == pytest.approx(expected, rel=1e-12)
    assert leanings(scene.contacts)[one.index, "rim"] == pytest.approx(4.0 / 3.0)  # one surface, three partners


def test_files_keep_it(soft, tmp_path) -> None:
    soft.save(tmp_path / "soft.h5")
    again = wf.ReducedBody.load(tmp_path / "soft.h5")
    kept, given = (body.contact_surfaces["rim"].slope_lags for body in (again, soft))
    assert kept is not None and given is not None and np.array_equal(kept, given)
