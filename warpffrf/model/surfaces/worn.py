r"""A contact surface less a form deviation w: another surface of revolution, or another curve.

Of a surface of revolution the form depends on z, measured along the normal: a drop of the radius by w sqrt(1 + R'^2),

    R_w = R - w sqrt(1 + R'^2),      R_w' = R' - w' sqrt(1 + R'^2) - w R' R''/sqrt(1 + R'^2),

exact to first order in w/R. Of an extruded curve c(u) it depends on u: with n' = kappa t

    c_w = c - w n,      c_w' = (1 - w kappa) t - w' n,      |c_w'| the rate of the new arc length.

Measured deviations are straight between their places. A contact needs a curvature there, and the spline through them
(C2) is used instead: with the jumps of curvature of monotone cubics, equilibria of patches a few places wide did not
converge.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.extruded import Extruded
from warpffrf.model.surfaces.form_deviations import AGREES, CompositeForm, Form, MeasuredForm, as_form
from warpffrf.model.surfaces.profiled_cylinder import ProfiledCylinder, RevolutionShape

Array = np.ndarray
NODES = 257  # of a profile along the contact, and of a form that is not measured
AROUND = np.linspace(0.0, 2.0 * np.pi, 17)[:-1]  # rad: where a form is compared with itself
STEEPEST = 0.95  # of the radius of a sphere or crown: limit of a profile along the axis, 72 degrees steep
GAUSS = 4  # points of Gauss's rule between two knots: w is a cubic there


def profile_coordinate(shape: Any, label: str) -> int:
    """The coordinate along the profile of a `shape` that can wear: 1, z of a surface of revolution; 0, u of a curve.
    Raises `InputError` naming `label` for others."""
    if isinstance(shape, Extruded):
        return 0
    if isinstance(shape, RevolutionShape) and shape.side > 0.0 and not getattr(shape, "steep", False):
        return 1
    raise InputError(
        f"{label}: a {shape.kind} has no profile that can change; outer surfaces of revolution and surfaces.Extruded "
        "have: describe a plane by surfaces.Extruded with a straight curve, across its motion; leave a hollow surface "
        "as it is, with the coefficient 0"
    )


def worn(shape: Any, form: Any, ends: Any, label: str) -> Any:
    """`shape` with the material of `form` removed; ends (2,) [m]: its limits along the axis, None without any. Raises
    `InputError` naming `label`."""
    known = as_form(form, f"{label}: form")
    if known is None:
        raise InputError(f"{label}: form is None; leave it out")
    along = profile_coordinate(shape, label)
    places = shape.curve.knots[[0, -1]] if along == 0 else _ends(shape, known) if ends is None else np.asarray(ends)
    others = AROUND if along else places
    at = np.linspace(places[0], places[-1], NODES)
    values = [known(other, at) if along else known(at, other) for other in others]
    if np.max(np.ptp(values, axis=0)) > AGREES * np.max(np.abs(values), initial=1e-30):
        raise InputError(
            f"{label}: {known.kind} changes {'around' if along else 'along'} the axis; a contact surface takes forms "
            f"that depend on {'z' if along else 'the length u along the curve'} alone"
        )
    return _revolved(shape, known, places) if along else _extruded(shape, known)


def _ends(shape: Any, form: Form) -> Array:
    """Limits [m] of a rigid surface along its axis: of its table, else of the form and its length to both sides."""
    if hasattr(shape, "table"):
        return shape.table[0, [0, -1]]
    places, reach = _places(form, 1), STEEPEST * min(shape.radius, abs(shape.profile().crown) or np.inf)
    if len(places) < 2:
        return np.array([-reach, reach])
    low, high = float(places.min()), float(places.max())
    return np.clip([2.0 * low - high, 2.0 * high - low], -reach, reach)


def _revolved(shape: Any, form: Form, ends: Array) -> ProfiledCylinder:
    profile, measured = shape.profile(), _places(form, 1)
    z = np.linspace(ends[0], ends[-1], NODES)
    if len(profile.breaks):
        z = np.concatenate([profile.breaks[1:-1], z[(z < profile.breaks[1]) | (z > profile.breaks[-2])]])
    z = _apart(np.concatenate([z, measured[(measured > ends[0]) & (measured < ends[1])]]))
    w, dw = _smooth(form, 1, z, None)
    R, slope, bend = profile.radius_at(z), profile.slope_at(z), profile.bend_at(z)
    steep = np.sqrt(1.0 + slope**2)
    table = (z, shape.radius - R + w * steep, -slope + dw * steep + w * slope * bend / steep)
    return ProfiledCylinder(
        radius=shape.radius, axis_point=shape.axis_point, axis_direction=shape.axis_direction, table=table,
        fit_tolerance=shape.fit_tolerance,
    )  # fmt: skip


def _extruded(shape: Extruded, form: Form) -> Extruded:
    curve: Curve = shape.curve
    ends, measured = curve.knots[[0, -1]], _places(form, 0)
    own = curve.knots if len(measured) else np.concatenate([curve.knots, np.linspace(ends[0], ends[-1], NODES)])
    u = _apart(np.concatenate([own, measured[(measured > ends[0]) & (measured < ends[1])]]))
    period = curve.length if curve.closed else None

    def moved(at: Array) -> tuple[Array, Array]:
        """c_w and c_w' at places between knots."""
        w, dw = (value[..., None] for value in _smooth(form, 0, at, period))
        tangent, normal = curve.at(at, 1), curve.normal(at)
        return curve.at(at) - w * normal, (1.0 - w * curve.curvature(at)[..., None]) * tangent - dw * normal

    x, weight = np.polynomial.legendre.leggauss(GAUSS)
    half = 0.5 * np.diff(u)
    rate = np.linalg.norm(moved(u[:-1, None] + half[:, None] * (x + 1.0))[1], axis=-1) @ weight
    points, tangents = moved(u)
    if curve.closed:
        points[-1], tangents[-1] = points[0], tangents[0]
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    knots = ends[0] + np.concatenate([[0.0], np.cumsum(half * rate)])
    section = Curve(knots=knots, points=points, tangents=tangents, closed=curve.closed, depth=curve.depth)
    return Extruded(
        curve=section, axis_point=shape.axis_point, axis_direction=shape.axis_direction,
        x_direction=shape.x_direction, twist=shape.twist, fit_tolerance=shape.fit_tolerance,
    )  # fmt: skip


def _places(form: Form, along: int) -> Array:
    """The places of measured parts along the profile."""
    if isinstance(form, CompositeForm):
        return np.concatenate([_places(part, along) for part in form.parts])
    if not isinstance(form, MeasuredForm):
        return np.zeros(0)
    return np.asarray(form.z if along else form.theta)


def _apart(places: Array) -> Array:
    """Sorted `places`, without those that nearly coincide."""
    places = np.sort(places)
    keep = np.append(True, np.diff(places) > 1e-3 * np.ptp(places) / len(places))
    keep[-1] = True
    if np.count_nonzero(keep) > 2 and places[-1] - places[keep][-2] < 1e-3 * np.ptp(places) / len(places):
        keep[np.flatnonzero(keep)[-2]] = False
    return places[keep]


def _smooth(form: Form, along: int, at: Array, period: float | None) -> tuple[Array, Array]:
    """w [m] and dw [-] along the profile, by the spline through the places of a measured form, else through NODES
    places; constant beyond them."""
    from scipy.interpolate import CubicSpline

    if isinstance(form, CompositeForm):
        parts = [_smooth(part, along, at, period) for part in form.parts]
        return np.sum([w for w, _ in parts], axis=0), np.sum([dw for _, dw in parts], axis=0)
    places = _places(form, along)
    if len(places) == 1:
        return np.broadcast_to(form(places[0], places[0]), at.shape).copy(), np.zeros(at.shape)
    if not len(places):
        places = np.linspace(at.min(), at.max(), NODES)
    values = form(0.0, places) if along else form(places, 0.0)
    inside = (at >= places[0]) & (at <= places[-1])
    closes = period is not None and np.isclose(places[-1] - places[0], period) and values[0] == values[-1]
    spline = CubicSpline(places, values, bc_type="periodic" if closes else "clamped")
    near = np.clip(at, places[0], places[-1])
    return spline(near), np.where(inside, spline(near, 1), 0.0)
