r"""A shallow arch that snaps through: by displacement along all of its path, by load with a jump there and one back.

An arch clamped at both ends, 2.5 times as high as thick, is pushed down at its crown. As it flattens, its thrust grows
and takes the stiffness away: at a limit load the tangent of the path F(w) is horizontal. Beyond it less and less force
is in balance with the arch, until it hangs down like a chain and stiffens. The path falls between two limit points,

    F(w):   rises to F_1 at w_1,   falls to F_2 at w_2,   rises from there on.

*By displacement*, with the crown on a rod whose length is prescribed, each w has one equilibrium, and load steps walk
along the whole path, the falling branch too. *By load* nothing is near F_1 once it is reached: the arch jumps to the
rising branch, where it is F_1 again, and swings there until damping has stopped it. As the load goes down it stays on
that branch as far as F_2 and jumps back. The run in time has a load that rises and falls slowly, so that it follows the
equilibria between the jumps, and takes in a cycle what the path leaves on both sides of the jumps,

    int (F_1 - F) dw  from w_1 to where it lands   +   int (F - F_2) dw  from where it lands to w_2.

It jumps a little late: where the tangent is horizontal nothing is fast, and the load goes on meanwhile, by as much as
goes with the power 2/3 of its rate, if damping is what makes it slow. The work of a cycle is late as well.

One flexible body with `stiffening` is all of it: what snaps is the thrust, a load of the ends, times the second-order
motion of ends and crown. The same mesh in full finite elements of St. Venant-Kirchhoff's material has the path beside
it (`tests/references/large_deflections`), by displacement of its own. What differs is of higher order in the
angles by which the arch turns from its mean axes, 0.1 before the jump and 0.2 after it.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import by_displacement
from warpffrf.output.plots.panels import COLORS, Panel

log = logging.getLogger("warpffrf")

Array = np.ndarray
SPAN, WIDTH, THICKNESS, RISE = 1.0, 0.03, 0.01, 0.025  # m
PATCH = 0.05  # m, half the length that the load is spread over
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
MODES, DAMPING = 40, 0.1
FARTHEST = 0.038  # m, of the crown, where the load is that of the jump again
LARGEST = 3000.0  # N, of the load that goes up and down: a fifth above the limit load
STEP = 5e-4  # s: 20 to a period of the first mode of the arch
MIDDLE = 0.02  # m of the crown: where it jumps, between the limit points
LIMIT, LOWER, PATH = 2e-3, 5e-3, 0.025  # of both limit loads, of the path over the upper one: at its end, 0.2 rad
LANDS, BEFORE = 5e-3, 5e-3  # of the crown behind the jump and before it, at the same load
LATE, SLOW = 0.012, 8.0  # of the limit loads: how late a load that grows for 8 s is, see the module
WORK = 5.0 * LATE  # of the work of a cycle: jumps that are late
TAKEN = 0.03  # of it: what the integrator takes in the place of damping


@dataclass(frozen=True)
class Size:
    """Quadratic cells along the arch (a multiple of 20), load steps of the path, seconds in which the load grows and
    falls, frames of the recording."""

    cells: int = 20
    steps: int = 38
    seconds: float = 8.0
    frames: int = 320


FULL, QUICK = Size(), Size(steps=19, seconds=2.0, frames=40)


def mesh(size: Size = FULL) -> wf.mesh.Mesh:
    """The arch along x, a parabola, with the facet sets `x_min`, `x_max` and `crown` on its upper side."""
    bar = wf.mesh.box((SPAN, WIDTH, THICKNESS), (size.cells, 1, 1), name="arch")
    height = RISE * (1.0 - (2.0 * bar.points[:, 0] / SPAN) ** 2)
    arch = replace(bar, points=bar.points + height[:, None] * np.array([0.0, 0.0, 1.0]))
    return arch.select("crown", "z_max", lambda x: np.abs(x[:, 0]) < PATCH)


def clamped(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene without a load: body `arch` with the interfaces `x_min`, `x_max`, `crown`, the ends held; sensor
    `crown`."""
    arch = wf.reduce(
        mesh(size), STEEL, interfaces={"x_min": "rigid", "x_max": "rigid", "crown": "average"}, modes=MODES,
        inertia_modes=MODES, stiffening=True, progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(arch, name="arch", damping=DAMPING, stiffening=True)
    for end in ("x_min", "x_max"):
        scene.add(wf.joints.Fixed(scene.ground, body[end], name=f"clamp_{end}"))
    scene.add(wf.sensors.Position(body["crown"], name="crown"))
    return scene


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The arch under a load at its crown that grows to `LARGEST` and falls to zero again."""
    scene = clamped(size, progress=progress)
    push = wf.signals.Table([0.0, size.seconds, 2.0 * size.seconds], [0.0, -LARGEST, 0.0])
    scene.add(wf.forces.PointForce(scene.body("arch")["crown"], (0.0, 0.0, push), name="push"))
    return scene


def driven(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The arch on a rod, joint `rod`, from the ground to its crown, which gets shorter by `FARTHEST`: a second a load
    step."""
    scene = clamped(size, progress=progress)
    crown = scene.body("arch")["crown"]
    foot = crown.point - [0.0, 0.0, SPAN]
    rod = scene.add(wf.joints.Distance(scene.ground.at(foot), crown, name="rod"))
    length = wf.signals.Table([0.0, float(size.steps)], [SPAN, SPAN - FARTHEST])
    scene.add(wf.joints.Drive(rod, length, quantity="position", name="spindle"))
    return scene


def crown_way(result: wf.Result) -> Array:
    """w (T,) [m] of the crown, downwards."""
    z = result.sensor("crown").values[:, 2]
    return z[0] - z


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria of the arch: ways w (n,) [m] of its crown, growing, forces F (n,) [N] down; cubic between."""

    w: Array
    F: Array

    def __call__(self, w: Array | float) -> Array:
        """F at w, or at many."""
        return self._spline(w)

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.w, self.F)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """w_1, w_2 [m] of the two limit points."""
        roots = self._spline.derivative().roots(extrapolate=False)
        bends = self._spline.derivative(2)(roots)
        return float(roots[bends < 0.0][0]), float(roots[bends > 0.0][-1])

    @property
    def loads(self) -> tuple[float, float]:
        """F_1, F_2 [N]."""
        w_1, w_2 = self.limits
        return float(self(w_1)), float(self(w_2))

    def rising(self, force: float, *, behind: bool) -> float:
        """w [m] at a force on the rising branch before the first limit point, or behind the second one."""
        roots = self._spline.solve(force, extrapolate=False)
        w_1, w_2 = self.limits
        return float(roots[roots > w_2][0] if behind else roots[roots < w_1][-1])

    @property
    def work_of_a_cycle(self) -> float:
        """J, what jumps there and back leave (see the module)."""
        (w_1, w_2), (F_1, F_2) = self.limits, self.loads
        there, back = self.rising(F_1, behind=True), self.rising(F_2, behind=False)
        up, down = self._spline.integrate(w_1, there), self._spline.integrate(back, w_2)
        return float(F_1 * (there - w_1) - up + down - F_2 * (w_2 - back))


def path_of(result: wf.Result) -> EquilibriumPath:
    """The path of a run of `driven`."""
    return EquilibriumPath(crown_way(result), -result.joint("rod").force[:, 2])


@dataclass(frozen=True, eq=False)
class FullModel:
    """The arch in full finite elements at w (n,) [m] of the middle of its crown's upper side: displacements u (n + 1,
    nodes, 3) [m], the first at rest, and its path, whose w is the mean over the crown."""

    points: Array
    u: Array
    path: EquilibriumPath


def full_model(size: Size = FULL) -> FullModel:
    """All of the path, by displacement."""
    body = StVenantKirchhoffBody(mesh(size), STEEL)
    load = body.spread("crown", (0.0, 0.0, -1.0))
    middle = 3 * body.nearest_node((0.0, 0.0, RISE + 0.5 * THICKNESS)) + 2
    ways = -FARTHEST * np.arange(1, size.steps + 2) / size.steps
    states = by_displacement(body, body.held("x_min", "x_max"), load, middle, ways)
    w, F = np.array([(0.0, 0.0), *((load @ s.u, s.factor) for s in states)]).T
    u = np.array([np.zeros(body.size), *(s.u for s in states)]).reshape(len(w), -1, 3)
    return FullModel(body.mesh.points, u, EquilibriumPath(w, F))


@dataclass(frozen=True, eq=False)
class Snapped:
    """The run under the load: `result`, way `w` (T,) [m] of the crown and `force` (T,) [N]."""

    result: wf.Result
    seconds: float

    @property
    def w(self) -> Array:
        """(T,) m."""
        return crown_way(self.result)

    @property
    def force(self) -> Array:
        """(T,) N."""
        t = self.result.time
        return LARGEST * np.minimum(t, 2.0 * self.seconds - t) / self.seconds

    @property
    def jumps(self) -> tuple[int, int]:
        """Rows in which the crown first is beyond `MIDDLE`, and above it again for good."""
        beyond = np.flatnonzero(self.w > MIDDLE)
        return int(beyond[0]), int(beyond[-1])

    def way(self, force: float, *, behind: bool) -> float:
        """w [m] at a force: behind the jump as the load comes down, before it as it grows."""
        half = len(self.w) // 2
        w, F = (self.w[half:][::-1], self.force[half:][::-1]) if behind else (self.w[:half], self.force[:half])
        return float(np.interp(force, F, w))


def run(size: Size = FULL, *, progress: bool = True) -> tuple[wf.Result, Snapped]:
    """The load steps by displacement, and the run in time under the load."""
    steps = wf.simulate(driven(size, progress=progress), float(size.steps), step=1.0, kind="static", progress=progress)
    scene = build(size, progress=progress)
    return steps, Snapped(wf.simulate(scene, 2.0 * size.seconds, step=STEP, progress=progress), size.seconds)


def checks(path: EquilibriumPath, snapped: Snapped, exact: EquilibriumPath) -> list[Check]:
    """The figures of both runs beside the path of the full model."""
    (F_1, F_2), fe = exact.loads, "full FE model"
    there, back = snapped.jumps
    first = slice(1, None)
    later = (SLOW / snapped.seconds) ** (2.0 / 3.0)
    off = float(np.abs(path.F - exact(path.w))[first].max())
    energy = snapped.result.energy
    return [
        Check("by displacement: limit load", path.loads[0], F_1, fe, LIMIT, "N"),
        Check("by displacement: its place", path.limits[0], exact.limits[0], fe, LANDS, "mm", 1e3),
        Check("by displacement: lower limit load", path.loads[1], F_2, fe, LOWER, "N"),
        Check("by displacement: place of the lower", path.limits[1], exact.limits[1], fe, LANDS, "mm", 1e3),
        Check("by displacement: force off by at most", off, 0.0, f"{fe}, over the limit load", PATH, "N", scale=F_1),
        Check("by load: crown at 0.97 of the limit", snapped.way(0.97 * F_1, behind=False),
              exact.rising(0.97 * F_1, behind=False), fe, BEFORE, "mm", 1e3),
        Check("by load: snaps through at", float(snapped.force[there]), F_1, f"{fe}, limit load", LATE * later, "N"),
        Check("by load: crown at this load, snapped", snapped.way(F_1, behind=True), exact.rising(F_1, behind=True),
              fe, LANDS, "mm", 1e3),
        Check("by load: snaps back at", float(snapped.force[back]), F_2, f"{fe}, lower limit load", LATE * later,
              "N"),
        Check("by load: comes to rest at", float(snapped.w[-1]), 0.0, "no load, over the rise", 1e-3, "mm", 1e3,
              scale=RISE),
        Check("by load: work that a cycle takes", float(energy["force_work"][-1]), exact.work_of_a_cycle,
              f"{fe}, both jumps", WORK * later, "J"),
        Check("by load: taken by damping", float(energy["damping"][-1]), float(energy["force_work"][-1]),
              "work of the force", TAKEN, "J"),
    ]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Shapes:
    """Upper side of the arch in load steps by displacement beside the full model."""

    steps: wf.Result
    full: FullModel

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        skin = self.steps.skins()["arch"]
        motion = self.steps.body("arch")
        rows = np.linspace(0, len(self.steps.time) - 1, 5).round().astype(int)
        for n, row in enumerate(rows):
            places = skin.points + skin.displacement(row)
            places = _rotated(motion, row, places)
            on = _edge(skin.points)
            w = 1e3 * crown_way(self.steps)[row]
            ax.plot(places[on, 0], 1e3 * places[on, 2], lw=1.4, color=COLORS[n], label=f"w = {w:.3g} mm")
            on = _edge(self.full.points)
            places = self.full.points + self.full.u[row]
            ax.plot(places[on, 0], 1e3 * places[on, 2], ls="none", marker=".", ms=4, color="black")
        ax.set(xlabel="x [m]", ylabel="z [mm]", ylim=(-22.0, 48.0))
        ax.set_title("Upper edge, by displacement; dots: full model", fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        ax.legend(frameon=False, fontsize=8, ncols=3, loc="upper center")


def _edge(points: Array) -> Array:
    """Nodes on the front upper edge, by x."""
    above = points[:, 2] - RISE * (1.0 - (2.0 * points[:, 0] / SPAN) ** 2)
    found = np.flatnonzero((above > 0.49 * THICKNESS) & (points[:, 1] < -0.49 * WIDTH))
    return found[np.argsort(points[found, 0])]


def _rotated(motion: Any, row: int, places: Array) -> Array:
    from warpffrf.output.geometry.places import rotate

    return motion.position[row] + rotate(motion.rotation[row], places)


def panels(steps: wf.Result, snapped: Snapped, full: FullModel) -> Sequence[Any]:
    """Force against the way of the crown; both over time; shapes."""
    path, exact = path_of(steps), full.path
    w = np.linspace(0.0, FARTHEST, 400)
    t = snapped.result.time
    return [
        Panel("Push at the crown", "down [mm]", "[kN]",
              {"by load, in time": (1e3 * snapped.w, 1e-3 * snapped.force)},
              {"full FE model": (1e3 * w, 1e-3 * exact(w))},
              points={"by displacement, at rest": (1e3 * path.w, 1e-3 * path.F)}),
        Panel("By load: crown over time", "time [s]", "down [mm]", {"crown": (t, 1e3 * snapped.w)},
              {"equilibrium, load grows": (_side(snapped, exact, behind=False)),
               "equilibrium, load falls": (_side(snapped, exact, behind=True))}),
        Shapes(steps, full),
    ]  # fmt: skip


def _side(snapped: Snapped, exact: EquilibriumPath, *, behind: bool) -> tuple[Array, Array]:
    """Time [s] and way [mm] of the equilibria before the jump there, and from there to the jump back."""
    F_1, F_2 = exact.loads
    loads = np.linspace(F_2 if behind else 0.0, 0.9999 * (min(LARGEST, float(exact.F[-1])) if behind else F_1), 60)[1:]
    ways = np.array([exact.rising(float(F), behind=behind) for F in loads])
    rise = loads / LARGEST * snapped.seconds
    return (2.0 * snapped.seconds - rise if behind else rise), 1e3 * ways


def main(out: str | Path = "out/snapping_arch", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write snapping_arch.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: fewer load steps, a load that grows faster. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("snapping arch: %d load steps by displacement, then a load that grows and falls", size.steps)
    steps, snapped = run(size, progress=progress)
    for result in (steps, snapped.result):
        if result.status != "completed":
            log.error("the run ended early, %s: %s", result.status, result.message)
            return 1
    full = full_model(size)
    F_1, F_2 = full.path.loads
    log.info("limit loads of the full model: %.0f N, %.0f N", F_1, F_2)
    return finish(
        folder / "snapping_arch", {"snapped": snapped.result, "driven": steps},
        checks(path_of(steps), snapped, full.path), panels(steps, snapped, full), frames=size.frames,
    )  # fmt: skip
