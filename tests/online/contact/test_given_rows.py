"""Rows of cells with given boundaries: the same contact as rows that follow it, and what they refuse."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import roller_body
from warpffrf.model.errors import InputError

CELLS = 0.01  # of the largest pressure, of cells that differ
CROWN, LOAD, TILT = 0.1, 2e3, 0.02  # m, N, rad: the patch is a fifth of the width, 2 mm off its middle


def pressed(cells: Any, friction: float = 0.0) -> Any:
    """A crowned roller, tilted, on a plane."""
    scene = wf.Scene(gravity=(0, 0, 0))
    body = roller_body(
        120, layers=6, axial=8, order=2, crown_radius=CROWN, modes=0, contact_fixed=True, tangential=friction > 0.0
    )
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    roller = scene.add_body(body, name="roller", position=(0, 0, 0.05), rotation={"xyz": (TILT, 0, 0)})
    scene.add(wf.joints.Prismatic(scene.ground, roller["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(roller["bore"], (0, 0, -LOAD)))
    contact = wf.Contact(roller["rim"], floor, grid="contact_fixed", cells=cells, friction=friction, name="pair")
    scene.close_gap(scene.add(contact), along=(0, 0, -1))
    return wf.equilibrium(scene, progress=False)


def test_they_give_what_rows_that_follow_do() -> None:
    """Peak and centre of a patch; rows that end in it are named."""
    free = pressed((21, 21)).contact("pair")
    z = float(free.center_of_pressure[-1, 1])
    assert abs(z) > 1e-3
    found = pressed((21, np.linspace(-5e-3, 5e-3, 61))).contact("pair")
    assert found.peak_pressure[-1] == pytest.approx(free.peak_pressure[-1], rel=CELLS)
    assert found.center_of_pressure[-1, 1] == pytest.approx(z, abs=2e-5)
    short = pressed((21, np.linspace(min(z, 0.0) - 1e-3, max(z, 0.0), 31)))
    assert "the patch reaches the outermost of the rows given" in " ".join(short.report().split())


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([-1e-3, 0.0, 1e-3], "must rise and be five or more"),
        ([-1e-3, 0.0, 0.0, 1e-3, 2e-3], "must rise and be five or more"),
        (
            np.linspace(-0.02, 0.02, 9),
            "cells: the rows reach from z = -0.02 to 0.02 m, the surfaces only from -0.01 to",
        ),
    ],
)
def test_what_is_refused(rows: Any, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        pressed((11, rows))
