r"""Small-sliding contacts of a run: fields over their cells, losses, slip zones, and positions for pictures.

Chart. The cells of a contact in a plane: projected along their mean normal, or unrolled around the axis of their
normals.

With the normals n_c and areas A_c, |sum A n| / sum A is 1 for a plane and 0 for a full revolution. Above `FLAT` the
cells are projected onto the plane normal to the mean normal. Otherwise the axis a is the direction of the smallest
normal components, the eigenvector of sum A n n^T to the smallest eigenvalue; it passes through the point of least
distance from the lines through the cells along their normals. Points have the coordinates arc r phi and height along a,
with the mean radius r. Triangles are not cut at the seam: each is drawn on the side of its centre.

Small-sliding result. One small-sliding contact of a run: forces on its bodies, fields over cells, friction loss, and
slip zones.

On skin. Displacement of the corners of a contact's cells, from that of the first body's skin, for pictures.

Sliding. Rigid sliding and rotation of the faces against each other: the rigid motion that best fits the slips of the
cells.

With the slips w_c (2,) along t_1, t_2 of cells at x_c, areas A_c and their middle x, the translation d and the rotation
theta solve

    min  sum_c A_c | w_c - T_c (d + theta x (x_c - x)) |^2,        T_c = rows t_1, t_2,

the smallest of all solutions, with theta scaled by the radius of gyration of the cells: motions without sliding, such
as a translation along the normal of a plane, are zero.

Without friction the engine does not integrate slips. Points x_c of the first body and y_c of the second, which coincide
at the initial pose, are then displaced against each other by

    A_1^T (r_2 + A_2 y_c - r_1) - x_c

in the axes of the first body, with r and A positions and rotations of the user frames: the elastic part is neglected.

Slip zone. The slip zone of a contact in a time interval, and its resolution by cells.

In partial slip, energy is dissipated in a zone between the outline and the stick region. Consider a bar (stiffness EA)
that is pulled at its end by +-F and held by friction tau per length, with cells of length a and springs K = EA/a
between them; each cell carries at most tau a. At f = F/(tau a) = n + 1/2 the first n cells slip, and the force
differences along the chain give the loss per cycle

    D_cells = 4 (tau a)^2 / K  sum_{j=1..n} j (f - j) = (tau a)^2 / (3 K)  n (n + 1) (2 n + 1),

compared with D = 2 F^3/(3 EA tau) of the continuous bar:

    D_cells / D = 4 n (n + 1) / (2 n + 1)^2 = 1 - 1/(2 n + 1)^2,        n cells across,

at f = n it is 1 - 1/n^2. With `ACROSS` cells the error is then at most 1.6 %, with one or two cells it is arbitrary.
Curved zones, and pressures that decrease across them, require more cells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.messages import reprs
from warpffrf.online.history.history import BodyHistory, SmallSlidingHistory
from warpffrf.output.bodies.normal_loads import left_out
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.contact.friction import slip_share
from warpffrf.output.exposed_histories import Recorded
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import SmallSlidingView
from warpffrf.output.geometry.skin_nodes import SkinNodes
from warpffrf.output.loops import cycle_times, value_at

FLAT = 0.8  # of the sum of areas: a cap of 120 degrees is still projected


@dataclass(frozen=True, eq=False)
class CellChart:
    """Triangles (t, 3, 2) [m] of the cells in the chart plane, the cell (t,) of each, the centres (c, 2) [m] of the
    cells, and the names of the two axes of the map. `radius` [m] if unrolled, else None."""

    triangles: np.ndarray
    cell: np.ndarray
    points: np.ndarray
    labels: tuple[str, str]
    radius: float | None


def cell_chart(view: SmallSlidingView) -> CellChart:
    """The chart of a contact's cells, in the axes of the first body."""
    normals, area = view.frames[:, 0], view.area
    corners, cell = view.triangles
    mean = area @ normals / area.sum()
    if np.linalg.norm(mean) > FLAT:
        axes, names = _plane(mean / np.linalg.norm(mean))
        return CellChart(corners @ axes.T, cell, view.points @ axes.T, names, None)
    axis = np.linalg.eigh(np.einsum("c,ci,cj->ij", area, normals, normals))[1][:, 0]
    axis = axis * (1.0 if axis[np.argmax(np.abs(axis))] > 0.0 else -1.0)
    e0, e1 = _plane(axis)[0]
    middle = _nearest_to_lines(view.points, normals, np.stack([e0, e1]))
    off = view.points - middle
    radius = float(area @ np.hypot(off @ e0, off @ e1) / area.sum())

    def around(x: np.ndarray) -> np.ndarray:
        return np.arctan2((x - middle) @ e1, (x - middle) @ e0)

    base = around(corners.mean(axis=1))
    turn = around(corners) - base[:, None]
    angle = base[:, None] + (turn + np.pi) % (2.0 * np.pi) - np.pi
    flat = np.stack([radius * angle, corners @ axis], axis=-1)
    points = np.stack([radius * around(view.points), view.points @ axis], axis=-1)
    return CellChart(flat, cell, points, ("arc", f"along ({', '.join(f'{v:.3g}' for v in axis + 0.0)})"), radius)


def _plane(normal: np.ndarray) -> tuple[np.ndarray, tuple[str, str]]:
    """Two axes (2, 3) normal to `normal`, right-handed with it, near axes of the body, and their names."""
    order = np.argsort(np.abs(normal))[:2]
    first = np.eye(3)[np.min(order)]
    a = first - (first @ normal) * normal
    a /= np.linalg.norm(a)
    axes = np.stack([a, np.cross(normal, a)])
    names = []
    for axis in axes:
        n = int(np.argmax(np.abs(axis)))
        straight = abs(axis[n]) > 1.0 - 1e-6
        sign = "-" if axis[n] < 0.0 else ""
        names.append(f"along {sign}{'xyz'[n]}" if straight else f"along ({', '.join(f'{v:.3g}' for v in axis + 0.0)})")
    return axes, (names[0], names[1])


def _nearest_to_lines(points: np.ndarray, normals: np.ndarray, across: np.ndarray) -> np.ndarray:
    """The point (3,) in the plane of `across` (2, 3) nearest to the lines along `normals`."""
    n = normals @ across.T
    n = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
    side = np.stack([-n[:, 1], n[:, 0]], axis=1)
    flat = points @ across.T
    return np.linalg.lstsq(side, np.einsum("ci,ci->c", side, flat), rcond=None)[0] @ across


OPEN, STICK, SLIP = 0, 1, 2
SLIDES = 0.5  # of the size of a cell: faces that slide further touch other partners than those of the run


class SmallSlidingResult(reprs.Shown):
    """One small-sliding contact of a run; arrays have one row per saved step, SI units.

    Forces act on the first body in world axes, torques about that body's user origin; their opposites act on the
    second. Fields are over cells (c), averages over each, along its frame (n, t_1, t_2), n outwards from the first
    face; frames and positions are in the user frame of the first body, and move with it.
    """

    _hidden = frozenset({"history", "view"})

    force = Recorded("(T, 3) N, on the first body, world axes.")
    torque = Recorded("(T, 3) N m, on the first body about its user origin, world axes.")
    normal_force = Recorded("(T,) N, of all cells, whatever their directions.")
    pressure = Recorded("(T, c) Pa, of the cells.")
    traction = Recorded("(T, c, 2) Pa, on the first face along t_1, t_2.")
    gap = Recorded("(T, c) m, of the cells.")
    slip = Recorded("(T, c, 2) m, accumulated, first face relative to second, along t_1, t_2.")
    state = Recorded("(T, c) the number of the state: 0 open, 1 stick, 2 slip.")
    cell_loss = Recorded("(T, c) J, accumulated friction loss.", "history.loss")
    points = Recorded("(c, 3) m, user frame of the first body: centres of the cells.", "view.points")
    frames = Recorded("(c, 3, 3), rows n, t_1, t_2, user axes.", "view.frames")
    area = Recorded("(c,) m2, areas of the cells.", "view.area")

    def __init__(
        self, history: SmallSlidingHistory, view: SmallSlidingView, time: np.ndarray, bodies: Mapping[str, BodyHistory]
    ) -> None:
        self.history = history
        self.view = view
        self.name = view.name
        self.time = time  # (T,) s
        self._bodies = bodies
        self.friction = view.friction  # coefficient of friction, -

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.area)

    @property
    def size(self) -> np.ndarray:
        """(c,) m, edges of squares with the cells' areas."""
        return np.sqrt(self.area)

    @property
    def polygons(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners (t, 3, 3) [m, user frame of the first body] of the triangles of the cells, oriented outwards, and the
        cell (t,) of each."""
        return self.view.triangles

    # --- fields ---

    @cached_property
    def traction_magnitude(self) -> np.ndarray:
        """(T, c) Pa."""
        return np.linalg.norm(self.traction, axis=2)

    @cached_property
    def shift(self) -> np.ndarray:
        """(T, c, 2) m, displacement of the first face from its initial position on the second, along t_1 and t_2:
        `slip`; without friction, where slips are not integrated, the relative displacement of the user frames of the
        bodies."""
        return self.slip if self.friction > 0.0 else of_user_frames(self.view, self._bodies)

    @cached_property
    def shift_distance(self) -> np.ndarray:
        """(T, c) m, length of `shift`: the distance between partners, not the path length."""
        return np.linalg.norm(self.shift, axis=2)

    @cached_property
    def loss_density(self) -> np.ndarray:
        """(T, c) J/m2, `cell_loss` over the areas."""
        return self.cell_loss / self.area

    # --- histories ---

    @cached_property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @cached_property
    def loss(self) -> np.ndarray:
        """(T,) J, friction loss since the start of the scene: the sum of `cell_loss`."""
        return self.cell_loss.sum(axis=1)

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa."""
        return self.pressure.max(axis=1, initial=0.0)

    @cached_property
    def peak_position(self) -> np.ndarray:
        """(T, 3) m, user frame of the first body: centre of the cell with the largest pressure; NaN without
        pressure."""
        return np.where(self.peak_pressure[:, None] > 0.0, self.points[np.argmax(self.pressure, axis=1)], np.nan)

    @cached_property
    def counts(self) -> np.ndarray:
        """(T, states) numbers of open, sticking and slipping cells."""
        return np.stack([(self.state == state).sum(axis=1) for state in (OPEN, STICK, SLIP)], axis=1)

    @cached_property
    def stick_area(self) -> np.ndarray:
        """(T,) m2 of sticking cells."""
        return (self.state == STICK) @ self.area

    @cached_property
    def slip_area(self) -> np.ndarray:
        """(T,) m2 of cells that slip under pressure."""
        return (self.state == SLIP) @ self.area

    @cached_property
    def slip_share(self) -> np.ndarray:
        """(T,) [-] of the area under pressure, the part that slips: 1 in gross slip; NaN without pressure."""
        return slip_share(self.stick_area, self.slip_area)

    @property
    def gross_slip_time(self) -> float:
        """Time [s] of the first saved step in which every loaded cell slips, so that the faces slide as a whole; NaN if
        there is none. A static run under a growing load ends there, with the reason in its message: there is no
        equilibrium beyond. A drive (`joints.Drive(..., quantity="position")`) goes on, with a constant force."""
        slides = np.flatnonzero(self.slip_share == 1.0)
        return float(self.time[slides[0]]) if len(slides) else float("nan")

    @cached_property
    def friction_force(self) -> np.ndarray:
        """(T, 3) N, resultant of the tractions on the first body, in its user axes: at `gross_slip_time` the force at
        which plane faces slide."""
        return np.einsum("tck,ckd,c->td", self.traction, self.frames[:, 1:], self.area)

    @cached_property
    def friction_torque(self) -> np.ndarray:
        """(T, 3) N m, moment of the tractions on the first body about the centre of the cells, in its user axes: at
        `gross_slip_time` the torque at which a shaft slides in its hub."""
        arm = self.points - self.area @ self.points / self.area.sum()
        along = np.cross(arm[:, None], self.frames[:, 1:])
        return np.einsum("tck,ckd,c->td", self.traction, along, self.area)

    @cached_property
    def _sliding(self) -> tuple[np.ndarray, np.ndarray]:
        return rigid_sliding(self.points, self.frames, self.area, self.shift)

    @property
    def sliding(self) -> np.ndarray:
        """(T, 3) m, rigid sliding of the first face on the second, in user axes of the first body, at the centre of the
        cells: the rigid motion nearest to `shift` (`sliding.py`)."""
        return self._sliding[0]

    @property
    def turning(self) -> np.ndarray:
        """(T, 3) rad, rotation of the first face relative to the second, user frame of the first body, likewise."""
        return self._sliding[1]

    # --- cycles ---

    def loss_between(self, begin: float, end: float) -> float:
        """Friction loss [J] between the times `begin` and `end` [s], linear between saved steps. Raises `InputError`
        for times outside of the run."""
        first, last = value_at(self.time, self.loss, np.array([begin, end]), f"contact '{self.name}'")
        return float(last - first)

    def loss_per_cycle(self, cycles: float | Sequence[float] | np.ndarray) -> np.ndarray:
        """Friction loss (cycles,) [J] in each cycle, D_k = loss(t_(k+1)) - loss(t_k).

        cycles: the period [s], for whole cycles from the first saved step on; or the ascending times [s] at which
        cycles begin and end. Under a repeated load the first cycle differs from the others, because the joint starts
        without tractions. Raises `InputError` for a period longer than the run, and times outside of it.
        """
        label = f"contact '{self.name}'"
        return np.diff(value_at(self.time, self.loss, cycle_times(self.time, cycles, label), label))

    def slip_zone(self, begin: float | None = None, end: float | None = None) -> SlipZone:
        """Cells that dissipated energy between the times `begin` and `end` [s]: which, their area, and their number
        across the zone (`slip_zone.py`). Without `begin` the loss before the first saved step is included, such as that
        of the equilibrium from which a run starts. Raises `InputError` for times outside of the run."""
        times = np.array([self.time[0] if begin is None else begin, self.time[-1] if end is None else end])
        first, last = value_at(self.time, self.cell_loss, times, f"contact '{self.name}'")
        rows = (self.time >= times[0]) & (self.time <= times[1])
        if begin is None:
            first = np.zeros_like(last)
        pressed = np.any(self.state[rows] != OPEN, axis=0) if np.any(rows) else self.state[-1] != OPEN
        return slip_zone(self.points, self.area, last - first, pressed)

    def warnings(self) -> list[str]:
        """Sources of uncertainty of this contact: faces that slid far from their cells, whose partners are fixed, slip
        zones of few cells, and skins without a response to the forces of the contact."""
        bodies = (self.view.first_body, self.view.second_body)
        found = left_out({body.name: body for body in bodies}.values())
        ratio = self.shift_distance / self.size
        if np.any(ratio > SLIDES):
            row, cell = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            found.append(
                f"cell {cell} slid by {self.shift_distance[row, cell] * 1e3:.4g} mm, {ratio[row, cell]:.2g} of its "
                f"size {self.size[cell] * 1e3:.4g} mm, but partners of cells are fixed: beyond {SLIDES:g} of a cell "
                "forces act at other places than they would; model such motion as a contact with finite sliding"
            )
        zone = self.slip_zone()
        if zone.coarse:
            found.append(
                f"the slip zone is {zone.across:.2g} cells across, {zone.cells} in all; below {ACROSS:g} the loss "
                "per cycle is uncertain: make the facets of the mesh smaller there; cells are facets, or with "
                "surfaces.Matched(size=) several of them"
            )
        return found

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "cells": self.cells, "rows": len(self.time)}


NEAREST = 3  # nodes of the face around a corner; a corner on a node has its displacement


class CellsOnSkin:
    """The corners (t, 3, 3) of the triangles of a contact's cells on the deformed skin of the first body: each moves
    with the nearest nodes of the skin, weighted by the inverse of the squared distance."""

    def __init__(self, view: SmallSlidingView, skin: Skin) -> None:
        self.skin = skin
        self.corners, self.cell = view.triangles
        own = np.flatnonzero(
            SkinNodes(skin.points, skin.triangles).on(self.corners, self.cell, len(view.cell)).sum(axis=1)
        )
        distance, near = KDTree(skin.points[own]).query(self.corners.reshape(-1, 3), k=NEAREST)
        self._nodes = own[near]
        least = 1e-12 * float(np.ptp(skin.points, axis=0).max())
        weight = 1.0 / np.maximum(distance, least) ** 2
        self._weight = weight / weight.sum(axis=1, keepdims=True)

    def displacement(self, i: int) -> np.ndarray:
        """(t, 3, 3) [m, user axes of the first body] of the corners at saved step `i`."""
        moved = self.skin.displacement(i)[self._nodes]
        return np.einsum("nk,nkd->nd", self._weight, moved).reshape(self.corners.shape)


INVERSE = np.array([-1.0, -1.0, -1.0, 1.0])  # times a unit quaternion
RANK = 1e-6  # of the largest singular value: rigid motions below it do not slide the cells


def rigid_sliding(
    points: np.ndarray, frames: np.ndarray, area: np.ndarray, slip: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Translation (T, 3) [m] at the centre of the cells and rotation (T, 3) [rad] of the second face against the first,
    in the axes of `points` (c, 3) and `frames` (c, 3, 3); slip (T, c, 2) [m]."""
    middle = area @ points / area.sum()
    arm = points - middle
    gyration = float(np.sqrt(area @ np.sum(arm**2, axis=1) / area.sum())) or 1.0
    along = frames[:, 1:]
    turning = np.cross(arm[:, None], along) / gyration
    weight = np.sqrt(area)[:, None]
    A = (np.concatenate([along, turning], axis=2) * weight[:, :, None]).reshape(-1, 6)
    found = (slip * weight).reshape(len(slip), -1) @ np.linalg.pinv(A, rcond=RANK).T
    return found[:, :3], found[:, 3:] / gyration


def of_user_frames(view: SmallSlidingView, bodies: Mapping[str, BodyHistory]) -> np.ndarray:
    """(T, c, 2) m along t_1 and t_2, displacement of the user frame of the first body relative to that of the second
    at the cells; zero within one body."""
    first, second = bodies[view.first_body.name], bodies.get(view.second_body.name)
    found = np.empty((len(first.position), len(view.area), 2))
    for i, (position, rotation) in enumerate(zip(first.position, first.rotation, strict=True)):
        placed = view.partners if second is None else second.position[i] + rotate(second.rotation[i], view.partners)
        apart = view.points - rotate(rotation * INVERSE, placed - position)
        found[i] = np.einsum("ckd,cd->ck", view.frames[:, 1:], apart)
    return found


ACROSS = 8.0  # cells across the slip zone; with fewer the loss per cycle is uncertain (1/n^2, module docstring)
LEAST = 1e-6  # of the largest loss of a cell: smaller losses result from tolerances in sticking cells


@dataclass(frozen=True, eq=False)
class SlipZone:
    """Cells of a contact that dissipated energy: `slips` (c,) bool, `area` [m2] of them, and `across`: the largest
    distance of a slipping cell from the cells that stuck under pressure, in cells; NaN if none slips or none sticks."""

    slips: np.ndarray
    area: float
    across: float

    @property
    def cells(self) -> int:
        """Number of cells in the zone."""
        return int(self.slips.sum())

    @property
    def coarse(self) -> bool:
        """True if the zone has fewer than `ACROSS` cells across, so that the loss is uncertain."""
        return bool(self.across < ACROSS)


def slip_zone(points: np.ndarray, area: np.ndarray, loss: np.ndarray, pressed: np.ndarray) -> SlipZone:
    """The slip zone of cells at `points` (c, 3) [m] with `area` (c,) [m2] and loss `loss` (c,) [J]; `pressed` (c,):
    under pressure at some time."""
    slips = loss > LEAST * max(float(loss.max(initial=0.0)), np.finfo(float).tiny)
    sticks = pressed & ~slips
    across = float("nan")
    if np.any(slips) and np.any(sticks):
        distance = KDTree(points[sticks]).query(points[slips])[0]
        across = float(np.max(distance / np.sqrt(area[slips])))
    return SlipZone(slips, float(area[slips].sum()), across)
