r"""A pin in a bore of nearly its own radius: conformal contact beside Persson's solution.

A slice of a pin of radius R lies in a sleeve with a bore of radius R + dR and is pressed down by a force in its middle
that rises and waits at several loads. They are those that give, by Persson, patches that reach 10, 30 and 60 degrees to
both sides. Two runs, with dR/R = 1e-3 and 1e-2.

What to expect: Hertz's line contact holds for small patches only; at 60 degrees his half-width is half as large again.
Persson's solution (A. Persson, Dissertation, Chalmers, 1964; M. Ciavarella and P. Decuzzi, Int. J. Solids Structures
38, 2001, 4507) holds for all, in an infinite plate. Its derivation is in
`tests/references/closed_forms/conformal.py`. It does not depend on Poisson's ratio, which is zero here: then
nothing moves along the axis, plane stress and plane strain are one, pressures are the same over the whole width, and
the slice may be as thick as its stability asks for.

Which it does ask for: the pin stands on its rim and is held at its hub. Tilted by psi, its load P acts R psi beside the
hub and tilts it on. What holds it is the bending stiffness of the slice. It grows with the cube of the width, P
with the width. A slice of 0.5 mm tips from about 40 degrees on in the wider bore (`eigenmodes` has a pair of real
eigenvalues there), and at 60 degrees no step converges; one of 5 mm stands at all of these loads.

The sleeve's outside is ten times as large as the bore and held, which makes pressures 0.2 % too high; the gap of
Persson is linear in dR/R, which at 1e-2 leaves 0.6 % (docs/studies/pin_in_bore.md).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import ConformalPin, LineContact, conformal_by_half_angle, contact_modulus

log = logging.getLogger("warpffrf")

MATERIAL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800, name="steel that keeps its width")
RADIUS, HOLE, OUTSIDE, WIDTH = 0.01, 5e-4, 0.1, 5e-3  # m: pin, its hole, sleeve, both along the axis
CLOSE, WIDE = 1e-3, 1e-2  # clearances, of the radius
ANGLES = {CLOSE: (10.0, 30.0, 60.0), WIDE: (10.0, 30.0, 60.0)}  # degrees, half of the patch
RISE, WAIT, STEP = 0.02, 0.01, 1e-3  # s: slow beside the pin on its contact, tens of kHz
RHO_INF = 0.0  # no ringing is wanted
MARGIN = 1.3  # room for hats, over those in the largest patch
PAIR, GUIDE = "pin-bore", "guide"
PEAK, ARC = 0.02, 0.03  # of the peak pressure and of the half-angle


@dataclass(frozen=True)
class Size:
    """Quadratic cells around, and how many frames the recording shows at most."""

    sectors: int = 192  # eleven nodes in 10 degrees
    layers: int = 10
    frames: int = 100


FULL, QUICK = Size(), Size(frames=20)


def states(clearance: float) -> list[ConformalPin]:
    """Persson's states that the run at `clearance` of the radius waits in."""
    return [
        conformal_by_half_angle(np.radians(angle), RADIUS, clearance * RADIUS, MATERIAL, MATERIAL)
        for angle in ANGLES[clearance]
    ]


def waits(clearance: float) -> np.ndarray:
    """Until when the loads wait (n,) [s]."""
    return (RISE + WAIT) * np.arange(1, len(ANGLES[clearance]) + 1)


def press(clearance: float) -> wf.signals.Table:
    """The force over time [N]."""
    loads = [WIDTH * state.load for state in states(clearance)]
    times = np.concatenate([[0.0], np.ravel([(end - WAIT, end) for end in waits(clearance)])])
    return wf.signals.Table(times, np.concatenate([loads[:1], np.repeat(loads, 2)]), hold=True)


def build(clearance: float = CLOSE, size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene at `clearance` of the radius: bodies `pin`, `sleeve`, joint `guide`, contact pair `pin-bore`."""
    around = {"sectors": size.sectors, "layers": size.layers, "axial": 1}
    pin = wf.reduce(
        wf.mesh.roller(RADIUS, HOLE, WIDTH, **around), MATERIAL, interfaces={"bore": "rigid"},
        contact={"rim": wf.surfaces.Cylinder()}, modes=0, progress=progress,
    )  # fmt: skip
    sleeve = wf.reduce(
        wf.mesh.sleeve(RADIUS * (1.0 + clearance), OUTSIDE, WIDTH, **around), MATERIAL, interfaces={"outside": "rigid"},
        contact={"bore": wf.surfaces.Bore()}, modes=0, progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    inner = scene.add_body(pin, name="pin", position=(0, 0, -clearance * RADIUS))
    outer = scene.add_body(sleeve, name="sleeve")
    nodes = 2.0 * np.radians(max(ANGLES[clearance])) / (np.pi / size.sectors) * inner["rim"].surface.grid.rows
    scene.add(wf.Contact(inner["rim"], outer["bore"], capacity=int(MARGIN * nodes), name=PAIR))
    scene.add(wf.joints.Fixed(scene.ground, outer["outside"], name="held"))
    scene.add(wf.joints.Prismatic(scene.ground, inner["bore"], axis=(0, 0, 1), name=GUIDE))
    scene.add(wf.forces.PointForce(inner["bore"], (press(clearance), (0, 0, -1)), name="press"))
    return scene


def run(scene: wf.Scene, clearance: float, *, progress: bool = True) -> wf.Result:
    """All loads of `clearance`, from the static state under the first."""
    integrator = wf.GeneralizedAlpha(RHO_INF)
    end = float(waits(clearance)[-1])
    return wf.simulate(scene, end, step=STEP, start="equilibrium", integrator=integrator, progress=progress)


def pressure_around(result: wf.Result, i: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Angle from the line of centres (columns,) [rad] and pressure, mean over the width (columns,) [Pa], of the saved
    step `i`; and twice the root of its second moment [rad]."""
    pair = result.contact(PAIR)
    z = pair.z
    share = np.gradient(z) * np.where(np.isin(np.arange(len(z)), (0, len(z) - 1)), 0.5, 1.0)  # trapezoids along z
    share /= share.sum()
    angle = pair.arc[i] / RADIUS
    p, raw = pair.mean_pressure[i] @ share, pair.history.pressure[i] @ share
    pitch = pair.spacing / RADIUS
    center = (raw @ angle) / raw.sum()
    second = raw @ ((angle - center) ** 2 + pitch**2 / 6.0) / raw.sum()  # hats, see `output.contact.result`
    return angle, p, 2.0 * float(np.sqrt(second))


def settled(result: wf.Result, clearance: float) -> list[tuple[int, float, ConformalPin]]:
    """The saved steps at the ends of the waits, the half-angle [deg] that they should have, and Persson's state."""
    rows = [int(np.argmin(np.abs(result.time - end))) for end in waits(clearance)]
    return list(zip(rows, ANGLES[clearance], states(clearance), strict=True))


def checks(results: dict[float, wf.Result]) -> list[Check]:
    """The figures of the runs, clearance -> result."""
    found = []
    for clearance, result in results.items():
        for i, angle, exact in settled(result, clearance):
            _, p, half = pressure_around(result, i)
            label = f"{angle:.0f} deg, clearance {clearance:g}"
            force = float(result.contact(PAIR).force[i, 2])
            found += [
                Check(f"{label}: force", force, WIDTH * exact.load, "statics", 1e-6, "N"),
                Check(f"{label}: peak", float(p.max()), exact.peak_pressure, "Persson", PEAK, "MPa", 1e-6),
                Check(f"{label}: half-angle", half, exact.moment_angle, "Persson, of the second moment", ARC, "deg",
                      float(np.degrees(1.0))),
            ]  # fmt: skip
    return found


def panels(results: dict[float, wf.Result]) -> list:
    """Pressure at the loads beside Persson and Hertz."""
    from warpffrf.output.plots.panels import Panel

    drawn = []
    for clearance, result in results.items():
        for i, _, exact in settled(result, clearance):
            reach = 1.4 * exact.half_angle
            theta, p, _ = pressure_around(result, i)
            near = np.abs(theta) < reach
            line = LineContact(exact.load, RADIUS * (1.0 + 1.0 / clearance), contact_modulus(MATERIAL, MATERIAL))
            fine = np.linspace(-reach, reach, 201)
            drawn.append(
                Panel(f"Pressure at {exact.load * WIDTH:.3g} N, clearance {clearance:g} R", "angle [deg]", "[MPa]",
                      {"run": (np.degrees(theta[near]), p[near] / 1e6)},
                      {"Persson": (np.degrees(fine), exact.pressure(fine) / 1e6),
                       "Hertz": (np.degrees(fine), line.pressure(RADIUS * fine) / 1e6)})
            )  # fmt: skip
    return drawn


def main(out: str | Path = "out/pin_in_bore", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write pin_in_bore.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    The second clearance is in pin_in_bore.wide.h5. quick: fewer frames. Raises `InputError` for a folder that cannot be
    written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    results: dict[float, wf.Result] = {}
    for clearance, angles in ANGLES.items():
        log.info("pin in bore: clearance %g of the radius, %d loads", clearance, len(angles))
        scene = build(clearance, size, progress=progress)
        result = results[clearance] = run(scene, clearance, progress=progress)
        if result.status != "completed":
            log.error("the run ended early, %s: %s", result.status, result.message)
            return 1
    named = {"close": results[CLOSE], "wide": results[WIDE]}
    return finish(folder / "pin_in_bore", named, checks(results), panels(results), frames=size.frames)
