"""Histories of oil films, from the saved rows of the films and of the nodes of their grids."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.films import Film
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.history.history import BodyHistory, FilmHistory
from warpffrf.online.history.interface_motion import turned
from warpffrf_kernels.films import heat, history

Array = np.ndarray
FORCE, MOMENT, MOMENT_SECOND = (slice(3 * n, 3 * n + 3) for n in range(3))  # of the numbers saved of a film
NUMBERS = {
    "smallest_gap": history.SMALLEST, "largest_pressure": history.LARGEST, "pressure_loss": history.BY_PRESSURE,
    "friction_power": history.BY_SLIDING, "feed_flow": history.FED, "end_flow": history.ENDS,
    "void_fraction": history.VOIDS, "oil_volume": history.OIL,
    "asperity_force": history.ROUGH, "largest_asperity_pressure": history.ROUGHEST,
}  # fmt: skip
HEATS = {
    "inlet_temperature": heat.INLET, "heat_generated": heat.GENERATED, "heat_carried": heat.CARRIED,
    "heat_to_a": heat.TO_A, "heat_to_b": heat.TO_B, "heat_stored": heat.STORED,
}  # fmt: skip
FIELDS = ("pressure", "gap", "void", "asperity")
TURNED_BACK = np.array([-1.0, -1.0, -1.0, 1.0])  # times a unit quaternion: its inverse


def film_histories(compiled: Any, rows: SavedRows, bodies: dict[str, BodyHistory]) -> dict[str, FilmHistory]:
    """By name; the arrays of films are read where the scene has some."""
    found = {}
    for i, film in enumerate(compiled.scene.films):
        first, end = compiled.films.node_start.numpy()[i : i + 2]
        fields = {name: rows[f"saved_film_{name}"][:, first:end] for name in FIELDS}
        history = _history(film, rows["saved_film"][:, i], fields, bodies)
        if not film.b.rigid:
            first, end = compiled.films.second_node_start.numpy()[i : i + 2]
            grid = film.b.surface.grid
            loads = rows["saved_film_second"][:, first:end]
            history.load_second = loads.reshape(-1, grid.columns, grid.rows).copy()
        if film.temperature is not None:
            first, end = compiled.films.heat_start.numpy()[i : i + 2]
            history.temperature = rows["saved_film_temperature"][:, first:end].reshape(history.gap.shape).copy()
            for name, n in HEATS.items():
                setattr(history, name, rows["saved_film_heat"][:, i, int(n)].copy())
        found[str(film.name)] = history
    return found


def _history(film: Film, saved: Array, fields: dict[str, Array], bodies: dict[str, BodyHistory]) -> FilmHistory:
    """History of a film from its numbers (T, `history.NUMBERS`) and its `fields` (T, nodes)."""
    T, force = len(saved), saved[:, FORCE].copy()
    numbers = {name: saved[:, n].copy() for name, n in NUMBERS.items()}
    shape = T, film.grid.columns, film.grid.rows
    if film.quadrature == "reduced":  # balances oil in axial means, not pointwise, at points far from the ends
        numbers |= {"feed_flow": np.full(T, np.nan), "end_flow": np.full(T, np.nan)}
        numbers["smallest_gap"] = narrowest(fields["gap"].reshape(shape), periodic=film.grid.periodic)
    return FilmHistory(
        force=force,
        torque=saved[:, MOMENT] + np.cross(_arm(film.a.body, bodies, T), force),
        torque_second=saved[:, MOMENT_SECOND] - np.cross(_arm(film.b.body, bodies, T), force),
        eccentricity=eccentricity(film, bodies, T),
        **{name: values.reshape(shape).copy() for name, values in fields.items()},
        **numbers,
    )


def narrowest(gap: Array, *, periodic: bool) -> Array:
    """(T,) m the smallest of gaps (T, columns, rows) at nodes: of each row the vertex of the parabola through the
    smallest one and its neighbours around, on an arc or a plane the smallest where it has no two."""
    columns = gap.shape[1]
    at = np.argmin(gap, axis=1)  # (T, rows)
    before, least, after = (
        np.take_along_axis(gap, (at + step)[:, None, :] % columns, axis=1)[:, 0] for step in (-1, 0, 1)
    )
    bend = before - 2.0 * least + after
    inside = (bend > 0.0) & (periodic | ((at > 0) & (at < columns - 1)))
    drop = np.divide((after - before) ** 2, 8.0 * bend, out=np.zeros_like(least), where=inside)
    return (least - drop).min(axis=1)


def _arm(body: Any, bodies: dict[str, BodyHistory], steps: int) -> Array:
    """(T, 3) m from the user origin of `body` to its centre of mass, world axes; none of the ground."""
    if body.name not in bodies:
        return np.zeros((steps, 3))
    return turned(bodies[body.name].rotation, body.center_of_mass)


def eccentricity(film: Film, bodies: dict[str, BodyHistory], steps: int) -> Array:
    """(T, 2) m, see `FilmHistory`: intersection of the axis of the second surface with the plane normal to that of the
    first, in the middle of the grid; for a sphere as second surface its centre."""
    first, second = film.a.surface.shape, film.b.surface.shape
    profile = second.profile()
    if profile.planar or first.profile().planar:
        return np.full((steps, 2), np.nan)
    place, axis = _in_world(film.b.body, bodies, steps, second.axis_point, second.axis_direction)
    motion = bodies[film.a.body.name]
    back = motion.rotation * TURNED_BACK
    place, axis = turned(back, place - motion.position), turned(back, axis)
    middle = 0.5 * (film.grid.z[0] + film.grid.z[-1])
    off = place - (np.asarray(first.axis_point) + middle * first.e_a)
    if profile.crown != profile.radius:  # that of a sphere
        off = off - (off @ first.e_a / (axis @ first.e_a))[:, None] * axis
    outer_first = first.side < 0.0
    return (off if outer_first else -off) @ first.frame[:2].T


def _in_world(body: Any, bodies: dict[str, BodyHistory], steps: int, point: Any, axis: Any) -> tuple[Array, Array]:
    """A point (T, 3) [m] and a direction (T, 3) of the user frame of `body`, in the world."""
    point, axis = np.asarray(point, dtype=float), np.asarray(axis, dtype=float)
    if body.name not in bodies:
        return np.tile(point, (steps, 1)), np.tile(axis, (steps, 1))
    motion = bodies[body.name]
    return motion.position + turned(motion.rotation, point), turned(motion.rotation, axis)
