"""A scene that was not run, as a result of one row: its bodies at their initial pose."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.online.history.history import BodyHistory, History
from warpffrf.output.geometry.scene_view import scene_view
from warpffrf.output.result import Result


def initial_pose(scene: Any) -> Result:
    """The bodies of `scene` at rest in their initial pose, without deformation and without any other item."""
    view = replace(scene_view(scene), pairs={}, lumped={}, films={}, small_sliding={})
    bodies = {}
    for body in scene.bodies:
        modes = 0 if body.reduced is None else len(body.reduced.frequencies)
        pose = np.array([body.position], dtype=float), np.array([body.rotation], dtype=float)
        bodies[body.name] = BodyHistory(*pose, np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, modes)))
    none = np.zeros(1)
    return Result(History(view, none, none, bodies, {}, {}, {}, none.astype(int), none.astype(int)))
