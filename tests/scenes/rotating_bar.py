r"""A bar rotating about its end (case D1), where each inertia level has its closed form.

A bar 0 <= x <= L, no lateral contraction, fixed at x = 0 and driven with omega about z: with k^2 = rho omega^2/E

    u'' + k^2 (x + u) = 0,   u(0) = 0, u'(L) = 0:      u(L) = tan(k L)/k - L.

The levels omit parts of the kinetic energy omega^2/2 int (x + u)^2 dm in a frame in the centre of mass. With the
mean U = int u dm/m, c = L/2, and the deformation in that frame u - U it is omega^2/2 times

    m (c + U)^2  +  2 int (x - c)(u - U) dm  +  int (u - U)^2 dm  +  constant,
    by the motion of the centre of mass        J1        J2

so that u'' + k^2 s = 0 with the lever s, and U follows from its own definition (L = 1 here for short):

    full, deformed          s = x + u
    gyroscopic (no J2)      s = x + U:    U = (5 k^2/24)/(1 - k^2/3),   u(1) = k^2 (1/3 + U/2)
    constant (no J1, J2)    s = c + U:    U = (k^2/6)/(1 - k^2/3),      u(1) = k^2 (c + U)/2
    "linear"                s = x:        u(1) = k^2/3

The centre of mass moves outwards at every level: the "linear" value of a frame fixed at the axis is none of
theirs. In the steady state there are no Coriolis and Euler forces: full equals deformed.

*Stationary state of a reduced model* (independent of kernels and integrator): with the axial motion p of the fixed
interface per modal coordinate, kinetic minus strain energy is stationary,

    V = omega^2/2 (J1_zz.q + q.J2_zz q + m s^2) - q.(Omega^2 + omega^2 Kc_zz) q/2,      s = c - p.q + q.Kf_x q/2,

where Kc, Kf (geometric stiffness due to rotation and to the force at the interface) exist with stiffening only. The bar
is stable while V is at a maximum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import joints, signals
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, bases, reduce
from warpffrf.online import History, run

Array = np.ndarray
ALUMINIUM = Material(70e9, 0.0, 2700.0, name="aluminium without lateral contraction")
LENGTH, SPEED = 1.0, 1000.0  # m, rad/s
THICK = 0.3  # m: bending in the plane of rotation is stable at this speed without geometric stiffening
SLENDER = 0.05  # m: without it, this bar buckles
DAMPING = 1.0  # ratio of all modes
SPIN_UP, SETTLING = 0.06, 0.04  # s: from rest to SPEED, and until the bar is at rest in the rotating frame
ALL = 1000  # modes with inertia terms: more than there are
CORRECTIONS = 20  # of the stationary state: Newton's method, which is stationary after four

K2 = ALUMINIUM.density * SPEED**2 / ALUMINIUM.youngs_modulus  # (k L)^2


def closed_form(level: str) -> float:
    """Elongation u(L) [m] of the bar at an inertia level, see the module; also of "linear"."""
    if level in ("deformed", "full"):
        k = np.sqrt(K2)
        return LENGTH * float(np.tan(k) / k - 1.0)
    if level == "gyroscopic":
        return LENGTH * K2 * (1.0 / 3.0 + 0.5 * (5.0 * K2 / 24.0) / (1.0 - K2 / 3.0))
    if level == "constant":
        return LENGTH * 0.5 * K2 * (0.5 + (K2 / 6.0) / (1.0 - K2 / 3.0))
    return LENGTH * K2 / 3.0


def bar_mesh(cells: int, side: float) -> Mesh:
    """A column of `cells` hex8 along x from 0 to LENGTH, square section of `side` [m]; facet sets `root`, `tip`."""
    x = np.linspace(0.0, LENGTH, cells + 1)
    half = 0.5 * side
    points = np.array([[a, y, z] for a in x for y in (-half, half) for z in (-half, half)])
    first = 4 * np.arange(cells)[:, None]
    hexes = first + np.array([0, 4, 6, 2, 1, 5, 7, 3])
    tip = 4 * cells + np.array([[0, 2, 3, 1]])
    sets = {"root": FacetSet({"quad4": np.array([[0, 1, 3, 2]])}), "tip": FacetSet({"quad4": tip})}
    return Mesh(points, {"hex8": hexes}, sets, name="bar")


def bar(
    cells: int = 30,
    side: float = THICK,
    *,
    terms: int | None = 6,
    max_frequency: float | None = None,
    stiffening: bool = False,
) -> ReducedBody:
    """The bar, reduced with the attachment modes of both ends and either `terms` Legendre polynomials of the axial
    displacement or the free-free modes up to `max_frequency` [Hz]."""  # fmt: skip
    mesh = bar_mesh(cells, side)
    basis: Any = "free_free"
    if terms is not None:
        x = 2.0 * mesh.points[:, 0] / LENGTH - 1.0
        fields = np.zeros((len(x), 3, terms))
        fields[:, 0] = np.polynomial.legendre.legvander(x, terms)[:, 1:]
        basis = bases.POD(snapshots=fields)
    return reduce(
        mesh, ALUMINIUM, interfaces={"root": "rigid", "tip": "rigid"}, basis=basis, max_frequency=max_frequency,
        options=ReductionOptions(inertia_modes=ALL, stiffening=stiffening), cache=False, progress=False,
    )  # fmt: skip


def axial_motion(body: ReducedBody, name: str) -> Array:
    """Axial displacement (m,) [m] of an interface per modal coordinate."""
    return np.asarray(body.interfaces[name].modes)[:, 0]


def elongation(body: ReducedBody, q: Array) -> Array:
    """Elongation [m] of modal coordinates (..., m)."""
    return np.asarray(q) @ (axial_motion(body, "tip") - axial_motion(body, "root"))


@dataclass(frozen=True, eq=False)
class Stationary:
    """Stationary state of the reduced model: modal coordinates `q` (m,), and whether it is `stable`."""

    q: Array
    stable: bool


def stationary(body: ReducedBody, level: str, *, stiffening: bool = False) -> Stationary:
    """The state of steady rotation, by Newton's method on the module's V."""
    terms: Any = body.inertia_terms
    J1, J2, _ = (part[..., 2, 2] if i < 2 else part for i, part in enumerate(terms.kept(level)))
    m, p, c = body.mass, axial_motion(body, "root"), body.center_of_mass[0]
    modes, square = len(p), SPEED**2
    K = np.diag((2.0 * np.pi * body.frequencies) ** 2)
    Kf = np.zeros((modes, modes))
    if stiffening:
        K = K + square * terms.stiffening.centrifugal[2]
        Kf = terms.stiffening.interfaces["root"][0]
    q, tangent = np.zeros(modes), K
    for _ in range(CORRECTIONS):
        s, slope = c - p @ q + 0.5 * q @ Kf @ q, Kf @ q - p
        force = square * (0.5 * J1 + J2 @ q + m * s * slope) - K @ q
        tangent = K - square * (J2 + m * np.outer(slope, slope) + m * s * Kf)
        q = q + np.linalg.solve(tangent, force)
    return Stationary(q, bool(np.linalg.eigvalsh(tangent)[0] > 0.0))


def bar_scene(body: ReducedBody, level: str, *, stiffening: bool = False, speed: float = SPEED) -> Scene:
    """The bar on a hinge at x = 0 about z, driven from rest to `speed` [rad/s] within SPIN_UP."""
    scene = Scene()
    handle = scene.add_body(body, name="bar", inertia=level, stiffening=stiffening, damping=DAMPING)
    hinge = scene.add(joints.Revolute(scene.ground, handle["root"], axis=(0, 0, 1), name="hinge"))
    scene.add(joints.Drive(hinge, signals.SmoothStep(0.0, speed, duration=SPIN_UP), quantity="velocity"))
    return scene


def spun_up(body: ReducedBody, level: str, step: float, *, stiffening: bool = False) -> History:
    """The bar from rest until it has settled, in steps of `step` [s]."""
    scene = bar_scene(body, level, stiffening=stiffening)
    return run(scene, SPIN_UP + SETTLING, step=step, save_every=10, progress=False)


def settled(start: History, step: float) -> History:
    """Continues from `start` until the bar has settled in steps of another size `step` [s]."""
    return run(start.scene, SETTLING, step=step, start=start, save_every=10, progress=False)


def settled_sequence(body: ReducedBody, level: str, steps: Sequence[float]) -> Array:
    """Elongation (n,) [m] in the rotating frame for each of `steps` [s]."""
    history, found = spun_up(body, level, steps[0]), []
    for step in steps:
        history = settled(history, step)
        found.append(elongation(body, history.bodies["bar"].modal[-1]))
    return np.array(found)
