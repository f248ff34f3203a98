"""What the results of oil films are worth: whether their columns are fine enough for the thinnest film of a run.

Where a film of revolution is thinnest, h = c (1 - eps cos phi) is a parabola of the half-width sqrt(2 h_min/c) [rad]; a
pressure of hats that are a RULE-th of it wide errs by ERROR at its peak, and by the square of the pitch (rigid
bearings, hats beside fine volumes: docs/studies/oil_film.md). An elastic surface flattens the place, so the figure is
on the safe side there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.films import Film
from warpffrf.model.films.film import places_around
from warpffrf.model.films.roughness import least_gap
from warpffrf.model.integrators import Integrator, roots_at_infinity
from warpffrf.model.scene import Scene
from warpffrf.online.engine import Engine
from warpffrf.online.history.films import TURNED_BACK
from warpffrf.online.history.history import History
from warpffrf.online.history.interface_motion import turned
from warpffrf_kernels.films.sampling import GAP

RULE, ERROR = 6.0, 0.01
DAMPS = 0.55  # spectral radius at infinity, of 0.5 with round-off: what alternates is gone in a few steps
SQUEEZED = 0.01  # of the clearance: no film is left where a run ends at that


def film_notes(scene: Scene, history: History) -> list[str]:
    """One line a film whose columns are too coarse for the eccentricity that it reached, one of rough walls that came
    closer than flow factors are known, one of walls that overlap where the pressure is given, and one of a film that
    went beyond the grid of a second surface that yields."""
    notes = []
    for film in scene.films:
        found, clearance = history.films.get(str(film.name)), film.clearance()
        if found is None or not len(found.smallest_gap):
            continue
        thinnest = float(found.smallest_gap.min())
        notes.extend(_thinner_than_known(film, thinnest))
        notes.extend(_overlapping(film, found.gap))
        if not film.b.rigid:
            notes.extend(_beyond_second(film, history))
        if clearance is None:
            continue
        fine = np.sqrt(2.0 * max(thinnest, 0.0) / clearance) / RULE
        error = ERROR * (film.grid.pitch / fine) ** 2 if fine > 0.0 else np.inf
        if error > ERROR:
            columns = int(np.ceil(2.0 * np.pi / fine)) if fine > 0.0 else None
            more = f", {columns} columns on a turn would do for 1 %" if columns else ""
            notes.append(
                f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / clearance:.2g} of the clearance, "
                f"coarse columns of {np.degrees(film.grid.pitch):.3g} degrees for that: the peak pressure may err by "
                f"{min(error, 1.0):.1%}, where the surface does not yield{more}; reduce with a finer mesh around"
            )
    return notes


def _thinner_than_known(film: Film, thinnest: float) -> list[str]:
    known = least_gap(film.roughness_a, film.roughness_b)
    if known <= 0.0 or thinnest >= known:
        return []
    s = film.deviation
    return [
        f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / s:.2g} deviations of its rough walls, and "
        f"flow factors are known from {known / s:.2g} on: below, those of the flow by pressure keep their values"
    ]


def _overlapping(film: Film, gap: np.ndarray) -> list[str]:
    """Of nodes whose pressure is given: where none pushes the walls apart, nothing keeps them from overlapping."""
    held = film.held()[0]
    least = float(gap[:, held].min())
    if least > 0.0:
        return []
    j, k = np.argwhere(held)[np.argmin(gap[:, held].min(axis=0))]
    return [
        f"{film.label}: its walls overlap by up to {-least:.3g} m at theta = {film.theta[j]:.4g}, z = "
        f"{film.grid.z[k]:.4g} m, where the pressure is given and nothing keeps them apart: the film beside it is "
        "squeezed by a shape that is not there; give the first surface a form that falls off to its ends "
        "(films.BarrelForm), or asperities that carry there (law=)"
    ]


def _beyond_second(film: Film, history: History) -> list[str]:
    """Of ends of the film that lay more than a cell beyond the grid of the second surface, which does not yield there
    (`warpffrf_kernels.films.seats`)."""
    surface, grid = film.b.surface, film.b.surface.grid
    first, second = (history.bodies[port.body.name] for port in film.ports)
    theta, z = (v.ravel() for v in np.meshgrid(film.theta, film.grid.z[[0, -1]], indexing="ij"))
    out = 0.0
    for place in film.a.surface.shape.point(theta, z):
        world = first.position + turned(first.rotation, place)
        theta_b, z_b, _ = surface.shape.chart(turned(second.rotation * TURNED_BACK, world - second.position))
        out = max(out, float(np.max(grid.z[0] - np.diff(grid.z[:2]) - z_b)))
        out = max(out, float(np.max(z_b - grid.z[-1] - np.diff(grid.z[-2:]))))
        if not grid.periodic:
            columns = places_around(surface)
            away = np.abs(theta_b - 0.5 * (columns[0] + columns[-1]))
            if not surface.shape.profile().planar:
                away = np.minimum(away % (2.0 * np.pi), -away % (2.0 * np.pi))
            beyond = away - 0.5 * (columns[-1] - columns[0]) - grid.pitch
            out = max(out, float(np.max(beyond * np.asarray(surface.shape.radius_at(z_b)))))
    if out <= 0.0:
        return []
    return [
        f"{film.label}: it reaches up to {out:.3g} m beyond the grid of {film.b.label} and a cell, where that surface "
        "does not yield; reduce its body with a longer contact surface"
    ]


def alternation_notes(scene: Scene, integrator: Integrator) -> list[str]:
    """Of a run whose steps were halved: what the integrator makes of overdamped motions, as those of thin films are,
    in steps that are long against them."""
    if not scene.films or np.abs(roots_at_infinity(integrator.coefficients)).max() <= DAMPS:
        return []
    return [
        "thin films damp motions within less than a step, which the integrator leaves alternating from step to step: "
        "steps are halved less with integrator=GeneralizedAlpha(0.5), or shorter ones"
    ]


def squeezed_out(engine: Engine, still: Sequence[Film] = ()) -> str:
    """Of a run or an equilibrium that failed, a clause that names the film that was squeezed out, "" where none was.
    still: films in which nothing slides, and never will."""
    films = engine.compiled.films
    for i, film in enumerate(engine.scene.films):
        first, end = films.point_start.numpy()[i : i + 2]
        gap = engine.scratch.film_line.numpy()[:, first:end, int(GAP)]
        least, thick = float(np.nanmin(gap, initial=np.inf)), float(films.thickness.numpy()[i])
        if least < SQUEEZED * thick:
            why, cure = "it does not carry what is on it", "it more speed, a thicker oil or less load"
            if film in still:
                why, cure = "nothing slides and it carries nothing at rest", "one of its bodies a velocity"
            return (
                f"{film.label} is squeezed to {least:.2g} m, {least / thick:.1g} of its clearance, where {why}; give "
                f"{cure}, or asperities=laws.ExponentialAsperities(...)"
            )
    return ""
