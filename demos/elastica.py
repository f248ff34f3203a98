r"""A cantilever bent far by a force across its tip: the elastica, in one body and in several in a row.

A slender beam is clamped at one end; at the other a force grows that keeps its direction, to P L^2/EI = 4. Then the tip
has moved by 0.67 L across and 0.33 L back to the root, and has turned by 65 degrees. The closed form is that of K. E.
Bisshopp and D. C. Drucker (`tests/references/closed_forms/large_deflections.py`).

What to expect. The frame of a body takes turns of any size, modes take what is left between its ends. With
`stiffening` deflections shorten the body, to second order in the modes: a beam whose fibres do not stretch moves its
ends towards each other by the integral of w'^2/2, and what pulls at the ends works on that. What is left out is of
third order, the turn of an end, asin w' and not w', and of fourth order in the energy. Both go with the square of the
angle by which ends turn from the body's mean axes. A beam cut in n bodies has 1/n of that angle in each, and n-th parts
of the deflections that it makes wrong, so that

    error of the deflection ~ (angle of an end)^4 ~ n^-4        at a given load,
    error over the deflection ~ (P L^2/EI)^2                    of one body, while deflections are small.

One body is off by 0.5 % at P L^2/EI = 1, two by less than a tenth of that, and four are enough for all of the curve.
Without `stiffening` bodies do not shorten: one alone turns its tip about the root on a circle. What is not in the
closed form, stretch and shear, is EI/(EA L^2) = 1e-5 of the length.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import Elastica
from warpffrf.output.plots.panels import COLORS, Panel

log = logging.getLogger("warpffrf")

Array = np.ndarray
LENGTH, WIDTH, HEIGHT = 1.0, 0.03, 0.01  # m
STEEL = wf.Material(
    youngs_modulus=210e9,
    poisson_ratio=0.0,  # the closed form knows no lateral strain, which rigid ends would hinder
    density=7850,
    name="steel that keeps its width",
)
BENDING = STEEL.youngs_modulus * WIDTH * HEIGHT**3 / 12.0  # N m2
LARGEST, PARTS = 4.0, 4  # P L^2/EI, bodies of the whole curve
ONE_BODY = 1.0  # P L^2/EI up to which one body is shown
SHOWN = (0.5, 1.0, 2.0, 4.0)  # P L^2/EI of the shapes drawn
ROOT = 1e-10  # of the length: joints hold to round-off of the largest forces
ACROSS, BACK = 1e-3, 1e-2  # of the tip of four bodies
ALONE, TWO = 6e-3, 1e-3  # of the tip across, one and two bodies, at ONE_BODY
ORDER = 0.15  # of the order 4 of the error in the number of bodies: two bodies are not many
WORK = 1e-3  # of the work of the force: that of straight lines between load steps


@dataclass(frozen=True)
class Size:
    """Quadratic cells along the whole beam, load steps to `LARGEST`, frames of the recording."""

    cells: int = 96
    steps: int = 64
    frames: int = 65


FULL, QUICK = Size(), Size(cells=48, steps=32, frames=33)


def build(
    size: Size = FULL, *, parts: int = PARTS, load: float = LARGEST, stiffening: bool = True, progress: bool = True
) -> wf.Scene:
    """The scene: bodies `part_1` to `part_n` in a row along +x from the root at the origin, each with the interfaces
    `x_min` and `x_max`, a force along +z at the tip that grows to `load` P L^2/EI, in a second a load step."""
    mesh = wf.mesh.box((LENGTH / parts, WIDTH, HEIGHT), (size.cells // parts, 1, 1))
    beam = wf.reduce(
        mesh, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=10, stiffening=True, progress=progress
    )
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    port: Any = scene.ground
    for i in range(parts):
        place = ((i + 0.5) * LENGTH / parts, 0.0, 0.0)
        body = scene.add_body(beam, name=f"part_{i + 1}", position=place, stiffening=stiffening)
        scene.add(wf.joints.Fixed(port, body["x_min"], name="root" if i == 0 else f"weld_{i}"))
        scene.add(wf.sensors.Position(body["x_min"], name=f"end_{i}"))
        port = body["x_max"]
    steps = load_steps(size, load)
    grows = wf.signals.Table([0.0, float(steps)], [0.0, load * BENDING / LENGTH**2])
    scene.add(wf.forces.PointForce(port, (0.0, 0.0, grows), name="force"))
    scene.add(wf.sensors.Position(port, name=f"end_{parts}"))
    return scene


def load_steps(size: Size, load: float) -> int:
    """Load steps to `load`: all are alike."""
    return round(size.steps * load / LARGEST)


@dataclass(frozen=True, eq=False)
class Bent:
    """A run: `load` (T,) P L^2/EI of its load steps, its `result`, and the number of bodies."""

    result: wf.Result
    load: Array
    parts: int

    @property
    def ends(self) -> Array:
        """Places (T, bodies + 1, 3) [m] of the ends of all bodies, from the root to the tip."""
        return np.stack([self.result.sensor(f"end_{i}").values for i in range(self.parts + 1)], axis=1)

    @property
    def across(self) -> Array:
        """w/L (T,) of the tip."""
        return self.ends[:, -1, 2] / LENGTH

    @property
    def back(self) -> Array:
        """u/L (T,) of the tip, towards the root."""
        return 1.0 - self.ends[:, -1, 0] / LENGTH

    def at(self, load: float) -> int:
        """The load step of a load. Loads that are not among those of the run are not asked for."""
        return int(np.argmin(np.abs(self.load - load)))

    def error(self, load: float) -> float:
        """Of w at a load, over w of the closed form."""
        return float(self.across[self.at(load)] / Elastica(load).deflection - 1.0)


def run(
    size: Size = FULL, *, parts: int = PARTS, load: float = LARGEST, stiffening: bool = True, progress: bool = True
) -> Bent:
    """All load steps of a scene of `build`."""
    scene = build(size, parts=parts, load=load, stiffening=stiffening, progress=progress)
    steps = load_steps(size, load)
    result = wf.simulate(scene, float(steps), step=1.0, kind="static", progress=progress)
    return Bent(result, load * result.time / steps, parts)


def shape(load: float, points: int = 101) -> Array:
    """Places (points, 2) x, z over L of the elastica from the root, by its differential equation from the tip."""
    from scipy.integrate import solve_ivp

    def rates(_s: float, y: Array) -> list[float]:
        return [y[1], -load * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

    start = [Elastica(load).tip_angle, 0.0, 0.0, 0.0]
    found = solve_ivp(rates, (0.0, -1.0), start, t_eval=-np.linspace(0.0, 1.0, points), rtol=1e-9, atol=1e-12).y
    return (found[2:] - found[2:, -1:])[:, ::-1].T


def checks(four: Bent, two: Bent, one: Bent) -> list[Check]:
    """The figures of the runs."""
    found, form = [], "elastica"
    for load in SHOWN:
        i, exact = four.at(load), Elastica(load)
        found.append(Check(f"4 bodies, PL2/EI = {load:g}: w/L", float(four.across[i]), exact.deflection, form, ACROSS))
        found.append(Check(f"4 bodies, PL2/EI = {load:g}: u/L", float(four.back[i]), exact.shortening, form, BACK))
    exact = Elastica(ONE_BODY)
    for bent, name, bound in ((two, "2 bodies", TWO), (one, "1 body", ALONE)):
        w = float(bent.across[bent.at(ONE_BODY)])
        found.append(Check(f"{name}, PL2/EI = {ONE_BODY:g}: w/L", w, exact.deflection, form, bound))
    order = float(np.log2(one.error(ONE_BODY) / two.error(ONE_BODY)))
    root = float(np.abs(four.ends[:, 0]).max())
    energy = four.result.energy
    found += [
        Check("order of the error in the number of bodies", order, 4.0, "module", ORDER),
        Check("the root is away from its place by", root, 0.0, "held, over L", ROOT, "m", scale=LENGTH),
        Check("work of the force", float(energy["force_work"][-1]), float(energy["strain"][-1]), "strain energy",
              WORK, "J"),
    ]  # fmt: skip
    return found


@dataclass(frozen=True, eq=False)
class Shapes:
    """The bent beam at some loads: ends of the bodies and the closed form."""

    bent: Bent

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        for n, load in enumerate(SHOWN):
            curve, ends = shape(load), self.bent.ends[self.bent.at(load)] / LENGTH
            ax.plot(curve[:, 0], curve[:, 1], lw=1.2, color=COLORS[n], label=f"elastica, {load:g}")
            ax.plot(ends[:, 0], ends[:, 2], ls="none", marker="o", ms=5, mfc="none", color=COLORS[n])
        ax.set(xlabel="x/L [-]", ylabel="z/L [-]", aspect="equal")
        ax.set_title("Shapes by PL²/EI; circles: ends of the bodies", fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        ax.legend(frameon=False, fontsize=8)


@dataclass(frozen=True, eq=False)
class Errors:
    """Error of the deflection over the load, both logarithmic, of several runs by name."""

    runs: dict[str, Bent]

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        for n, (name, bent) in enumerate(self.runs.items()):
            error = [abs(bent.error(load)) for load in bent.load[1:]]
            ax.loglog(bent.load[1:], error, lw=1.4, color=COLORS[n], label=name)
        ax.set(xlabel="PL²/EI [-]", ylabel="of w [-]", ylim=(1e-6, 1.0))
        ax.set_title("How far the tip is off", fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        ax.legend(frameon=False, fontsize=8, loc="upper left")


def panels(runs: dict[str, Bent]) -> Sequence[Any]:
    """Tip against load; shapes; errors. The first of `runs` is the one drawn whole."""
    four = next(iter(runs.values()))
    loads = np.linspace(0.0, LARGEST, 81)[1:]
    w, u = (np.array([getattr(Elastica(p), what) for p in loads]) for what in ("deflection", "shortening"))
    tips = {f"{name}, w/L": (bent.load, bent.across) for name, bent in list(runs.items())[1:]}
    marked = slice(None, None, max(1, len(four.load) // 16))
    return [
        Panel("Tip of the cantilever", "PL²/EI [-]", "[-]", tips, {"elastica, w/L": (loads, w), "u/L": (loads, u)},
              limits=(0.0, 0.8),
              points={"4 bodies, w/L": (four.load[marked], four.across[marked]),
                      "4 bodies, u/L": (four.load[marked], four.back[marked])}),
        Shapes(four),
        Errors(runs),
    ]  # fmt: skip


def main(out: str | Path = "out/elastica", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write elastica.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells, fewer load steps. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("elastica: a cantilever in four bodies, two and one, each in load steps")
    four = run(size, progress=progress)
    two = run(size, parts=2, progress=progress)
    one = run(size, parts=1, load=ONE_BODY, progress=progress)
    linear = run(size, parts=1, load=ONE_BODY, stiffening=False, progress=progress)
    runs = {"4 bodies": four, "2 bodies": two, "1 body": one, "1 body without stiffening": linear}
    for name, bent in runs.items():
        if bent.result.status != "completed":
            log.error("the run of %s ended early, %s: %s", name, bent.result.status, bent.result.message)
            return 1
    return finish(folder / "elastica", {"bent": four.result}, checks(four, two, one), panels(runs), frames=size.frames)
