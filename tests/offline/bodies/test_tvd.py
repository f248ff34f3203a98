"""Trial vector derivatives of a joint: pairs, what the derivatives are, what is left out, `reduce` with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from interface_bodies import free_body
from offline_bodies import STEEL

from references.small_sliding.sheets import ROOT, one_body, stack
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import box
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline import bases, reduce
from warpffrf.offline.bases.trial_vector_derivatives import joint_modes, node_pairs
from warpffrf.offline.elastic import free_model

LOWER, UPPER = "sheet0_z_max", "sheet1_z_min"
ROUND_OFF = 1e-8  # of products of vectors of unit energy, and with the base


@pytest.fixture(scope="module")
def sheets():
    return one_body(stack((0.1, 0.01, 0.004), (8, 1, 1), 2))


@pytest.fixture(scope="module")
def model(sheets):
    return free_body(sheets, {ROOT: "rigid"})[0]


@pytest.fixture(scope="module")
def pairs(sheets):
    """In the coordinates of the model, whose root is rigid: without that the sheets hang in a hinge."""
    found = node_pairs(sheets, LOWER, UPPER)
    return replace(found, relative=found.relative @ free_body(sheets, {ROOT: "rigid"})[1].T)


@pytest.fixture(scope="module")
def base(model):
    """Static responses to forces at the free ends, as different as may be."""
    F = np.random.default_rng(2).standard_normal((model.size, 5))
    return model.flexibility(F)


def test_pairs_see_relative_motion_and_have_the_area(sheets):
    pairs = node_pairs(sheets, LOWER, UPPER)
    nodes = 17 * 3 - 3  # less the line of the root, which both faces share
    assert pairs.relative.shape[0] == 3 * nodes and pairs.alone == 0
    share = 0.1 * 0.01 / 8 / 6  # of the root's line: a sixth of the first facet
    assert pairs.area.sum() == pytest.approx(0.1 * 0.01 - share)
    assert abs(pairs.relative @ rigid_modes(sheets.points, np.zeros(3))[:, :3]).max() < 1e-15
    u = np.zeros((len(sheets.points), 3))
    u[np.setdiff1d(sheets.facets(UPPER).node_set, sheets.facets(LOWER).node_set)] = [1.0, 2.0, 3.0]
    assert np.allclose((pairs.relative @ u.ravel()).reshape(-1, 3), [3.0, 1.0, 2.0])  # n = z, t1 = x, t2 = y
    with pytest.raises(InputError, match="no node of 'sheet0_y_max' has a partner on 'sheet1_z_max'.*face each other"):
        node_pairs(sheets, "sheet0_y_max", "sheet1_z_max")


def test_joint_modes_hold_the_derivatives_of_a_joint_with_a_changing_stiffness(model, pairs, base):
    """By differences: the response of the sheets to a load as a penalty that follows gaps comes on."""
    found = joint_modes(model, base, pairs.relative, pairs.area, 200, 200)
    assert found.derivatives == (15, 25) and max(found.left_out) < 1e-6
    Q = np.concatenate([base, found.columns], axis=1)
    g = (pairs.relative @ base)[::3]
    n = sp.csr_matrix(pairs.relative)[::3]
    softest = 1.0 / float(np.max(g[:, 0] ** 2 @ pairs.area))
    for k in (0, 3):
        stiffness = n.T @ sp.diags(pairs.area * g[:, k]) @ n
        e = 1e-4 * softest * float(base[:, 1] @ (model.K @ base[:, 1])) / np.abs(g[:, k]).max()
        held = free_model(model.K + e * stiffness, model.M, model.R)
        change = held.flexibility((model.K @ base[:, 1])[:, None])[:, 0] - base[:, 1]
        rest = (
            change
            - Q @ np.linalg.lstsq(np.asarray(Q.T @ (model.K @ Q)), np.asarray(Q.T @ (model.K @ change)), rcond=1e-13)[0]
        )
        size = np.sqrt(change @ (model.K @ change))
        assert np.sqrt(rest @ (model.K @ rest)) < 1e-2 * size  # the second derivative, of the order of e


def test_modes_are_of_unit_energy_and_what_they_leave_out_falls(model, pairs, base):
    left = []
    for count in (2, 4, 6):
        found = joint_modes(model, base, pairs.relative, pairs.area, count, count)
        V = found.columns
        assert V.shape[1] == 2 * count and found.taken == (count, count)
        for part in (V[:, :count], V[:, count:]):
            assert np.abs(part.T @ (model.K @ part) - np.eye(count)).max() < ROUND_OFF
        on_base = base.T @ (model.K @ V) / np.sqrt(np.einsum("nb,nb->b", base, model.K @ base))[:, None]
        assert np.abs(on_base).max() < ROUND_OFF
        left.append(found.left_out)
    assert all(
        later < earlier for a, b in zip(left, left[1:], strict=False) for earlier, later in zip(a, b, strict=True)
    )
    # by its definition: the part of all derivatives outside the leading vectors
    every = joint_modes(model, base, pairs.relative, pairs.area, 15, 0)
    assert every.left_out[1] == 1.0 and every.left_out[0] < 1e-6


def test_reduce_with_joint_modes_says_what_they_leave_out(sheets):
    kinds = {ROOT: "rigid", "sheet1_x_max": "average"}
    options = bases.TrialVectorDerivatives(first=LOWER, second=UPPER, normal=8, tangential=6)
    plain, joint = (
        reduce(sheets, STEEL, interfaces=kinds, modes=6, basis=basis, cache=False, progress=False)
        for basis in (bases.FreeFree(), options)
    )
    assert len(joint.frequencies) == len(plain.frequencies) + 14
    facts = joint.report["basis"]
    assert facts["kind"] == "trial_vector_derivatives" and facts["joint_modes"] == [8, 6]
    assert all(0.0 < left < 1.0 for left in facts["derivatives_left_out"])
    shown = "; ".join(joint.report["quality"]["truncated"])
    assert f"{facts['derivatives_left_out'][0]:.2%} of the normal" in shown
    covered = [body.report["quality"]["frequencies"] for body in (plain, joint)]
    assert covered[0]["covered"] == pytest.approx(covered[1]["covered"], rel=1e-9)
    assert joint.frequencies[:6] == pytest.approx(plain.frequencies[:6], rel=1e-8)
    many = bases.TrialVectorDerivatives(first=LOWER, second=UPPER, normal=4000, tangential=0)
    body = reduce(sheets, STEEL, interfaces=kinds, modes=2, basis=many, cache=False, progress=False)
    assert any("normal=4000: the derivatives span" in note for note in body.report["notes"])
    elsewhere = bases.TrialVectorDerivatives(first=LOWER, second="top")
    with pytest.raises(InputError, match="facet set 'top' does not exist"):
        reduce(sheets, STEEL, basis=elsewhere, modes=2, cache=False, progress=False)
    faces = bases.TrialVectorDerivatives(first="z_min", second="z_max")  # of a body that does not hang in a hinge
    with pytest.raises(InputError, match="there is no mode to differentiate"):
        reduce(box((0.1, 0.1, 0.01), (4, 4, 1)), STEEL, basis=faces, cache=False, progress=False)
