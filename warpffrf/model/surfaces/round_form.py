r"""A form deviation around a rigid surface of revolution in lumped contact: waviness, ovality, a measured roundness.

A form of `warpffrf.films` says by how much material is missing, w(theta) [m], and adds to the gap. Here it depends on
the angle theta about the axis alone, and is kept as the periodic cubic spline through STEPS places: a wave of order 60
has an error of 1e-5 of its amplitude, and of 0.1 % of its curvature. What the device makes of it, gap, normal and
curvature of first order in the slope, is derived in `warpffrf_kernels.lumped.form`.

Two surfaces touch in one place only where the one curves more than the other follows: around the axis the relative
curvature of the ideal surfaces must exceed -w''/rho^2, the hollow that a wave makes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.surfaces.form_deviations import CompositeForm, Form, MeasuredForm, as_form

STEPS = 4096  # around
AGREES = 1e-4  # of the largest deviation: how near the spline comes to the form between its places
TURN = 2.0 * np.pi


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
                f"{label}: form: a {shape.kind} has no axis that a form deviation could go around; give it to a "
                "raceway or another surface of revolution"
            )
        theta = np.linspace(0.0, TURN, 64, endpoint=False)
        ends = [found.form(theta, z) for z in (-shape.radius, 0.0, shape.radius)]
        size = float(np.max(np.abs(ends))) or 1.0
        if np.ptp(ends, axis=0).max() > AGREES * size or not found.form.turns:
            raise InputError(
                f"{label}: form: {found.form.kind} changes along the axis, or does not close around it; a lumped "
                "contact takes waves around, films.LobedForm, films.WornForm, or films.MeasuredForm with one z"
            )
        middle = (np.arange(STEPS) + 0.5) * TURN / STEPS
        off = np.abs(found.at(middle + found.start)[0] - _curve(found.form, middle)).max()
        if off > AGREES * size:
            raise InputError(
                f"{label}: form: {found.form.kind} has waves too short or edges too sharp, {STEPS} places around miss "
                f"it by {off:.3g} m; take fewer waves"
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
        """The same form, farther around by `angle` [rad]."""
        return RoundForm(self.form, self.start + angle)

    @property
    def most_hollow(self) -> float:
        """The largest -w'' [m]: where a surface is made most concave."""
        return float(np.max(-2.0 * self.pieces[:, 2], initial=0.0))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"form": self.form.describe(), "start": self.start}


def refuse_form(port: Any, label: str) -> None:
    """Raises `InputError` for a surface whose form deviation would be left out."""
    if port.surface.form is not None:
        raise InputError(
            f"{label}: {port.label} has a form deviation, which only lumped contacts see; leave it out, or give a film "
            "its own, Film(..., form_a=...)"
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
