"""The forces of laps on one flexible body at saved steps, as its responses to them know them.

Pressure and traction of a cell times its area are its forces s on the second face; `model.laps.face_loads` has what
they are on the cells of a body. Skin and stress follow from these and the body's own responses, beyond its global
modes: what cells yield by themselves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.laps import face_loads
from warpffrf.online.history.history import History, LapHistory
from warpffrf.output.geometry.scene_view import BodyView, LapView, SceneView


def cell_forces(lap: LapHistory, area: np.ndarray, i: int) -> np.ndarray:
    """Forces (3 c,) [N] of the cells with `area` (c,) [m2] on the second face, along their frames, at saved step
    `i`."""
    return (np.column_stack([lap.pressure[i], lap.traction[i]]) * area[:, None]).ravel()


def on_first(lap: LapView) -> sp.csr_matrix:
    """P (N, 3 c) of `face_loads` on the lap's first body."""
    return face_loads.on_own(lap.first_body.reduced.laps, lap.first_surface_name, lap.cell)


def on_second(lap: LapView) -> sp.csr_matrix:
    """P (N, 3 c) on the second body, which has to be another flexible one."""
    laps = lap.second_body.reduced.laps
    return face_loads.on_partner(laps, lap.second_surface_name, lap.weights, lap.partner_frames)


class LapLoads:
    """Of all laps that the body takes part in."""

    def __init__(self, history: History, view: SceneView, body: str) -> None:
        """body: name of a flexible one."""
        self._parts: list[tuple[LapHistory, np.ndarray, sp.csr_matrix]] = []
        for name, lap in view.laps.items():
            if lap.first_body.name == body:
                self._parts.append((history.laps[name], lap.area, on_first(lap)))
            if lap.second is not None and lap.second_body.name == body:
                self._parts.append((history.laps[name], lap.area, on_second(lap)))

    def forces(self, i: int) -> np.ndarray | None:
        """Forces (N,) [N] on all cells of the body's laps, in the order of `ReducedBody.laps`, at saved step `i`; None
        of a body without laps in the scene."""
        parts = [P @ cell_forces(lap, area, i) for lap, area, P in self._parts]
        return np.sum(parts, axis=0) if parts else None


def left_out(bodies: Any) -> list[str]:
    """A line for each of the `bodies`, views, whose skin does not know what forces on its laps do to it."""
    return [
        _left_out(body) for body in bodies if body.reduced and body.reduced.laps and body.reduced.surface.laps is None
    ]


def _left_out(body: BodyView) -> str:
    return (
        f"the skin of '{body.name}' moves by its modes alone: what forces on its laps do to it beside them was left "
        "out of its file as too large; LapCells(size=, growth=) makes fewer cells"
    )
