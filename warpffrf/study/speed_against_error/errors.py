r"""Relative errors of a run compared with the reference, over their common times t_k.

    force         |F - F_ref|_2 / |F_ref|_2 over times, pairs and directions; pairs are distributed and lumped contacts
    force_max     the largest |F - F_ref| over the largest |F_ref| of a pair and time
    pressure      L2 norm of P - P_ref over surface, times and pairs, over that of P_ref, as means over boxes (`fields`)
    displacement  |x - x_ref|_2 / |x_ref - x_ref(0)|_2 of points in the world (`places`)
    deformation   |u - u_ref|_2 / |u_ref|_2 of points of flexible bodies, in the frame of their body
    stress        |s - s_ref|_2 / |s_ref|_2, all components at all stress points and stress sensors
    energy        range of the energy residual of the run itself, over its energy scale: no reference

A measure with zero denominator is omitted. Sums weight all saved times equally.

Fields. Pressures of two runs on any grids, compared as in `warpffrf.model.half_space`.

Areas are those of the first surface, A_B = R sqrt(1 + R'^2) dtheta dz. Angles on a surface of revolution are measured
from the line of centres: the material in contact follows from the motion, which has its own measure. On a plane the
chart coordinates are used.

Places. Motion of selected points of a run: positions in the world, and elastic displacements in the body's frame.

    x = r + A (X + u),     u = sum_m phi_m(X) q_m

Points of a rigid body are any X of its user frame, by default its origin. Points of a flexible body are by default its
interfaces, which local modes do not move; the user's points are replaced by the nearest nodes of its skin, with the
global modes only: local displacements are below the approach, and are measured by the pressure.

Times. Common saved times of runs with different steps; nothing is interpolated between saved steps.

With steps h_i all h_i = I/n_i for whole n_i, and rows are those at the times k I, k = 0, 1, ... The interval I is the
least multiple of the coarsest step that all steps divide, times a whole number if more than MOST_ROWS rows would be
saved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.half_space import Boxes
from warpffrf.model.half_space import squares as of_boxes
from warpffrf.output.contact.pair_result import PairResult
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import BodyView
from warpffrf.output.result import Result

MEASURES = ("force", "force_max", "pressure", "displacement", "deformation", "stress", "energy")
OF_CONTACT = ("force", "force_max", "pressure")
OWN = ("energy",)  # of the run itself, without a reference
RECOMMENDED = ("force", "pressure", "displacement", "deformation", "stress")  # measures of a required error


def relative(values: np.ndarray, reference: np.ndarray) -> float:
    """|values - reference| over |reference|, L2 of all entries; NaN if the reference is zero."""
    size = float(np.linalg.norm(reference))
    return float(np.linalg.norm(np.asarray(values) - reference)) / size if size > 0.0 else np.nan


def relative_largest(values: np.ndarray, reference: np.ndarray) -> float:
    """The largest |values - reference| of the vectors (..., 3) over the largest |reference|; NaN if the latter is
    zero."""
    size = float(np.linalg.norm(reference, axis=-1).max(initial=0.0))
    apart = float(np.linalg.norm(np.asarray(values) - reference, axis=-1).max(initial=0.0))
    return apart / size if size > 0.0 else np.nan


def measures_of(scene: Any, wanted: Sequence[str] | None) -> tuple[str, ...]:
    """The measures available for `scene`, or the `wanted` ones. Raises `InputError` for unknown and unavailable
    ones."""
    has = {name: True for name in MEASURES}
    contacts, lumped = bool(scene.contacts), bool(scene.lumped_contacts)
    has |= {"force": contacts or lumped, "force_max": contacts or lumped, "pressure": contacts}
    flexible = [body for body in scene.bodies if body.reduced is not None]
    has["deformation"] = any(len(body.reduced.frequencies) for body in flexible)
    has["stress"] = any(body.reduced.stress for body in flexible)
    if wanted is None:
        return tuple(name for name in MEASURES if has[name])
    cures = {
        **dict.fromkeys(OF_CONTACT, "it has no contact; add a Contact, or ask for 'displacement' or 'energy'"),
        "pressure": "it has no distributed contact; add a Contact, or ask for another measure",
        "deformation": "no body has global modes; ask for 'displacement'",
        "stress": "no body has stress points; reduce(..., stress={name: points})",
    }
    for name in wanted:
        if name not in MEASURES:
            raise unknown_name("speed_error: measure", name, MEASURES)
        if not has[name]:
            raise InputError(f"speed_error: errors of {name!r} are asked for, which the scene lacks: {cures[name]}")
    return tuple(name for name in MEASURES if name in wanted)


def errors_of(
    result: Result,
    rows: np.ndarray,
    reference: Result,
    reference_rows: np.ndarray,
    measures: Sequence[str],
    points: Mapping[str, np.ndarray],
) -> dict[str, float]:
    """Each of `measures` with a nonzero denominator, as a fraction; `rows` (T,) of both runs have the same times."""
    found: dict[str, float] = {}
    if "force" in measures or "force_max" in measures:
        F, F_ref = contact_forces(result, rows), contact_forces(reference, reference_rows)
        found["force"], found["force_max"] = relative(F, F_ref), relative_largest(F, F_ref)
    if "pressure" in measures:
        found["pressure"] = _pressure(result, rows, reference, reference_rows)
    if "displacement" in measures or "deformation" in measures:
        x, x_ref = motion_of(result, rows, points), motion_of(reference, reference_rows, points)
        start = x_ref.world[:1]
        found["displacement"] = relative(x.world - start, x_ref.world - start)
        found["deformation"] = relative(x.elastic, x_ref.elastic) if x.elastic.shape == x_ref.elastic.shape else np.nan
    if "stress" in measures:
        s, s_ref = stresses(result, rows), stresses(reference, reference_rows)
        found["stress"] = relative(s, s_ref) if s.shape == s_ref.shape else np.nan
    if "energy" in measures:
        found["energy"] = float(np.ptp(result.energy_residual)) if len(result.time) else np.nan
    return {name: found[name] for name in measures if np.isfinite(found[name])}


def contact_forces(result: Result, rows: np.ndarray) -> np.ndarray:
    """(T, pairs, 3) N, world, on the first bodies of distributed and lumped contacts."""
    pairs = [*result.history.contacts.values(), *result.history.lumped_contacts.values()]
    return np.stack([np.asarray(pair.force)[rows] for pair in pairs], axis=1)


def stresses(result: Result, rows: np.ndarray) -> np.ndarray:
    """(T, n) Pa, all components at all stress points of flexible bodies."""
    parts = [
        np.asarray(result.stress(name, points).tensor)[rows].reshape(len(rows), -1)
        for name, body in result.view.bodies.items()
        if body.reduced is not None
        for points in body.reduced.stress
    ]
    return np.concatenate(parts, axis=1)


def _pressure(result: Result, rows: np.ndarray, reference: Result, reference_rows: np.ndarray) -> float:
    apart = size = 0.0
    for name in reference.finite_sliding_names:
        pair, pair_ref = result.contact(name), reference.contact(name)
        shape = pair_ref.view.first.shape
        for i, j in zip(rows, reference_rows, strict=True):
            one, other = squares(field_of(pair, int(i)), field_of(pair_ref, int(j)), shape)
            apart, size = apart + one, size + other
    return float(np.sqrt(apart / size)) if size > 0.0 else np.nan


def field_of(pair: PairResult, i: int) -> Boxes:
    """The pressures of `pair` at its saved step `i`."""
    x, z = pair.cell_lines(i)
    if pair.view.first.shape.kind == "plane":
        x = x + float(pair.theta[i][0] - pair.arc[i][0])
    arrays = (np.asarray(values, dtype=float) for values in (x, z, pair.mean_pressure[i]))
    return Boxes(*arrays)


def squares(field: Boxes, reference: Boxes, shape: object) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2]."""
    measure_at, radius_at = shape.measure_at, shape.radius_at  # type: ignore[attr-defined]
    middle = 0.5 * (min(field.z[0], reference.z[0]) + max(field.z[-1], reference.z[-1]))
    return of_boxes(field, reference, lambda z: measure_at(z) / radius_at(middle))


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of points at the requested rows: `world` (T, p, 3) m, and `elastic` (T, e, 3) m, u of flexible bodies, in
    user axes."""

    world: np.ndarray
    elastic: np.ndarray


def check_points(points: Mapping[str, Any] | None, names: list[str]) -> dict[str, np.ndarray]:
    """The user's `points` {body: (n, 3)} [m, user frame]; raises `InputError` for unknown bodies."""
    found = {}
    for name, places in (points or {}).items():
        if name not in names:
            known = ", ".join(map(repr, names))
            raise InputError(f"speed_error: points are given on body {name!r}, which does not exist; known: {known}")
        found[name] = require_array(np.atleast_2d(places), f"speed_error: points of body {name!r}", (None, 3))
    return found


def motion_of(result: Result, rows: np.ndarray, points: Mapping[str, np.ndarray]) -> Motion:
    """Motion of the `points` of a run at `rows` (T,); for bodies without points those of the module docstring."""
    world, elastic = [], []
    for name, body in result.view.bodies.items():
        places, modes = _places(body, points.get(name))
        history = result.history.bodies[name]
        q = history.modal[rows]
        u = np.einsum("tm,mpd->tpd", q, modes) if modes.shape[0] else np.zeros((len(rows), *places.shape))
        turned = np.array([rotate(history.rotation[row], places + ut) for row, ut in zip(rows, u, strict=True)])
        world.append(history.position[rows][:, None] + turned)
        if modes.shape[0]:
            elastic.append(u)
    none = np.zeros((len(rows), 0, 3))
    return Motion(np.concatenate([none, *world], axis=1), np.concatenate([none, *elastic], axis=1))


def _places(body: BodyView, wanted: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Points (p, 3) of the user frame and displacement per mode (m, p, 3)."""
    if body.reduced is None:
        places = np.zeros((1, 3)) if wanted is None else wanted
        return places, np.zeros((0, len(places), 3))
    if wanted is not None:
        skin = body.reduced.surface
        places = np.asarray(skin.points, dtype=float)
        nearest = np.array([np.argmin(np.sum((places - x) ** 2, axis=1)) for x in wanted])
        return places[nearest], np.asarray(skin.modes, dtype=float)[:, nearest]
    held = body.reduced.interfaces.values()
    if not held:
        return np.zeros((1, 3)), np.zeros((0, 1, 3))
    places = np.array([i.point for i in held], dtype=float)
    modes = np.stack([np.asarray(i.modes, dtype=float)[:, :3] for i in held], axis=1)
    return places, modes


MOST_ROWS = 200  # more pressure fields would not improve an error, and would enlarge the folder
MOST_MULTIPLES = 1000  # of the coarsest step, in the search for one that all steps divide
WHOLE = 1e-9  # relative: steps are decimals, and their ratios are whole to round-off
SAME = 1e-6  # of the interval: times of a run are sums or multiples of steps, to round-off


def divides(step: float, interval: float) -> bool:
    """Whether `interval` [s] is a whole number of steps of `step` [s]."""
    count = interval / step
    return round(count) >= 1 and abs(count - round(count)) <= WHOLE * count


def common_interval(steps: Sequence[float], duration: float) -> float:
    """The interval [s] of the rows of runs with `steps` [s] over `duration` [s]. Raises `InputError` for steps without
    a common interval, and for a duration shorter than it."""
    coarsest = max(steps)
    for n in range(1, MOST_MULTIPLES + 1):
        if all(divides(step, n * coarsest) for step in steps):
            break
    else:
        shown = ", ".join(f"{step:g}" for step in sorted(set(steps), reverse=True))
        raise InputError(
            f"speed_error: the steps {shown} s have no common times within {MOST_MULTIPLES} of the coarsest; take "
            "steps in ratios of small whole numbers, such as halves"
        )
    interval = n * coarsest
    if interval > duration * (1.0 + WHOLE):
        raise InputError(
            f"speed_error: the common times are only every {interval:g} s, longer than the run of {duration:g} s; "
            "take steps in ratios of small whole numbers, or a longer run"
        )
    rows = int(np.floor(duration / interval + SAME))
    return interval * max(1, -(-rows // MOST_ROWS))


def saved_times(interval: float, duration: float) -> np.ndarray:
    """(T,) s from the start of a run, the common times."""
    return interval * np.arange(int(np.floor(duration / interval + SAME)) + 1)


def common_rows(time: np.ndarray, interval: float, duration: float) -> np.ndarray | None:
    """Rows (T,) of a run's `time` (n,) [s] at the common times; None if one is missing."""
    wanted = saved_times(interval, duration)
    if not len(time):
        return None
    since = np.asarray(time) - time[0]
    at = np.clip(np.searchsorted(since, wanted - SAME * interval), 0, len(since) - 1)
    return at if np.all(np.abs(since[at] - wanted) <= SAME * interval) else None
