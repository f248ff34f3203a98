r"""Creep curves of two crowned rollers on a mesh far coarser than their contact: along, across, both, with spin.

Two equal rollers, crowned so that their patch is an ellipse, are pressed together and rolled with prescribed creepages:
the lower one turns on a fixed axle, the upper one in a fork which is pressed down and which a drive can turn about the
vertical. Along the upper axle a second drive moves the roller, a third turns it. With the mean rolling speed V, the
longitudinal and lateral creepages xi and eta and the spin phi [rad/m], the patch rolls along +x:

    lower surface       -V (1 - xi/2, 0)
    upper surface       -V (1 + xi/2, eta),    the fork turns by -phi V.

A fork that stands at the angle theta has its roller askew, which alone would be a lateral creepage theta. So the drives
of the upper roller give its surface, along and across itself, the velocity above as seen from there, less that of the
fork where the patch is: with s, by which the roller has moved along its axle, the patch is s/2 off the fork's axis.

What to expect. The scene is that of CONTACT's wheel on a rail (`verification.closed_forms.rolling_tables`) at a
twenty-fifth of its size: relative radii of 25 and 71.08 mm, 170.7 N, like materials, friction 0.33. Forces over mu N
depend on the ratio of the radii and on Poisson's ratio only, so the nine published ones hold here. Half-spaces have no
bodies around them: `half_space.patch_rolling` gives the other curves, with a law of friction of its own on a grid that
shares nothing with the mesh. Small creepages and spins have Kalker's coefficients. The sum of longitudinal and
lateral force is never above mu N; spin makes a lateral force as well, and leaves less for the longitudinal one.

Creepages rise in stairs. On each the material runs `HELD` times through the patch, after which tractions are steady.
Spin changes its sign from stair to stair, so that the fork swings to and fro and stays nearly straight.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import contact_modulus
from references.closed_forms import rolling_tables as published
from references.closed_forms.elliptic import EllipticContact
from references.half_space.patch_rolling import HalfSpaces, PatchRolling, settle
from warpffrf.output.plots.friction import StickSlipMap
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

POISSON, SHEAR, FRICTION = published.EUROSPRINTER_POISSON, published.EUROSPRINTER_SHEAR, published.EUROSPRINTER_FRICTION
STEEL = wf.Material(youngs_modulus=2.0 * SHEAR * (1.0 + POISSON), poisson_ratio=POISSON, density=7850, name="steel")
SCALE = 0.04  # of the wheel on the rail; two equal rollers have twice the relative radii
OUTER_RADIUS, CROWN = (2.0 * SCALE * radius for radius in published.EUROSPRINTER_RADII)  # m
BORE_RADIUS, WIDTH = 0.03, 0.014  # m
SECTORS, LAYERS, AXIAL = 78, 5, 4  # cells of 4 mm
LOAD = published.EUROSPRINTER_LOAD * SCALE**2  # N
HERTZ = EllipticContact(LOAD, 0.5 * OUTER_RADIUS, 0.5 * CROWN, contact_modulus(STEEL, STEEL))
SEMI_ALONG, SEMI_ACROSS = HERTZ.half_axes  # m
SIZE = float(np.sqrt(SEMI_ALONG * SEMI_ACROSS))  # m
SPAN = 1.3  # half-axes of the cells over those of the patch
FORK_MASS, FORK_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
SPEED = 0.5  # m/s
TURN = SPEED / OUTER_RADIUS  # rad/s
CROSSING = 2.0 * SEMI_ALONG / SPEED  # s, in which the material runs through the patch
RISE, HELD = 0.5, 4.0  # crossings: from stair to stair, on each
RHO_INF = 0.5
SAMPLES = 8  # of the drives' tables in a crossing
PASSES = 3  # for the patch's offset, which is small
PAIR = "lower-upper"
CREEPAGES = tuple(xi for xi, _ in published.EUROSPRINTER_FORCES)
SPINS = (0.1, 1.0, 2.0, 4.0, 6.0, 9.0, 13.0, 18.0)  # rad/m
LITTLE = CREEPAGES[0], CREEPAGES[0], SPINS[0]  # at which nearly all sticks, for Kalker's coefficients
WITH_SPIN = 4.0  # rad/m beside longitudinal creepage
TO_AND_FRO = tuple((-1) ** n for n in range(len(CREEPAGES)))  # signs of the spin from stair to stair
CONTACT_ERROR = 0.01  # of mu N: CONTACT's own cells, see `rolling_tables`
HALF_SPACE_ERROR = 0.01  # of mu N: cells here and there
AXES = 0.01  # of the half-axes
BOUND = 1e-6  # of mu N above the bound
BALANCE = 1e-4  # of the load
DISSIPATION = 1e-9  # of the work of friction
MAP = "with_spin", 1.2e-3  # the run and its creepage of which stick and slip are drawn


@dataclass(frozen=True)
class Size:
    """Cells across the patch in both directions, which stairs (every third, say), and frames of the recording.

    columns: cells of the half-spaces in both directions. kalker_error: of forces without slip, by the cells that the
    patch touches at its sides.
    """

    cells: int
    columns: int
    every: int
    frames: int
    kalker_error: float

    @property
    def step(self) -> float:
        """s: the patch advances by one cell."""
        return 2.0 * SPAN * SEMI_ALONG / self.cells / SPEED


FULL, QUICK = Size(21, 17, 1, 200, 0.02), Size(15, 13, 3, 60, 0.04)
Stair = tuple[float, float, float]  # longitudinal and lateral creepage [-], spin [rad/m]


def stairs(size: Size) -> dict[str, list[Stair]]:
    """The stairs of every run; the first is recorded."""
    creepages, spins = CREEPAGES[:: size.every], SPINS[:: size.every]
    half = np.sqrt(0.5)
    return {
        "with_spin": [(c, 0.0, WITH_SPIN * sign) for c, sign in zip(creepages, TO_AND_FRO, strict=False)],
        "longitudinal": [(c, 0.0, 0.0) for c in creepages],
        "lateral": [(0.0, c, 0.0) for c in creepages],
        "both": [(half * c, half * c, 0.0) for c in creepages],
        "spin": [(0.0, 0.0, phi * sign) for phi, sign in zip(spins, TO_AND_FRO, strict=False)],
    }


def ends(run: Sequence[Stair]) -> np.ndarray:
    """Times [s] at which the stairs end."""
    return (RISE + HELD) * CROSSING * np.arange(1, len(run) + 1)


def _integral(rate: np.ndarray, t: np.ndarray) -> np.ndarray:
    """From the first of the times t (n,) on, by trapezoids."""
    return np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t)))


def drives(run: Sequence[Stair]) -> dict[str, wf.signals.Table]:
    """Velocities over time: `axle` and `roller` [rad/s], `slide` [m/s] along the upper axle, `fork` [rad/s]."""
    starts = np.append(0.0, ends(run))
    t = np.linspace(0.0, starts[-1], round(starts[-1] / CROSSING) * SAMPLES + 1)
    values = np.zeros((3, len(t)))
    for start, before, after in zip(starts, ((0.0, 0.0, 0.0), *run), run, strict=False):
        x = np.clip((t - start) / (RISE * CROSSING), 0.0, 1.0)
        values += np.outer(np.subtract(after, before), x * x * (3.0 - 2.0 * x))
    xi, eta, phi = values
    turning = -phi * SPEED
    theta = _integral(turning, t)
    along, offset, aside = np.zeros_like(t), np.zeros_like(t), -SPEED * eta
    for _ in range(PASSES):
        ahead = -SPEED * (1.0 + 0.5 * xi) + turning * offset
        along = aside * np.cos(theta) - ahead * np.sin(theta)
        offset = 0.5 * _integral(along, t)
    around = ahead * np.cos(theta) + aside * np.sin(theta)
    found = {
        "axle": -SPEED * (1.0 - 0.5 * xi) / OUTER_RADIUS,
        "roller": -around / OUTER_RADIUS,
        "slide": along,
        "fork": turning,
    }
    return {name: wf.signals.Table(t, rate, hold=True) for name, rate in found.items()}


def reduced(*, progress: bool = True) -> wf.ReducedBody:
    """One roller, in cells of 4 mm."""
    mesh = wf.mesh.roller(
        OUTER_RADIUS, BORE_RADIUS, WIDTH, sectors=SECTORS, layers=8,
        axial=AXIAL, crown_radius=CROWN, order=2,
    )  # fmt: skip
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.CrownedCylinder(crown_radius=CROWN)},
        modes=0, tangential=True, contact_fixed=True, progress=progress,
    )  # fmt: skip


def build(
    run: Sequence[Stair], size: Size = FULL, *, body: wf.ReducedBody | None = None, progress: bool = True
) -> wf.Scene:
    """The scene with the drives of `run`: bodies `lower`, `upper`, `fork`, contact pair `lower-upper`.

    body: the reduced roller, made here unless given. The press is a force on the fork; there is no gravity.
    """
    roller = reduced(progress=progress) if body is None else body
    rates = drives(run)
    scene = wf.Scene()
    lower = scene.add_body(roller, name="lower", angular_velocity=(0, -TURN, 0))
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS), angular_velocity=(0, TURN, 0))
    contact = scene.add(
        wf.Contact(
            lower["rim"],
            upper["rim"],
            friction=FRICTION,
            grid="contact_fixed",
            cells=(size.cells, size.cells),
            name=PAIR,
        )
    )
    scene.close_gap(contact)
    fork = scene.add_rigid_body(FORK_MASS, FORK_INERTIA, name="fork", position=upper["bore"].world_point())
    head = fork.at((0, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    swivel = scene.add(wf.joints.Cylindrical(scene.ground, head, axis=(0, 0, 1), name="swivel"))
    above = scene.add(wf.joints.Cylindrical(head, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.joints.Drive(axle, rates["axle"]))
    scene.add(wf.joints.Drive(swivel, rates["fork"], coordinate="rotation"))
    scene.add(wf.joints.Drive(above, rates["roller"], coordinate="rotation"))
    scene.add(wf.joints.Drive(above, rates["slide"], coordinate="translation"))
    scene.add(wf.forces.PointForce(head, (0, 0, -LOAD), name="press"))
    return scene


def roll(scene: wf.Scene, run: Sequence[Stair], size: Size, *, progress: bool = True) -> wf.Result:
    """All stairs, from the static state under the press."""
    return wf.simulate(
        scene, float(ends(run)[-1]), step=size.step, start="equilibrium", integrator=wf.GeneralizedAlpha(RHO_INF),
        progress=progress,
    )  # fmt: skip


@dataclass(frozen=True)
class Curve:
    """At the end of each stair: forces (n, 2) over mu N and spin moment (n,) over mu N sqrt(a b), on the upper body, so
    that they have the signs of the creepages."""

    forces: np.ndarray
    moment: np.ndarray

    def minus(self, other: Curve) -> float:
        """Largest difference of a force or moment from another curve's."""
        return float(max(np.abs(self.forces - other.forces).max(), np.abs(self.moment - other.moment).max()))


def rows(result: wf.Result, run: Sequence[Stair]) -> list[int]:
    """The saved steps at the ends of the stairs."""
    return [int(np.flatnonzero(result.time <= end + 1e-9)[-1]) for end in ends(run)]


def curve(result: wf.Result, run: Sequence[Stair]) -> Curve:
    """What a run finds."""
    pair, at = result.contact(PAIR), rows(result, run)
    most = FRICTION * pair.normal_load[at]
    forces, moment = pair.friction.tangential_force[at], pair.friction.spin_moment[at]
    return Curve(-forces / most[:, None], -moment / (most * SIZE))


def of_half_spaces(run: Sequence[Stair], size: Size) -> Curve:
    """The same of two half-spaces, each stair rolled until it is steady."""
    rolling = PatchRolling(HERTZ, FRICTION, (size.columns, size.columns), HalfSpaces(STEEL, STEEL))
    forces, moments = [], []
    for stair in run:
        forces.append(-settle(rolling, 1.0, stair)[-1])
        x, y = rolling.centers.T
        moment = (x * rolling.traction[:, 1] - y * rolling.traction[:, 0]).sum() * rolling.area
        moments.append(-moment / (FRICTION * LOAD * SIZE))
    return Curve(np.array(forces), np.array(moments))


def kalker() -> np.ndarray:
    """C11, C22, C23 at this Poisson's ratio; the patch has a/b = 0.49995."""
    table = np.array(published.KALKER[0.5])
    return np.array([np.polynomial.Polynomial.fit(published.KALKER_POISSON, row, 2)(POISSON) for row in table])


def slopes() -> np.ndarray:
    """(3,) what Kalker's coefficients are multiplied by: force over mu N by creepages [-] and by spin [1/m]."""
    return SHEAR * SEMI_ALONG * SEMI_ACROSS / (FRICTION * LOAD) * np.array([1.0, 1.0, SIZE])


def checks(results: dict[str, wf.Result], exact: dict[str, Curve], size: Size) -> list[Check]:
    """The figures of all runs beside CONTACT, Kalker, half-spaces and Coulomb."""
    runs = stairs(size)
    found = {name: curve(result, runs[name]) for name, result in results.items()}
    pair = results["longitudinal"].contact(PAIR)
    a, b = pair.half_widths[0]
    values = [
        Check("contact force", float(pair.normal_load[-1]), LOAD, "statics", BALANCE, "N"),
        Check("half-axis along the rolling direction", float(a), SEMI_ALONG, "Hertz", AXES, "um", 1e6),
        Check("half-axis across", float(b), SEMI_ACROSS, "Hertz", AXES, "um", 1e6),
    ]
    for (xi, wanted), share in zip(published.EUROSPRINTER_FORCES[:: size.every], found["longitudinal"].forces[:, 0],
                                   strict=True):  # fmt: skip
        values.append(Check(f"Fx/(mu N) at {xi * 1e3:.2g}e-3", share, wanted, "CONTACT", CONTACT_ERROR, scale=1.0))
    little = np.array([found["longitudinal"].forces[0, 0], found["lateral"].forces[0, 1], found["spin"].forces[0, 1]])
    coefficients = little / (slopes() * LITTLE)
    for label, value, wanted in zip(("C11", "C22", "C23"), coefficients, kalker(), strict=True):
        values.append(Check(label, float(value), float(wanted), "Kalker's table", size.kalker_error))
    for name in exact:
        label = f"{name.replace('_', ' ')}, {len(runs[name])} stairs: differs by"
        values.append(Check(label, found[name].minus(exact[name]), 0.0, "half-spaces, over mu N", HALF_SPACE_ERROR,
                            scale=1.0))  # fmt: skip
    largest = max(float(np.nanmax(result.contact(PAIR).friction.traction_coefficient)) for result in results.values())
    gain = max(float(np.diff(result.energy["friction"]).max()) for result in results.values())
    work = max(float(np.ptp(result.energy["friction"])) for result in results.values())
    return [
        *values,
        Check("largest traction coefficient", max(largest, FRICTION), FRICTION, "Coulomb", BOUND),
        Check("largest gain from friction", max(gain, 0.0), 0.0, "takes energy only", DISSIPATION, "J", scale=work),
    ]


def panels(results: dict[str, wf.Result], exact: dict[str, Curve], size: Size) -> list:
    """Forces against creepages and spin beside the others', and a map of the patch."""
    runs = stairs(size)
    found = {name: curve(result, runs[name]) for name, result in results.items()}
    at = {name: np.array(run) for name, run in runs.items()}
    x = at["longitudinal"][:, 0] * 1e3
    steep = kalker() * slopes()

    def line(n: int, top: float) -> tuple[np.ndarray, np.ndarray]:
        """Kalker's, as far as a force of `top`."""
        return np.array([0.0, top / steep[n]]) * (1e3 if n < 2 else 1.0), np.array([0.0, top])

    def panel(title: str, x_label: str, y_label: str, curves: dict, reference: dict, points: dict) -> Panel:
        return Panel(title, x_label, y_label, curves, reference, points=points)

    both, exact_both = found["both"].forces, exact["both"].forces
    phi, way = np.abs(at["spin"][:, 2]), np.sign(at["spin"][:, 2])
    spun, exact_spun = (np.column_stack([c["spin"].forces[:, 1], c["spin"].moment]) * way[:, None]
                        for c in (found, exact))  # fmt: skip
    beside, exact_beside = (c["with_spin"].forces * np.column_stack([np.ones(len(x)), np.sign(at["with_spin"][:, 2])])
                            for c in (found, exact))  # fmt: skip
    published_points = np.array(published.EUROSPRINTER_FORCES)
    name, creepage = MAP
    stair = int(np.argmin(np.abs(at[name][:, 0] - creepage)))
    xi, _, spin = runs[name][stair]
    return [
        panel("Longitudinal creepage", "creepage [1e-3]", "Fx/(mu N)", {"run": (x, found["longitudinal"].forces[:, 0])},
              {"Kalker": line(0, 0.7)}, {"CONTACT": (published_points[:, 0] * 1e3, published_points[:, 1])}),
        panel("Lateral creepage", "creepage [1e-3]", "Fy/(mu N)", {"run": (x, found["lateral"].forces[:, 1])},
              {"Kalker": line(1, 0.7)}, {"half-spaces": (x, exact["lateral"].forces[:, 1])}),
        panel("Both creepages equal", "both together [1e-3]", "over mu N",
              {"both": (x, np.hypot(*both.T)), "Fx": (x, both[:, 0]), "Fy": (x, both[:, 1])}, {},
              {"half-spaces": (np.tile(x, 2), exact_both.T.ravel())}),
        panel("Spin alone", "spin [rad/m]", "over mu N, of Mz over mu N sqrt(ab)",
              {"Fy": (phi, spun[:, 0]), "Mz": (phi, spun[:, 1])}, {"Kalker": line(2, 0.4)},
              {"half-spaces": (np.tile(phi, 2), exact_spun.T.ravel())}),
        panel(f"Longitudinal creepage with a spin of {WITH_SPIN:g} rad/m", "creepage [1e-3]", "over mu N",
              {"Fx": (x, beside[:, 0]), "Fy": (x, beside[:, 1])},
              {"Fx without spin": (x, found["longitudinal"].forces[:, 0])},
              {"half-spaces": (np.tile(x, 2), exact_beside.T.ravel())}),
        StickSlipMap(f"Tractions on the lower roller, creepage {xi * 1e3:g}e-3, spin {spin:g} rad/m", results[name],
            rows(results[name], runs[name])[stair]),
    ]  # fmt: skip


def main(out: str | Path = "out/creep_curves", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo, write creep_curves.h5, .rrd, .png and summary.json into `out`; 0 when all checks passed.

    quick: fewer cells, half of the stairs, fewer frames. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    body, results, exact = reduced(progress=progress), {}, {}
    for name, run in stairs(size).items():
        begin = time.perf_counter()
        results[name] = roll(build(run, size, body=body, progress=progress), run, size, progress=progress)
        if results[name].status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, results[name].status, results[name].message)
            return 1
        taken = time.perf_counter() - begin
        steps = int(results[name].history.counters["steps"])
        log.info("creep curves: %s, %d stairs, %d steps in %.1f s", name.replace("_", " "), len(run), steps, taken)
        if name != "longitudinal":  # which has CONTACT beside it
            exact[name] = of_half_spaces(run, size)
    found, pictures = checks(results, exact, size), panels(results, exact, size)
    return finish(folder / "creep_curves", results, found, pictures, frames=size.frames)
