r"""How far a run is from the reference, as fractions, over the times t_k that they have in common.

    force         |F - F_ref|_2 / |F_ref|_2 over times, pairs and directions; pairs are distributed and lumped contacts
    force_max     the largest |F - F_ref| over the largest |F_ref| of a pair and time
    pressure      L2 norm of P - P_ref over surface, times and pairs, over that of P_ref, as means over boxes (`fields`)
    displacement  |x - x_ref|_2 / |x_ref - x_ref(0)|_2 of points in the world (`places`)
    deformation   |u - u_ref|_2 / |u_ref|_2 of points of flexible bodies, in the frame of their body
    stress        |s - s_ref|_2 / |s_ref|_2, all components at all stress points and stress sensors
    energy        range of the energy residual of the run itself, over the largest energy at hand: no reference

A measure whose denominator is zero says nothing and is left out. Sums weigh all saved times alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.result import Result
from warpffrf.study.speed_against_error.fields import field_of, squares
from warpffrf.study.speed_against_error.places import motion_of

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
