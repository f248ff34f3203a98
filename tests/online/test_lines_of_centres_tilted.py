"""The moment of two rollers whose axes lean towards each other: what lines of centres leave of it out, and the note."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.online import Settings, run
from warpffrf.study.hard_cases.cases.misaligned import LOAD, RADIUS, TILT, scene_of
from warpffrf.verification.scenes.rollers import PAIR

SAID = "gaps along the line of centres leave about"


@pytest.mark.parametrize(("skew", "points"), [(0.0, False), (0.0, True), (3e-2, False)])
def test_moments_that_are_left_out_are_named(skew: float, points: bool) -> None:
    """R_B tilt F on the line of centres, and a note; nothing at points, whether asked for or because of the skew."""
    history = run(scene_of(skew), 0.06, step=1e-4, progress=False, settings=Settings(force_points=points))
    pair, surface = history.contacts[PAIR], history.scene.contacts[0].a.surface
    loads = surface.gram_z @ pair.pressure[-1].sum(axis=0)
    F = pair.force[-1]
    off = pair.torque[-1, 0] - (loads @ np.asarray(surface.grid.z) / loads.sum() * F[2] - RADIUS * F[1])
    noted = [note for note in history.notes if SAID in note]
    left = LOAD * RADIUS * TILT
    if skew or points:
        assert abs(off) < 0.03 * left and not noted
    else:
        assert abs(off) == pytest.approx(left, rel=0.05)
        assert len(noted) == 1
        largest = TILT * RADIUS * float(np.linalg.norm(pair.force, axis=1).max())  # of the run, which swings at first
        assert float(noted[0].split(f"{SAID} ")[1].split()[0]) == pytest.approx(largest, rel=0.05)
