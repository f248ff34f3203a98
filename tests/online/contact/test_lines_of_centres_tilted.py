"""The moment of two rollers whose axes lean towards each other: what lines of centres leave of it out, and the note."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import PAIR
from studies.hard_cases.cases.misaligned import LOAD, RADIUS, TILT, scene_of
from warpffrf.model.errors import InputError
from warpffrf.online import run
from warpffrf.output.accuracy.demands import contact_choices
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.budget.contacts import GAPS
from warpffrf.output.simulate import simulate

SAID = "parallel-axes kinematics omits about"


@pytest.mark.parametrize(("skew", "points"), [(0.0, False), (0.0, True), (3e-2, False)])
def test_moments_that_are_left_out_are_named(skew: float, points: bool) -> None:
    """R_B tilt F on the line of centres, and a note; nothing at points, whether asked for or because of the skew."""
    scene = scene_of(skew)
    scene.contacts[0].kinematics = "closest_point" if points else "auto"
    history = run(scene, 0.06, step=1e-4, progress=False)
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
        assert 'kinematics="closest_point"' in noted[0]
        assert float(noted[0].split(f"{SAID} ")[1].split()[0]) == pytest.approx(largest, rel=0.05)


def test_the_budget_says_what_is_left_out_and_accuracy_asks_for_points() -> None:
    scene = scene_of(0.0)
    result = simulate(scene, 0.06, step=1e-4, progress=False)
    lines = result.error_budget()
    (line,) = (line for line in lines if line.source == GAPS)
    pair = result.history.contacts[PAIR]
    moment = np.linalg.norm(pair.torque, axis=1)[np.linalg.norm(pair.force, axis=1).argmax()]
    assert line.size == pytest.approx(TILT * RADIUS * np.linalg.norm(pair.force, axis=1).max() / moment, rel=0.05)
    asked = [
        choice for choice in contact_choices(scene, result, lines, Limits.of(1e-3)) if choice.option == "kinematics"
    ]
    assert [(choice.name, choice.value) for choice in asked] == [(PAIR, "closest_point")]
    assert not [c for c in contact_choices(scene, result, lines, Limits.of(0.2)) if c.option == "kinematics"]
    before = scene.content_hash()
    scene.contacts[0].kinematics = "closest_point"
    assert scene.content_hash() != before
    with pytest.raises(InputError, match="kinematics"):
        scene.contacts[0].kinematics = "lines"
