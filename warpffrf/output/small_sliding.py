r"""Laps of a run: fields over their cells, losses, slip zones, and places for pictures.

Chart. The cells of a lap laid flat: seen along their mean normal, or unrolled around the axis that normals turn about.

With the normals n_c and areas A_c, |sum A n| / sum A is 1 of a plane and 0 of a full turn. Above `FLAT` the cells are
projected on the plane across the mean normal. Otherwise the axis a is the direction that the normals have least of, the
eigenvector of sum A n n^T to the smallest eigenvalue; it goes through the place whose distance from the lines through
the cells along their normals is least, and places have the arc r phi and the height along a, with r the mean radius.
Triangles are cut nowhere: each is drawn on the side of the seam on which its middle is.

Lap result. One lap of a run: what it does to its bodies, its fields over cells, what friction takes, and where it
slips.

On skin. Displacement of the corners of a lap's cells, from that of the first body's skin, for pictures.

Sliding. How faces have slid and turned on each other as wholes: the rigid motion that slips of cells are nearest to.

With the slips w_c (2,) along t_1, t_2 of cells at x_c, areas A_c and their middle x, the translation d and the turn
theta are those of

    min  sum_c A_c | w_c - T_c (d + theta x (x_c - x)) |^2,        T_c = rows t_1, t_2,

of all that do as well the smallest, with theta measured by the radius of gyration of the cells: what slides no face,
such as a translation along the normal of a plane, is zero.

Without friction the engine follows no slips. Places x_c of the first body and y_c of the second, the same at the
initial pose, are then apart by

    A_1^T (r_2 + A_2 y_c - r_1) - x_c

in the axes of the first body, with r and A positions and rotations of the user frames: the elastic part is left out.

Slip zone. The slip zone of a lap in a time, and how well cells resolve it.

Where a joint slips in part, the loss is made in a zone between the outline and the stick region, a few cells wide or
many. Of a bar (stiffness EA) that is pulled at its end by +-F and held by friction tau per length, cells of length a,
K = EA/a springs between them, each cell gives at most tau a. At f = F/(tau a) = n + 1/2 the n first cells slip, and by
the differences of forces along the chain, a cycle takes

    D_cells = 4 (tau a)^2 / K  sum_{j=1..n} j (f - j) = (tau a)^2 / (3 K)  n (n + 1) (2 n + 1),

beside D = 2 F^3/(3 EA tau) of the continuous bar:

    D_cells / D = 4 n (n + 1) / (2 n + 1)^2 = 1 - 1/(2 n + 1)^2,        n cells across,

at f = n it is 1 - 1/n^2. `ACROSS` cells leave 1.6 % at most there, one or two cells anything. Zones that are not
straight, and pressures that fall across them, take more.
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
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import SmallSlidingView
from warpffrf.output.geometry.skin_nodes import SkinNodes
from warpffrf.output.loops import cycle_times, value_at
from warpffrf.output.recorded import Recorded

FLAT = 0.8  # of the sum of areas: a cap of 120 degrees around is still seen from above


@dataclass(frozen=True, eq=False)
class CellChart:
    """Triangles (t, 3, 2) [m] of the cells laid flat, the cell (t,) of each, the middles (c, 2) [m] of the cells, and
    what the two axes of the map are. `radius` [m] of one that was unrolled, else None."""

    triangles: np.ndarray
    cell: np.ndarray
    points: np.ndarray
    labels: tuple[str, str]
    radius: float | None


def cell_chart(view: SmallSlidingView) -> CellChart:
    """The chart of a lap's cells, in the axes of the first body."""
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
    """Two axes (2, 3) across `normal`, right-handed with it, near axes of the body, and their names."""
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
    """The place (3,) in the plane of `across` (2, 3) that is nearest to the lines along `normals`."""
    n = normals @ across.T
    n = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
    side = np.stack([-n[:, 1], n[:, 0]], axis=1)
    flat = points @ across.T
    return np.linalg.lstsq(side, np.einsum("ci,ci->c", side, flat), rcond=None)[0] @ across


OPEN, STICK, SLIP = 0, 1, 2
SLIDES = 0.5  # of the size of a cell: faces that slide further have other partners than those of the run


class SmallSlidingResult(reprs.Shown):
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

    def __init__(
        self, history: SmallSlidingHistory, view: SmallSlidingView, time: np.ndarray, bodies: Mapping[str, BodyHistory]
    ) -> None:
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
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @cached_property
    def loss(self) -> np.ndarray:
        """(T,) J, taken by friction since the scene began: the sum of `cell_loss`."""
        return self.cell_loss.sum(axis=1)

    @cached_property
    def peak_pressure(self) -> np.ndarray:
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
        first, last = value_at(self.time, self.loss, np.array([begin, end]), f"contact '{self.name}'")
        return float(last - first)

    def loss_per_cycle(self, cycles: float | Sequence[float] | np.ndarray) -> np.ndarray:
        """Energy (cycles,) [J] that friction took in each cycle, D_k = loss(t_(k+1)) - loss(t_k).

        cycles: the period [s], for whole cycles from the first saved step on; or the times [s] at which cycles begin
        and end, ascending. Of a load that is repeated the first cycle differs from those that follow, as the joint
        begins without tractions. Raises `InputError` for a period longer than the run, and times outside of it.
        """
        label = f"contact '{self.name}'"
        return np.diff(value_at(self.time, self.loss, cycle_times(self.time, cycles, label), label))

    def slip_zone(self, begin: float | None = None, end: float | None = None) -> SlipZone:
        """Cells that lost energy between the times `begin` and `end` [s]: which, their area, and how many there are
        across (`slip_zone.py`). Without a begin what they lost before the first saved step counts, too, as in the
        equilibrium that a run starts from. Raises `InputError` for times outside of the run."""
        times = np.array([self.time[0] if begin is None else begin, self.time[-1] if end is None else end])
        first, last = value_at(self.time, self.cell_loss, times, f"contact '{self.name}'")
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
                "forces act at other places than they would; model such motion as a contact with finite sliding"
            )
        zone = self.slip_zone()
        if zone.coarse:
            found.append(
                f"the slip zone is {zone.across:.2g} cells across, {zone.cells} in all; below {ACROSS:g} the loss "
                "per cycle is uncertain: make cells smaller there, "
                "reduce(contact={...: surfaces.Matched(size=, growth=)})"
            )
        return found

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "cells": self.cells, "rows": len(self.time)}


NEAREST = 3  # nodes of the face beside a corner; a corner on a node has its displacement


class CellsOnSkin:
    """The corners (t, 3, 3) of the triangles that the cells of a lap consist of, on the deformed skin of the first
    body: each moves as the nodes of the skin next to it, weighed by the inverse of their distance squared."""

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
RANK = 1e-6  # of the largest singular value: rigid motions that slide the cells by less are none


def rigid_sliding(
    points: np.ndarray, frames: np.ndarray, area: np.ndarray, slip: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Translation (T, 3) [m] at the middle of the cells and turn (T, 3) [rad] of the second face against the first, in
    the axes of `points` (c, 3) and `frames` (c, 3, 3); slip (T, c, 2) [m]."""
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
    """(T, c, 2) m along t_1 and t_2, by how much the user frame of the second body has moved against that of the first
    at the cells; zero within one body."""
    first, second = bodies[view.first_body.name], bodies.get(view.second_body.name)
    found = np.empty((len(first.position), len(view.area), 2))
    for i, (position, rotation) in enumerate(zip(first.position, first.rotation, strict=True)):
        placed = view.partners if second is None else second.position[i] + rotate(second.rotation[i], view.partners)
        apart = rotate(rotation * INVERSE, placed - position) - view.points
        found[i] = np.einsum("ckd,cd->ck", view.frames[:, 1:], apart)
    return found


ACROSS = 8.0  # cells across the slip zone, below which the loss per cycle is uncertain (1/n^2, module docstring)
LEAST = 1e-6  # of the largest loss of a cell: below it is what tolerances leave of sticking


@dataclass(frozen=True, eq=False)
class SlipZone:
    """Cells of a lap that friction took energy in: `slips` (c,) bool, `area` [m2] of them, and `across`: the farthest
    of them from the cells that pressed and stuck, in cells; NaN where none slips, or no cell sticks."""

    slips: np.ndarray
    area: float
    across: float

    @property
    def cells(self) -> int:
        """Number of cells in the zone."""
        return int(self.slips.sum())

    @property
    def coarse(self) -> bool:
        """True where the zone has fewer than `ACROSS` cells across, so that the loss is uncertain."""
        return bool(self.across < ACROSS)


def slip_zone(points: np.ndarray, area: np.ndarray, loss: np.ndarray, pressed: np.ndarray) -> SlipZone:
    """Of cells at `points` (c, 3) [m] with `area` (c,) [m2] that lost `loss` (c,) [J], and were `pressed` (c,) at some
    time."""
    slips = loss > LEAST * max(float(loss.max(initial=0.0)), np.finfo(float).tiny)
    sticks = pressed & ~slips
    across = float("nan")
    if np.any(slips) and np.any(sticks):
        distance = KDTree(points[sticks]).query(points[slips])[0]
        across = float(np.max(distance / np.sqrt(area[slips])))
    return SlipZone(slips, float(area[slips].sum()), across)
