"""One lap of a run: what it does to its bodies, its fields over cells, what friction takes, and where it slips."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.messages import reprs
from warpffrf.online.history.history import BodyHistory, LapHistory
from warpffrf.output.bodies.lap_loads import left_out
from warpffrf.output.geometry.scene_view import LapView
from warpffrf.output.laps.sliding import of_user_frames, rigid_sliding
from warpffrf.output.laps.slip_zone import ACROSS, SlipZone, slip_zone
from warpffrf.output.loops.cycles import cycle_times, value_at
from warpffrf.output.recorded import Recorded

OPEN, STICK, SLIP = 0, 1, 2
SLIDES = 0.5  # of the size of a cell: faces that slide further have other partners than those of the run


class LapResult(reprs.Shown):
    """One lap of a run; arrays have one row per saved step, SI units.

    Forces act on the second face in world axes, the torque about the middle of the first face's cells; their opposite
    on the first. Fields are over cells (c), means over each, along its frame (n, t_1, t_2), n outwards of the first
    face; frames and places are in the user frame of the first body, and move with it.
    """

    _hidden = frozenset({"history", "view"})

    force = Recorded("(T, 3) N, on the second face, world axes.")
    torque = Recorded("(T, 3) N m, on the second face about the middle of the first face's cells, world axes.")
    normal_force = Recorded("(T,) N, of all cells, whatever their directions.")
    pressure = Recorded("(T, c) Pa, of the cells.")
    traction = Recorded("(T, c, 2) Pa, on the second face along t_1, t_2.")
    gap = Recorded("(T, c) m, of the cells.")
    slip = Recorded("(T, c, 2) m, of the second face against the first so far, along t_1, t_2.")
    state = Recorded("(T, c) the number of the state: 0 open, 1 stick, 2 slip.")
    cell_loss = Recorded("(T, c) J, by friction so far.", "history.loss")
    points = Recorded("(c, 3) m, user frame of the first body: middles of the cells.", "view.points")
    frames = Recorded("(c, 3, 3), rows n, t_1, t_2, user axes.", "view.frames")
    area = Recorded("(c,) m2, areas of the cells.", "view.area")

    def __init__(self, history: LapHistory, view: LapView, time: np.ndarray, bodies: Mapping[str, BodyHistory]) -> None:
        self.history = history
        self.view = view
        self.name = view.name
        self.time = time  # (T,) s
        self._bodies = bodies
        self.friction = view.friction  # the coefficient, -

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.area)

    @property
    def size(self) -> np.ndarray:
        """(c,) m, edges of squares of the cells' areas."""
        return np.sqrt(self.area)

    @property
    def polygons(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners (t, 3, 3) [m, user frame of the first body] of the triangles that the cells consist of, outwards, and
        the cell (t,) of each."""
        return self.view.triangles

    # --- fields ---

    @cached_property
    def traction_magnitude(self) -> np.ndarray:
        """(T, c) Pa."""
        return np.linalg.norm(self.traction, axis=2)

    @cached_property
    def shift(self) -> np.ndarray:
        """(T, c, 2) m, how far the second face is from its place on the first, along t_1 and t_2: `slip`, and without
        friction, where slips are not followed, what the user frames of the bodies have moved."""
        return self.slip if self.friction > 0.0 else of_user_frames(self.view, self._bodies)

    @cached_property
    def shift_distance(self) -> np.ndarray:
        """(T, c) m, length of `shift`: how far partners are apart, not the way there."""
        return np.linalg.norm(self.shift, axis=2)

    @cached_property
    def loss_density(self) -> np.ndarray:
        """(T, c) J/m2, `cell_loss` over the areas."""
        return self.cell_loss / self.area

    # --- histories ---

    @cached_property
    def loss(self) -> np.ndarray:
        """(T,) J, taken by friction since the scene began: the sum of `cell_loss`."""
        return self.cell_loss.sum(axis=1)

    @cached_property
    def largest_pressure(self) -> np.ndarray:
        """(T,) Pa."""
        return self.pressure.max(axis=1, initial=0.0)

    @cached_property
    def counts(self) -> np.ndarray:
        """(T, states) numbers of cells that are open, stick and slip."""
        return np.stack([(self.state == state).sum(axis=1) for state in (OPEN, STICK, SLIP)], axis=1)

    @cached_property
    def stick_area(self) -> np.ndarray:
        """(T,) m2 of the cells that stick."""
        return (self.state == STICK) @ self.area

    @cached_property
    def slip_area(self) -> np.ndarray:
        """(T,) m2 of the cells that slip under pressure."""
        return (self.state == SLIP) @ self.area

    @cached_property
    def _sliding(self) -> tuple[np.ndarray, np.ndarray]:
        return rigid_sliding(self.points, self.frames, self.area, self.shift)

    @property
    def sliding(self) -> np.ndarray:
        """(T, 3) m, by how much the second face as a whole has slid on the first, in user axes of the first body, at
        the middle of the cells: the rigid motion nearest to `shift` (`sliding.py`)."""
        return self._sliding[0]

    @property
    def turning(self) -> np.ndarray:
        """(T, 3) rad, by how much it has turned, user frame of the first body, likewise."""
        return self._sliding[1]

    # --- cycles ---

    def loss_between(self, begin: float, end: float) -> float:
        """Energy [J] that friction took between two times, `begin` and `end` [s], straight between saved steps. Raises
        `InputError` for times outside of the run."""
        first, last = value_at(self.time, self.loss, np.array([begin, end]), f"lap '{self.name}'")
        return float(last - first)

    def loss_per_cycle(self, cycles: float | Sequence[float] | np.ndarray) -> np.ndarray:
        """Energy (cycles,) [J] that friction took in each cycle, D_k = loss(t_(k+1)) - loss(t_k).

        cycles: the period [s], for whole cycles from the first saved step on; or the times [s] at which cycles begin
        and end, ascending. Of a load that is repeated the first cycle differs from those that follow, as the joint
        begins without tractions. Raises `InputError` for a period longer than the run, and times outside of it.
        """
        label = f"lap '{self.name}'"
        return np.diff(value_at(self.time, self.loss, cycle_times(self.time, cycles, label), label))

    def slip_zone(self, begin: float | None = None, end: float | None = None) -> SlipZone:
        """Cells that lost energy between the times `begin` and `end` [s]: which, their area, and how many there are
        across (`slip_zone.py`). Without a begin what they lost before the first saved step counts, too, as in the
        equilibrium that a run starts from. Raises `InputError` for times outside of the run."""
        times = np.array([self.time[0] if begin is None else begin, self.time[-1] if end is None else end])
        first, last = value_at(self.time, self.cell_loss, times, f"lap '{self.name}'")
        rows = (self.time >= times[0]) & (self.time <= times[1])
        if begin is None:
            first = np.zeros_like(last)
        pressed = np.any(self.state[rows] != OPEN, axis=0) if np.any(rows) else self.state[-1] != OPEN
        return slip_zone(self.points, self.area, last - first, pressed)

    def warnings(self) -> list[str]:
        """What makes results of this lap uncertain: faces that slid far beside their cells, whose partners are fixed,
        slip zones of few cells, and skins that do not know what the lap does to them."""
        bodies = (self.view.first_body, self.view.second_body)
        found = left_out({body.name: body for body in bodies}.values())
        ratio = self.shift_distance / self.size
        if np.any(ratio > SLIDES):
            row, cell = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            found.append(
                f"cell {cell} slid by {self.shift_distance[row, cell] * 1e3:.4g} mm, {ratio[row, cell]:.2g} of its "
                f"size {self.size[cell] * 1e3:.4g} mm, and partners of cells are fixed: beyond {SLIDES:g} of a cell "
                "forces act at other places than they would; model such motion as a contact"
            )
        zone = self.slip_zone()
        if zone.coarse:
            found.append(
                f"the slip zone is {zone.across:.2g} cells across, {zone.cells} in all; below {ACROSS:g} the loss "
                "per cycle is uncertain: make cells smaller there, reduce(laps={...: LapCells(..., size=, growth=)})"
            )
        return found

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "cells": self.cells, "rows": len(self.time)}
