"""A wheelset of two cones on round rails, and the exact kinematics of its rolling (Klingel 1883, Wickens).

With b half the distance of the contacts, r the rolling radius, kappa = phi/y the roll by a lateral displacement y of
the centre, and lambda = (r_left - r_right)/(2 y), no slip means

    y' (1 + kappa r) = v psi  (lateral),      psi' = -v lambda y/(b r)  (along),

so that y = sin(2 pi x/L) with L = 2 pi sqrt(b r (1 + kappa r)/lambda). kappa, lambda, b and r are those of two lines
(the cones' lower edges) that touch two circles (the rails).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

import warpffrf as wf
from warpffrf.model import rotation as rot

RADIUS, HALF_GAUGE, SLOPE, RAIL = 0.46, 0.75, 0.05, 0.3  # m, m, -, m
DEPTH = 14e-3  # m below the top of the rails, at which the gauge is measured
LOAD, SPEED, START = 100e3, 5.0, 3e-3  # N, m/s, m
RISE, END, STEP = 0.1, 2.5, 1.25e-3  # s: of the load; three quarters of a wave
CELLS = (9, 9)
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.28, density=7850)


def touched(y: float, phi: float, side: int) -> tuple[float, float]:
    """Height of a cone's lower edge above its rail, and the place along it from its middle [m]."""
    c, s = np.cos(phi), np.sin(phi)
    turn = np.array([[c, -s], [s, c]])
    along = turn @ np.array([1.0, side * SLOPE]) / np.hypot(1.0, SLOPE)
    down = np.array([along[1], -along[0]])
    away = np.array([side * HALF_GAUGE, -RADIUS - RAIL]) - turn @ np.array([side * HALF_GAUGE, -RADIUS]) - [y, 0.0]
    return float((away @ down - RAIL) / -down[1]), float(away @ along)


def kinematics(y: float = 1e-4) -> tuple[float, float, float, float]:
    """kappa [1/m], lambda, b, r."""
    phi = float(brentq(lambda phi: touched(y, phi, 1)[0] - touched(y, phi, -1)[0], -0.05, 0.05, xtol=1e-15))  # pyright: ignore[reportArgumentType]
    z = {side: touched(y, phi, side)[1] / np.hypot(1.0, SLOPE) for side in (1, -1)}
    radius = {side: RADIUS - SLOPE * side * z[side] for side in z}
    half = HALF_GAUGE + 0.5 * (z[1] - z[-1])
    return phi / y, (radius[1] - radius[-1]) / (2.0 * y), half, 0.5 * (radius[1] + radius[-1])


def wheelset() -> wf.Scene:
    """Free on two rails, START off the middle, with the load that rises to LOAD."""
    scene, reach = wf.Scene(), 0.35  # rad of the round rails to both sides
    face = np.sqrt(RAIL**2 - (RAIL - DEPTH) ** 2)
    start = RAIL * np.array([np.sin(reach), np.cos(reach)])
    moving = scene.add_wheelset(
        wf.surfaces.Cone(radius=RADIUS, half_angle=-np.arctan(SLOPE)),
        wf.surfaces.Curve.arcs(start, np.pi - reach, [(2.0 * reach * RAIL, RAIL)]), name="wheelset", mass=1200.0,
        inertia_tensor=(700.0, 100.0, 700.0), material=STEEL, track=(-1.0, 1.0 + SPEED * END), speed=SPEED, y=START,
        friction=0.4, cells=CELLS, extent=(-0.05, 0.05), running_circle=HALF_GAUGE, gauge=2.0 * (HALF_GAUGE - face),
        gauge_depth=DEPTH, inclination=0.0, rigid_rails=True,
    )  # fmt: skip
    rising = wf.signals.Table([0.0, RISE], [0.0, -LOAD], hold=True)
    scene.add(wf.forces.PointForce(moving.body["center"], (0, 0, rising)))
    return scene


def rate(a: np.ndarray, b: np.ndarray) -> float:
    """The factor of b closest to a."""
    return float(a @ b) / float(b @ b)


@dataclass(frozen=True)
class Hunting:
    """Rates of a run, once the load has risen: roll over displacement [1/m], lateral speed over yaw [m/s], yaw rate
    over displacement [1/m s]; speed [m/s] and wavelength [m]."""

    result: wf.Result
    roll: float
    drift: float
    steer: float
    speed: float
    wave: float

    @classmethod
    def of(cls, result: wf.Result) -> Hunting:
        motion, loaded = result.history.bodies["wheelset"], result.time > 3.0 * RISE
        t, (x, y) = result.time[loaded], motion.position[loaded, :2].T
        axle = np.array([rot.matrix(q)[:, 1] for q in motion.rotation[loaded]])
        psi, phi, v = -axle[:, 0], axle[:, 2], float(np.mean(np.gradient(x, t)))
        at = [float(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i])) for i in np.flatnonzero(np.diff(y > 0.0))]
        rates = rate(phi, y), rate(np.gradient(y, t), psi), rate(np.gradient(psi, t), y)
        return cls(result, *rates, v, 2.0 * (at[1] - at[0]))


def hunting() -> Hunting:
    """A run of three quarters of a wave."""
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.5))
    return Hunting.of(wf.simulate(wheelset(), END, step=STEP, options=options, progress=False, check=True))


def wavelength() -> float:
    """L [m] of the kinematics."""
    kappa, conicity, b, r = kinematics()
    return 2.0 * np.pi * float(np.sqrt(b * r * (1.0 + kappa * r) / conicity))
