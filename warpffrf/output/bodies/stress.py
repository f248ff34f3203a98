r"""Stress of one body over a run, at points that were named when it was reduced.

    sigma(t) = sum_i modes_i q_i(t) + sum_pairs [T f(t) + W s(t)] + sum_i laps_i s_i(t) + sum_r membrane_r e_r(t)

with the global coordinates `q`, and of every contact pair that the body takes part in, as first or as second body, the
outward hat forces `f` and, with friction, the tangential forces of the cells (`StressField`); of oil films on the body
their pressure, without their shear; of laps the forces `s` on their cells (`lap_loads`); of a body with membrane energy
that loads stiffen its amplitudes `e_r = q.L_r q/2`. The tensor is in the axes of the body's user frame, which turns
with the body; von Mises and principal stresses do not depend on axes. With membrane energy it is the second
Piola-Kirchhoff stress: along fibres of the undeformed body, which turn with it, and Cauchy's stress but for a fraction
of the size of strains.

On a pair's first body the traction is the pressure that the contact found, hat by hat; on the second it is that
pressure projected on its own hats. Both swing a little from node to node about their mean over a hat, which is what
contact results show as pressure; a few elements below the surface nothing of that is left.

A pressure on cells that travel with the patch, finer than the mesh, reaches the body through equivalent hat forces, and
what is near the patch is put right by the half-space under it (`patch_stress`). Tractions on such cells are shared
between the cells of the contact grid, and their stress is that: spread over a spacing of nodes near the patch, right in
its sum a few of them below.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.output_paths import size_text
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.membrane import membrane_amplitudes, membrane_forms
from warpffrf.model.reduced.stress_field import StressField, max_shear, principal, von_mises
from warpffrf.online.history.history import History
from warpffrf.output.bodies.lap_loads import LapLoads
from warpffrf.output.bodies.normal_loads import CellLoads, NormalLoads, film_loads, normal_loads
from warpffrf.output.bodies.patch_on_skin import tangential_forces
from warpffrf.output.bodies.patch_stress import PatchStress
from warpffrf.output.geometry.scene_view import SceneView

MUCH = 2e9  # byte, of a result whose size is said before it is made

log = logging.getLogger("warpffrf")


@dataclass(frozen=True, eq=False, repr=False)
class StressResult(reprs.Rows):
    """Stress at `points` (p, 3) [m, user frame, undeformed] at the saved steps `time` (T,) [s]; `tensor` (T, p, 6) [Pa]
    in the order xx, yy, zz, xy, yz, zx, axes of the body's user frame."""

    time: np.ndarray
    points: np.ndarray
    tensor: np.ndarray

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress (T, p) [Pa]."""
        return von_mises(self.tensor)

    @cached_property
    def principal(self) -> np.ndarray:
        """Principal stresses (T, p, 3) [Pa], largest first."""
        return principal(self.tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress (T, p) [Pa]."""
        return max_shear(self.tensor)


def surface_forces(loads: list[NormalLoads | PatchStress], i: int) -> dict[str, np.ndarray]:
    """Outward hat forces [N] on each loaded contact surface of a body, by name, summed over its pairs' `loads` at saved
    step `i`."""
    found: dict[str, np.ndarray] = {}
    for load in loads:
        forces, name = load.forces(i), load.surface.name
        found[name] = found[name] + forces if name in found else forces
    return found


def tangential_surface_forces(history: History, view: SceneView, body: str, i: int) -> dict[str, np.ndarray]:
    """Tangential forces (2, columns, rows) [N] on each contact surface of `body` that rubs, summed over its pairs, at
    saved step `i`; see `patch_on_skin`."""
    found: dict[str, np.ndarray] = {}
    for pair in view.pairs.values():
        contact = history.contacts[pair.name]
        if body not in (pair.first_body.name, pair.second_body.name) or getattr(contact, "friction", None) is None:
            continue
        first = pair.first_body.name == body
        name = pair.first_surface_name if first else pair.second_surface_name
        forces = tangential_forces(pair, contact, history.bodies, i, first=first)
        found[name] = found[name] + forces if name in found else forces
    return found


def stress_field(view: SceneView, body: str, points: str) -> StressField:
    """The recovery called `points` of the body; raises `InputError` naming the bodies, or the names that there are."""
    if body not in view.bodies:
        known = ", ".join(f"'{n}'" for n in view.bodies) or "none"
        raise InputError(f"the result has no body called '{body}'; it has: {known}")
    reduced = view.bodies[body].reduced
    if reduced is None:
        raise InputError(f"body '{body}' is rigid and has no stress; add it as a flexible body, made by reduce(...)")
    if not isinstance(points, str) or points not in reduced.stress:
        known = ", ".join(f"'{n}'" for n in reduced.stress) or "none"
        raise InputError(
            f"body '{body}' has no stress points called {points!r}; it has: {known}. Name them when it is reduced: "
            "reduce(..., stress={name: points})"
        )
    return reduced.stress[points]


class BodyStress:
    """Stress of one body at the `points` named when it was reduced, one saved step at a time. Raises `InputError` as
    `stress_field`."""

    def __init__(self, history: History, view: SceneView, body: str, points: str) -> None:
        self.history, self.view, self.body = history, view, body
        self.field = stress_field(view, body, points)
        self._squares = membrane_forms(view.bodies[body])
        walls = view.bodies[body].reduced.provenance.get("contact_walls", {})
        self._loads: list[NormalLoads | PatchStress] = []
        for pair in view.pairs.values():
            if body in (pair.first_body.name, pair.second_body.name):
                load = normal_loads(pair, history, first=pair.first_body.name == body)
                is_fine = isinstance(load, CellLoads)
                self._loads.append(PatchStress(load, self.field, walls.get(load.surface.name)) if is_fine else load)
        self._loads += film_loads(view.films.values(), history, body)
        self._laps = LapLoads(history, view, body)

    def tensor(self, i: int) -> np.ndarray:
        """Stress (p, 6) [Pa] in the order xx, yy, zz, xy, yz, zx, axes of the body's user frame, at saved step `i`."""
        modal, loads = self.history.bodies[self.body].modal[i], self._loads
        rubbing = tangential_surface_forces(self.history, self.view, self.body, i)
        stretched = None if self._squares is None else membrane_amplitudes(self._squares, modal)
        tensor = self.field.evaluate(modal, surface_forces(loads, i), rubbing, self._laps.forces(i), stretched)
        for load in loads:
            if isinstance(load, PatchStress):
                tensor = tensor + load.at(i, load.forces(i))
        return tensor


def stress_result(
    result: Any, body: str, points: str, rows: Sequence[int] | np.ndarray | None, only: Sequence[int] | None
) -> StressResult:
    """Stress of `body` at the `points` named when it was reduced, at the saved steps `rows` (r,) and at those points
    whose numbers are in `only` (p,), all where they are None. Raises `InputError`."""
    source, count = BodyStress(result.history, result.view, body, points), len(result.time)
    shown = np.arange(count) if rows is None else numbers(rows, count, "stress: rows")
    every = len(source.field.points)
    wanted = np.arange(every) if only is None else numbers(only, every, "stress: only", "points", f"{points!r} has")
    shape = len(shown), len(wanted), 6
    size = 8 * int(np.prod(shape))
    if size > MUCH:
        log.warning("stress: '%s' of '%s' takes %s; name the saved steps wanted, rows=", points, body, size_text(size))
    tensor = np.empty(shape)
    for n, i in enumerate(shown):
        tensor[n] = source.tensor(int(i))[wanted]
    return StressResult(result.time[shown], source.field.points[wanted], tensor)


def numbers(given: Any, count: int, what: str, of: str = "saved steps", holder: str = "the run has") -> np.ndarray:
    """The numbers `given` (r,) of things that are counted from 0, negative ones from the end; raises `InputError`
    naming `what` for no whole numbers, and for one that is not among the `count` that the `holder` has."""
    found = np.atleast_1d(np.asarray(given))
    if found.ndim != 1 or not np.issubdtype(found.dtype, np.integer):
        raise InputError(f"{what} must be whole numbers of {of}, got {given!r}")
    if len(found) and not -count <= found.min() <= found.max() < count:
        raise InputError(f"{what}: {holder} {of} 0 to {count - 1}, got {found.min()} to {found.max()}")
    return found % max(count, 1)
