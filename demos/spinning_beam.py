r"""A slender beam spun up about one end: why geometric stiffening matters.

A beam of length L hangs with one end in a hub that is driven smoothly from rest to omega_s within 15 s (T. R. Kane,
R. R. Ryan and A. K. Banerjee, J. Guidance 10, 1987, 139; the beam and the speed are those of J. C. Simo and L. Vu-Quoc,
J. Appl. Mech. 54, 1987: EA = 2.8e7 N, EI = 1.4e4 N m2, rho A = 1.2 kg/m, L = 10 m, omega_s = 6 rad/s). The final
speed is above the first natural frequency of the beam at rest, 3.8 rad/s.

What to expect. The tip lags behind the hub while the speed rises and comes back to it. In the frame of the hub the
deflection w(x, t) in the plane follows

    rho A (w'' - omega^2 w) + E I w_xxxx - (N w_x)_x = -rho A alpha x,      N = rho A omega^2 (L^2 - x^2)/2,

clamped at the hub. The tension N keeps the beam straight. Its term is of second order in the displacements, so linear
modes know nothing of it: without `stiffening` the tip lags a fifth too far behind. (It would be torn aside altogether
if the frame of reference stood on the hub; the floating frame takes the mean rotation up.) The demo runs both.

The equation is solved by itself, with polynomials in x that fulfil the clamping (Galerkin) and SciPy in time. At the
final speed the beam is longer, by the exact solution of a bar that stretches in its own centrifugal field,

    u(L) = tan(k L)/k - L,      k = omega sqrt(rho/E).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder

log = logging.getLogger("warpffrf")

LENGTH, LINE_MASS = 10.0, 1.2  # m, kg/m
AXIAL_STIFFNESS, BENDING_STIFFNESS = 2.8e7, 1.4e4  # N, N m2
SIDE = float(np.sqrt(12.0 * BENDING_STIFFNESS / AXIAL_STIFFNESS))  # m, of the square section with this EI/EA
MATERIAL = wf.Material(
    youngs_modulus=AXIAL_STIFFNESS / SIDE**2,
    poisson_ratio=0.0,  # the closed form knows no lateral strain, which the rigid hub would hinder
    density=LINE_MASS / SIDE**2,
    name="beam",
)
SPEED, SPIN_UP = 6.0, 15.0  # rad/s, s
STEP = 5e-3  # s: 50 steps to a period of the second bending mode
RHO_INF = 0.9
POLYNOMIALS, MODES_OF_REFERENCE = 8, 3  # x^2 to x^9, and the natural modes of the clamped beam made of them
# The beam equation is linear in w/L, of which the square is 3e-3; the axial modes kept miss 3e-4 of the elongation.
LAG, ELONGATION = 0.01, 1e-3


@dataclass(frozen=True)
class Size:
    """Cells along the beam, time at the final speed [s], frames of the recording."""

    cells: int = 20
    at_speed: float = 5.0
    frames: int = 300


FULL, QUICK = Size(), Size(cells=10, at_speed=2.0, frames=60)


def build(size: Size = FULL, *, inertia: str = "full", stiffening: bool = True, progress: bool = True) -> wf.Scene:
    """The scene at rest, the beam along +x from the hub at the origin, the hub's axis along +z.

    Body `beam` with the rigid interface `hub`; joint `hub`. inertia, stiffening: as in `Scene.add_body`.
    """
    mesh = wf.mesh.box((LENGTH, SIDE, SIDE), (size.cells, 1, 1), center=(0.5 * LENGTH, 0, 0), name="beam")
    mesh = mesh.select_plane("hub", point=(0, 0, 0), normal=(1, 0, 0))
    beam = wf.reduce(
        mesh, MATERIAL, interfaces={"hub": "rigid"}, modes=44, stiffening=True, cache=False, progress=progress
    )
    scene = wf.Scene()
    body = scene.add_body(beam, name="beam", damping=0.0, inertia=inertia, stiffening=stiffening)
    hub = scene.add(wf.joints.Revolute(scene.ground, body["hub"], axis=(0, 0, 1), name="hub"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP)
    scene.add(wf.joints.Drive(hub, spin, quantity="velocity"))
    return scene


def hub_motion(t: Any) -> tuple[Any, Any, Any]:
    """Angle [rad], speed [rad/s] and angular acceleration [rad/s2] of the hub at times t [s]."""
    x = np.clip(np.asarray(t, float) / SPIN_UP, 0.0, 1.0)
    angle = SPEED * SPIN_UP * x**4 * (2.5 - 3.0 * x + x**2) + SPEED * np.maximum(np.asarray(t, float) - SPIN_UP, 0.0)
    return angle, SPEED * x**3 * (10.0 - 15.0 * x + 6.0 * x**2), SPEED / SPIN_UP * 30.0 * (x * (1.0 - x)) ** 2


def beam_tip(t: np.ndarray, *, tension: bool = True) -> np.ndarray:
    """Deflection of the tip (T,) [m] in the plane, in the hub's frame, by the equation of the module."""
    from scipy.integrate import solve_ivp
    from scipy.linalg import eigh

    xi, weights = np.polynomial.legendre.leggauss(POLYNOMIALS + 4)  # exact for products with (L^2 - x^2)
    x, weights = 0.5 * (xi + 1.0), 0.5 * weights  # of the length
    p = np.arange(2, 2 + POLYNOMIALS, dtype=float)[:, None]
    shape, slope, bend = x**p, p * x ** (p - 1.0), p * (p - 1.0) * x ** (p - 2.0)

    def integral(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return (a * weights) @ b.T

    M = LINE_MASS * LENGTH * integral(shape, shape)
    K = BENDING_STIFFNESS / LENGTH**3 * integral(bend, bend)
    K_N = 0.5 * LINE_MASS * LENGTH * integral(slope * (1.0 - x**2), slope) * float(tension)  # times omega^2
    F = LINE_MASS * LENGTH**2 * (shape * weights) @ x  # times -alpha
    modes = eigh(K, M)[1][:, :MODES_OF_REFERENCE]
    K, K_N, F = modes.T @ K @ modes, modes.T @ K_N @ modes, modes.T @ F

    def rates(time: float, y: np.ndarray) -> np.ndarray:
        w, v = np.split(y, 2)
        _, omega, alpha = hub_motion(time)
        return np.concatenate([v, -K @ w - omega**2 * (K_N @ w - w) - alpha * F])

    start = np.zeros(2 * MODES_OF_REFERENCE)
    found = solve_ivp(rates, (0.0, t[-1]), start, t_eval=t, rtol=1e-7, atol=1e-9, method="DOP853")
    return modes.sum(axis=0) @ found.y[:MODES_OF_REFERENCE]


def tip_in_hub_frame(scene: wf.Scene, result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Tip of the beam's axis: elongation in the frame of the beam, deflection in that of the drive, each (T,) [m]."""
    from warpffrf.output.geometry.places import rotate

    skin = result.skins()["beam"]
    end = np.flatnonzero(np.abs(skin.points[:, 0] - LENGTH) < 1e-9 * LENGTH)
    motion = result.body("beam")
    reduced: Any = scene.body("beam").reduced
    shape = reduced.surface.modes[:, end].mean(axis=1)
    u = motion.modal @ shape
    elongation = motion.modal @ (shape[:, 0] - reduced.interfaces["hub"].modes[:, 0])
    local = skin.points[end].mean(axis=0) + u
    tip = np.stack([x + rotate(p, y[None])[0] for x, p, y in zip(motion.position, motion.rotation, local, strict=True)])
    angle, _, _ = hub_motion(result.time)
    c, s = np.cos(angle), np.sin(angle)
    return elongation, -s * tip[:, 0] + c * tip[:, 1]


def run(size: Size, *, stiffening: bool, progress: bool = True) -> tuple[wf.Scene, wf.Result]:
    """The scene and its run, with or without geometric stiffening."""
    scene = build(size, stiffening=stiffening, progress=progress)
    integrator = wf.GeneralizedAlpha(RHO_INF)
    return scene, wf.simulate(scene, SPIN_UP + size.at_speed, step=STEP, integrator=integrator, progress=progress)


def checks(t: np.ndarray, elongation: np.ndarray, deflection: np.ndarray, beam: np.ndarray) -> list[Check]:
    """The figures of the stiffened beam; elongation, deflection (T,) m of its tip, and that of the beam equation."""
    k = SPEED * np.sqrt(LINE_MASS / AXIAL_STIFFNESS)
    lag = float(-beam.min())
    return [
        Check("largest lag of the tip", float(-deflection.min()), lag, "beam equation", LAG, "m"),
        Check("largest difference of the deflection", float(np.abs(deflection - beam).max()), 0.0,
              "beam equation, over the lag", LAG, "m", scale=lag),
        Check("elongation at the final speed", float(elongation[t > SPIN_UP].mean()),
              float(np.tan(k * LENGTH) / k - LENGTH), "tan(kL)/k - L", ELONGATION, "mm", 1e3),
    ]  # fmt: skip


def main(out: str | Path = "out/spinning_beam", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write spinning_beam.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: a coarser beam and less time at the final speed. Raises `InputError` for a folder that cannot be written.
    """
    from warpffrf.output.plots.panels import Panel

    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("spinning beam: with geometric stiffening, then without")
    scene, result = run(size, stiffening=True, progress=progress)
    bare_scene, bare = run(size, stiffening=False, progress=progress)
    u, w = tip_in_hub_frame(scene, result)
    _, w_bare = tip_in_hub_frame(bare_scene, bare)
    t = result.time
    beam, omega = beam_tip(t), hub_motion(t)[1]
    shown = (1.3 * float(w.min()), -1.3 * float(w.min()))
    panels = [
        Panel("Speed of the hub", "time [s]", "[rad/s]", {"hub": (t, omega)}),
        Panel("Deflection of the tip in the plane", "time [s]", "[m]",
              {"with stiffening": (t, w), "without": (bare.time, w_bare)}, {"beam equation": (t, beam)}, shown),
        Panel("Elongation", "time [s]", "[mm]", {"computed": (t, u * 1e3)},
              {"tan(kL)/k - L, k of the speed at the time": (t, _stretch(omega) * 1e3)}),
    ]  # fmt: skip
    return finish(folder / "spinning_beam", {"stiffened": result}, checks(t, u, w, beam), panels, frames=size.frames)


def _stretch(omega: np.ndarray) -> np.ndarray:
    k = np.maximum(omega, 1e-9) * np.sqrt(LINE_MASS / AXIAL_STIFFNESS)
    return np.tan(k * LENGTH) / k - LENGTH
