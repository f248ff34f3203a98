"""Small vibrations of jointed bodies: small-sliding contacts that stick are as if grown together, those without
friction slide."""

from __future__ import annotations

import numpy as np
import pytest
from small_sliding_scenes import LOAD, one_block, two_blocks

from warpffrf.model import signals
from warpffrf.online.engine import Engine
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.linearise import linearise
from warpffrf.output.modes_result import eigenmodes
from warpffrf.output.simulate import static
from warpffrf_kernels.matched.status_words import ANEW, READY

TRUNCATED = 1e-3  # of a frequency: what modes of the blocks above HIGHEST have of inertia
CELLS = (6, 2, 2), (12, 4, 4)


def test_laps_that_stick_are_as_if_grown_together() -> None:
    """With a cell a node the same displacements are tied as in one body; with means over facets fewer are."""
    between = []
    for cells in CELLS:
        exact = eigenmodes(one_block(cells), 3).frequencies
        found = {by: eigenmodes(two_blocks(cells, by), 3) for by in ("nodes", "facets")}
        tied, means = (found[by].frequencies for by in ("nodes", "facets"))
        np.testing.assert_allclose(tied, exact, rtol=TRUNCATED)
        assert np.all(tied >= exact) and np.all(tied >= means)
        between.append(np.max(tied / means - 1.0))
    assert between[0] < 3e-4 and between[1] < 0.1 * between[0]  # fourth order would be 1/16
    assert "cells are under pressure and stick" in found["facets"].report()


def test_without_friction_the_upper_block_slides() -> None:
    """Two translations and a turn in the plane have no stiffness but what the load has at its arms."""
    modes = eigenmodes(two_blocks(friction=0.0), 12)
    soft = modes.frequencies < 5.0
    assert np.sum(soft) >= 3 and modes.frequencies[~soft].min() > 1e4
    assert "slide without friction" in modes.report()


@pytest.mark.parametrize("friction", [0.3, 0.0])
def test_matrices_are_symmetric(friction: float) -> None:
    """Forces of small-sliding contacts at rest have a potential: arms and turns of theirs leave nothing one-sided."""
    engine = Engine(two_blocks(friction=friction))
    assert settle(engine)
    linear = linearise(engine)
    rest = linear.K - linear.K_matched
    np.testing.assert_allclose(rest, rest.T, atol=5e-9 * LOAD)  # N m: round-off of differences over 10 um
    assert np.abs(linear.K_matched - linear.K_matched.T).max() <= 1e-15 * np.abs(linear.K_matched).max()
    assert np.linalg.eigvalsh(linear.K_matched).min() > -1e-9 * np.abs(linear.K_matched).max()
    ready = engine.scratch.matched_words.numpy()[..., int(READY)]
    assert np.all(ready == int(ANEW))  # the engine goes on with its own forces


def test_cells_that_have_slipped_stick_in_small_vibrations() -> None:
    scene = two_blocks(pull=signals.Table([0.0, 1.0], [0.0, 595.0]))
    pulled = static(scene, 1.0, step=0.2, progress=False)
    assert np.sum(pulled.history.small_sliding["lap"].state[-1] == 2) >= 6
    after = eigenmodes(scene, 3, about=pulled).frequencies
    before = eigenmodes(two_blocks(), 3).frequencies
    np.testing.assert_allclose(after, before, rtol=1e-3)  # geometric stiffness of the pull


def test_open_cells_hold_nothing() -> None:
    modes = eigenmodes(two_blocks(), 12, about="initial")
    assert modes.frequencies[5] < 500.0 and "none of its 12 cells is under pressure" in modes.report()
