r"""Motion of chosen points of a run: where they are in the world, and what the elastic body adds in its own frame.

    x = r + A (X + u),     u = sum_m phi_m(X) q_m

Of a rigid body points are any X of its user frame, its origin without the user's choice. Of a flexible one they are its
interfaces, which local modes do not move; the user's points are the nearest nodes of its skin, whose global modes are
taken: contact moves them by less than the patch is deep, and that is in the pressure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.output.geometry.grid_places import rotate
from warpffrf.output.geometry.scene_view import BodyView
from warpffrf.output.result import Result


@dataclass(frozen=True, eq=False)
class Motion:
    """Of points at the rows asked for: `world` (T, p, 3) m, and `elastic` (T, e, 3) m, u of flexible bodies, in user
    axes."""

    world: np.ndarray
    elastic: np.ndarray


def check_points(points: Mapping[str, Any] | None, names: list[str]) -> dict[str, np.ndarray]:
    """The user's `points` {body: (n, 3)} [m, user frame]; raises `InputError` for bodies that there are not."""
    found = {}
    for name, places in (points or {}).items():
        if name not in names:
            known = ", ".join(map(repr, names))
            raise InputError(f"speed_error: points are given on body {name!r}, which does not exist; known: {known}")
        found[name] = require_array(np.atleast_2d(places), f"speed_error: points of body {name!r}", (None, 3))
    return found


def motion_of(result: Result, rows: np.ndarray, points: Mapping[str, np.ndarray]) -> Motion:
    """Motion of the `points` of a run, of bodies without any those of the module, at `rows` (T,)."""
    world, elastic = [], []
    for name, body in result.view.bodies.items():
        places, modes = _places(body, points.get(name))
        history = result.history.bodies[name]
        q = history.modal[rows]
        u = np.einsum("tm,mpd->tpd", q, modes) if modes.shape[0] else np.zeros((len(rows), *places.shape))
        turned = np.array([rotate(history.rotation[row], places + ut) for row, ut in zip(rows, u, strict=True)])
        world.append(history.position[rows][:, None] + turned)
        if modes.shape[0]:
            elastic.append(u)
    none = np.zeros((len(rows), 0, 3))
    return Motion(np.concatenate([none, *world], axis=1), np.concatenate([none, *elastic], axis=1))


def _places(body: BodyView, wanted: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Points (p, 3) of the user frame and displacement per mode (m, p, 3)."""
    if body.reduced is None:
        places = np.zeros((1, 3)) if wanted is None else wanted
        return places, np.zeros((0, len(places), 3))
    if wanted is not None:
        skin = body.reduced.surface
        places = np.asarray(skin.points, dtype=float)
        nearest = np.array([np.argmin(np.sum((places - x) ** 2, axis=1)) for x in wanted])
        return places[nearest], np.asarray(skin.modes, dtype=float)[:, nearest]
    held = body.reduced.interfaces.values()
    if not held:
        return np.zeros((1, 3)), np.zeros((0, 1, 3))
    places = np.array([i.point for i in held], dtype=float)
    modes = np.stack([np.asarray(i.modes, dtype=float)[:, :3] for i in held], axis=1)
    return places, modes
