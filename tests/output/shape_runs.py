"""Contact results of pairs of any shapes with a pressure given in closed form, without an offline run."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
from synthetic_run import STEPS, R, make_history

from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.surfaces import Plane
from warpffrf.online.history.history import BodyHistory, ContactHistory, History
from warpffrf.output.contact.result import ContactResult
from warpffrf.output.geometry.scene_view import BodyView, PairView, SceneView, ground_view

YOUNG, POISSON = 200e9, 0.3
PLANE_STRAIN = YOUNG / (1.0 - POISSON**2)  # E* of one flexible body on a rigid one


def grid_of(shape: Any, pitch: float, columns: int, z: np.ndarray, *, middle: float = 0.0) -> SurfaceGrid:
    """An arc of `columns` about theta = middle."""
    return SurfaceGrid(shape.e_0, middle - 0.5 * (columns - 1) * pitch, pitch, columns, False, z, 1)


def still(position: Any = (0.0, 0.0, 0.0), rotation: Any = (0.0, 0.0, 0.0, 1.0)) -> BodyHistory:
    """A body that does not move, one row."""
    zero = np.zeros((1, 3))
    return BodyHistory(np.array([position], float), np.array([rotation], float), zero, zero, np.zeros((1, 0)))


def contact_of(
    first: Any,
    grid: SurfaceGrid,
    second: Any,
    pressure: Callable[[np.ndarray, np.ndarray], np.ndarray],
    *,
    bodies: dict[str, BodyHistory] | None = None,
    second_grid: SurfaceGrid | None = None,
    friction: Any = None,
) -> ContactResult:
    """A result of one row of the surface `first` of body "a" on `second` of body "b" (rigid without `second_grid`).

    pressure(theta, z) [Pa], in the chart of the first surface, is sampled at the nodes; the line of centres is column
    (columns - 1)/2.
    """

    def body(name: str, shape: Any, grid: SurfaceGrid | None) -> BodyView:
        if grid is None:
            return BodyView(name, None, 1.0, np.zeros(3), shapes={"face": shape})
        material = {"youngs_modulus": YOUNG, "poisson_ratio": POISSON}
        surface = SimpleNamespace(name="face", shape=shape, grid=grid)
        reduced = SimpleNamespace(
            contact_surfaces={"face": surface}, provenance={"contact_materials": {"face": material}}
        )
        return BodyView(name, reduced, 1.0, np.zeros(3))

    p = pressure(grid.theta[:, None], np.asarray(grid.z)[None, :])[None]
    zero, one = np.zeros((1, 3)), np.zeros(1)
    history = ContactHistory(
        zero, zero, zero, zero, np.zeros(1, dtype=int), np.array([0.5 * (grid.columns - 1)]), p, np.zeros(1, dtype=int),
        np.zeros((1, 2, 2)), one, np.count_nonzero(p, axis=(1, 2)), friction,
    )  # fmt: skip
    pair = PairView("a-b", body("a", first, grid), "face", body("b", second, second_grid), "face", 0.3)
    return ContactResult(history, pair, bodies or {"a": still(), "b": still()})


def ellipsoid(a: float, b: float, peak: float, *, turn: float = 0.0) -> Callable[[Any, Any], np.ndarray]:
    """Hertz's pressure over x, y [m] with semi-axes a, b; the first rotated by `turn` from x towards y."""

    def pressure(x: Any, y: Any) -> np.ndarray:
        along, across = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
        return peak * np.sqrt(np.maximum(0.0, 1.0 - (along / a) ** 2 - (across / b) ** 2))

    return pressure


def on_the_floor(body: Any) -> History:
    """The lower roller with a rigid floor on top of it instead of the upper roller."""
    history = make_history(body)
    old = history.scene
    assert isinstance(old, SceneView)
    floor = Plane(origin=(0.0, 0.0, R), outward=(0.0, 0.0, -1.0))
    lower = old.bodies["lower"]
    pair = PairView("lower-upper", lower, "rim", ground_view({"floor": floor}), "floor", 0.1)
    history.scene = SceneView("hash", {"lower": lower}, {"lower-upper": pair})
    del history.bodies["upper"]
    history.contacts["lower-upper"].load_second = np.zeros((STEPS, 0, 0))  # a rigid surface has no grid
    return history
