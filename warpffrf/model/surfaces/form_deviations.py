r"""Deviations of a surface from its true shape, which add to the gap of a film: positive where material is missing.

Coordinates are those of the chart of the surface with the form: theta [rad, of a plane m], z [m]. Forms add up:
`LobedForm(5e-6, 2) + BarrelForm(3e-6, 0.03)`. A user-defined form is a subclass of `Form`.

Round form. A form deviation around a rigid surface of revolution in lumped contact: waviness, ovality, a measured
roundness.

A form of `warpffrf.films` is the missing material, w(theta) [m], which adds to the gap. Here it depends on the angle
theta about the axis alone, and is kept as the periodic cubic spline through STEPS points: a wave of order 60 has an
error of 1e-8 of its amplitude, and of 1e-4 of its curvature. Its effect on gap, normal and curvature, of first order
in the slope, is derived in `warpffrf_kernels.lumped.form`.

Two surfaces touch at a single point only where the one curves more than the other follows: around the axis the relative
curvature of the ideal surfaces must exceed -w''/rho^2, the hollow that a wave makes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments

TURN = 2.0 * np.pi


class Form(ABC):
    """A form deviation: a frozen dataclass with a `kind`, called with coordinates."""

    kind: ClassVar[str]

    @abstractmethod
    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        """Contribution to the gap [m] at theta [rad, of a plane m], z [m]; arguments broadcast."""

    @property
    def turns(self) -> bool:
        """Whether it is periodic over a revolution, and so not applicable to a plane."""
        return False

    def __add__(self, other: Any) -> CompositeForm:
        return CompositeForm((self, other)) if isinstance(other, Form) else NotImplemented

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: v.tolist() if isinstance(v, np.ndarray) else v for n, v in values.items()}


@named_arguments
@dataclass(frozen=True)
class LobedForm(Form):
    """Waves around, amplitude cos(count (theta - phase)); amplitude [m], phase [rad] of a point where material is
    missing. A count of 2 gives an oval surface. Raises `InputError`."""

    amplitude: float
    count: int
    phase: float = 0.0
    kind: ClassVar[str] = "lobed_form"

    def __post_init__(self) -> None:
        _keep_number(self, "amplitude", "[m]")
        object.__setattr__(self, "count", require_count(self.count, "films.LobedForm: count", 1))
        _keep_number(self, "phase", "[rad]")

    @property
    def turns(self) -> bool:
        return True

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.amplitude * np.cos(self.count * (theta - self.phase))


@named_arguments
@dataclass(frozen=True)
class BarrelForm(Form):
    """A parabola along the axis: zero at `middle` [m], `drop` [m] at half the `length` [m] from it;
    hollow where the drop is negative. Raises `InputError`."""

    drop: float
    length: float
    middle: float = 0.0
    kind: ClassVar[str] = "barrel_form"

    def __post_init__(self) -> None:
        _keep_number(self, "drop", "[m]")
        _keep_number(self, "length", "[m]", positive=True)
        _keep_number(self, "middle", "[m]")

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        _, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.drop * (2.0 * (z - self.middle) / self.length) ** 2


@named_arguments
@dataclass(frozen=True)
class WornForm(Form):
    """A worn region, or a spall, depth cos^2(pi/2 (angle from theta)/width) within the angle `width` [rad] to both
    sides of theta [rad], along the whole length; depth [m]. Raises `InputError`."""

    depth: float
    theta: float
    width: float
    kind: ClassVar[str] = "worn_form"

    def __post_init__(self) -> None:
        _keep_number(self, "depth", "[m]")
        _keep_number(self, "theta", "[rad]")
        _keep_number(self, "width", "[rad]", positive=True)
        if self.width > np.pi:
            raise InputError(
                f"films.WornForm: width must be at most pi, half a revolution to each side, got {self.width:g} rad"
            )

    @property
    def turns(self) -> bool:
        return True

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        off = np.abs(np.remainder(theta - self.theta + np.pi, TURN) - np.pi)
        return np.where(off < self.width, self.depth * np.cos(0.5 * np.pi * off / self.width) ** 2, 0.0)


@named_arguments
@dataclass(frozen=True)
class PadForm(Form):
    """A pad whose centre of curvature lies `offset` [m] off the axis, away from theta [rad]: the gap is narrower by
    offset cos(angle from theta) between the angles `within` (first, last) [rad] of the pad, and unchanged elsewhere.
    Raises `InputError`."""

    offset: float
    theta: float
    within: tuple[float, float]
    kind: ClassVar[str] = "pad_form"

    def __post_init__(self) -> None:
        _keep_number(self, "offset", "[m]")
        _keep_number(self, "theta", "[rad]")
        _keep_limits(self, "within", "[rad]")

    @property
    def turns(self) -> bool:
        return True

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return np.where(_inside(theta, self.within), -self.offset * np.cos(theta - self.theta), 0.0)


@named_arguments
@dataclass(frozen=True)
class PocketForm(Form):
    """A pocket with sharp edges, `depth` [m], between the angles theta (first, last) [rad, of a plane m] and z (low,
    high) [m], the whole length if None; a dam, or the texture of a slider. Its edges should lie on columns and rows of
    the film's grid. Raises `InputError`."""

    depth: float
    theta: tuple[float, float]
    z: tuple[float, float] | None = None
    kind: ClassVar[str] = "pocket_form"

    def __post_init__(self) -> None:
        _keep_number(self, "depth", "[m]")
        _keep_limits(self, "theta", "[rad, of a plane m]")
        if self.z is not None:
            _keep_limits(self, "z", "[m]")

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        inside = _inside(theta, self.theta)
        if self.z is not None:
            inside &= (z >= self.z[0]) & (z <= self.z[1])
        return np.where(inside, self.depth, 0.0)


@named_arguments
@dataclass(frozen=True, eq=False)
class MeasuredForm(Form):
    """Measured deviations, `values` (n, m) [m] at theta (n,) [rad, of a plane m] and z (m,) [m], both rising,
    straight between them; beyond the outermost z their value.

    periodic: over the full revolution, with the first theta after the last; otherwise constant beyond the outermost
    theta too. Raises `InputError`.
    """

    theta: Any
    z: Any
    values: Any
    periodic: bool = True
    kind: ClassVar[str] = "measured_form"

    def __post_init__(self) -> None:
        theta = require_array(self.theta, "films.MeasuredForm: theta", (None,))
        z = require_array(self.z, "films.MeasuredForm: z [m]", (None,))
        for name, places in (("theta", theta), ("z", z)):
            if not len(places):
                raise InputError(f"films.MeasuredForm: {name} is empty, at least one point is needed")
            if np.any(wrong := np.diff(places) <= 0.0):
                i = int(np.argmax(wrong))
                raise InputError(
                    f"films.MeasuredForm: {name} must rise, got {places[i]:g} and then {places[i + 1]:g} (points {i} "
                    f"and {i + 1})"
                )
        values = require_array(self.values, "films.MeasuredForm: values [m]", (None, None))
        if values.shape != (len(theta), len(z)):
            raise InputError(
                f"films.MeasuredForm: values must have shape ({len(theta)}, {len(z)}), a row for each theta and a "
                f"column for each z, got {values.shape}"
            )
        if self.periodic and theta[-1] - theta[0] >= TURN * (1.0 - 1e-12):
            raise InputError(
                f"films.MeasuredForm: theta spans {theta[-1] - theta[0]:g} rad, a full revolution or more; leave out "
                "the last point, which repeats the first, or use periodic=False on a plane"
            )
        for name, array in (("theta", theta), ("z", z), ("values", values)):
            object.__setattr__(self, name, array)
        object.__setattr__(self, "periodic", bool(self.periodic))

    @property
    def turns(self) -> bool:
        return self.periodic

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        at, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        places, values = self.theta, self.values
        if self.periodic:
            at = places[0] + np.remainder(at - places[0], TURN)
            places, values = np.append(places, places[0] + TURN), np.concatenate([values, values[:1]])
        i, s = _piece(places, at)
        k, t = _piece(self.z, z)
        i_next, k_next = np.minimum(i + 1, len(places) - 1), np.minimum(k + 1, len(self.z) - 1)
        low = (1.0 - t) * values[i, k] + t * values[i, k_next]
        high = (1.0 - t) * values[i_next, k] + t * values[i_next, k_next]
        return (1.0 - s) * low + s * high


@named_arguments
@dataclass(frozen=True)
class CompositeForm(Form):
    """The sum of several forms, the result of `+`. Raises `InputError` for parts that are no forms."""

    parts: tuple[Form, ...]
    kind: ClassVar[str] = "composite_form"

    def __post_init__(self) -> None:
        parts = tuple(self.parts) if isinstance(self.parts, Sequence) else (self.parts,)
        flat: list[Form] = []
        for part in parts:
            if not isinstance(part, Form):
                raise InputError(f"films.CompositeForm: parts must be forms, {_names()}, got {part!r}")
            flat += part.parts if isinstance(part, CompositeForm) else [part]
        if not flat:
            raise InputError("films.CompositeForm: parts is empty; leave the form out")
        object.__setattr__(self, "parts", tuple(flat))

    @property
    def turns(self) -> bool:
        return any(part.turns for part in self.parts)

    def __call__(self, theta: Any, z: Any) -> np.ndarray:
        return np.sum([part(theta, z) for part in self.parts], axis=0)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "parts": [part.describe() for part in self.parts]}


FORMS: dict[str, type[Any]] = {
    form.kind: form for form in (LobedForm, BarrelForm, WornForm, PadForm, PocketForm, MeasuredForm, CompositeForm)
}


def as_form(value: Any, label: str) -> Form | None:
    """`value` as a form, None for none; raises `InputError` naming `label`, with the existing forms."""
    if value is None or isinstance(value, Form):
        return value
    raise InputError(f"{label} must be one of {_names()}, or a sum of them, got {value!r}")


def _names() -> str:
    return ", ".join(f"films.{form.__name__}" for form in FORMS.values() if form is not CompositeForm)


def _keep_number(form: Form, name: str, unit: str, *, positive: bool = False) -> None:
    label = f"films.{type(form).__name__}: {name} {unit}"
    object.__setattr__(form, name, require_number(getattr(form, name), label, positive=positive))


def _keep_limits(form: Form, name: str, unit: str) -> None:
    label = f"films.{type(form).__name__}: {name} {unit}, (first, last)"
    low, high = require_array(getattr(form, name), label, (2,))
    if not low < high:
        raise InputError(f"{label}, must rise, got ({low:g}, {high:g})")
    object.__setattr__(form, name, (float(low), float(high)))


def _inside(theta: np.ndarray, limits: tuple[float, float]) -> np.ndarray:
    """Whether angles, also lengths of less than 2 pi m, lie between limits."""
    return np.remainder(theta - limits[0], TURN) <= limits[1] - limits[0]


def _piece(places: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The piece between ascending `places` (n,) that contains each `at`, and the fraction along it, 0 to 1; of one
    place 0."""
    if len(places) == 1:
        return np.zeros(at.shape, dtype=int), np.zeros(at.shape)
    i = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    return i, np.clip((at - places[i]) / (places[i + 1] - places[i]), 0.0, 1.0)


STEPS = 16384  # around
AGREES = 1e-4  # of the largest deviation: admissible distance of the spline from the form between its points


@dataclass(frozen=True, eq=False)
class RoundForm:
    """A form whose angles count from `start` [rad] of the chart of its surface."""

    form: Form
    start: float = 0.0

    @classmethod
    def of(cls, value: Any, shape: Any, label: str) -> RoundForm:
        """A checked one: `value` a form of `warpffrf.films`, or a `RoundForm`. Raises `InputError` naming `label`."""
        found = value if isinstance(value, cls) else cls(_known(value, f"{label}: form"))
        profile = shape.profile()
        if profile.planar or profile.spherical:
            raise InputError(
                f"{label}: form: a {shape.kind} has no axis of revolution for a form deviation; give it to a raceway "
                "or another surface of revolution"
            )
        theta = np.linspace(0.0, TURN, 64, endpoint=False)
        ends = [found.form(theta, z) for z in (-shape.radius, 0.0, shape.radius)]
        size = float(np.max(np.abs(ends))) or 1.0
        if np.ptp(ends, axis=0).max() > AGREES * size or not found.form.turns:
            raise InputError(
                f"{label}: form: {found.form.kind} changes along the axis, or does not close around it; a lumped "
                "contact supports waves around the axis, films.LobedForm, films.WornForm, or films.MeasuredForm with "
                "one z"
            )
        middle = (np.arange(STEPS) + 0.5) * TURN / STEPS
        off = np.abs(found.at(middle + found.start)[0] - _curve(found.form, middle)).max()
        if off > AGREES * size:
            raise InputError(
                f"{label}: form: {found.form.kind} has waves too short or edges too sharp, {STEPS} points around have "
                f"an error of {off:.3g} m; use fewer waves, or wider hollows"
            )
        return found

    @cached_property
    def pieces(self) -> np.ndarray:
        """(STEPS, 4): cubics of w [m] in powers of the angle [rad] from the beginning of each piece."""
        from scipy.interpolate import CubicSpline

        steps = np.linspace(0.0, TURN, STEPS + 1)
        w = _curve(self.form, steps[:-1])
        return np.ascontiguousarray(CubicSpline(steps, [*w, w[0]], bc_type="periodic").c[::-1].T)

    def at(self, theta: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """w [m] and its derivatives w' and w'' [m] by angles [rad] of the surface's chart, any shape."""
        along = np.mod((np.asarray(theta, float) - self.start) / TURN, 1.0) * STEPS
        i = np.minimum(along.astype(int), STEPS - 1)
        t = (along - i) * (TURN / STEPS)
        c0, c1, c2, c3 = np.moveaxis(self.pieces[i], -1, 0)
        return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + 3.0 * t * c3), 2.0 * c2 + 6.0 * t * c3

    def turned(self, angle: float) -> RoundForm:
        """The same form, rotated by `angle` [rad]."""
        return RoundForm(self.form, self.start + angle)

    @property
    def most_hollow(self) -> float:
        """The largest -w'' [m]: where a surface is made most concave."""
        return float(np.max(-2.0 * self.pieces[:, 2], initial=0.0))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"form": self.form.describe(), "start": self.start}


def refuse_form(port: Any, label: str) -> None:
    """Raises `InputError` for a surface whose form deviation would be ignored."""
    if port.surface.form is not None:
        raise InputError(
            f"{label}: {port.label} has a form deviation, which only lumped contacts support; leave it out, or give a "
            "film its own, Film(..., form_a=...)"
        )


def _known(value: Any, label: str) -> Form:
    form = as_form(value, label)
    if form is None:
        raise InputError(f"{label} is None; leave it out")
    return form


def _curve(form: Form, theta: np.ndarray) -> np.ndarray:
    """w [m] at angles [rad]; of a measured form a smooth curve through its values instead of straight lines."""
    if isinstance(form, CompositeForm):
        return np.sum([_curve(part, theta) for part in form.parts], axis=0)
    if not isinstance(form, MeasuredForm) or len(form.theta) < 3:
        return form(theta, np.zeros_like(theta))
    from scipy.interpolate import CubicSpline

    places, values = form.theta, form(form.theta, np.zeros(len(form.theta)))
    spline = CubicSpline([*places, places[0] + TURN], [*values, values[0]], bc_type="periodic")
    return spline(places[0] + np.mod(theta - places[0], TURN))
