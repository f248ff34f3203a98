r"""A pin in a bore of nearly its own radius: conformal contact and Persson's solution.

A slice of a pin of radius R lies in a sleeve with a bore of radius R + dR, dR/R = 1e-3, and is pressed down by a force
in its middle that rises to and is held at three loads. By Persson's solution they give patches that reach 10, 30 and 60
degrees to both sides.

What to expect: Hertz's line contact holds for small patches only; at 60 degrees his half-width is half as large again.
Persson's solution (A. Persson, Dissertation, Chalmers, 1964; M. Ciavarella and P. Decuzzi, Int. J. Solids Structures
38, 2001, 4507) holds for all, in an infinite plate. It does not depend on Poisson's ratio, which is zero here: then
plane stress and plane strain are one, and pressures are the same over the whole width.

The slice must be thick enough: the pin is supported at its rim and held at its hub. Tilted by psi, its load P acts at
R psi from the hub and tilts it further; the bending stiffness of the slice, in proportion to the cube of the width,
resists. A slice of 0.5 mm tips at 40 degrees in a bore with dR/R = 1e-2; one of 5 mm is stable at all of these loads.

The sleeve's outside is ten times as large as the bore and held; pressures are 0.2 % too high for this reason.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

MATERIAL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800, name="steel that keeps its width")
RADIUS, HOLE, OUTSIDE, WIDTH = 0.01, 5e-4, 0.1, 5e-3  # m: pin, its hole, sleeve, both along the axis
CLEARANCE = 1e-3  # of the radius
ANGLES = (10.0, 30.0, 60.0)  # deg, half of the patch
LOADS = (25.5410510e6, 264.365772e6, 1967.76162e6)  # N/m over dR/R: Persson's
PEAKS = (9.35199985e9, 33.3177182e9, 140.049812e9)  # Pa over dR/R: Persson's
RISE, WAIT, STEP = 0.02, 0.01, 1e-3  # s: slow compared with the pin on its contact, tens of kHz
RHO_INF = 0.0  # for a quasi-static motion
PAIR, GUIDE = "pin-bore", "guide"


@dataclass(frozen=True)
class Size:
    """Quadratic cells around and through the wall."""

    sectors: int = 192  # eleven nodes in 10 degrees
    layers: int = 10


FULL = Size()


def waits(count: int = len(ANGLES)) -> np.ndarray:
    """The times at which the loads cease to be constant (n,) [s]."""
    return (RISE + WAIT) * np.arange(1, count + 1)


def press(clearance: float, loads: tuple[float, ...]) -> wf.signals.Table:
    """The force over time [N]."""
    forces = WIDTH * clearance * np.array(loads)
    times = np.concatenate([[0.0], np.ravel([(end - WAIT, end) for end in waits(len(loads))])])
    return wf.signals.Table(times, np.concatenate([forces[:1], np.repeat(forces, 2)]), hold=True)


def build(
    clearance: float = CLEARANCE, size: Size = FULL, *, loads: tuple[float, ...] = LOADS, largest: float = ANGLES[-1],
    progress: bool = True,
) -> wf.Scene:  # fmt: skip
    """The scene at `clearance` of the radius: bodies `pin`, `sleeve`, joint `guide`, contact `pin-bore`; the `loads`
    [N/m over dR/R], of which the last gives half a patch of `largest` [deg]."""
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
    nodes = 2.0 * np.radians(largest) / (np.pi / size.sectors) * inner["rim"].surface.grid.rows
    scene.add(wf.Contact(inner["rim"], outer["bore"], capacity=int(1.3 * nodes), name=PAIR))
    scene.add(wf.joints.Fixed(scene.ground, outer["outside"], name="held"))
    scene.add(wf.joints.Prismatic(scene.ground, inner["bore"], axis=(0, 0, 1), name=GUIDE))
    scene.add(wf.forces.PointForce(inner["bore"], (press(clearance, loads), (0, 0, -1)), name="press"))
    return scene


def run(scene: wf.Scene, *, progress: bool = True) -> wf.Result:
    """All loads, from the static state under the first."""
    integrator, end = wf.integrators.GeneralizedAlpha(RHO_INF), float(waits()[-1])
    return wf.simulate(
        scene, end, step=STEP, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=progress
    )


def main(out: str | Path = "out/pin_in_bore", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write pin_in_bore.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer frames."""
    stem = Path(out) / "pin_in_bore"
    result = run(build(progress=progress), progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=20 if quick else 100, overwrite=True)

    contact, drawn = result.contact(PAIR), []
    modulus, relative = 0.5 * MATERIAL.youngs_modulus, RADIUS * (1.0 + 1.0 / CLEARANCE)
    for angle, end, load, persson in zip(ANGLES, waits(), LOADS, PEAKS, strict=True):
        i = int(np.argmin(np.abs(result.time - end)))
        line = CLEARANCE * load  # N/m
        a = np.sqrt(4.0 * line * relative / (np.pi * modulus))
        peak, theta = contact.mean_pressure[i].max(), np.linspace(-1.4, 1.4, 201) * np.radians(angle)
        hertz = 2.0 * line / (np.pi * a) * np.sqrt(np.maximum(1.0 - (RADIUS * theta / a) ** 2, 0.0))
        near = np.abs(contact.arc[i]) < 1.4 * np.radians(angle) * RADIUS
        drawn.append(
            Panel(f"Pressure at {line * WIDTH:.4g} N", "angle [deg]", "[MPa]",
                  {"run": (np.degrees(contact.arc[i][near] / RADIUS), contact.mid_pressure[i][near] / 1e6)},
                  {"Hertz": (np.degrees(theta), hertz / 1e6)},
                  points={"Persson": (np.zeros(1), np.array([persson * CLEARANCE / 1e6]))})
        )  # fmt: skip
        print(f"{angle:.0f} deg, {line * WIDTH:8.2f} N: peak {peak / 1e6:8.3f} MPa, "
              f"Persson {persson * CLEARANCE / 1e6:8.3f}, Hertz {hertz.max() / 1e6:8.3f}")  # fmt: skip
    save_panels(drawn, f"{stem}.png", overwrite=True)
    return [result]


if __name__ == "__main__":
    main()
