"""Friction on cells that travel with a patch, made by hand: one pair with any fields, and the synthetic run of rollers.

The run is that of `rubbing_run`, Carter's rolling, with its pressure and tractions on cells whose width changes from
row to row and, of the upper roller, a turning about the normal: spin of a known size.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
from rubbing_run import COLUMNS_PER_STEP, CREEPAGE, MU, SHIFT, SPEED, STICK, carter_slip, carter_traction
from shape_runs import grid_of, still
from synthetic_run import DURATION, HALF_WIDTH, PEAK, STEPS, WIDTH, make_history

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import CellHistory, ContactHistory, FrictionHistory, History
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.geometry.scene_view import BodyView, PairView, SceneView

STRIPS, CELL_ROWS = 11, 5
SPAN = 1.3  # half-widths of the cells over that of the patch, in the first row; they widen to WIDEST of it
WIDEST = 1.2
TURNING = 3.0  # rad/s of the lower roller against the upper one, about the outward normal of the lower


def cell_widths() -> np.ndarray:
    """W (T,) [m] of the synthetic run."""
    return SPAN * HALF_WIDTH * np.linspace(1.0, WIDEST, STEPS)


def make_patch_history(body: ReducedBody, *, spin: float = TURNING) -> History:
    """The run with friction on cells; the upper roller turns about the normal so that the lower one turns against it by
    `spin` [rad/s]."""
    history = make_history(body)
    (name, contact), *_ = history.contacts.items()
    W = cell_widths()
    x = 2.0 * W[:, None] / STRIPS * (np.arange(STRIPS) - 0.5 * (STRIPS - 1))
    peak = PEAK * (1.0 + history.time / DURATION)
    length = np.full((STEPS, CELL_ROWS), WIDTH / CELL_ROWS)
    z = np.tile(WIDTH / CELL_ROWS * (np.arange(CELL_ROWS) - 0.5 * (CELL_ROWS - 1)), (STEPS, 1))

    def on_rows(values: np.ndarray) -> np.ndarray:
        return np.repeat(values[:, :, None], CELL_ROWS, axis=2)

    contact.pressure = on_rows(peak[:, None] * np.sqrt(np.maximum(1.0 - (x / HALF_WIDTH) ** 2, 0.0)))
    middle = contact.center_column.copy()
    contact.cells = CellHistory(middle, W, z, length, middle, np.zeros(z.shape))
    contact.active_nodes = np.count_nonzero(contact.pressure, axis=(1, 2))
    slip, traction = (
        on_rows(carter_slip(x)),
        on_rows(np.stack([carter_traction(a, p) for a, p in zip(x, peak, strict=True)])),
    )
    inside = np.abs(x) < HALF_WIDTH
    state = on_rows(np.where(inside, np.where(x > STICK - SHIFT, 2, 1), 0)).astype(np.int8)
    fine = np.linspace(-HALF_WIDTH, HALF_WIDTH, 20001)
    contact.friction = FrictionHistory(
        traction=np.stack([traction, 0.1 * traction], axis=1), slip_velocity=np.stack([slip, 0.0 * slip], axis=1),
        state=state, power=-peak * np.trapezoid(carter_traction(fine, 1.0) * carter_slip(fine), fine) * WIDTH,
        creep_velocity=np.tile([CREEPAGE * SPEED, 0.0], (STEPS, 1)), rolling_velocity=np.full(STEPS, SPEED),
        cells_per_step=np.full(STEPS, COLUMNS_PER_STEP),
    )  # fmt: skip
    history.bodies["upper"].angular_velocity[:, 2] = -spin  # the outward normal of the lower roller is +z
    view = history.scene
    assert isinstance(view, SceneView)
    old = view.pairs[name]
    pair = PairView(name, old.first_body, old.first_surface_name, old.second_body, old.second_surface_name, friction=MU)
    history.scene = SceneView(view.content_hash, view.bodies, {name: pair}, view.joints, view.anchors)
    return history


def patch_contact(
    shape: Any,
    fields: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    *,
    widths: tuple[float, ...] = (0.5e-3,),
    length: float = 1.4e-3,
    creep: tuple[float, float] = (0.0, 0.0),
    spin: float = 0.0,
    rolling: float = 1.0,
) -> CellContactResult:
    """A pair of the surface `shape` of body "a", which turns by `spin` [rad/s] about its outward normal, with a rigid
    body "b": a row for each of the half-widths [m] of the cells, in the middle of the grid.

    fields(x, y): pressure (columns, rows) [Pa], traction and slip velocity (2, columns, rows) at x (columns, 1) along
    e_theta and y (1, rows) along the axis [m] from the middle.
    """
    T, strips, rows = len(widths), 20, 14
    scale = 1.0 if shape.kind == "plane" else float(shape.radius_at(0.0))
    grid = grid_of(shape, 1e-3 / scale, 41, np.linspace(-4e-3, 4e-3, 9))
    z = length / rows * (np.arange(rows) - 0.5 * (rows - 1))
    found = []
    for W in widths:
        x = (
            shape.side * 2.0 * W / strips * (np.arange(strips) - 0.5 * (strips - 1))
        )  # e_theta runs against theta inside
        found.append(fields(x[:, None], z[None, :]))
    pressure, traction, slip = (np.stack([np.broadcast_to(f[n], f[n].shape) for f in found]) for n in range(3))
    moves = np.any(slip != 0.0, axis=1)
    state = np.where(np.any(traction != 0.0, axis=1), np.where(moves, 2, 1), 0).astype(np.int8)
    middle, none = np.full(T, 20.0), np.zeros((T, 3))
    friction = FrictionHistory(
        traction, slip, state, np.zeros(T), np.tile(creep, (T, 1)), np.full(T, rolling), np.full(T, 0.5)
    )
    cells = CellHistory(
        middle, np.array(widths), np.tile(z, (T, 1)), np.full((T, rows), length / rows), middle, np.zeros((T, rows))
    )
    history = ContactHistory(
        none, none, none, none, np.zeros(T, dtype=int), middle, pressure, np.zeros(T, dtype=int), np.zeros((T, 2, 2)),
        np.zeros(T), np.count_nonzero(pressure, axis=(1, 2)), friction, cells,
    )  # fmt: skip
    reduced: Any = SimpleNamespace(
        contact_surfaces={"face": SimpleNamespace(name="face", shape=shape, grid=grid)}, provenance={}
    )
    pair = PairView(
        "a-b", BodyView("a", reduced, 1.0, np.zeros(3)), "face",
        BodyView("b", None, 1.0, np.zeros(3), shapes={"face": shape}), "face", MU,
    )  # fmt: skip
    bodies = {"a": still(), "b": still()}
    for motion in bodies.values():
        for field in ("position", "rotation", "velocity", "angular_velocity", "modal"):
            setattr(motion, field, np.repeat(getattr(motion, field), T, axis=0))
    bodies["a"].angular_velocity = spin * np.tile(shape.normal(0.0, 0.0), (T, 1))
    contact = CellContactResult(history, pair, bodies)
    contact.patch_kind = "point"  # the second surface is only a stand-in
    return contact
