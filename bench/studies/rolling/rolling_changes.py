r"""Histories of friction on contact-fixed cells: the rows of `rolling_patches` on Cattaneo and Mindlin, work and
energy, and patches that grow, shrink, part, split and leave an end.

**Cattaneo.** The lower roller is shifted along x to Q = 0.5 mu P and back and forth. Its way is made of that of a patch
that sticks, C Q with the compliance C of a run with much friction, and of what slip adds,

    line    (2/(pi E*)) (Q'/2 + (mu P' - Q')/2 ln(1 - Q'/(mu P'))),        point    b(Q) - Q S/(8 a),

so that the rest of the bodies, which half-spaces lack, cancels.

**Splitting.** A roller with two humps, its radius less d ((z/L)^2 - 1)^2, on a straight one: the approach falls and the
one patch becomes two along the axis, and one again. They stay on one grid, with open cells between them. With an end of
the profile lower by `tilt`, one of the two goes altogether and comes back.

**Jumps.** How far a value lies from the cubic through its two neighbours either way. A force has a corner where all of
the patch begins or ceases to slip, and where contact is lost, for it is mu N until then: the jump there is that of N,
which depends on where in a step the contact parts (0.31 and 0.50 % of mu N, 21 strips, at 0.96 and 1.02 per step).
Steps next to such a corner are left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from references.closed_forms import MindlinLine, MindlinPoint, PointContact, contact_modulus, tangential_compliance
from scenes.rolling_pairs import (
    BORE,
    FRICTION,
    LASTS,
    PAIR,
    PLANE_STEEL,
    SPEED,
    STEEL,
    WIDTH,
    Drives,
    R,
    line_contact,
    pair,
    reduced,
    roller,
    run,
)
from studies.rolling.rolling_steady import APPROACH, CROWN, HALF_WIDTH, SIZE, crowned, straight
from warpffrf.model import surfaces
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.signals import Table
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online.compile.patches.plan import span_of
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.study.markdown import table

Array = np.ndarray
LEGS, PER_LEG = 4, 20  # ways from one end to the other, steps from the middle to an end
POINT_APPROACH, SMALL_WAY, NO_SLIP = 4e-6, 1e-8, 1e4  # m, m, coefficient
SHARE = 0.5  # Q/(mu P)
DEEP, DEEP_HALF_WIDTH = 5e-5, 6.2e-4  # m, a line contact in which a revolution has few cells
TWIST = 2e-6  # m, way by which a locked-in traction is made
DRIVEN, REVOLUTIONS = 2e-3, 10  # creepage
PERIOD, SWING = 3.0, 0.6  # half-widths rolled; of the load
GENTLE = 0.15  # creepage over that of gross slip while the load changes
HUMP, HOLLOW, TILTED = (
    5e-3,
    2e-6,
    1e-6,
)  # m: place of the humps off the middle, depth between them, one next to the other
ONE_PATCH, TWO_PATCHES, SPLIT_HALF_WIDTH = 6e-6, 1.5e-6, 2.2e-4  # m: approaches, a of the largest
TILTED_APPROACHES = 4e-6, 0.5e-6  # m
SPLITS, SPLIT_WAY = 2, 20.0  # times that a patch splits, half-widths rolled
FULL = 0.999  # of mu N from which all of the patch slips
NEAR = 3  # steps
PARTED = 2  # what is neither stuck in part, 0, nor slips as a whole, 1


@dataclass(frozen=True)
class Cattaneo:
    """Errors against the closed form, and the cell."""

    way: float  # relative
    loss: float  # relative
    stick: float  # c/a found less that of the closed form
    cell: float  # over a


def to_and_fro(way: float, legs: int) -> Table:
    """A way [m] from 0 to `way` in the first second, then `legs` times from one end to the other in two."""
    end = 1.0 + 2.0 * legs
    t = np.linspace(0.0, end, 60 * int(end) + 1)
    x = np.where(t < 1.0, 0.5 * way * (1.0 - np.cos(np.pi * t)), way * np.cos(0.5 * np.pi * (t - 1.0)))
    return Table(np.append(t, end + 10.0), np.append(x, x[-1]), cubic=True)


def shifted(
    body: ReducedBody, approach: float, way: float, cells: tuple[int, int], legs: int, friction: float
) -> Result:  # fmt: skip
    """Rollers that stand, the lower one moved along x."""
    drives = Drives(speed=0.0, way=to_and_fro(way, legs), along=(1.0, 0.0, 0.0))
    scene = pair(body, body, approach, drives, cells=cells, friction=friction)
    return run(scene, PER_LEG * (1 + 2 * legs), 1.0 / PER_LEG)


@cache
def sphere() -> ReducedBody:
    """A roller whose crown is as round as itself."""
    return reduced(roller(SIZE, crown_radius=R), STEEL, crowned=True)


def cattaneo(strips: int, *, point: bool = False) -> Cattaneo:
    """The case of the module in that many strips."""
    body = sphere() if point else straight()
    approach, cells = (POINT_APPROACH, (strips, strips)) if point else (APPROACH, (strips, 5))
    width = 1.0 if point else WIDTH
    stuck: Any = shifted(body, approach, SMALL_WAY, cells, 0, NO_SLIP).contact(PAIR)
    compliance, load = SMALL_WAY / abs(float(stuck.force[-1, 0])), float(stuck.normal_load[-1])
    if point:
        hertz = PointContact(load, 0.5 * R, contact_modulus(STEEL, STEEL))
        closed = MindlinPoint(hertz, FRICTION, tangential_compliance(STEEL, STEEL))
        stick_alone = closed.compliance / (8.0 * hertz.half_width)
    else:
        hertz = line_contact(load, PLANE_STEEL, PLANE_STEEL)
        closed = MindlinLine(hertz, FRICTION, 1.0)
        stick_alone = 2.0 / (np.pi * hertz.modulus) * np.log(2.0 / hertz.half_width)

    def wanted_way(force: float) -> float:
        return compliance * force + float(closed.loading(force / width)) - force / width * stick_alone

    way = wanted_way(SHARE * closed.limit * width)
    result = shifted(body, approach, way, cells, LEGS, FRICTION)
    contact: Any = result.contact(PAIR)
    force = -contact.force[:, 0]
    at = PER_LEG, 3 * PER_LEG, 7 * PER_LEG
    x = to_and_fro(way, LEGS)(result.time)
    cycle = slice(at[1], at[2])
    loop = float(np.sum(0.5 * (force[cycle] + force[at[1] + 1 : at[2] + 1]) * np.diff(x[at[1] : at[2] + 1])))
    reached = 0.5 * float(np.ptp(force[at[1] : at[2] + 1])) / width
    area = float(contact.friction.stick_area[at[0]])
    stick = np.sqrt(area / np.pi) if point else 0.5 * area / WIDTH
    peak = float(force[at[0]])
    return Cattaneo(
        way / wanted_way(peak) - 1.0, loop / (closed.cycle_loss(reached) * width) - 1.0,
        stick / hertz.half_width - closed.stick_ratio(peak / width), 2.0 * span_of(strips) / strips,
    )  # fmt: skip


def cattaneo_rows() -> list[list[str]]:
    """Line and point, strips down."""
    rows = []
    for point, strips in ((False, 21), (False, 31), (True, 15), (True, 31)):
        found = cattaneo(strips, point=point)
        rows.append(["point" if point else "line", str(strips), f"{found.way:+.2%}", f"{found.loss:+.1%}",
                     f"{found.stick:+.3f}", f"{found.cell:.3f}"])  # fmt: skip
    return rows


# --- work ---


@dataclass(frozen=True)
class Locked:
    """Of a revolution at equal speeds. Energies [J]: that of the locked-in traction, what friction took, what the cells
    moved, what passes through the patch; largest change of the work of friction in a step, not above 0."""

    stored: float
    lost: float
    moved: float
    passing: float
    gained: float
    share: float  # of the force left at the end, over that locked in


def locked(strips: int = 15, advance: float = 1.0) -> Locked:
    """Pressed, the lower roller held back while both stand, then one revolution at equal speeds; nothing slips."""
    step = advance * 2.0 * span_of(strips) * DEEP_HALF_WIDTH / strips / SPEED
    times = np.array([0.0, 10.0, 20.0, 30.0, 40.0, 60.0, LASTS / step]) * step
    rate = -TWIST / (20.0 * step) / SPEED
    lower = Table(times, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0])
    upper = Table(times, [0.0, 0.0, rate, 0.0, 0.0, 1.0, 1.0])
    body = straight()
    scene = pair(body, body, DEEP, Drives(speeds=(lower, upper)), cells=(strips, 5), friction=NO_SLIP)
    result = run(scene, int(np.ceil(2.0 * np.pi * R / SPEED / step)) + 60, step)
    contact: Any = result.contact(PAIR)
    energy, force = result.history.energy, np.abs(contact.force[:, 0])
    work, moved = np.asarray(energy["friction"]), np.asarray(energy["contact_grid"])
    elastic = float(energy["strain"][-1] + energy["contact"][-1])
    return Locked(
        0.25 * float(force[40]) * TWIST, float(work[40] - work[-1]), float(moved[-1] - moved[40]),
        elastic * np.pi * R / DEEP_HALF_WIDTH, float(np.diff(work).max()), float(force[-1] / force[40]),
    )  # fmt: skip


@cache
def driven(strips: int, advance: float, revolutions: float) -> dict[str, float]:
    """What the lines of the ledger changed by [J] while one roller drives the other."""
    step = advance * 2.0 * span_of(strips) * DEEP_HALF_WIDTH / strips / SPEED
    body = straight()
    scene = pair(body, body, DEEP, Drives(creepage=DRIVEN), cells=(strips, 5))
    steps = int(np.ceil(2.0 * np.pi * R * revolutions / SPEED / step))
    energy = run(scene, steps, step, options=RunOptions(save_every=10)).history.energy
    return {line: float(values[-1] - values[0]) for line, values in energy.items()}


def ledger(strips: int, advance: float, revolutions: float) -> float:
    """Contact grid and numerical lines over the work of the drives."""
    found = driven(strips, advance, revolutions)
    return (found["contact_grid"] + found["numerical"]) / found["drive_work"]


def work_rows() -> list[list[str]]:
    """Runs down: ledger over the work of the drives."""
    cases = ((11, 0.5, 0.5), (11, 1.0, 0.5), (11, 2.0, 0.5), (15, 1.0, 0.5), (11, 1.0, REVOLUTIONS))
    return [[str(n), f"{c:g}", f"{turns:g}", f"{100 * ledger(n, c, turns):+.2f}"] for n, c, turns in cases]


# --- changes ---


@dataclass(frozen=True)
class Jumps:
    """Largest jumps beyond a smooth curve, of the largest mu N (force) and the largest N (load); least of the load over
    the largest; steps of a run that had to be repeated."""

    force: float
    load: float
    least: float
    rejected: int
    steps: int


def beyond_smooth(values: Array) -> Array:
    """Distance (n - 4,) of values (n,) from the cubic through two neighbours either way."""
    v = values
    return np.abs(v[2:-2] - (4.0 * (v[1:-3] + v[3:-1]) - v[:-4] - v[4:]) / 6.0)


def jumps(scene: Any, steps: int, step: float, skip: int = 8) -> Jumps:
    """Of a run, its first `skip` steps left out."""
    return jumps_of(run(scene, steps, step), steps, skip)


def jumps_of(result: Result, steps: int, skip: int = 8) -> Jumps:
    """Of the run that made a result."""
    contact: Any = result.contact(PAIR)
    load = np.asarray(contact.normal_load)[skip:]
    most, jump = load.max(), 0.0
    if result.history.contacts[PAIR].friction is not None:
        force = contact.friction.tangential_force[skip:]
        slips = np.linalg.norm(force, axis=1) >= FULL * FRICTION * load
        state = np.where(load > 0.0, slips, PARTED)
        corner = np.flatnonzero(state[1:] != state[:-1])
        smooth = np.ones(len(load), dtype=bool)
        for i in corner:
            smooth[max(0, i - NEAR) : i + NEAR + 2] = False
        found = np.max([beyond_smooth(force[:, k]) for k in (0, 1)], axis=0)[smooth[2:-2]]
        jump = float(found.max() / (FRICTION * most))
    return Jumps(
        jump, float(beyond_smooth(load).max() / most), float(load.min() / most),
        int(result.history.counters["rejected_steps"]), steps,
    )  # fmt: skip


def varied(change: Callable[[Array], Array], duration: float) -> Table:
    """A smooth signal of time [s]."""
    t = np.linspace(0.0, duration, 401)
    x = change(t)
    return Table(np.append(t, 2.0 * duration), np.append(x, x[-1]), cubic=True)


def _case(point: bool) -> tuple[ReducedBody, float, float]:
    return (crowned(), 3.06e-6, 2.52e-4) if point else (straight(), APPROACH, HALF_WIDTH)


def swelling(strips: int, advance: float, *, point: bool) -> Jumps:
    """The load goes up and down by SWING in PERIOD half-widths."""
    body, approach, a = _case(point)
    step = advance * 2.0 * span_of(strips) * a / strips / SPEED
    period = PERIOD * a / SPEED
    depth = approach * SWING * (0.65 if point else 0.9)  # P as approach^1.5, and as approach^1.1
    steps = int(round(6.0 * period / step))
    way = varied(lambda t: depth * np.sin(2.0 * np.pi * t / period) * np.minimum(t / period, 1.0) ** 2, steps * step)
    xi = GENTLE * FRICTION * a / (0.5 * R)
    cells = (strips, strips) if point else (strips, 5)
    return jumps(pair(body, body, approach, Drives(creepage=xi, way=way), cells=cells), steps, step)


def parted(strips: int, advance: float, *, point: bool) -> Jumps:
    """Contact is lost twice and comes back."""
    body, approach, a = _case(point)
    step = advance * 2.0 * span_of(strips) * a / strips / SPEED
    steps = int(round(20.0 * a / SPEED / step))
    way = varied(lambda t: -0.65 * approach * (1.0 - np.cos(4.0 * np.pi * t / (steps * step))), steps * step)
    xi = GENTLE * FRICTION * a / (0.5 * R)
    cells = (strips, strips) if point else (strips, 5)
    return jumps(pair(body, body, approach, Drives(creepage=xi, way=way), cells=cells), steps, step)


def off_the_end(strips: int, advance: float, *, point: bool) -> Jumps:
    """The upper roller moves along its axle, past the flush end of the lower one."""
    body, approach, a = _case(point)
    step = advance * 2.0 * span_of(strips) * a / strips / SPEED
    start, way, lateral = (0.5 * WIDTH - 4e-4, 8e-4, -0.02) if point else (-1e-4, 2e-4, -0.01)
    steps = int(round(way / (abs(lateral) * SPEED * step)))
    drives = Drives(creepage=1e-3, lateral_creepage=lateral)
    cells = (strips, strips) if point else (strips, 9)
    scene = pair(straight(), body, approach, drives, cells=cells, shift=start)
    return jumps(scene, steps, step, skip=6 * strips)


@cache
def humped(tilt: float = 0.0) -> ReducedBody:
    """A roller with two humps, one of them lower by `tilt` [m]."""
    z = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, 161)
    x = z / HUMP
    drop, slope = HOLLOW * (x**2 - 1.0) ** 2, 4.0 * HOLLOW * (x**2 - 1.0) * x / HUMP
    profile = (z, drop + 0.5 * tilt * (x + 1.0), slope + 0.5 * tilt / HUMP)
    shape = surfaces.ProfiledCylinder(
        table=profile, radius=R, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0)
    )
    mesh = roller_mesh(
        R, BORE, WIDTH, sectors=4 * round(0.5 * np.pi * R / SIZE), layers=7, axial=round(WIDTH / SIZE), profile=shape
    )
    return reduce(
        mesh, PLANE_STEEL, interfaces={"bore": "rigid"}, contact={"rim": shape}, modes=0,
        grid=ContactGrid(contact_fixed=True, tangential=True), progress=False,
    )  # fmt: skip


@dataclass(frozen=True)
class Split:
    """Of a patch that splits: jumps; how often the middle row opened or closed; open rows between the two patches at
    the least load, 0 where one of them is all that is left."""

    jumps: Jumps
    changes: int
    open_rows: int


def split(strips: int, advance: float, rows: int, *, friction: float = FRICTION, tilt: float = 0.0) -> Split:
    """The approach falls and rises SPLITS times in SPLIT_WAY half-widths."""
    a = SPLIT_HALF_WIDTH
    high, low = TILTED_APPROACHES if tilt else (ONE_PATCH, TWO_PATCHES)
    step = advance * 2.0 * span_of(strips) * a / strips / SPEED
    steps = int(round(SPLIT_WAY * a / SPEED / step))
    turn = 2.0 * np.pi * SPLITS / (steps * step)
    way = varied(lambda t: -0.5 * (high - low) * (1.0 - np.cos(turn * t)), steps * step)
    xi = GENTLE * FRICTION * a / (0.5 * R)
    drives = Drives(creepage=xi, way=way)
    scene = pair(humped(tilt), straight(), high, drives, cells=(strips, rows), friction=friction)
    result = run(scene, steps, step)
    pressed = np.any(result.history.contacts[PAIR].pressure > 0.0, axis=1)  # (steps, rows)
    whole = pressed[:, rows // 2]
    found = pressed[np.argmin(np.asarray(result.contact(PAIR).normal_load))]
    used = np.flatnonzero(found)
    return Split(
        jumps_of(result, steps), int(np.count_nonzero(whole[1:] != whole[:-1])),
        int(np.ptp(used)) + 1 - len(used),
    )  # fmt: skip


SPLIT_HEAD = ["case", "strips", "rows", "strips per step", "force", "load", "load, no friction", "least load",
              "changes", "open rows", "repeated"]  # fmt: skip


def split_rows() -> list[list[str]]:
    """Cells and steps down; the same without friction, and with one hump that loses contact."""
    rows = []
    cases: list[tuple[str, int, float, int, float]] = [
        ("splits", 15, 1.0, 21, 0.0), ("splits", 15, 0.5, 21, 0.0), ("splits", 15, 2.0, 21, 0.0),
        ("splits", 21, 1.0, 41, 0.0), ("splits, one part goes", 15, 1.0, 21, TILTED),
        ("splits, one part goes", 15, 1.0, 41, TILTED),
    ]  # fmt: skip
    for name, strips, advance, along, tilt in cases:
        found = split(strips, advance, along, tilt=tilt)
        alone = split(strips, advance, along, tilt=tilt, friction=0.0).jumps
        most = found.jumps
        rows.append([name, str(strips), str(along), f"{advance:g}", f"{100 * most.force:.2f}", f"{100 * most.load:.2f}",
                     f"{100 * alone.load:.2f}", f"{100 * most.least:.0f}", str(found.changes), str(found.open_rows),
                     f"{most.rejected} of {most.steps}"])  # fmt: skip
    return rows


def change_rows() -> list[list[str]]:
    """Cases down."""
    cases: dict[str, Callable[..., Jumps]] = {
        "load ±60 %": swelling, "contact lost and back": parted, "off the partner's end": off_the_end
    }  # fmt: skip
    rows = []
    for name, made in cases.items():
        for point in (False, True):
            for strips, advance in ((15, 1.0), (21, 1.0)):
                found = made(strips, advance, point=point)
                rows.append([name, "point" if point else "line", str(strips), f"{advance:g}",
                             f"{100 * found.force:.2f}", f"{100 * found.load:.2f}", f"{100 * found.least:.0f}",
                             f"{found.rejected} of {found.steps}"])  # fmt: skip
    return rows


def compute() -> dict[str, Any]:
    """The figures of the section."""
    return {
        "locked": locked(),
        "cattaneo": cattaneo_rows(),
        "work": work_rows(),
        "change": change_rows(),
        "split": split_rows(),
    }


def section(figures: dict[str, Any]) -> str:
    """What the page says on histories."""
    found = figures["locked"]
    return f"""## Cattaneo and Mindlin

Shifted to Q = {SHARE:g} mu P and back and forth twice: errors of the way at the first end (both without the rest of the
bodies, see the module), of the loss in the second cycle; stick zone's c/a less the closed form's, and a cell over a.
Points: rollers with a crown of their own radius.

{table(["contact", "strips", "way", "loss", "c/a", "cell"], figures["cattaneo"])}
## Work

Much friction, a traction locked in while both stand ({1e3 * found.stored:.3f} mJ), then a revolution at equal speeds.
Friction takes {1e3 * found.lost:.3f} mJ, contact-fixed cells move {1e3 * found.moved:+.3f} mJ; {found.passing:.0f} J of
elastic energy pass through the patch, so that friction takes {found.lost / found.passing:.1e} of it. It gains in no
step (largest change {found.gained:.1e} J), and {found.share:.1e} of the force is left.

One roller drives the other at a creepage of {DRIVEN:g} (0.41 mu N): contact grid and numerical lines of the ledger over
the work of the drives, in percent.

{table(["strips", "strips per step", "revolutions", "ledger"], figures["work"])}
## Patches that change

Off the end, a point contact loses load in steps, a row of cells at a time, with friction or without; the force follows
the load.

Largest jumps of the force beyond a smooth curve in percent of the largest mu N, of the load in percent of its largest,
least load in percent of that, steps that were repeated. Creepage {GENTLE:g} of gross slip's,
crown {1e3 * CROWN:.0f} mm.

{table(["case", "contact", "strips", "strips per step", "force", "load", "least load", "repeated"], figures["change"])}
## Patches that split

A roller with two humps {2e3 * HUMP:g} mm apart and {1e6 * HOLLOW:g} µm high on a straight one, creepage {GENTLE:g} of
gross slip's; the approach falls from {1e6 * ONE_PATCH:g} to {1e6 * TWO_PATCHES:g} µm and rises, {SPLITS} times in
{SPLIT_WAY:g} half-widths, so that the middle opens and closes. Both patches stay on one grid, open rows between them.
With one hump {1e6 * TILTED:g} µm lower its patch goes and comes too (from {1e6 * TILTED_APPROACHES[0]:g} to
{1e6 * TILTED_APPROACHES[1]:g} µm). Jumps as above, of the load also without friction; how often the middle row opened
or closed, open rows between two patches at the least load.

{table(SPLIT_HEAD, figures["split"])}"""
