"""One oil film of a run: what it does to its bodies, its fields, and the places of its nodes."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from warpffrf.online.history.history import FilmHistory
from warpffrf.output.geometry.grid_places import grid_theta_offset
from warpffrf.output.geometry.scene_view import FilmView


class FilmResult:
    """One oil film of a run; arrays have one row per saved step, SI units.

    Forces act on the film's first body in world axes, torques about that body's user origin; their opposite on the
    second. Fields stand at the nodes (columns, rows) of the contact grid of the first surface, at `theta` and `z`.
    """

    def __init__(self, history: FilmHistory, view: FilmView, time: np.ndarray) -> None:
        self.history = history
        self.view = view
        self.name = view.name
        self.time = time  # (T,) s
        self.clearance = view.clearance  # m, radius of the bore less that of the shaft; None of planes and cones
        self.force = history.force  # (T, 3) N, on the first body, shear included
        self.torque = history.torque  # (T, 3) N m
        self.torque_second = history.torque_second  # (T, 3) N m, on the second body, about its user origin
        self.smallest_gap = history.smallest_gap  # (T,) m
        self.largest_pressure = history.largest_pressure  # (T,) Pa
        self.pressure_loss = history.pressure_loss  # (T,) W, by flow under pressure, voids that close and feeds
        self.friction_power = history.friction_power  # (T,) W, taken by sliding
        self.feed_flow = history.feed_flow  # (T,) m3/s, in through feeds
        self.end_flow = history.end_flow  # (T,) m3/s, out at the ends
        self.void_fraction = history.void_fraction  # (T,) volume of the voids over that of the gap
        self.oil_volume = history.oil_volume  # (T,) m3 in the film, as of the density without pressure
        self.asperity_force = history.asperity_force  # (T,) N, normal force of the asperities
        self.largest_asperity_pressure = history.largest_asperity_pressure  # (T,) Pa
        self.eccentricity = history.eccentricity  # (T, 2) m, inner axis against the outer one, along e_0 and e_1
        self.pressure = history.pressure  # (T, columns, rows) Pa
        self.gap = history.gap  # (T, columns, rows) m
        self.void = history.void  # (T, columns, rows) m, volume of the voids per area
        self.asperity = history.asperity  # (T, columns, rows) Pa, pressure of the asperities beside that of the oil
        # (T, columns2, rows2) N, forces of the hats of a second surface that yields, inwards; None of a rigid one
        self.load_second = history.load_second

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @property
    def fill(self) -> np.ndarray:
        """(T, columns, rows) part of the gap that oil fills, 1 where there is no void."""
        return self.history.fill

    @cached_property
    def theta(self) -> np.ndarray:
        """(columns,) rad, of a plane m: the columns in the chart of the first surface, from its direction e_0."""
        return np.asarray(self.view.first.grid.theta) + grid_theta_offset(self.view.first)

    @property
    def z(self) -> np.ndarray:
        """(rows,) m along the axis of the first surface."""
        return np.asarray(self.view.first.grid.z, dtype=float)
