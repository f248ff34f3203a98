"""Time of a step against the number of local modes, and against the size of the patch.

*Against local modes*: two equal rollers press on each other at a constant approach. Nodes cover an arc of the rim (the
tread)
that grows from row to row; mesh, contact grid, approach and speed stay the same, so that the patch is the same too. The
rollers swing to and fro so far that the patch runs over the whole tread: what it touches is new to the caches. If the
cost
followed the number of local modes, the last row would be many times the first.

*Against the active nodes*: the same pair, whole rim, pressed deeper and deeper.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from scenes.rollers import PAIR, STEEL
from warpffrf.model import joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, ReductionOptions, reduce
from warpffrf.online import History, LocalModes, Settings, run

RADIUS, BORE, WIDTH = 0.05, 0.015, 0.02  # m
SAMPLES_PER_SWING = 12  # of the sine table: its spline is right to 1e-3, and a short table costs the step nothing
SPARE_COLUMNS = 4  # nodes that stay untouched at both ends of the tread


@dataclass(frozen=True)
class StepTime:
    """One measured run."""

    local_modes: int  # of one roller
    active_nodes: float  # mean over the run
    retained_columns: int
    iterations: float  # Newton iterations per step, mean
    factorisations: float  # of the active block per step, mean
    seconds_per_step: float
    steps: int
    outside_graph: float  # fraction of the run outside the graph's replay
    status: str

    def row(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def tread_body(
    columns: int | None,
    *,
    sectors: int = 960,
    layers: int = 14,
    axial: int = 8,
    modes: int = 0,
    local_dynamics: bool = False,
) -> ReducedBody:
    """A roller of linear hexahedra whose nodes cover `columns` grid columns about the angle zero; None: the whole rim.
    Contact stands on these nodes (no `contact_fixed`). `local_dynamics` keeps the inertia of its local modes."""
    mesh = roller(RADIUS, BORE, WIDTH, sectors=sectors, layers=layers, axial=axial, grading=1.3, order=1)
    name = "rim"
    if columns is not None:
        half = 0.5 * (columns + 1) * 2.0 * np.pi / sectors
        mesh = mesh.select("tread", "rim", lambda x: np.abs(np.arctan2(-x[:, 2], x[:, 0])) < half)
        name = "tread"
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={name: Cylinder()}, modes=modes,
        options=ReductionOptions(local_dynamics=local_dynamics), grid=ContactGrid(contact_fixed=False), progress=False,
    )  # fmt: skip


def swinging_pair(
    body: ReducedBody, approach: float, swing: float, rate: float, duration: float, second: ReducedBody | None = None
) -> Scene:
    """Two such rollers with axles fixed at the distance 2 R - `approach` [m] that roll to and fro on each other; the
    upper one is `second`, if given.

    swing [rad] is the amplitude about the middle of the tread, rate [rad/s] the largest speed, duration [s] the time
    to cover.
    """
    scene = Scene()
    (name,) = body.contact_surfaces
    bodies = []
    for label, turn, position in (("lower", -1.0, 0.0), ("upper", 1.0, 2.0 * RADIUS)):
        half = 0.25 * np.pi * turn  # the tread's middle, +x, rotated to face the other roller
        bodies.append(
            scene.add_body(
                body if second is None or label == "lower" else second,
                name=label,
                position=(0.0, 0.0, position),
                rotation=(0.0, np.sin(half), 0.0, np.cos(half)),
                angular_velocity=(0.0, -turn * rate, 0.0),
            )
        )
    scene.add(Contact(bodies[0][name], bodies[1][name], name=PAIR))
    scene.close_gap(scene.contacts[0], along=(0.0, 0.0, 1.0), gap=-approach)
    period = 2.0 * np.pi * swing / rate
    for one, sense in zip(bodies, (1.0, -1.0), strict=True):
        axle = scene.add(joints.Revolute(scene.ground, one["bore"], axis=(0, 1, 0)))
        scene.add(joints.Drive(axle, _sine(sense * swing, period, duration), quantity="position"))
    return scene


def _sine(amplitude: float, period: float, duration: float) -> signals.Table:
    """amplitude sin(2 pi t / period) from its trough before t = 0 to a turning point after `duration`, where the
    spline's end
    slopes, zero, are right."""
    halves = int(np.ceil(2.0 * duration / period + 0.5))
    t = period * np.linspace(-0.25, -0.25 + 0.5 * halves, halves * SAMPLES_PER_SWING // 2 + 1)
    return signals.Table(t, amplitude * np.sin(2.0 * np.pi * t / period), cubic=True)


def measured(history: History, local_modes: int) -> StepTime:
    """Figures of a run."""
    c = history.counters
    contact = history.contacts[PAIR]
    steps = max(int(c["steps"]), 1)
    return StepTime(
        local_modes=local_modes,
        active_nodes=float(contact.active_nodes.mean()),
        retained_columns=int(c["retained_columns"]),
        iterations=float(c["mean_iterations"]),
        factorisations=float(history.factorisations[1:].sum() / steps),
        seconds_per_step=c["seconds_in_graph"] / steps,
        steps=steps,
        outside_graph=1.0 - c["seconds_in_graph"] / c["loop_seconds"],
        status=history.status,
    )


def time_swing(
    body: ReducedBody,
    *,
    approach: float,
    steps: int = 2000,
    step: float = 1e-4,
    columns_per_step: float = 0.25,
    settings: Settings | None = None,
    local: LocalModes | str = "quasi_static",
) -> StepTime:
    """Time of a step while two such rollers swing over all of their tread (a whole rim: a sixth of the turn each way),
    with the treatment `local` of the local modes."""
    (surface,) = body.contact_surfaces.values()
    grid = surface.grid
    half_patch = np.sqrt(approach * RADIUS) / (RADIUS * grid.pitch)  # columns, more than the patch has
    reach = 0.5 * grid.columns - half_patch - SPARE_COLUMNS
    swing = np.pi / 3.0 if grid.periodic else max(reach, 1.0) * grid.pitch
    rate = columns_per_step * grid.pitch / step
    scene = swinging_pair(body, approach, swing, rate, steps * step)
    history = run(
        scene, steps * step, step=step, start="equilibrium", progress=False, settings=settings, local_modes=local
    )
    return measured(history, body.local_modes)
