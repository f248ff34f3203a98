r"""A slider-crank with a flexible connecting rod: rigid kinematics, bent rod.

A crank of radius r is driven smoothly up to a constant speed Omega; a slender steel rod of length l drives a piston in
a straight liner. Everything turns in the plane x-z; there is no gravity.

What to expect. The piston follows the rigid kinematics

    x = r cos(theta) + sqrt(l^2 - r^2 sin(theta)^2),

up to the little that the rod stretches. The rod bends because its own mass is thrown to and fro. A material point at s
from the big end of a straight rod has the transverse acceleration a(s), linear in s between a_0 at the crank pin and
a_l at the piston; pinned at both ends, the rod has the modes sin(n pi s/l), and with w = sum w_n(t) sin(n pi s/l)

    w_n'' + (omega_n^2 - phi'^2 + S_n) w_n = -2/(n pi) (a_0 - (-1)^n a_l),

phi' the angular velocity of the rod. omega_n are the frequencies of a pinned beam with rotary inertia and shear
(S. Timoshenko, Vibration Problems in Engineering, 1937, section 54; k = n pi/l, kappa of G. R. Cowper, J. Appl. Mech.
33, 1966, 335),

    omega_n^2 = E I k^4 / (rho A (1 + k^2 I/A (1 + E/(kappa G)))),

and what the axial force N(s) in the rod adds is S_n = (2/(rho A l)) int N (n pi/l)^2 cos(n pi s/l)^2 ds. N(s) pushes
the piston and the part of the rod between s and the piston. The equations of the modes are coupled by N a little; that
is left out, and so is what the bending does to a(s). The deflection at midspan, w_1 - w_3, is integrated by
itself (SciPy) and held against that of the simulated rod over the last turn (A. C. Chu and B. D. Pan,
Dynamic response of a high-speed slider-crank mechanism with an elastic connecting rod, J. Eng. Ind. 97, 1975, 542).
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

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
CRANK, ROD, SECTION = 0.15, 0.5, 0.02  # m: radius, length, side of the rod's square section
CRANK_MASS, CRANK_INERTIA = 2.0, (0.0006, 0.004, 0.004)  # kg, kg m2: a bar of 150 x 55 x 20 mm or so
PISTON_MASS, PISTON_INERTIA = 0.4, (0.0003, 0.0003, 0.0003)
SPEED, SPIN_UP = 50.0 * np.pi, 0.1  # rad/s (1500 turns a minute, 0.04 s each), s
STEP = 1e-4  # s: 54 steps to a period of the rod's first bending mode
RHO_INF = 0.9
MODES_OF_REFERENCE = (1, 3)  # the even ones have a node at midspan, the fifth answers with 3e-4 of the first
DEFLECTION = 0.006  # of its amplitude: the beam equation leaves out coupling of the modes and feedback on a(s)
STRETCH = 5e-4  # of the crank radius: piston and rod pull 3 kN out of a rod of 84 MN, 3e-5 of its length


@dataclass(frozen=True)
class Size:
    """Cells along the rod, turns after the spin-up, frames of the recording."""

    cells: int = 20
    turns: int = 3
    frames: int = 300


FULL, QUICK = Size(), Size(cells=10, turns=1, frames=60)


def rod_body(size: Size = FULL, *, progress: bool = True) -> wf.ReducedBody:
    """The reduced rod along x about the origin, with rigid interfaces `big_end` (x < 0) and `small_end` at its ends."""
    mesh = wf.mesh.box((ROD, SECTION, SECTION), (size.cells, 1, 1), name="rod")
    for name, x in (("big_end", -0.5 * ROD), ("small_end", 0.5 * ROD)):
        mesh = mesh.select_plane(name, point=(x, 0, 0), normal=(1, 0, 0))
    return wf.reduce(
        mesh, STEEL, interfaces={"big_end": "rigid", "small_end": "rigid"}, modes=6, stiffening=True, cache=False,
        progress=progress,
    )  # fmt: skip


def build(size: Size = FULL, *, inertia: str = "full", stiffening: bool = True, progress: bool = True) -> wf.Scene:
    """The scene, starting at rest with the piston farthest from the axle.

    Bodies `crank`, `rod`, `piston`; joints `axle`, `big_end`, `wrist`, `liner`. inertia, stiffening: of the rod, as in
    `Scene.add_body`.
    """
    return machine(rod_body(size, progress=progress), inertia=inertia, stiffening=stiffening)


def machine(reduced: wf.ReducedBody, *, inertia: str = "full", stiffening: bool = True) -> wf.Scene:
    """The scene of `build` around a rod that is reduced already."""
    scene = wf.Scene()
    crank = scene.add_rigid_body(CRANK_MASS, CRANK_INERTIA, name="crank", position=(0.5 * CRANK, 0, 0))
    rod = scene.add_body(
        reduced, name="rod", position=(CRANK + 0.5 * ROD, 0, 0), damping=0.0,
        inertia=inertia, stiffening=stiffening,
    )  # fmt: skip
    piston = scene.add_rigid_body(PISTON_MASS, PISTON_INERTIA, name="piston", position=(CRANK + ROD, 0, 0))
    pin = crank.at((0.5 * CRANK, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, crank.at((-0.5 * CRANK, 0, 0)), axis=(0, -1, 0), name="axle"))
    scene.add(wf.joints.Revolute(pin, rod["big_end"], axis=(0, -1, 0), name="big_end"))
    scene.add(wf.joints.Spherical(rod["small_end"], piston.at((0, 0, 0)), name="wrist"))
    scene.add(wf.joints.Prismatic(scene.ground, piston.at((0, 0, 0)), axis=(1, 0, 0), name="liner"))
    scene.add(wf.joints.Drive(axle, spin(), quantity="velocity"))
    return scene


def spin() -> wf.signals.SmoothStep:
    """Speed of the crank [rad/s]."""
    return wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP)


def duration(size: Size) -> float:
    """Length of the run [s]."""
    return SPIN_UP + size.turns * 2.0 * np.pi / SPEED


@dataclass(frozen=True)
class Kinematics:
    """The rigid mechanism at times t (T,): crank angle and rates, angle of the rod (from +x, about -y), piston."""

    theta: np.ndarray
    rod_rate: np.ndarray
    piston: np.ndarray
    piston_acceleration: np.ndarray
    pin_across: np.ndarray  # (T,) m/s2, acceleration of the crank pin across the rod
    piston_across: np.ndarray  # (T,) m/s2, of the piston
    pin_along: np.ndarray  # (T,) m/s2, of the crank pin along the rod


def kinematics(t: np.ndarray) -> Kinematics:
    """Rigid motion under the drive: with (c, s) of the crank and (C, S) of the rod, r s + l S = 0."""
    # the quintic's integral and derivative in closed form
    x = np.clip(t / SPIN_UP, 0.0, 1.0)
    omega = SPEED * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    alpha = SPEED / SPIN_UP * 30.0 * x**2 * (1.0 - x) ** 2
    theta = SPEED * SPIN_UP * x**4 * (2.5 - 3.0 * x + x**2) + SPEED * np.maximum(t - SPIN_UP, 0.0)
    c, s = np.cos(theta), np.sin(theta)
    S = -CRANK / ROD * s
    C = np.sqrt(1.0 - S**2)
    phi_1 = -CRANK / ROD * c * omega / C  # of r s + l S = 0, differentiated once and twice
    phi_2 = (-CRANK / ROD * (c * alpha - s * omega**2) + S * phi_1**2) / C
    pin = CRANK * np.array([-s * alpha - c * omega**2, c * alpha - s * omega**2])  # x, z
    piston = pin[0] + ROD * (-S * phi_2 - C * phi_1**2)
    return Kinematics(
        theta, phi_1, CRANK * c + ROD * C, piston,
        pin_across=-S * pin[0] + C * pin[1], piston_across=-S * piston, pin_along=C * pin[0] + S * pin[1],
    )  # fmt: skip


def beam_deflection(t: np.ndarray, *, inertia_terms: bool = True, axial_force: bool = True) -> np.ndarray:
    """Deflection at midspan (T,) [m], towards +z of a rod that points along +x, by the equations of the module."""
    from scipy.integrate import solve_ivp

    E, G, rho = STEEL.youngs_modulus, STEEL.youngs_modulus / (2.0 * (1.0 + STEEL.poisson_ratio)), STEEL.density
    A, I_A = SECTION**2, SECTION**2 / 12.0
    kappa = 10.0 * (1.0 + STEEL.poisson_ratio) / (12.0 + 11.0 * STEEL.poisson_ratio)
    n = np.array(MODES_OF_REFERENCE, dtype=float)
    k = n * np.pi / ROD
    stiffness = E * I_A * k**4 / (rho * (1.0 + k**2 * I_A * (1.0 + E / (kappa * G))))  # omega_n^2
    s = np.linspace(0.0, ROD, 41)
    shape = 2.0 / (rho * A * ROD) * (k[:, None] * np.cos(k[:, None] * s)) ** 2

    def rates(time: float, y: np.ndarray) -> np.ndarray:
        m = kinematics(np.array(time))
        w, v = np.split(y, 2)
        added = np.zeros(len(n))
        if inertia_terms:
            added = added - m.rod_rate**2
        if axial_force:
            added = added + np.trapezoid(shape * _axial_force(m, s, rho * A), s, axis=1)
        return np.concatenate([v, -2.0 / (n * np.pi) * (m.pin_across + m.piston_across) - (stiffness + added) * w])

    found = solve_ivp(rates, (t[0], t[-1]), np.zeros(2 * len(n)), t_eval=t, rtol=1e-7, atol=1e-10, method="DOP853")
    return np.sin(0.5 * n * np.pi) @ found.y[: len(n)]


def _axial_force(m: Kinematics, s: np.ndarray, line_mass: float) -> np.ndarray:
    """Tension N(s) [N] of the rigid rod: N(l) cos(phi) pulls the piston as the transverse force on it allows.

    Along the rod the point at s has a_0 - phi'^2 s. At the piston end the transverse force V follows from the moments
    about the crank pin, V l = -int rho A a(s) s ds, and the piston from N cos(phi) - V sin(phi) = -m a_p.
    """
    S = -CRANK / ROD * np.sin(m.theta)
    C = np.sqrt(1.0 - S**2)
    V = -line_mass * ROD * (m.pin_across / 6.0 + m.piston_across / 3.0)  # of the rod on the piston
    end = (-PISTON_MASS * m.piston_acceleration - V * S) / C
    along = m.pin_along * (ROD - s) - 0.5 * m.rod_rate**2 * (ROD**2 - s**2)  # int_s^l (a_0 - phi'^2 s) ds
    return end - line_mass * along


def midspan(scene: wf.Scene, result: wf.Result) -> np.ndarray:
    """Deflection (T,) [m] of the rod's middle from the line between its pins, along the rod's z axis."""
    body: Any = scene.body("rod").reduced
    skin = body.surface
    middle = np.abs(skin.points[:, 0]) < 1e-6 * ROD
    ends = [body.interfaces[name].modes[:, 2] for name in ("big_end", "small_end")]
    return result.body("rod").modal @ (skin.modes[:, middle, 2].mean(axis=1) - 0.5 * (ends[0] + ends[1]))


def run(size: Size, *, inertia: str, stiffening: bool, progress: bool = True) -> tuple[wf.Scene, wf.Result]:
    """The scene and its run with one level of the rod's inertia."""
    scene = build(size, inertia=inertia, stiffening=stiffening, progress=progress)
    integrator = wf.GeneralizedAlpha(RHO_INF)
    return scene, wf.simulate(scene, duration(size), step=STEP, integrator=integrator, progress=progress)


def checks(result: wf.Result, deflection: np.ndarray, reference: np.ndarray, label: str) -> list[Check]:
    """The figures of one run over the last turn; deflection, reference: (T,) m of its rod and of the beam equation."""
    last = result.time > result.time[-1] - 2.0 * np.pi / SPEED
    amplitude = float(np.abs(reference[last]).max())
    apart = float(np.abs(deflection - reference)[last].max())
    piston = np.abs(result.body("piston").position[:, 0] - kinematics(result.time).piston).max()
    return [
        Check(f"midspan deflection, {label}", float(np.abs(deflection[last]).max()), amplitude, "beam equation",
              DEFLECTION, "mm", 1e3),
        Check(f"its largest difference, {label}", apart, 0.0, "beam equation, over the amplitude", DEFLECTION, "mm",
              1e3, scale=amplitude),
        Check(f"piston, largest difference, {label}", float(piston), 0.0, "rigid kinematics, over the crank radius",
              STRETCH, "mm", 1e3, scale=CRANK),
    ]  # fmt: skip


def main(out: str | Path = "out/slider_crank", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write slider_crank.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    The rod is run with all inertia terms and geometric stiffening, and with constant inertia. quick: a coarser rod and
    one turn at speed. Raises `InputError` for a folder that cannot be written.
    """
    from warpffrf.output.plots.panels import Panel

    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("slider-crank: rod with all inertia terms and stiffening, then with constant inertia")
    scene, full = run(size, inertia="full", stiffening=True, progress=progress)
    plain_scene, plain = run(size, inertia="constant", stiffening=False, progress=progress)
    t = full.time
    bent, bent_plain = midspan(scene, full), midspan(plain_scene, plain)
    beam, beam_plain = beam_deflection(t), beam_deflection(t, inertia_terms=False, axial_force=False)
    found = checks(full, bent, beam, "all terms") + checks(plain, bent_plain, beam_plain, "constant")
    ms, x = t * 1e3, full.body("piston").position[:, 0]
    panels = [
        Panel("Piston", "time [ms]", "x [m]", {"computed": (ms, x)}, {"rigid kinematics": (ms, kinematics(t).piston)}),
        Panel("Rod: deflection at midspan, all inertia terms", "time [ms]", "[mm]", {"computed": (ms, bent * 1e3)},
              {"beam equation": (ms, beam * 1e3)}),
        Panel("What the inertia terms and the axial force change", "time [ms]", "all terms less constant [mm]",
              {"computed": (ms, (bent - bent_plain) * 1e3)}, {"beam equation": (ms, (beam - beam_plain) * 1e3)}),
    ]  # fmt: skip
    results = {"all_terms": full, "constant": plain}
    return finish(folder / "slider_crank", results, found, panels, frames=size.frames)
