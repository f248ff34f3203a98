r"""A disc rotating about its axis (case D2): an annulus in plane stress under its own centrifugal load.

Radii b <= r <= a, angular velocity w, free edges (Timoshenko and Goodier, Theory of Elasticity, 1970, art. 32):

    sigma_r = (3 + nu)/8 rho w^2 (a^2 + b^2 - a^2 b^2/r^2 - r^2),
    sigma_t = rho w^2/8 ((3 + nu)(a^2 + b^2 + a^2 b^2/r^2) - (1 + 3 nu) r^2),       u = r (sigma_t - nu sigma_r)/E;

for b -> 0, at r = a: u = (1 - nu) rho w^2 a^3/(4 E). Thickness t changes the stress by order (t/a)^2, the load on the
deformed disc by order w^2 over the square of its lowest radial frequency: here both 1e-4.

The body's modes span radial fields r, 1/r, r^2, r^3, r^5 and the contraction of the thickness that goes with them:
attachment modes require interfaces, and free-free modes of an axisymmetric shape are few and far apart. No inertia
level but "constant" omits the centrifugal load; "constant" leaves the disc undeformed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, bases, reduce
from warpffrf.online import run
from warpffrf.output.result import Result

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7800.0, name="steel")
OUTER, INNER, THICKNESS = 0.1, 0.02, 0.002  # m
SPEED = 1000.0  # rad/s
PLACES = np.array([0.025, 0.04, 0.06, 0.08, 0.095])  # m, radii at which stress is evaluated
DURATION, STEP = 1e-3, 1e-5  # s: fifteen periods of the lowest mode, which is damped critically


def closed_form(r: Array, speed: float) -> tuple[Array, Array, Array]:
    """Radial displacement [m], radial and hoop stress [Pa] at the radii `r` [m] for `speed` [rad/s]."""
    a, b, nu = OUTER**2, INNER**2, STEEL.poisson_ratio
    load = STEEL.density * speed**2 / 8.0
    sigma_r = (3.0 + nu) * load * (a + b - a * b / r**2 - r**2)
    sigma_t = load * ((3.0 + nu) * (a + b + a * b / r**2) - (1.0 + 3.0 * nu) * r**2)
    return r * (sigma_t - nu * sigma_r) / STEEL.youngs_modulus, sigma_r, sigma_t


def disc(sectors: int = 24, layers: int = 8) -> ReducedBody:
    """The annulus about y, of curved quadratic cells, with the modes of the module and stress points "wall"."""
    mesh = roller(OUTER, INNER, THICKNESS, sectors=sectors, layers=layers, axial=1, grading=1.0, order=2)
    x = mesh.points
    r = np.hypot(x[:, 0], x[:, 2])
    s = r / OUTER
    out, along = np.stack([x[:, 0] / r, 0.0 * r, x[:, 2] / r], axis=1), np.outer(x[:, 1] / OUTER, (0.0, 1.0, 0.0))
    fields = [out * f[:, None] for f in (s, 1.0 / s, s**2, s**3, s**5)]
    fields += [along * f[:, None] for f in (s**0, s, s**2, s**4)]
    points = np.outer(PLACES, (1.0, 0.0, 0.0))
    return reduce(
        mesh, STEEL, basis=bases.POD(snapshots=np.stack(fields, axis=2)), stress={"wall": points},
        options=ReductionOptions(periodic=False), cache=False, progress=False,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Spin:
    """A disc that has settled: relative errors of the displacement at bore and rim, of the radial and the hoop stress
    at PLACES (over the largest hoop stress); radial displacement of the rim [m]; the run."""

    bore: float
    rim: float
    radial_stress: Array
    hoop_stress: Array
    grown: float
    result: Result


def spin(body: ReducedBody, level: str) -> Spin:
    """The free disc, started undeformed at SPEED; the closed form is evaluated at the final speed, which is lower due
    to the expansion of the disc."""
    scene = Scene()
    scene.add_body(body, name="disc", inertia=level, damping=1.0, angular_velocity=(0.0, SPEED, 0.0))
    history = run(scene, DURATION, step=STEP, progress=False)
    motion = history.bodies["disc"]
    u = np.tensordot(motion.modal[-1], body.surface.modes, 1)
    x = body.surface.points
    r = np.hypot(x[:, 0], x[:, 2])
    radial = (u[:, 0] * x[:, 0] + u[:, 2] * x[:, 2]) / r
    speed = float(np.linalg.norm(motion.angular_velocity[-1]))
    found = [float(radial[np.isclose(r, edge)].mean()) for edge in (INNER, OUTER)]
    exact, _, hoop = closed_form(np.array([INNER, OUTER]), speed)
    result = Result(history)
    tensor = result.stress("disc", "wall").tensor[-1]
    _, sigma_r, sigma_t = closed_form(PLACES, speed)
    return Spin(
        found[0] / exact[0] - 1.0,
        found[1] / exact[1] - 1.0,
        (tensor[:, 0] - sigma_r) / hoop[0],
        (tensor[:, 2] - sigma_t) / hoop[0],
        found[1],
        result,
    )
