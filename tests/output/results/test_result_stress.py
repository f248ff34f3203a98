"""Stress of a run: the parts of both bodies of a pair, invariants in closed form, and names that do not exist."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from synthetic_run import COLUMNS, MODES, ROWS, make_history, roller

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import Recovery
from warpffrf.model.reduced.stress_field import (
    GridSpan,
    LoadStress,
    StressField,
    from_tensor,
    max_shear,
    principal,
    rotated,
    to_tensor,
    von_mises,
)
from warpffrf.output.geometry.places import spread
from warpffrf.output.geometry.scene_view import SceneView
from warpffrf.output.result import Result

POINTS = 4
SINGLE = 1e-6  # transfers in single precision


@pytest.fixture(scope="module")
def stressed():
    """The synthetic roller with made-up stress operators of full rank at four points."""
    body = roller()
    rng = np.random.default_rng(3)
    grid_nodes = COLUMNS * ROWS
    transfer = Recovery(rng.standard_normal((1, 6 * POINTS, grid_nodes)).astype(np.float32), 1, np.eye(3))
    own = sp.csr_matrix(rng.standard_normal((6 * POINTS, grid_nodes)) * (rng.random((6 * POINTS, grid_nodes)) < 0.2))
    surface = LoadStress(body.contact_surfaces["rim"], transfer, own, GridSpan(0, COLUMNS, True))
    field = StressField(
        "here",
        rng.standard_normal((POINTS, 3)),
        rng.standard_normal((MODES, POINTS, 6)).astype(np.float32),
        {"rim": surface},
        {},
        np.arange(POINTS),
        np.zeros(POINTS, dtype=int),
    )
    return replace(body, stress={"here": field})


def test_stress_is_modes_response_and_traction(stressed) -> None:
    history = make_history(stressed)
    result = Result(history)
    field = stressed.stress["here"]
    s, contact = stressed.contact_surfaces["rim"], history.contacts["lower-upper"]
    gram = np.kron(s.grid.gram_theta(), s.gram_z)
    for name in ("lower", "upper"):
        found = result.stress(name, "here")
        assert found.tensor.shape == (len(history.time), POINTS, 6)
        assert np.array_equal(found.time, history.time) and np.array_equal(found.points, field.points)
        for i in (0, 4, 8):
            if name == "lower":
                coefficients = -spread(s, contact.first_column[i], contact.pressure[i]).ravel()
                forces = gram @ coefficients
            else:
                forces = -spread(s, contact.first_column_second[i], contact.load_second[i]).ravel()
                coefficients = np.linalg.solve(gram, forces)
            q = history.bodies[name].modal[i]
            part = field.normal["rim"]
            expected = np.tensordot(q, field.modes, axes=1).ravel() + part.transfer.transfer[0] @ forces
            expected = (expected + part.own @ coefficients).reshape(-1, 6)
            assert np.abs(found.tensor[i] - expected).max() < SINGLE * np.abs(expected).max()
    assert found.von_mises.shape == (len(history.time), POINTS)
    assert found.principal.shape == (len(history.time), POINTS, 3)
    assert found.max_shear == pytest.approx(0.5 * (found.principal[..., 0] - found.principal[..., 2]))


def test_loads_of_several_pairs_on_one_surface_add(stressed) -> None:
    history = make_history(stressed)
    scene = history.scene
    assert isinstance(scene, SceneView)
    pair = scene.pairs["lower-upper"]
    once = Result(history).stress("lower", "here").tensor
    modes = Result(replace(history, contacts={}, scene=replace(scene, pairs={}))).stress("lower", "here").tensor
    twice = replace(
        history,
        contacts={**history.contacts, "again": history.contacts["lower-upper"]},
        scene=replace(scene, pairs={"lower-upper": pair, "again": replace(pair, name="again")}),
    )
    found = Result(twice).stress("lower", "here").tensor
    assert np.abs(found - modes - 2.0 * (once - modes)).max() < SINGLE * np.abs(once).max()


def test_unknown_names_are_listed(stressed) -> None:
    result = Result(make_history(stressed))
    with pytest.raises(InputError, match=r"no stress points called 'bore'; it has: 'here'.*reduce\(\.\.\., stress="):
        result.stress("lower", "bore")
    with pytest.raises(InputError, match="no body called 'middle'; it has: 'lower', 'upper'"):
        result.stress("middle", "here")
    bare = Result(make_history(roller()))
    with pytest.raises(InputError, match="no stress points called 'here'; it has: none"):
        bare.stress("lower", "here")


# --- invariants ---


def test_invariants_of_plain_states() -> None:
    pull = np.array([2.0, 0, 0, 0, 0, 0])
    shear = np.array([0, 0, 0, 0, 3.0, 0])
    pressure = np.array([-5.0, -5.0, -5.0, 0, 0, 0])
    states = np.stack([pull, shear, pressure])
    assert von_mises(states) == pytest.approx([2.0, 3.0 * np.sqrt(3.0), 0.0])
    assert principal(states) == pytest.approx(np.array([[2, 0, 0], [3, 0, -3], [-5, -5, -5.0]]), abs=1e-12)
    assert max_shear(states) == pytest.approx([1.0, 3.0, 0.0], abs=1e-12)


def test_invariants_do_not_turn() -> None:
    rng = np.random.default_rng(0)
    stress = rng.standard_normal((7, 6))
    Q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turned = rotated(stress, Q)
    assert von_mises(turned) == pytest.approx(von_mises(stress))
    assert principal(turned) == pytest.approx(principal(stress))
    assert from_tensor(to_tensor(stress)) == pytest.approx(stress)
    deviator = to_tensor(stress) - np.trace(to_tensor(stress), axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    assert von_mises(stress) == pytest.approx(np.sqrt(1.5 * np.sum(deviator**2, axis=(1, 2))))


# --- the Gram matrix behind the traction ---


@pytest.mark.parametrize("closed", [True, False])
def test_traction_coefficients_invert_the_gram_matrix(closed: bool) -> None:
    """A full turn, and an arc of which the grid is a part: outside that there is no traction."""
    rng = np.random.default_rng(1)
    columns, rows, pitch, first = 9, 3, 0.1, 2
    gram_z = np.diag([2.0, 4.0, 2.0]) + 0.5 * (np.eye(3, k=1) + np.eye(3, k=-1))
    grid_nodes = pitch / 6.0 * (4.0 * np.eye(columns) + np.eye(columns, k=1) + np.eye(columns, k=-1))
    if closed:
        grid_nodes[0, -1] = grid_nodes[-1, 0] = pitch / 6.0
    forces = rng.standard_normal((2, 5, rows))
    whole = np.zeros((2, columns, rows))
    whole[:, first : first + 5] = forces
    found = GridSpan(first, columns, closed).coefficients(forces, "nodes", pitch, gram_z)
    kept = slice(None) if closed else slice(first, first + 5)
    assert (grid_nodes @ found @ gram_z)[:, kept] == pytest.approx(whole[:, kept], abs=1e-12)
    outside = np.delete(found, np.arange(first, first + 5), axis=1)
    assert bool(np.any(outside)) == closed
    found = GridSpan(first, columns, closed).coefficients(forces, "cells", pitch, np.diag(np.diag(gram_z)))
    assert pitch * found * np.diag(gram_z) == pytest.approx(whole, abs=1e-12)


# --- how right it is ---


def known(body, spacing: float | None):
    """The body with nodes so far apart at its rim."""
    return replace(body, provenance={**body.provenance, "contact_node_spacings": {"rim": spacing}})


def test_the_error_of_the_stress_falls_with_the_nodes_in_a_half_width(stressed) -> None:
    contact = Result(make_history(known(stressed, 2e-4))).contact("lower-upper")
    half_width = contact.half_width[0]
    found = contact.stress_errors(0)["lower"]
    assert found.spacings == pytest.approx(half_width / 2e-4)
    finer = Result(make_history(known(stressed, 1e-4))).contact("lower-upper").stress_errors(0)["upper"]
    assert 4.0 * (finer.von_mises - 0.01) == pytest.approx(found.von_mises - 0.01)
    assert 4.0 * (finer.depth - 0.03) == pytest.approx(found.depth - 0.03)


def test_the_report_says_it_where_there_are_stresses(stressed) -> None:
    said = "stress below    of 'lower' von Mises to"
    assert said in Result(make_history(known(stressed, 1e-4))).report()
    assert "stress below" not in Result(make_history(known(stressed, None))).report()  # tetrahedra: not measured
    assert "stress below" not in Result(make_history(known(replace(stressed, stress={}), 1e-4))).report()


def test_a_mesh_too_coarse_to_tell_is_named(stressed) -> None:
    result = Result(make_history(known(stressed, 1.0)))
    found = result.contact("lower-upper").stress_errors(0)["lower"]
    assert np.isnan(found.von_mises) and "nodes of 'lower' are 1 m apart, and the half-width is" in found.reason
    assert "stress below    contact 'lower-upper': the error of the stress is not known" in result.report()
