"""The tableau of small-sliding contacts on the device compared with dense matrices, while more cells change over than
stand next to a table."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_sliding_scenes import two_blocks

from warpffrf.online.engine import Engine
from warpffrf.online.vibrations.rubbing import MatchedForces
from warpffrf_kernels.matched.forms import OPEN, SLIP, STICK

FRICTION = 0.3
ROUND_OFF = 1e-9  # of forces and of T_zz: G has a condition of 1e4
MET = 1e-9  # of the largest force, and what it yields: passes settle to 1e-11


def tables(engine: Engine) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """G (n, n), J (n, z) and the gaps of the cells where the scene begins."""
    matched = engine.compiled.matched
    n, z = 3 * matched.gap.shape[0], int(matched.column_start.numpy()[-1])
    return matched.compliance.numpy().reshape(n, n).T, matched.motion.numpy().reshape(z, n).T, matched.gap.numpy()


def conditions(modes: np.ndarray, aims: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A, B (n, n) of A s + B y = const: three for each cell in its state, slips linearised about `aims`."""
    n = 3 * len(modes)
    A, B = np.zeros((n, n)), np.zeros((n, n))
    for c, (mode, (x, y, kappa)) in enumerate(zip(modes, aims, strict=True)):
        own = slice(3 * c, 3 * c + 3)
        if mode == int(OPEN):
            A[own, own] = np.eye(3)
        elif mode == int(STICK):
            B[own, own] = np.eye(3)
        else:
            A[own, own] = [[0, 0, 0], [-FRICTION, x, y], [0, -kappa * y, kappa * x]]
            B[own, own] = [[1, 0, 0], [0, 0, 0], [0, -y, x]]
    return A, B


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine(two_blocks((12, 8, 2), friction=FRICTION))


def moved(engine: Engine, rng: np.random.Generator, sink: float, slide: float) -> Any:
    """The upper body moves down, to the side and tilts [m, rad], its modes and those of the lower one a little."""
    matched = MatchedForces(engine)
    x = np.zeros(matched.rigid + engine.compiled.model.modes.count)
    upper = 6 * 1
    x[upper : upper + 3] = *(slide * rng.normal(size=2)), -sink
    x[upper + 3 : upper + 5] = 50.0 * sink * rng.normal(size=2)
    return matched, x


def test_forces_and_tangents_are_those_of_dense_matrices(engine: Engine) -> None:
    """At twelve places one after the other, between which many more lines change over than may differ."""
    rng = np.random.default_rng(4)
    G, J, gap = tables(engine)
    earlier, changed, seen = None, 0, set()
    for _ in range(12):
        matched, x = moved(engine, rng, 1e-6 * rng.uniform(0.5, 2.0), 10.0 ** rng.uniform(-8.0, -6.0))
        f = matched.at(x)
        assert f is not None
        scratch = engine.scratch
        modes, aims = scratch.matched_mode.numpy()[0], scratch.matched_target_form.numpy()[0]
        s, z = scratch.matched_trial.numpy()[: len(G)], scratch.matched_z.numpy()[0]
        y = G @ s + J @ z
        y[::3] += gap
        largest, yields = np.abs(s).max(), G.diagonal()[::3].mean()
        p, t, g, w = s[::3], s.reshape(-1, 3)[:, 1:], y[::3], y.reshape(-1, 3)[:, 1:]
        bound = FRICTION * p
        assert p.min() >= -MET * largest and g.min() >= -MET * largest * yields
        assert np.abs(np.where(p > MET * largest, g, 0.0)).max() < MET * largest * yields
        assert np.all(np.hypot(*t.T) <= bound + MET * largest)
        sticks, slips = modes == int(STICK), modes == int(SLIP)
        assert np.abs(w[sticks]).max(initial=0.0) < MET * largest * yields
        against = t[slips] * np.hypot(*w[slips].T)[:, None] + bound[slips, None] * w[slips]
        assert np.abs(against).max(initial=0.0) < MET * largest**2 * yields
        assert np.abs(f - J.T @ s).max() < ROUND_OFF * np.abs(f).max()
        A, B = conditions(modes, aims)
        exact = -J.T @ np.linalg.solve(A + B @ G, B @ J)
        assert np.abs(-matched.tangent() - exact).max() < ROUND_OFF * np.abs(exact).max()
        changed += 0 if earlier is None else 3 * int(np.sum(modes != earlier))
        earlier = modes.copy()
        seen |= set(modes.tolist())
    assert changed > 2 * int(engine.compiled.matched.differing_start.numpy()[-1]) and seen == {
        int(OPEN),
        int(STICK),
        int(SLIP),
    }
