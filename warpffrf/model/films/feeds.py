"""Oil feeds of a film: regions of its first surface with prescribed pressure.

Positions are in the chart of the first surface (`warpffrf.model.surfaces`): theta [rad, of a plane m] from the
direction e_0 of its shape, z [m] along its axis; widths and diameters [m] are lengths on the surface. A feed that
covers no node of the grid applies to the nearest one, a groove to the nearest column, a ring to the nearest row.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments


class Feed(ABC):
    """A feed: a frozen dataclass with a `kind` and a `pressure` [Pa]."""

    kind: ClassVar[str]
    pressure: float

    @property
    @abstractmethod
    def label(self) -> str:
        """Readable position, for messages."""

    @property
    @abstractmethod
    def place(self) -> tuple[float | None, tuple[float, float] | None]:
        """Its centre theta [rad, of a plane m] and its extent along z [m]; None where it is unbounded."""

    @abstractmethod
    def covers(self, shape: Any, theta: Any, z: Any) -> np.ndarray:
        """Whether points theta [rad, of a plane m], z [m] of the surface `shape` lie in it; arguments broadcast."""

    @property
    def reaches_ends(self) -> bool:
        """Whether it may prescribe nodes of the first and last row."""
        return True

    def nodes(self, shape: Any, theta: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, bool]:
        """Nodes (columns, rows) bool of the grid of a surface `shape`, at theta (columns,) [rad, of a plane m] and z
        (rows,) [m], with its pressure, and whether it covers them: False if they are only the nearest ones."""
        found = self.covers(shape, theta[:, None], z[None, :])
        if not self.reaches_ends:
            found[:, [0, -1]] = False
        if found.any():
            return found, True
        return self.nearest(shape, theta, z), False

    @abstractmethod
    def nearest(self, shape: Any, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        """The nodes (columns, rows) bool of the grid of the surface `shape`, at theta (columns,) [rad, of a plane m],
        z (rows,) [m], that are nearest to it, none in the first and the last row."""

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}

    def _keep_numbers(self, *names: str) -> None:
        """Checked numbers: coordinates of any sign, positive widths and diameters, non-negative pressure."""
        for name in names:
            positive = name in ("width", "diameter")
            label = f"films.{type(self).__name__}: {name}"
            value = require_number(getattr(self, name), label, positive=positive, non_negative=name == "pressure")
            object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True)
class AxialGroove(Feed):
    """A groove along the axis at the angle theta [rad, of a plane m], of the `width` [m]; pressure [Pa].

    z: its ends (low, high) [m]; None: the whole length except the end rows, which keep the ambient pressure. Raises
    `InputError`.
    """

    theta: float
    width: float
    pressure: float
    z: tuple[float, float] | None = None
    kind: ClassVar[str] = "axial_groove"

    def __post_init__(self) -> None:
        self._keep_numbers("theta", "width", "pressure")
        if self.z is not None:
            low, high = require_array(self.z, "films.AxialGroove: z [m], (low, high)", (2,))
            if not low < high:
                raise InputError(f"films.AxialGroove: z must be (low, high) with low < high, got ({low:g}, {high:g})")
            object.__setattr__(self, "z", (float(low), float(high)))

    @property
    def label(self) -> str:
        return f"groove at theta = {self.theta:.4g}"

    @property
    def place(self) -> tuple[float | None, tuple[float, float] | None]:
        return self.theta, self.z

    @property
    def reaches_ends(self) -> bool:
        return self.z is not None

    def covers(self, shape: Any, theta: Any, z: Any) -> np.ndarray:
        off, z = np.broadcast_arrays(np.abs(_turn(shape, theta, self.theta)), np.asarray(z, float))
        across = off * shape.radius_at(z) <= 0.5 * self.width
        return across if self.z is None else across & (z >= self.z[0]) & (z <= self.z[1])

    def nearest(self, shape: Any, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        if self.z is None:
            middle, rows = 0.5 * (z[0] + z[-1]), np.ones(len(z), dtype=bool)
            rows[[0, -1]] = False
        else:
            middle = 0.5 * (self.z[0] + self.z[1])
            rows = _within(_between_ends(np.abs(z - middle)), 0.5 * (self.z[1] - self.z[0]))
        across = np.abs(_turn(shape, theta, self.theta)) * float(shape.radius_at(middle))
        return _within(across, 0.5 * self.width)[:, None] & rows[None, :]


@named_arguments
@dataclass(frozen=True)
class CircumferentialGroove(Feed):
    """A groove all around at z [m], of the `width` [m] along the meridian; pressure [Pa]. Raises `InputError`."""

    z: float
    width: float
    pressure: float
    kind: ClassVar[str] = "circumferential_groove"

    def __post_init__(self) -> None:
        self._keep_numbers("z", "width", "pressure")

    @property
    def label(self) -> str:
        return f"ring at z = {self.z:.4g}"

    @property
    def place(self) -> tuple[float | None, tuple[float, float] | None]:
        return None, (self.z, self.z)

    def covers(self, shape: Any, theta: Any, z: Any) -> np.ndarray:
        _, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return _along(shape, z, self.z) <= 0.5 * self.width

    def nearest(self, shape: Any, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        rows = _within(_between_ends(_along(shape, z, self.z)), 0.5 * self.width)
        return np.repeat(rows[None, :], len(theta), axis=0)


@named_arguments
@dataclass(frozen=True)
class SupplyHole(Feed):
    """A round hole at theta [rad, of a plane m], z [m], of the `diameter` [m]; pressure [Pa]. Raises `InputError`."""

    theta: float
    z: float
    diameter: float
    pressure: float
    kind: ClassVar[str] = "supply_hole"

    def __post_init__(self) -> None:
        self._keep_numbers("theta", "z", "diameter", "pressure")

    @property
    def label(self) -> str:
        return f"hole at theta = {self.theta:.4g}, z = {self.z:.4g}"

    @property
    def place(self) -> tuple[float | None, tuple[float, float] | None]:
        return self.theta, (self.z, self.z)

    def covers(self, shape: Any, theta: Any, z: Any) -> np.ndarray:
        return self._distance(shape, theta, z) <= 0.5 * self.diameter

    def nearest(self, shape: Any, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        distance = self._distance(shape, theta[:, None], z[None, :])
        distance[:, [0, -1]] = np.inf
        return _within(distance.ravel(), 0.5 * self.diameter).reshape(distance.shape)

    def _distance(self, shape: Any, theta: Any, z: Any) -> np.ndarray:
        """Distances [m] of points from its centre on the surface; accurate nearby, where the surface is nearly flat."""
        off, z = np.broadcast_arrays(np.abs(_turn(shape, theta, self.theta)), np.asarray(z, float))
        return np.hypot(off * shape.radius_at(z), _along(shape, z, self.z))


FEEDS: dict[str, type[Any]] = {feed.kind: feed for feed in (AxialGroove, CircumferentialGroove, SupplyHole)}


def _turn(shape: Any, theta: Any, middle: float) -> np.ndarray:
    """theta - middle [rad, of a plane m], in the shorter direction."""
    off = np.asarray(theta, float) - middle
    return off if shape.profile().planar else np.remainder(off + np.pi, 2.0 * np.pi) - np.pi


def _along(shape: Any, z: np.ndarray, middle: float) -> np.ndarray:
    """Lengths [m] on the meridian from `middle` to nearby points."""
    steep = 0.0 if shape.profile().planar else shape.slope_at(z)
    return np.abs(z - middle) * np.sqrt(1.0 + steep**2)


def _between_ends(distance: np.ndarray) -> np.ndarray:
    """Distances (rows,) with the first and the last row excluded."""
    return np.concatenate([[np.inf], distance[1:-1], [np.inf]])


def _within(distance: np.ndarray, reach: float) -> np.ndarray:
    """Where distances (n,) are at most `reach`; if there are none, the smallest."""
    found = distance <= reach
    if not found.any():
        found[np.argmin(distance)] = True
    return found
