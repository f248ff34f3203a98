r"""A cantilever under a transverse force at its tip with large deflections: the elastica, in one and in several bodies.

A slender beam is clamped at one end; at the other a force grows that keeps its direction, to P L^2/EI = 4. Then the tip
has moved by 0.67 L across and 0.33 L towards the root, and has rotated by 65 degrees (K. E. Bisshopp and D. C. Drucker,
Large deflection of cantilever beams, Q. Appl. Math. 3, 1945, 272).

What to expect. The frame of a body represents large rotations, modes the remaining deformation between its ends. With
`stiffening` deflections shorten the body, to second order in the modes: a beam whose fibres do not stretch moves its
ends towards each other by the integral of w'^2/2. What is neglected is of fourth order in the energy, and grows with
the angle by which ends rotate from the body's mean axes. A beam cut in n bodies has 1/n of that angle in each, so that

    error of the deflection ~ (angle of an end)^4 ~ n^-4        at a given load.

One body has an error of 0.5 % at P L^2/EI = 1, two less than a tenth of that, and four are enough for the whole curve.
Without `stiffening` bodies do not shorten: the tip of one alone moves about the root on a circle.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import COLORS, Panel, save_panels

LENGTH, WIDTH, HEIGHT = 1.0, 0.03, 0.01  # m
STEEL = wf.Material(
    youngs_modulus=210e9,
    poisson_ratio=0.0,  # the closed form has no lateral strain, which rigid ends would hinder
    density=7850,
    name="steel that keeps its width",
)
BENDING = STEEL.youngs_modulus * WIDTH * HEIGHT**3 / 12.0  # N m2
LARGEST, PARTS = 4.0, 4  # P L^2/EI, bodies of the whole curve
ONE_BODY = 1.0  # P L^2/EI up to which one body is run
ELASTICA = {0.5: (0.16214, 0.01592), 1.0: (0.30172, 0.05643), 2.0: (0.49346, 0.16064), 4.0: (0.66996, 0.32894)}
"""P L^2/EI -> deflection and shortening over L, the closed form."""


def build(
    cells: int = 96, *, steps: int = 64, parts: int = PARTS, load: float = LARGEST, stiffening: bool = True,
    progress: bool = True,
) -> wf.Scene:  # fmt: skip
    """The scene: bodies `part_1` to `part_n` in a row along +x from the root at the origin, each with the interfaces
    `x_min` and `x_max`, `cells` quadratic cells in all, and a force along +z at the tip that increases to `load` P
    L^2/EI, a second per load step, of which there are `steps` to `LARGEST`."""
    mesh = wf.mesh.box((LENGTH / parts, WIDTH, HEIGHT), (cells // parts, 1, 1))
    beam = wf.reduce(
        mesh,
        STEEL,
        interfaces={"x_min": "rigid", "x_max": "rigid"},
        modes=10,
        options=wf.ReductionOptions(stiffening=True),
        progress=progress,
    )
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    port: Any = scene.ground
    for i in range(parts):
        place = ((i + 0.5) * LENGTH / parts, 0.0, 0.0)
        body = scene.add_body(beam, name=f"part_{i + 1}", position=place, stiffening=stiffening)
        scene.add(wf.joints.Fixed(port, body["x_min"], name="root" if i == 0 else f"weld_{i}"))
        scene.add(wf.sensors.Position(body["x_min"], name=f"end_{i}"))
        port = body["x_max"]
    grows = wf.signals.Table([0.0, round(steps * load / LARGEST)], [0.0, load * BENDING / LENGTH**2])
    scene.add(wf.forces.PointForce(port, (0.0, 0.0, grows), name="force"))
    scene.add(wf.sensors.Position(port, name=f"end_{parts}"))
    return scene


def run(
    cells: int = 96, *, steps: int = 64, parts: int = PARTS, load: float = LARGEST, stiffening: bool = True,
    progress: bool = True,
) -> wf.Result:  # fmt: skip
    """All load steps of a scene of `build`."""
    scene = build(cells, steps=steps, parts=parts, load=load, stiffening=stiffening, progress=progress)
    return wf.static(scene, float(round(steps * load / LARGEST)), step=1.0, progress=progress)


def ends(result: wf.Result, parts: int) -> np.ndarray:
    """Positions (T, bodies + 1, 3) [m] of the ends of all bodies, from the root to the tip."""
    return np.stack([result.sensor(f"end_{i}").values for i in range(parts + 1)], axis=1)


class Shapes:
    """The ends of the bodies at the loads of `ELASTICA`."""

    def __init__(self, shape: np.ndarray, load: np.ndarray) -> None:
        self.shape, self.load = shape, load

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        for color, load in zip(COLORS, ELASTICA, strict=False):
            x, _, z = self.shape[int(np.argmin(np.abs(self.load - load)))].T / LENGTH
            ax.plot(x, z, marker="o", ms=5, lw=0.8, color=color, label=f"PL²/EI = {load:g}")
        ax.set(xlabel="x/L [-]", ylabel="z/L [-]", aspect="equal")
        ax.set_title("Ends of the bodies", fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        ax.legend(frameon=False, fontsize=8)


def main(out: str | Path = "out/elastica", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write elastica.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells and load
    steps."""
    stem, cells, steps = Path(out) / "elastica", 48 if quick else 96, 32 if quick else 64
    four = run(cells, steps=steps, progress=progress)
    one = run(cells, steps=steps, parts=1, load=ONE_BODY, progress=progress)
    four.save(f"{stem}.h5", overwrite=True)
    wf.record(four, f"{stem}.rrd", overwrite=True)

    shape, alone = ends(four, PARTS), ends(one, 1)
    load, load_alone = LARGEST * four.time / steps, LARGEST * one.time / steps
    tips = {"4 bodies, w/L": (load, shape[:, -1, 2] / LENGTH), "4 bodies, u/L": (load, 1.0 - shape[:, -1, 0] / LENGTH),
            "1 body, w/L": (load_alone, alone[:, -1, 2] / LENGTH)}  # fmt: skip
    known = np.array([(p, *values) for p, values in ELASTICA.items()])
    exact = {"elastica, w/L": (known[:, 0], known[:, 1]), "elastica, u/L": (known[:, 0], known[:, 2])}
    drawn = [Panel("Tip of the cantilever", "PL²/EI [-]", "[-]", tips, points=exact), Shapes(shape, load)]
    save_panels(drawn, f"{stem}.png", overwrite=True)

    for p, (w, u) in ELASTICA.items():
        x, _, z = shape[int(np.argmin(np.abs(load - p))), -1] / LENGTH
        print(f"PL2/EI = {p:3g}, 4 bodies: w/L {z:.5f}, elastica {w:.5f}; u/L {1.0 - x:.5f}, elastica {u:.5f}")
    print(f"PL2/EI =   1, 1 body:   w/L {alone[-1, -1, 2] / LENGTH:.5f}, elastica {ELASTICA[1.0][0]:.5f}")
    return [four, one]


if __name__ == "__main__":
    main()
