"""One oil film of a run: what it does to its bodies, its fields, and the places of its nodes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.messages import reprs
from warpffrf.online.history.history import FilmHistory
from warpffrf.output.geometry.grid_places import grid_theta_offset
from warpffrf.output.geometry.scene_view import FilmView
from warpffrf.output.recorded import Recorded


class FilmResult(reprs.Shown):
    """One oil film of a run; arrays have one row per saved step, SI units.

    Forces act on the film's first body in world axes, torques about that body's user origin; their opposite on the
    second. Fields stand at the nodes (columns, rows) of the contact grid of the first surface, at `theta` and `z`.
    """

    _hidden = frozenset({"history", "view", "load_second"})

    force = Recorded("(T, 3) N, on the first body, shear included, world axes.")
    torque = Recorded("(T, 3) N m, on the first body about its user origin, world axes.")
    torque_second = Recorded("(T, 3) N m, on the second body, about its user origin.")
    smallest_gap = Recorded("(T,) m, the smallest film thickness.")
    largest_pressure = Recorded("(T,) Pa, of the oil.")
    pressure_loss = Recorded("(T,) W, by flow under pressure, voids that close and feeds.")
    friction_power = Recorded("(T,) W, taken by sliding.")
    feed_flow = Recorded("(T,) m3/s, in through feeds.")
    end_flow = Recorded("(T,) m3/s, out at the ends.")
    void_fraction = Recorded("(T,) [-] volume of the voids over that of the gap.")
    oil_volume = Recorded("(T,) m3 in the film, as of the density without pressure.")
    asperity_force = Recorded("(T,) N, normal force of the asperities.")
    largest_asperity_pressure = Recorded("(T,) Pa, of the asperities.")
    eccentricity = Recorded("(T, 2) m, inner axis against the outer one, along e_0 and e_1.")
    pressure = Recorded("(T, columns, rows) Pa, of the oil.")
    gap = Recorded("(T, columns, rows) m, film thickness.")
    void = Recorded("(T, columns, rows) m, volume of the voids per area.")
    asperity = Recorded("(T, columns, rows) Pa, pressure of the asperities beside that of the oil.")

    def __init__(self, history: FilmHistory, view: FilmView, time: np.ndarray) -> None:
        self.history = history
        self.view = view
        self.name = view.name
        self.time = time  # (T,) s
        self.clearance = view.clearance  # m, radius of the bore less that of the shaft; None of planes and cones
        # (T, columns2, rows2) N, forces of the hats of a second surface that yields, inwards; None of a rigid one
        self.load_second = history.load_second

    def _facts(self) -> dict[str, Any]:
        rows, *grid = self.pressure.shape
        return {"name": self.name, "rows": rows, "grid": f"{grid[0]} x {grid[1]}"}

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @property
    def fill(self) -> np.ndarray:
        """(T, columns, rows) [-] part of the gap that oil fills, 1 where there is no void."""
        return self.history.fill

    @cached_property
    def theta(self) -> np.ndarray:
        """(columns,) rad, of a plane m: the columns in the chart of the first surface, from its direction e_0."""
        return np.asarray(self.view.first.grid.theta) + grid_theta_offset(self.view.first)

    @property
    def z(self) -> np.ndarray:
        """(rows,) m along the axis of the first surface."""
        return np.asarray(self.view.first.grid.z, dtype=float)
