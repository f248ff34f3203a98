r"""Carter's rolling with two rollers; some minutes.

Two equal rollers under a load, the lower one driven, the upper one braked by a torque: Carter's rolling contact with
friction, by the engine, against his closed form (`closed_forms.CarterRolling`).

The upper roller has no drive: the torque T on it prescribes the tangential force, Q = T/R, from the first crossing on.
With both speeds prescribed, the elastic twist of the two rollers would have to be wound up by the creep first, which
takes many crossings. What is judged is the state that is there once it is steady: with the half-width a of the
pressures found (twice the root of their second moment) and R' = R/2

    creepage      xi = creep velocity / rolling velocity  of the result, mean over a crossing,
    error of Q    (Q/(mu P)) / (1 - k^2) - 1,             k = 1 - xi R'/(mu a), not below 0,
    error of xi   xi / ((mu a/R') (1 - sqrt(1 - Q/(mu P)))) - 1.

Near gross slip the first is insensitive to xi and the second very sensitive: d ln(xi)/d ln(Q) is 5.5 at 0.99.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.closed_forms import CarterRolling, LineContact, contact_modulus
from references.half_space.rolling import Rolling, settle
from scenes.rollers import CARRIAGE_INERTIA, PAIR, STEEL
from studies.rolling.carter import SHARES
from warpffrf.model import forces, joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.study.markdown import table

RADIUS, BORE, WIDTH = 0.05, 0.015, 0.005  # m
HALF_WIDTH = 1.5e-3  # m, a/R' = 0.06: Hertz and Carter are right to (a/R)^2 = 1e-3
FRICTION = 0.3
SPEED = 0.5  # m/s
CARRIAGE = 1.0  # kg
AXIS = (0.0, 1.0, 0.0)
RAMP = 2.0  # crossings in which the torque rises
CROSSINGS = 10
CELLS, PER_CELL = (8, 16), (0.5, 1.0, 2.0)  # cells in a half-width; cells advanced per step


def rolling_body(cells: int, *, order: int = 2, cache: bool = True) -> ReducedBody:
    """A roller with `cells` cells of the contact grid in HALF_WIDTH; quadratic elements have two columns each."""
    columns = int(np.ceil(2.0 * np.pi * RADIUS / HALF_WIDTH * cells / (4 * order))) * 4 * order
    mesh = roller(RADIUS, BORE, WIDTH, sectors=columns // order, layers=8, axial=1, grading=1.8, order=order)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=0,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=cache,
        progress=False,
    )  # fmt: skip


def line_load() -> float:
    """P' [N/m] at which Hertz's half-width is HALF_WIDTH."""
    return HALF_WIDTH**2 * np.pi * contact_modulus(STEEL, STEEL) / (4.0 * 0.5 * RADIUS)


def braked_pair(body: ReducedBody, share: float, friction: Any = FRICTION) -> Scene:
    """The lower roller driven at SPEED, the upper one under the load and a torque that asks for Q = share mu P."""
    load = line_load() * WIDTH
    turning = np.array([0.0, SPEED / RADIUS, 0.0])
    place = (0.0, 0.0, 2.0 * RADIUS)
    scene = Scene()
    lower = scene.add_body(body, name="lower", angular_velocity=turning)
    upper = scene.add_body(body, name="upper", position=place, angular_velocity=-turning)
    carriage = scene.add_rigid_body(CARRIAGE, CARRIAGE_INERTIA, name="carriage", position=place)
    center = carriage.at((0.0, 0.0, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=AXIS, name="axle"))
    scene.add(joints.Prismatic(scene.ground, center, axis=(0.0, 0.0, 1.0), name="guide"))
    scene.add(joints.Revolute(center, upper["bore"], axis=AXIS, name="upper_axle"))
    scene.add(joints.Drive(axle, SPEED / RADIUS, quantity="velocity"))
    scene.add(forces.PointForce(center, (0.0, 0.0, -load)))
    torque = signals.SmoothStep(0.0, share * FRICTION * load * RADIUS, duration=RAMP * 2.0 * HALF_WIDTH / SPEED)
    scene.add(forces.PointTorque(upper["bore"], (torque, AXIS)))
    scene.add(Contact(lower["rim"], upper["rim"], friction=friction, name=PAIR))
    return scene


@dataclass(frozen=True)
class Rolled:
    """What a run settled to, mean over its last crossing."""

    share: float  # Q/(mu P)
    creepage: float
    half_width: float  # m, of the pressures
    cells: float  # in a half-width
    per_step: float  # cells that the patch advances in a step
    drift: float  # of the creepage between the last two crossings, relative
    least_power: float  # W, smallest of all steps
    status: str

    @property
    def saturation(self) -> float:
        """mu a/R'."""
        return FRICTION * self.half_width / (0.5 * RADIUS)

    @property
    def force_error(self) -> float:
        """Q/(mu P) over Carter's at the creepage found, less 1."""
        k = max(0.0, 1.0 - self.creepage / self.saturation)
        return self.share / (1.0 - k * k) - 1.0

    @property
    def creepage_error(self) -> float:
        """Creepage over Carter's at the force found, less 1."""
        return self.creepage / (self.saturation * (1.0 - np.sqrt(1.0 - min(self.share, 1.0)))) - 1.0


def roll(body: ReducedBody, share: float, per_cell: float, *, crossings: int = CROSSINGS) -> tuple[Rolled, Result]:
    """A run in which the patch advances by about `per_cell` cells per step."""
    pitch = body.contact_surfaces["rim"].grid.pitch * RADIUS
    steps = int(round(2.0 * HALF_WIDTH / (pitch * per_cell)))
    h = 2.0 * HALF_WIDTH / steps / SPEED
    result = simulate(
        braked_pair(body, share), crossings * steps * h, step=h, start="equilibrium", progress=False,
        options=RunOptions(integrator=GeneralizedAlpha(rho_inf=0.5)),
    )  # fmt: skip
    return settled(result, steps), result


def settled(result: Result, steps: int) -> Rolled:
    """The last crossing, of `steps` steps, of a run."""
    history = result.history
    c: Any = history.contacts[PAIR]
    friction = c.friction
    scene: Any = history.scene
    h = scene.contacts[0].a.surface.grid.pitch * RADIUS
    share = -c.force[:, 0] / (FRICTION * np.abs(c.force[:, 2]))
    moving = friction.rolling_velocity > 0.0
    creepage = np.divide(
        friction.creep_velocity[:, 0], friction.rolling_velocity, where=moving, out=np.zeros(len(moving))
    )
    p = c.pressure[-1].sum(axis=1)
    y = h * np.arange(len(p))
    middle = p @ y / p.sum()
    a = 2.0 * np.sqrt(p @ ((y - middle) ** 2 + h * h / 6.0) / p.sum())
    last, before = creepage[-steps:].mean(), creepage[-2 * steps : -steps].mean()
    return Rolled(
        float(share[-steps:].mean()), float(last), float(a), float(a / h),
        float(friction.cells_per_step[-steps:].mean()), float(last / before - 1.0),
        float(friction.power.min()), history.status,
    )  # fmt: skip


def law_error(found: Rolled) -> float:
    """Error of Q of the law alone, on an elastic half-plane with the same cells and steps at the same creepage."""
    exact = CarterRolling(LineContact(line_load(), 0.5 * RADIUS, contact_modulus(STEEL, STEEL)), FRICTION, 0.0)
    share = 1.0 - max(0.0, 1.0 - found.creepage / found.saturation) ** 2
    exact = CarterRolling.from_share(exact.contact, FRICTION, share)
    steps = int(round(2.0 * found.cells / found.per_step))
    rolling = Rolling(exact.contact, FRICTION, found.cells, carried=True)
    shares = settle(rolling, exact.creepage, steps=steps, crossings=CROSSINGS)
    return float(np.mean(shares[-steps:])) / share - 1.0


def compute() -> list[list[str]]:
    """One row per grid, step and share of the bound."""
    rows = []
    for cells in CELLS:
        body = rolling_body(cells)
        for per_cell in PER_CELL:
            for q in SHARES:
                found, _ = roll(body, q, per_cell)
                rows.append([
                    f"{found.cells:.1f}", f"{2.0 * found.cells / found.per_step:.0f}", f"{found.per_step:.2f}",
                    f"{found.share:.4f}", f"{found.creepage:.4e}", f"{found.force_error:+.2%}",
                    f"{found.creepage_error:+.2%}", f"{law_error(found):+.2%}", f"{found.drift:+.2%}",
                ])  # fmt: skip
    return rows


def page(rows: list[list[str]]) -> str:
    """The whole page."""
    head = ["cells", "steps", "cells/step", "Q/μP", "creepage", "error of Q", "error of creepage", "law alone", "drift"]
    return f"""# Carter's rolling with two rollers

Two steel rollers, R = {RADIUS * 1e3:g} mm, {WIDTH * 1e3:g} mm wide, quadratic cells, Hertz's half-width
{HALF_WIDTH * 1e3:g} mm, μ = {FRICTION:g}; the lower one is driven, on the upper one acts a torque, so that Q is
prescribed and the creepage found. After {CROSSINGS} crossings of the patch, mean over the last; *cells* in a
half-width, *steps* in a crossing. *Error of Q*: against Carter's at the creepage found; *of creepage*: against
Carter's at the Q found. *Law alone*: the error of Q on an elastic half-plane in the same cells and steps (see
[carter](carter.md)); the rest is the bodies and how the pressure in a cell is taken. *Drift*: of the creepage between
the last two crossings.

{table(head, rows)}"""
