r"""Small motions of a scene with oil films: pressures and cavity fractions are unknowns with rates.

With the set of cavitated functions fixed, a film is linear about a state. With its unknowns x, pressures or cavity
fractions and pressures of asperities, and the columns c that it is coupled to, motions of both bodies and global modes
(`warpffrf_kernels.films`),

    J_0 x + J_1 x' + B_0 c + B_1 c' = 0,       force on c:  P^T x.

The boundary of the set moves nevertheless: the cavity fraction of the last function before a film that forms again
represents how far that function is filled, and reduces the cavity flow into the film accordingly; so boundaries travel
within cells.

J and B of a step are J_0 + a_0 J_1 and B_0 + a_0 B_1, with the coefficient a_0 of its rates (`film_system`). With y of
`linearise`, c = T y and c' = T y' + U y, and y = N z of rigid rows that stay satisfied, a motion z exp(lambda t) and
the film satisfy

    T(lambda) z = 0,
    T = lambda^2 m + lambda d + k + N^T T^T P^T (J_0 + lambda J_1)^-1 (B_0 T + B_1 U + lambda B_1 T) N.

**Cavity fractions are never part of an eigenproblem.** Transport from function to function is a chain, in a matrix a
Jordan block as long as the row of cavitated functions. Among the eigenvalues of a pencil of (z, z', x) the round-off
eps of such a block of length n appears as eps^(1/n), about half of the rate at which the cavity fractions leave a
function, on circles that reach far into the unstable half-plane. Solving with J_0 + lambda J_1 avoids this: cavity
fractions are eliminated first, as a triangle, which leaves the dense rows of full functions.

**Each motion separately.** About a point mu, T is the quadratic T(mu) + (lambda - mu) T'(mu), except for lambda^2 m,
which is kept whole; its eigenvalue nearest to mu is the next point. That is Newton's method for an eigenvalue, which
also converges for double ones. It begins at mu = 0 and proceeds upwards: the next start is the slowest eigenvalue about
the last point that is not assigned to a known one. Searches that fail, or end at a known one, are given up and
reported: they concern motions that decay as fast as cavity fractions leave, where the film has an unlimited number of
poles.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from scipy import sparse
from scipy.sparse.linalg import splu

from warpffrf.online.vibrations.film_system import FilmSystem
from warpffrf.online.vibrations.quadratic import quadratic_modes

Array = np.ndarray
SPARSE = 0.05  # part of the entries: fewer are those of films between rigid bodies, where no pressure opens other gaps
MOST_PLACES = 20  # iterations of Newton's method per motion
CLOSE = 1e-5  # of |lambda|, a step of it: the next would be its square
ROUND_OFF = 1e-13  # of the highest frequency: resolution of all motions
MARGIN = 0.3  # of |lambda|, by which a motion may differ from where its search begins
SAME = 1e-6  # of |lambda|, and of a shape: the same motion found twice


class FilmResponse:
    """Response of films to motions z exp(lambda t), columns Q z at rates Q z' + QU z."""

    def __init__(self, system: FilmSystem, Q: Array, QU: Array) -> None:
        order = np.argsort(~system.thin, kind="stable")
        self.thin, self.order = int(np.count_nonzero(system.thin)), order
        line = 1.0 / np.maximum(np.abs(system.J_0).max(axis=1), np.abs(system.J_1).max(axis=1))[order]
        self.J = [line[:, None] * J[np.ix_(order, order)] for J in (system.J_0, system.J_1)]
        few = sum(int(np.count_nonzero(J)) for J in self.J) < SPARSE * len(order) ** 2
        self.sparse = [sparse.csc_array(J) for J in self.J] if few else None
        self.to_thin = [sparse.csc_array(J[:, : self.thin]) for J in self.J]
        self.by_place = line[:, None] * (system.B_0 @ Q + system.B_1 @ QU)[order]
        self.by_rate = line[:, None] * (system.B_1 @ Q)[order]
        self.push = (system.P @ Q).T[:, order]

    def at(self, value: complex) -> tuple[Array, Array]:
        """(n, n) of T, and its derivative by lambda [N/m, N s/m]."""
        x, x_rate = self.unknowns(value)
        return self.push @ x[self.order], self.push @ x_rate[self.order]

    def unknowns(self, value: complex) -> tuple[Array, Array]:
        """(J_0 + lambda J_1)^-1 (B_0 + lambda B_1) (x, n), minus the film's unknowns by motions, and its derivative by
        lambda."""
        right = self.by_place + value * self.by_rate
        if self.sparse is not None:
            solved = splu(self.sparse[0] + value * self.sparse[1])
            x = solved.solve(right.astype(solved.L.dtype))
            rate = solved.solve((self.by_rate - self.sparse[1] @ x).astype(solved.L.dtype))
            return self._in_order(x, rate)
        t = self.thin
        J = self.J[0][:, t:] + value * self.J[1][:, t:]
        to_thin = sparse.csc_array(self.to_thin[0] + value * self.to_thin[1])
        voids = splu(to_thin[:t]) if t else None
        over = to_thin[t:]

        def answer(right: Array) -> Array:
            return voids.solve(np.asarray(right, J.dtype)) if voids is not None else right

        within = answer(J[:t])
        full = scipy.linalg.lu_factor(J[t:] - over @ within)

        def solve(right: Array) -> Array:
            first = answer(right[:t])
            last = scipy.linalg.lu_solve(full, right[t:] - over @ first)
            return np.concatenate([first - within @ last, last])

        x = solve(right)
        return self._in_order(x, solve(self.by_rate - self.J[1] @ x))

    def _in_order(self, x: Array, x_rate: Array) -> tuple[Array, Array]:
        found = np.zeros((2, *x.shape), x.dtype)
        found[:, self.order] = x, x_rate
        return found[0], found[1]


def film_modes(
    m: Array, d: Array, k: Array, Q: Array, QU: Array, systems: list[FilmSystem], count: int
) -> tuple[Array, Array, list[complex]]:
    """The `count` slowest eigenvalues [1/s] of Im >= 0 and shapes z (n, modes) of m z'' + d z' + k z and the films,
    whose columns move by Q z at rates Q z' + QU z; and the starts of searches that were given up, see the module.
    """
    films = [FilmResponse(system, Q, QU) for system in systems]

    def about(place: complex) -> tuple[Array, Array]:
        """Eigenvalues and shapes of the quadratic about a point."""
        stiffness, damping = (sum(parts) for parts in zip(*(film.at(place) for film in films), strict=True))
        return quadratic_modes(m, d + damping, k + stiffness - place * damping)

    there, shapes = about(0.0)
    least = ROUND_OFF * float(np.abs(there).max(initial=0.0))
    found: list[tuple[complex, Array]] = []
    lost: list[complex] = []
    while True:
        known = [value for value, _ in found]
        starts = [i for i in _free(there, known + lost, least) if there[i].imag >= -least]
        slowest = sorted(abs(value) for value in known)
        start = min(starts, key=lambda i: abs(there[i]), default=None)
        if start is None or len(slowest) >= count and slowest[count - 1] < (1.0 - MARGIN) * abs(there[start]):
            break
        begun = place = there[start]
        shape, near = shapes[:, start], abs(place) <= least
        for _ in range(MOST_PLACES):
            if near:
                break
            place = place.real if abs(place.imag) <= least else place
            there, shapes = about(place)
            i = min(_free(there, known, least), key=lambda i: abs(there[i] - place))
            near = bool(abs(there[i] - place) <= CLOSE * abs(place) + least)
            place, shape = there[i], shapes[:, i]
        again = any(abs(value - place) <= SAME * abs(place) + least and _alike(other, shape) for value, other in found)
        if near and place.imag >= -least and not (again and abs(place) > least):
            found.append((place, shape))
        else:
            lost.append(begun)
    if not found:
        return np.zeros(0, complex), np.zeros((len(m), 0), complex), lost
    return np.array([value for value, _ in found]), np.stack([shape for _, shape in found], axis=1), lost


def _free(there: Array, done: list[complex], least: float) -> list[int]:
    """Eigenvalues of a quadratic that are neither in `done` nor their conjugates: each of these takes the nearest."""
    free = list(range(len(there)))
    for value in done:
        for one in (value, np.conj(value)) if abs(value.imag) > least else (value,):
            if len(free) > 1:
                free.remove(min(free, key=lambda i: abs(there[i] - one)))
    return free


def _alike(one: Array, other: Array) -> bool:
    """Whether two shapes are the same."""
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return bool(abs(np.vdot(one, other)) > (1.0 - SAME) * size)
