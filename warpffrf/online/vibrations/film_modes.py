r"""Small motions of a scene with oil films: their pressures and voids move, too, with rates of their own.

With the set of voids as it is, a film about a state is linear. Of its unknowns x, pressures or voids and pressures of
asperities, and the columns c that it is coupled to, motions of both bodies and global modes (`warpffrf_kernels.films`),

    J_0 x + J_1 x' + B_0 c + B_1 c' = 0,       force on c:  P^T x.

J and B of a step are J_0 + a_0 J_1 and B_0 + a_0 B_1, with the coefficient a_0 of its rates, so that two of them, from
the kernels of a step, give all four. With y of `linearise`, c = T y and c' = T y' + U y, and y = N z of rigid rows that
stay satisfied,

    m z'' + d z' + k z = N^T T^T P^T x,
    J_1 x' + B_1 T N z' = -J_0 x - (B_0 T + B_1 U) N z,

whose eigenvalues are those of the pencil of both in (z, z', x). J_1 is singular, as far as neither walls nor voids
take oil: as many eigenvalues are infinite, and left out. So are motions of the oil alone, whose bodies hardly move:
voids that travel. What counts is the oil that the motion of bodies takes, beside what voids and walls take: MOVES of
both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from warpffrf_kernels.films import unknowns
from warpffrf_kernels.films.sampling import GAP

from warpffrf.online.engine import Engine

Array = np.ndarray
RATES = 100.0, 200.0  # 1/s: two coefficients of rates, of which J and B are linear functions
MOVES = 0.02  # see the module
INFINITE = 1e12  # 1/s
SLOWEST = 1e-6  # of the highest frequency: coordinates without stiffness are scaled as if they had some
GAP_STEP = 1e-3  # of the smallest gap, for differences


@dataclass(frozen=True)
class FilmSystem:
    """J_0, J_1 (x, x), B_0, B_1 (x, n), P (x, n) over displacements, turns and modes of all bodies (n)."""

    J_0: Array
    J_1: Array
    B_0: Array
    B_1: Array
    P: Array


def smallest_gap(engine: Engine) -> float:
    """Of all films [m], at the last evaluation; infinite without."""
    count = engine.compiled.films.count
    return float(engine.scratch.film_line.numpy()[0, :, int(GAP)].min()) if count else np.inf


def film_systems(engine: Engine, coordinates: int) -> list[FilmSystem]:
    """Of all films of world 0 at the state that was evaluated last; `coordinates`: n."""
    films = engine.compiled.films
    if not films.count:
        return []
    found = []
    for rate in RATES:
        engine.scratch.film_rates.assign(np.tile([rate, 0.0, 0.0], (engine.worlds, 1)))
        engine.control(run=1, moved=1, refresh=1, failure=0, changes=0)
        engine.graph.move_and_load()
        engine.graph.assemble()
        found.append([_system(engine, film, coordinates) for film in range(films.count)])
    first, second = RATES
    systems = []
    for (J, B, P), (J_2, B_2, _) in zip(*found, strict=True):
        J_1, B_1 = ((two - one) / (second - first) for one, two in ((J, J_2), (B, B_2)))
        systems.append(FilmSystem(J - first * J_1, J_1, B - first * B_1, B_1, P))
    return systems


def _system(engine: Engine, film: int, coordinates: int) -> tuple[Array, Array, Array]:
    """J, B and P of a film as it was assembled last."""
    m, films = engine.compiled.model, engine.compiled.films
    lines = int(films.unknowns.numpy()[film] + films.rough.numpy()[film])
    modes = [int(count.numpy()[film]) for count in (films.modes, films.second_modes)]
    columns = int(unknowns.RIGID) + sum(modes)
    start, stride = int(films.matrix_start.numpy()[film]), lines + 1 + 2 * columns
    table = engine.scratch.film_matrix.numpy()[start : start + lines * stride].reshape(lines, stride)
    J, X, P = table[:, :lines], table[:, lines + 1 : lines + 1 + columns], table[:, lines + 1 + columns :]
    place = np.zeros((columns, coordinates))
    surfaces, body = (films.first.numpy()[film], films.second.numpy()[film]), m.surfaces.body.numpy()
    for side, surface in enumerate(surfaces):
        if body[surface] >= 0:
            place[6 * side : 6 * side + 6, 6 * body[surface] : 6 * body[surface] + 6] = np.eye(6)
    start = int(unknowns.RIGID)
    for surface, count in zip(surfaces, modes, strict=True):
        first = 6 * m.bodies.count + int(m.surfaces.modal_start.numpy()[surface])
        place[start : start + count, first : first + count] = np.eye(count)
        start += count
    return J.copy(), (J @ X) @ place, P @ place


def film_modes(m: Array, d: Array, k: Array, Q: Array, QU: Array, systems: list[FilmSystem]) -> tuple[Array, Array]:
    """Eigenvalues [1/s] and shapes z (n, modes) of m z'' + d z' + k z and the films, whose columns move by Q z at rates
    Q z' + QU z."""
    J_0 = np.asarray(scipy.linalg.block_diag(*(s.J_0 for s in systems)))
    J_1 = np.asarray(scipy.linalg.block_diag(*(s.J_1 for s in systems)))
    B_0, B_1, P = (np.concatenate([getattr(s, name) for s in systems]) for name in ("B_0", "B_1", "P"))
    n, x = len(m), len(J_0)
    line = 1.0 / np.maximum(np.abs(J_0).max(axis=1), np.abs(J_1).max(axis=1))
    column = 1.0 / np.maximum(np.abs(line[:, None] * J_0).max(axis=0), np.finfo(float).tiny)
    J_0, J_1 = (line[:, None] * J * column for J in (J_0, J_1))
    by_place, by_rate = line[:, None] * (B_0 @ Q + B_1 @ QU), line[:, None] * (B_1 @ Q)
    push = (Q.T @ P.T) * column
    # (w z, z', x/u) in place of (z, z', x): of coordinates that differ as 1 and 1e7 rad/s no square is left
    w = np.sqrt(np.abs(np.diag(k) + np.diag(push @ np.linalg.solve(J_0, by_place))))
    w = np.maximum(w, SLOWEST * w.max())
    u = np.sqrt(np.abs(by_place / w).max() / np.abs(push).max())
    one, none = np.eye(n), np.zeros
    E = np.block([
        [one, none((n, n)), none((n, x))], [none((n, n)), m, none((n, x))], [none((x, n)), none((x, n)), J_1]
    ])  # fmt: skip
    A = np.block([
        [none((n, n)), np.diag(w), none((n, x))], [-k / w, -d, push * u], [-by_place / w / u, -by_rate / u, -J_0]
    ])  # fmt: skip
    found: Any = scipy.linalg.eig(A, E)
    values, vectors = found
    z, inside = vectors[:n] / w[:, None], u * vectors[2 * n :]
    by_bodies, by_film = (np.linalg.norm(X, axis=0) for X in (by_rate @ z, J_1 @ inside))
    free = np.linalg.norm(by_rate, axis=0).max() * np.linalg.norm(z, axis=0)  # what such a motion could take
    moves = (by_bodies > MOVES * (by_bodies + by_film)) | (by_film <= MOVES * free)
    kept = np.isfinite(values) & (np.abs(values) < INFINITE) & moves & (np.linalg.norm(z, axis=0) > 0.0)
    return values[kept], z[:, kept]
