"""A crowned roller on cells of the patch that is tilted off the end of its partner."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.online.diagnosis.border_notes import BORDER
from warpffrf.verification.scenes.rolling_pairs import STEEL, R, reduced, roller

CROWN = 2.0  # m: on both, 1/m of relative curvature along the axis, an ellipse of aspect 10 and more
LOAD = 3000.0  # N
OVER = "the patch reaches an end"


@pytest.fixture(scope="module")
def crowned() -> ReducedBody:
    mesh = roller(4e-3, order=1, crown_radius=CROWN)
    return reduced(mesh, STEEL, crowned=True, tangential=None, cache=False)


@pytest.mark.parametrize(("tilt", "named"), [(0.0, False), (9e-3, True)])
def test_a_crown_over_the_end_is_named(crowned: ReducedBody, tilt: float, named: bool) -> None:
    """Two crowns touch at CROWN tilt/2 from their middles, 9 mm of 10; without a tilt the ends carry nothing."""
    scene = wf.Scene(gravity=(0, 0, 0))
    turn = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
    lower = scene.add_body(crowned, name="lower")
    upper = scene.add_body(crowned, name="upper", position=(0, 0, 2.0 * R), rotation=turn)
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], grid="patch", cells=(11, 15), name="pair", overlap=1.0))
    scene.close_gap(contact, along=(0, 0, 1))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -LOAD)))
    rest = wf.equilibrium(scene)
    assert rest.status == "completed", rest.message
    pressure = rest.history.contacts["pair"].pressure[0].max(axis=0)
    share = max(pressure[0], pressure[-1]) / pressure.max()
    assert (share > BORDER) == named
    assert any(f"had {share:.0%} of the largest pressure" in note for note in rest.history.notes) == named
    assert any(OVER in note for note in rest.history.notes) == named
