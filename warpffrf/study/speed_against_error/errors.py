r"""How far a run is from the reference, as fractions, over the times t_k that they have in common.

    force         |F - F_ref|_2 / |F_ref|_2 over times, pairs and directions; pairs are distributed and lumped contacts
    force_max     the largest |F - F_ref| over the largest |F_ref| of a pair and time
    pressure      L2 norm of P - P_ref over surface, times and pairs, over that of P_ref, as means over boxes (`fields`)
    displacement  |x - x_ref|_2 / |x_ref - x_ref(0)|_2 of points in the world (`places`)
    deformation   |u - u_ref|_2 / |u_ref|_2 of points of flexible bodies, in the frame of their body
    stress        |s - s_ref|_2 / |s_ref|_2, all components at all stress points and stress sensors
    energy        range of the energy residual of the run itself, over the largest energy at hand: no reference

A measure whose denominator is zero says nothing and is left out. Sums weigh all saved times alike.

Fields. Pressures of two runs, whatever grids they stand on, as `warpffrf.model.half_space` compares them.

Areas are those of the first surface, A_B = R sqrt(1 + R'^2) dtheta dz. Angles on a surface of revolution are counted
from the line of centres: which of the material is in contact is said by the motion, and measured by it. On a plane they
are the chart's own.

Places. Motion of chosen points of a run: where they are in the world, and what the elastic body adds in its own frame.

    x = r + A (X + u),     u = sum_m phi_m(X) q_m

Of a rigid body points are any X of its user frame, its origin without the user's choice. Of a flexible one they are its
interfaces, which local modes do not move; the user's points are the nearest nodes of its skin, whose global modes are
taken: contact moves them by less than the patch is deep, and that is in the pressure.

Times. Saved times that runs of different steps have in common; nothing is interpolated between saved steps.

With steps h_i all h_i = I/n_i for whole n_i, and rows are those at the times k I, k = 0, 1, ... The interval I is the
least multiple of the coarsest step that all steps divide, times a whole number where that would save more than
MOST_ROWS rows.
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
OWN = ("energy",)  # of a run by itself, without a reference
RECOMMENDED = ("force", "pressure", "displacement", "deformation", "stress")  # that a wanted error is of


def relative(values: np.ndarray, reference: np.ndarray) -> float:
    """|values - reference| over |reference|, L2 of all entries; NaN where the reference is zero."""
    size = float(np.linalg.norm(reference))
    return float(np.linalg.norm(np.asarray(values) - reference)) / size if size > 0.0 else np.nan


def relative_largest(values: np.ndarray, reference: np.ndarray) -> float:
    """The largest |values - reference| of the vectors (..., 3) over the largest |reference|; NaN where that is zero."""
    size = float(np.linalg.norm(reference, axis=-1).max(initial=0.0))
    apart = float(np.linalg.norm(np.asarray(values) - reference, axis=-1).max(initial=0.0))
    return apart / size if size > 0.0 else np.nan


def measures_of(scene: Any, wanted: Sequence[str] | None) -> tuple[str, ...]:
    """The measures that `scene` has, or the `wanted` ones. Raises `InputError` for unknown ones and for those that the
    scene does not have."""
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
    """Each of `measures` that says something, as a fraction; `rows` (T,) of both runs stand at the same times."""
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
    for name in reference.contact_names:
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
    """Of points at the rows asked for: `world` (T, p, 3) m, and `elastic` (T, e, 3) m, u of flexible bodies, in user
    axes."""

    world: np.ndarray
    elastic: np.ndarray


def check_points(points: Mapping[str, Any] | None, names: list[str]) -> dict[str, np.ndarray]:
    """The user's `points` {body: (n, 3)} [m, user frame]; raises `InputError` for bodies that there are not."""
    found = {}
    for name, places in (points or {}).items():
        if name not in names:
            known = ", ".join(map(repr, names))
            raise InputError(f"speed_error: points are given on body {name!r}, which does not exist; known: {known}")
        found[name] = require_array(np.atleast_2d(places), f"speed_error: points of body {name!r}", (None, 3))
    return found


def motion_of(result: Result, rows: np.ndarray, points: Mapping[str, np.ndarray]) -> Motion:
    """Motion of the `points` of a run, of bodies without any those of the module, at `rows` (T,)."""
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


MOST_ROWS = 200  # pressure fields of more would say no more of an error, and fill a folder
MOST_MULTIPLES = 1000  # of the coarsest step, in search of one that all steps divide
WHOLE = 1e-9  # relative: steps are written as decimals, and their ratios are whole to round-off
SAME = 1e-6  # of the interval: times of a run are sums of steps, or products, to round-off


def divides(step: float, interval: float) -> bool:
    """Whether `interval` [s] is a whole number of steps of `step` [s]."""
    count = interval / step
    return round(count) >= 1 and abs(count - round(count)) <= WHOLE * count


def common_interval(steps: Sequence[float], duration: float) -> float:
    """The interval [s] of the rows of runs with `steps` [s] over `duration` [s]. Raises `InputError` for steps that
    have none in common, and for a duration that is shorter than it."""
    coarsest = max(steps)
    for n in range(1, MOST_MULTIPLES + 1):
        if all(divides(step, n * coarsest) for step in steps):
            break
    else:
        shown = ", ".join(f"{step:g}" for step in sorted(set(steps), reverse=True))
        raise InputError(
            f"speed_error: the steps {shown} s have no times in common within {MOST_MULTIPLES} of the coarsest; take "
            "steps in ratios of small whole numbers, such as halves"
        )
    interval = n * coarsest
    if interval > duration * (1.0 + WHOLE):
        raise InputError(
            f"speed_error: the steps meet only every {interval:g} s, which is longer than the run of {duration:g} s; "
            "take steps in ratios of small whole numbers, or a longer run"
        )
    rows = int(np.floor(duration / interval + SAME))
    return interval * max(1, -(-rows // MOST_ROWS))


def saved_times(interval: float, duration: float) -> np.ndarray:
    """(T,) s from the start of a run, the common times."""
    return interval * np.arange(int(np.floor(duration / interval + SAME)) + 1)


def common_rows(time: np.ndarray, interval: float, duration: float) -> np.ndarray | None:
    """Rows (T,) of a run's `time` (n,) [s] that stand at the common times; None where one is missing."""
    wanted = saved_times(interval, duration)
    if not len(time):
        return None
    since = np.asarray(time) - time[0]
    at = np.clip(np.searchsorted(since, wanted - SAME * interval), 0, len(since) - 1)
    return at if np.all(np.abs(since[at] - wanted) <= SAME * interval) else None
