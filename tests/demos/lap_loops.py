r"""Loops of force over place in load steps, and full finite elements with friction that go through them.

Two strips lie on each other, held at their far ends, the end of the upper one on a carriage that goes along x by given
places, and bolts draw them together. The reference of `demos.lap_joint`: every node of the meshes, no code of
engine or reduction [`references.small_sliding`].

**A held body that rides.** With the carriage at x, the displacement v = u - x e_x of the upper strip is zero at its
end, as full finite elements with supports have it. Cells see the slip x (t . e_x) compared with what v gives,

    delta = B^T v + x (t . e_x),

and x is one more load. The carriage is pushed by what friction and bolts do to the upper strip.

**Bolts.** With axes e along x, y, z and the mean displacements of its heads, a_k^T u the one of the upper head along
e_k less that of the lower one, a bolt of stiffness k, tightened with T_0 between heads l apart, pulls with

    T = T_0 + k a_z^T u,      and across, as it leans with the heads,      (T/l) a_x^T u,   (T/l) a_y^T u,

springs k a_z a_z^T + (T/l) (a_x a_x^T + a_y a_y^T) with T as it is at rest, and the load -T_0 a_z.

**Masing's rule.** Where no pressure changes, a loop is the first loading F = g(x) twice as large: from -a to a it is
-g(a) + 2 g((x + a)/2), and its area

    D = 8 int_0^a g dx - 4 a g(a).

It is for pressures that stay and joints that begin without tractions; strips bend and press elsewhere as they are
pulled, and tightening leaves tractions. So it is a check of the loop of full slip, where both hardly matter.

**Swings.** Released, the carriage reverses at tops and bottoms; cycle n goes from one top to the next one. Half a cycle
begins at rest in m + e and ends at rest in -(m - e), so that the force has done no work between. It is the half loop of
amplitude m, which takes D/2, but begun further out by e, with a force that is F_a'(m) e higher all the way of 2 m,

    D/2 = 2 m F_a' e,       so that in a cycle       D = m dF,       ln(F_n/F_(n+1)) = D/(m F) = D/(2 U),   U = m F/2.

It is the amplitude of the *force* that falls by pi 2 zeta with 2 zeta = D/(2 pi U) of the loop; that of the place falls
faster where the joint becomes softer. Forces are those of the first loading at the tops that the carriage comes to. At
larger amplitudes the frequency falls with the secant stiffness k of the loops, (2 pi f)^2 = k/M, M the modal mass at
the carriage.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from references.small_sliding.cells import facet_cells
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import Followed, StaticSmallSliding, follow
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.output.loops import Loop

HALF = 16  # load steps of half a loop


@dataclass(frozen=True, eq=False)
class LoadPath:
    """Places of the carriage (n,) [m] from rest in load steps of a second: for each of the rising `amplitudes` a way
    up to it and a loop from there, that begins and ends in the rows `loops` (k, 2)."""

    amplitudes: np.ndarray
    places: np.ndarray
    loops: np.ndarray

    @classmethod
    def of(cls, amplitudes: np.ndarray) -> LoadPath:
        """Through loops of `amplitudes` (k,) [m]."""
        parts, rows, last = [np.zeros(1)], [], 0.0
        for a in amplitudes:
            steps = max(3, round(HALF * (a - last) / a))
            parts.append(np.linspace(last, a, steps + 1)[1:])
            first = sum(map(len, parts)) - 1
            parts += [np.linspace(a, -a, HALF + 1)[1:], np.linspace(-a, a, HALF + 1)[1:]]
            rows.append((first, first + 2 * HALF))
            last = a
        return cls(np.asarray(amplitudes), np.concatenate(parts), np.array(rows))

    @property
    def first_loading(self) -> np.ndarray:
        """Rows of the way up, without the loops."""
        ends = np.append(0, self.loops[:, 1] + 1)[:-1]
        ways = [np.arange(a, b + 1) for a, b in zip(ends, self.loops[:, 0], strict=True)]
        return np.concatenate(ways)


@dataclass(frozen=True, eq=False)
class Loops:
    """What came of a path: force on the carriage (n,) [N], and what friction took in each loop (k,) [J]."""

    path: LoadPath
    force: np.ndarray
    loss: np.ndarray

    @property
    def all(self) -> list[Loop]:
        """The loops."""
        t = np.arange(len(self.force), dtype=float)
        rows = [slice(first, last + 1) for first, last in self.path.loops]
        return [Loop(t[part], self.force[part], self.path.places[part]) for part in rows]

    @property
    def amplitude(self) -> np.ndarray:
        """Of the force (k,) [N]."""
        return np.array([loop.force_amplitude for loop in self.all])

    def nearest(self, amplitude: float) -> int:
        """Number of the loop whose amplitude [m] is the nearest."""
        return int(np.argmin(np.abs(self.path.amplitudes - amplitude)))

    @property
    def damping(self) -> np.ndarray:
        """2 zeta (k,) = D/(2 pi U)."""
        return self.loss / (np.pi * self.amplitude * self.path.amplitudes)

    @property
    def stiffness(self) -> np.ndarray:
        """Secant stiffness (k,) [N/m]."""
        return self.amplitude / self.path.amplitudes

    @property
    def stuck(self) -> float:
        """Stiffness [N/m] in the first steps back from both reversals of the smallest loop."""
        (first, last), F, x = self.path.loops[0], self.force, self.path.places
        turns = (first, (first + last) // 2)
        return float(np.mean([(F[i + 1] - F[i]) / (x[i + 1] - x[i]) for i in turns]))

    @property
    def masing(self) -> np.ndarray:
        """Losses (k,) [J] by Masing's rule from the first loading."""
        rows = self.path.first_loading
        x, g = self.path.places[rows], self.force[rows]
        upto = [x <= a * (1.0 + 1e-9) for a in self.path.amplitudes]
        return np.array([8.0 * np.trapezoid(g[on], x[on]) - 4.0 * x[on][-1] * g[on][-1] for on in upto])


@dataclass(frozen=True, eq=False)
class Swing:
    """A vibration about the place `rest` [m]: time (T,) [s] since it was let go in equal steps, place (T,) [m] from
    rest, on the side from which it is let go positive, loss (T,) [J] by friction so far."""

    time: np.ndarray
    place: np.ndarray
    loss: np.ndarray
    rest: float = 0.0

    def turns(self, sign: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] of the reversals on the side of `sign`, and how far they are from rest [m]: where it is let go,
        then tops of parabolas through three rows."""
        t, x = self.time, sign * self.place
        k = 1 + np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]) & (x[1:-1] > 0.0))
        slope, bend = 0.5 * (x[k + 1] - x[k - 1]), x[k + 1] - 2.0 * x[k] + x[k - 1]
        at, top = t[k] - slope / bend * (t[1] - t[0]), x[k] - 0.5 * slope**2 / bend
        return (np.append(t[0], at), np.append(x[0], top)) if sign > 0.0 else (at, top)

    @property
    def amplitude(self) -> np.ndarray:
        """Of each cycle (n,) [m]: half of the way between the mean of its tops and its bottom."""
        top, bottom = self.turns()[1], self.turns(-1.0)[1]
        n = min(len(top) - 1, len(bottom))
        return 0.5 * (0.5 * (top[:n] + top[1 : n + 1]) + bottom[:n])

    @property
    def frequency(self) -> np.ndarray:
        """Of each cycle (n,) [Hz]."""
        return 1.0 / np.diff(self.turns()[0])[: len(self.amplitude)]

    @property
    def taken(self) -> np.ndarray:
        """By friction in each cycle (n,) [J]."""
        return np.diff(np.interp(self.turns()[0], self.time, self.loss))[: len(self.amplitude)]


@dataclass(frozen=True)
class Bolt:
    """tightened T_0 [N], stiffness k [N/m], length l [m] between the heads, tension T [N] at rest."""

    tightened: float
    stiffness: float
    length: float
    tension: float


@dataclass(frozen=True, eq=False)
class Full:
    """Full finite elements through a path: `cells` have pressure, state and loss, `loops` the forces, `tension`
    (n, bolts) [N]."""

    cells: Followed
    loops: Loops
    tension: np.ndarray

    @classmethod
    def of(
        cls,
        meshes: Sequence[Mesh],
        material: Material,
        friction: float,
        bolt: Bolt,
        count: int,
        path: LoadPath,
        rest: float,
    ) -> Full:
        """The lower and the upper mesh, with facet sets `overlap` and `head0`, ..., held at `x_min` and `x_max`; so
        many alike bolts; a path about the place `rest` [m]."""
        model = FullModel([Part(m, material, (end,)) for m, end in zip(meshes, ("x_min", "x_max"), strict=True)])
        along, aside, pull = (
            np.array([model.spread(1, f"head{i}", e) - model.spread(0, f"head{i}", e) for i in range(count)])
            for e in np.eye(3)
        )
        leans = bolt.tension / bolt.length
        springs = [(a, k) for rows, k in ((along, leans), (aside, leans), (pull, bolt.stiffness)) for a in rows]
        model = model.with_springs(*springs)
        cells = facet_cells(model, (0, "overlap"), (1, "overlap"))
        lap = StaticSmallSliding(model, cells, friction)
        loads = np.stack([-bolt.tightened * pull.sum(axis=0), -leans * along.sum(axis=0)], axis=1)
        still = model.solve(loads)
        ride = cells.frames[:, :, 0].ravel()  # of the cells, with the carriage
        places = rest + path.places
        seen = np.concatenate([along, pull])
        found = follow(
            lap.flexibility, cells, friction, lap.layers, cells.loads.T @ still + np.outer(ride, [0.0, 1.0]),
            np.stack([np.ones_like(places), places], axis=1), (seen @ still, seen @ lap.responses), loads.T @ still,
        )  # fmt: skip
        lean = leans * (found.observed[:, :count] + places[:, None]).sum(axis=1)
        force = lean - found.force.reshape(len(places), -1) @ ride
        loss = np.array([found.loss(first, last) for first, last in path.loops])
        return cls(found, Loops(path, force, loss), bolt.tightened + bolt.stiffness * found.observed[:, count:])
