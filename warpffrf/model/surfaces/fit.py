"""Least-squares fit of a surface of revolution with a circular, straight, conical or given profile to points.

Unknowns are axis point c, axis direction e_a, radius R, tangent t and profile curvature kappa = 1/Rc, except those that
are given. The radial residual f = rho - R(z) is minimised in the least-squares sense by Gauss-Newton; with e_r the
radial direction of a point, s(z) = kappa z^2 / (1 + w) the drop of the arc, w = sqrt(1 - kappa^2 z^2), and T(z) a drop
that is known, R(z) = R + t z - s(z) - T(z), the columns of the Jacobian are

    d/d(shift of c along e_i)     = -e_r.e_i                        i = 0, 1
    d/d(shift of c along e_a)     = dR/dz
    d/d(tilt of e_a towards e_i)  = -(z + rho dR/dz) e_r.e_i
    d/dR = -1,      d/dt = -z,      d/dkappa = z^2 / (w (1 + w)).

Each step re-linearises about the current axis. It starts from each principal direction of the point cloud with an
algebraic circle fit (Kasa 1976: u^2 + v^2 = 2 a u + 2 b v + k is linear in a, b, k), of a free arc from a straight
profile and from the same kind of fit in the meridian, and the best fit is used: which of the principal directions is
the axis depends on the width and on the arc that the points cover.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from warpffrf.model.errors import InputError

# axis components within this fraction count as equal: the sign of a fitted axis must not follow round-off
SAME_SIZE = 1e-6
FIT_STEPS = 60  # Gauss-Newton converges in under 10 steps from a good start; more indicate a wrong axis
FIT_STALLED = 1e-15  # a step of this fraction of R no longer moves anything in float64
COLUMNS = ("shift_0", "shift_1", "shift_a", "tilt_0", "tilt_1", "radius", "tangent", "curvature")
Table = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # z [m] -> drop [m] and its slope


@dataclass(frozen=True, eq=False)
class Revolution:
    """A surface of revolution: axis point (3,) m, unit axis (3,), radius m at the axis point, curvature 1/m, tangent,
    and a drop that is known."""

    axis_point: np.ndarray
    axis_direction: np.ndarray
    radius: float
    curvature: float
    tangent: float = 0.0
    table: Table | None = None

    @property
    def placed(self) -> bool:
        """True if the profile has a middle, so that the position of the axis point along the axis matters."""
        return self.curvature != 0.0 or self.table is not None


def fit_revolution(
    points: np.ndarray,
    kind: str,
    radius: float | None,
    axis_point: np.ndarray | None,
    axis_direction: np.ndarray | None,
    *,
    curvature: float | None,
    tangent: float | None = 0.0,
    table: Table | None = None,
) -> Revolution:
    """Fit the parameters that are None to `points` (n, 3) [m]; `kind` names the surface in errors.

    The free origin along the axis of a straight or conical profile is placed in the middle of the points; a fitted
    axis points towards its first largest component. Raises `InputError` when the points do not determine the unknowns.
    """
    unknowns = 2 * (axis_point is None) + 2 * (axis_direction is None) + (radius is None) + (tangent is None)
    unknowns += 0 if curvature is not None else 1
    unknowns += axis_point is None and (curvature != 0.0 or table is not None)
    if len(points) < max(unknowns, 3):
        raise InputError(f"surface {kind}: {len(points)} points cannot determine {unknowns} unknowns")
    if axis_direction is not None:
        starts = [axis_direction]
    else:
        starts = [signed_axis(d) for d in np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]]
    best, best_rms = None, np.inf
    firsts = [
        replace(_start(points, start, radius, axis_point, curvature or 0.0), tangent=tangent or 0.0, table=table)
        for start in starts
    ]
    if curvature is None:
        firsts += [arc for first in firsts if (arc := _arc_start(points, first, radius, axis_point)) is not None]
    for first in firsts:
        fit = _gauss_newton(
            points,
            first,
            free_point=axis_point is None,
            free_axis=axis_direction is None,
            free_radius=radius is None,
            free_curvature=curvature is None,
            free_tangent=tangent is None,
        )
        rms = np.inf if fit is None else rms_distance(points, fit)
        if rms < best_rms:
            best, best_rms = fit, rms
    if best is None:
        raise InputError(f"surface {kind}: no surface of revolution fits the facets; give radius and axis")
    if axis_direction is None and table is None:  # a table need not be symmetric: reversed it would differ
        axis = signed_axis(best.axis_direction)
        turned = float(np.sign(axis @ best.axis_direction))
        best = replace(best, axis_direction=axis, tangent=turned * best.tangent)
    if axis_point is None and not best.placed:
        along = (points - best.axis_point) @ best.axis_direction
        middle = 0.5 * (along.min() + along.max())
        moved = best.radius + middle * best.tangent
        best = replace(best, axis_point=best.axis_point + middle * best.axis_direction, radius=moved)
    return best


def rms_distance(points: np.ndarray, fit: Revolution) -> float:
    """Root mean square of the radial residuals [m] of `points` (n, 3) [m]; infinite where the arc does not reach."""
    return float(np.sqrt(np.mean(_residual(points, fit) ** 2)))


def reference_direction(e_a: np.ndarray) -> np.ndarray:
    """Unit vector perpendicular to the unit vector `e_a`: +x projected, or +y where `e_a` is within 26 degrees of x."""
    seed = np.array([1.0, 0.0, 0.0]) if abs(e_a[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    e_0 = seed - (seed @ e_a) * e_a
    return e_0 / np.linalg.norm(e_0)


def signed_axis(e_a: np.ndarray) -> np.ndarray:
    """The axis with its first largest component positive, so that the same surface always has the same frame."""
    largest = int(np.flatnonzero(np.abs(e_a) >= (1.0 - SAME_SIZE) * np.max(np.abs(e_a)))[0])
    return e_a if e_a[largest] > 0.0 else -e_a


def crown_drop(z: np.ndarray, kappa: float) -> np.ndarray:
    """Drop Rc - sqrt(Rc^2 - z^2) [m] of a circular profile of curvature kappa = 1/Rc at z [m], without cancellation."""
    return kappa * z**2 / (1.0 + np.sqrt(1.0 - (kappa * z) ** 2))


def _cylindrical(points: np.ndarray, fit: Revolution) -> tuple[np.ndarray, np.ndarray]:
    """Axial positions (n,) and radial vectors (n, 3) of points."""
    x = points - fit.axis_point
    z = x @ fit.axis_direction
    return z, x - np.outer(z, fit.axis_direction)


def _residual(points: np.ndarray, fit: Revolution) -> np.ndarray:
    z, radial = _cylindrical(points, fit)
    if np.any(np.abs(fit.curvature * z) >= 1.0):
        return np.full(len(z), np.inf)
    drop = crown_drop(z, fit.curvature) + (0.0 if fit.table is None else fit.table(z)[0])
    return np.linalg.norm(radial, axis=1) - fit.radius - fit.tangent * z + drop


def _start(
    points: np.ndarray, e_a: np.ndarray, radius: float | None, axis_point: np.ndarray | None, kappa: float
) -> Revolution:
    """Start values about the direction `e_a`: the algebraic circle through the projected points."""
    e_0 = reference_direction(e_a)
    e_1 = np.cross(e_a, e_0)
    if axis_point is None:
        u, v, along = points @ e_0, points @ e_1, points @ e_a
        A = np.stack([2.0 * u, 2.0 * v, np.ones(len(u))], axis=1)
        a, b, _ = np.linalg.lstsq(A, u**2 + v**2, rcond=None)[0]
        axis_point = a * e_0 + b * e_1 + 0.5 * (along.min() + along.max()) * e_a
    fit = Revolution(np.asarray(axis_point), e_a, 1.0, kappa)
    mean = float(np.mean(np.linalg.norm(_cylindrical(points, fit)[1], axis=1)))
    return replace(fit, radius=mean if radius is None else radius)


def _arc_start(
    points: np.ndarray, first: Revolution, radius: float | None, axis_point: np.ndarray | None
) -> Revolution | None:
    """`first` with the circle through the points of the meridian; None where they lie on a line."""
    z, radial = _cylindrical(points, first)
    rho = np.linalg.norm(radial, axis=1)
    A = np.stack([2.0 * rho, 2.0 * z, np.ones(len(z))], axis=1)
    middle, place, k = np.linalg.lstsq(A, rho**2 + z**2, rcond=None)[0]
    square = k + middle**2 + place**2
    if not square > 0.0:
        return None
    arc = np.sqrt(square) * (1.0 if middle < np.mean(rho) else -1.0)
    if axis_point is None:
        first = replace(first, axis_point=first.axis_point + place * first.axis_direction)
    return replace(first, curvature=1.0 / arc, radius=middle + arc if radius is None else radius)


def _gauss_newton(
    points: np.ndarray,
    fit: Revolution,
    *,
    free_point: bool,
    free_axis: bool,
    free_radius: bool,
    free_curvature: bool,
    free_tangent: bool,
) -> Revolution | None:
    """Iterate from `fit`; None where the iteration leaves the domain or a column vanishes."""
    if not (free_point or free_axis or free_radius or free_curvature or free_tangent):
        return fit
    for _ in range(FIT_STEPS):
        e_a, kappa = fit.axis_direction, fit.curvature
        e_0 = reference_direction(e_a)
        e_1 = np.cross(e_a, e_0)
        z, radial = _cylindrical(points, fit)
        rho = np.linalg.norm(radial, axis=1)
        if not np.all(rho > 0.0) or np.any(np.abs(kappa * z) >= 1.0) or not fit.radius > 0.0:
            return None
        e_r = radial / rho[:, None]
        w = np.sqrt(1.0 - (kappa * z) ** 2)
        slope = fit.tangent - kappa * z / w - (0.0 if fit.table is None else fit.table(z)[1])
        columns = {}
        if free_point:
            columns |= {"shift_0": -e_r @ e_0, "shift_1": -e_r @ e_1}
            if fit.placed:  # a straight profile has no middle: free the position of the crown once there is curvature
                columns["shift_a"] = slope
        if free_axis:
            lever = -(z + rho * slope)
            columns |= {"tilt_0": lever * (e_r @ e_0), "tilt_1": lever * (e_r @ e_1)}
        if free_radius:
            columns["radius"] = -np.ones(len(z))
        if free_tangent:
            columns["tangent"] = -z
        if free_curvature:
            columns["curvature"] = z**2 / (w * (1.0 + w))
        J = np.stack(list(columns.values()), axis=1)
        scale = np.linalg.norm(J, axis=0)
        if not np.all(scale > 0.0):
            return None
        solution = -np.linalg.lstsq(J / scale, _residual(points, fit), rcond=None)[0] / scale
        if not np.all(np.isfinite(solution)):
            return None
        step = dict.fromkeys(COLUMNS, 0.0)
        step |= dict(zip(columns, solution, strict=True))
        tilted = e_a + step["tilt_0"] * e_0 + step["tilt_1"] * e_1
        fit = replace(
            fit,
            axis_point=fit.axis_point + step["shift_0"] * e_0 + step["shift_1"] * e_1 + step["shift_a"] * e_a,
            axis_direction=tilted / np.linalg.norm(tilted),
            radius=fit.radius + step["radius"],
            curvature=kappa + step["curvature"],
            tangent=fit.tangent + step["tangent"],
        )
        # all steps as lengths: tilts, tangent and curvature by their displacement at a distance R
        lengths = {"tilt_0": fit.radius, "tilt_1": fit.radius, "tangent": fit.radius, "curvature": fit.radius**2}
        if max(abs(v) * lengths.get(k, 1.0) for k, v in step.items()) <= FIT_STALLED * abs(fit.radius):
            break
    return fit if fit.radius > 0.0 else None
