r"""A flexible frame on four bushings, pushed at a seat: concentrated loads, a car body in small.

An aluminium cage of square bars, 1.6 x 0.8 x 0.4 m, rests on four rubber bushings (full 6 x 6 law, here diagonal)
under the corners of its floor. Three kinds of interfaces take the loads: the *rigid* mounts hold the bushings, the
*averaging* seat, which leaves its bar free to deform, takes a force, and a *free* panel, which keeps every node, a load
spread over its nodes. From the static state under gravity and the load of the panel, a push of 20 ms on the seat sets
the frame swinging; the dampers of the bushings bring it to rest.

What to expect.

1. The static state is that of the full finite-element model, K + sum C_b^T K_b C_b = f with every node of the mesh, the
   mounts held rigid: the modes contain the static answer to every load at an interface, so the reduction costs nothing
   here. The bushings' laws are linear in displacement and rotation, of which the squares are left out.
2. A rigid body of the same mass on the same bushings has six frequencies. About the centre of mass C, with the bushings
   at X_b - C = r_b and the rigid motion u_b = [1, -r_b^] (v, theta) = R_b (v, theta),

       sum_b R_b^T K_b R_b x = lambda diag(m 1, J) x.

   They are found again in the motion of a rigid body that is set off in all six of its modes at once: the coordinate
   of each mode is then a cosine whose frequency is fitted.
3. The momentum gained is the impulse of all forces, m (v(t) - v(0)) = int F dt: seat, bushings and weight.
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

ALUMINIUM = wf.Material(youngs_modulus=70e9, poisson_ratio=0.33, density=2700, name="aluminium")
SIZE, BAR = (1.6, 0.8, 0.4), 0.04  # m
GRAVITY = 9.81  # m/s2
MOUNT_AT = {  # m, x and y of the mounts' middles; +x is the rear, +y the right side
    f"{end}_{side}": (x, y)
    for end, x in (("front", 0.5 * BAR), ("rear", SIZE[0] - 0.5 * BAR))
    for side, y in (("left", 0.5 * BAR), ("right", SIZE[1] - 0.5 * BAR))
}
MOUNTS = tuple(MOUNT_AT)
MOUNT_STIFFNESS = (1.5e5, 1.0e5, 2.0e5, 60.0, 60.0, 40.0)  # N/m along x, y, z; N m/rad about them
MOUNT_DAMPING = tuple(k * 2e-3 for k in MOUNT_STIFFNESS)  # N s/m, N m s/rad: a tenth of critical at 17 Hz
PANEL_LOAD = (0.0, 0.0, -100.0)  # N, in all
PUSH, PUSH_AT, PUSH_TAKES, PUSH_SAMPLES = (600.0, 400.0, -2500.0), 0.02, 0.02, 41  # N at its peak, s, s, of the table
DAMPING = 0.01  # ratio of the frame's own modes
DURATION, STEP = 0.4, 2e-4  # s
RHO_INF = 0.8
STATIC = 1e-5  # of the sink: the turning of the mounts, 1e-4 rad or less, is of first order in the full model
IMPULSE = 5e-5  # of the push: sums over steps instead of integrals
RIGID_STEP, RIGID_DURATION = 1e-4, 0.6  # s
FREQUENCY = 5e-5  # (omega h)^2/12, the period error of the integrator, is 2.4e-5 for the highest of the six
KICK = 1e-3  # m/s over the root of the mass: amplitudes of some micrometres, far from large rotations


@dataclass(frozen=True)
class Cells:
    """Cells along each free length of the bars between the joints, and frames of the recording.

    An odd number across, so that there is a middle cell for the seat.
    """

    along: int = 4
    across: int = 5
    up: int = 2
    order: int = 2
    frames: int = 300


FULL, QUICK = Cells(), Cells(along=2, across=3, up=1, frames=60)


def frame_mesh(cells: Cells = FULL) -> wf.mesh.Mesh:
    """The cage with facet sets of its mounts, `seat` (middle of the floor) and `panel` (middle of the roof's rear)."""
    Lx, Ly, Lz = SIZE
    x = _lines([0.0, 0.5 * (Lx - BAR), Lx - BAR], cells.along)
    y = _lines([0.0, Ly - BAR], cells.across)
    z = _lines([0.0, Lz - BAR], cells.up)
    in_x, in_y, in_z = (np.isclose(np.diff(line), BAR) for line in (x, y, z))
    X, Y, Z = np.meshgrid(in_x, in_y, in_z, indexing="ij")
    mesh = wf.mesh.grid(x, y, z, filled=(Y & Z) | (X & Z) | (X & Y), order=cells.order, name="frame")
    middle, edge = 0.5 * Ly, 0.5 * BAR
    mesh = mesh.select_plane("floor", point=(0, 0, BAR), normal=(0, 0, 1))
    places = {name: ("z_min", at) for name, at in MOUNT_AT.items()}
    places |= {"seat": ("floor", (0.5 * Lx, middle)), "panel": ("z_max", (Lx - edge, middle))}
    for name, (source, at) in places.items():
        mesh = mesh.select(name, source, lambda c, at=at: np.linalg.norm(c[:, :2] - at, axis=1) < edge)
    return mesh


def _lines(bars: list[float], cells: int) -> np.ndarray:
    """Grid lines with a cell for each bar, which begin at `bars` [m], and `cells` between one bar and the next."""
    lines = [np.array([bars[0], bars[0] + BAR])]
    for start, end in zip(bars[:-1], bars[1:], strict=True):
        lines += [np.linspace(start + BAR, end, cells + 1)[1:], np.array([end + BAR])]
    return np.concatenate(lines)


def bushings(scene: wf.Scene, port_of: Any, damping: Any) -> None:
    """Four bushings between the ground and the mounts; `port_of(name)` is the port of the frame at a mount."""
    for name in MOUNTS:
        port = port_of(name)
        at = scene.ground.at(port.world_point())
        scene.add(wf.forces.Bushing(at, port, MOUNT_STIFFNESS, damping, name=name))


def build(cells: Cells = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: body `frame`, bushings named as the mounts, forces `push` and `panel`, sensors `seat` and `stress`."""
    mesh = frame_mesh(cells)
    below = (0.5 * SIZE[0], 0.5 * SIZE[1], 0.0)  # the under side of the bar that carries the seat
    frame = wf.reduce(
        mesh, ALUMINIUM, interfaces={**dict.fromkeys(MOUNTS, "rigid"), "seat": "average", "panel": "free"}, modes=20,
        stress={"below": [below]}, cache=False, progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    body = scene.add_body(frame, name="frame", damping=DAMPING)
    bushings(scene, lambda name: body[name], MOUNT_DAMPING)
    scene.add(wf.forces.NodalLoad(body["panel"], PANEL_LOAD, name="panel"))
    scene.add(wf.forces.PointForce(body["seat"], (push(), PUSH), name="push"))
    scene.add(wf.sensors.Position(body["seat"], name="seat"))
    scene.add(wf.sensors.Stress(body, "below", name="stress"))
    return scene


def push() -> wf.signals.Table:
    """The push over time, sin^2 with its peak in the middle, as a spline; nothing before and after."""
    x = np.linspace(0.0, 1.0, PUSH_SAMPLES)
    values = np.linalg.norm(PUSH) * np.sin(np.pi * x) ** 2
    return wf.signals.Table(PUSH_AT + PUSH_TAKES * x, values, cubic=True, hold=True)


def momentum(scene: wf.Scene, result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Momentum gained and impulse of all forces up to each saved step, each (T, 3) [N s].

    The frame's deformation does not move its centre of mass in its frame of reference, so the momentum is m times the
    velocity of that point.
    """
    from warpffrf.output.geometry.places import rotate

    body, motion, t = scene.body("frame"), result.body("frame"), result.time
    arm = np.stack([rotate(p, body.center_of_mass[None])[0] for p in motion.rotation])
    p = body.mass * (motion.velocity + np.cross(motion.angular_velocity, arm))
    force = sum((result.force(name).force for name in (*MOUNTS, "panel", "push")), body.mass * scene.gravity)
    steps = 0.5 * np.diff(t)[:, None] * (force[1:] + force[:-1])
    return p - p[0], np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def rigid_frequencies(scene: wf.Scene) -> tuple[np.ndarray, np.ndarray]:
    """Six frequencies (6,) [Hz] of the frame as a rigid body on undamped bushings: found in a run, and exact."""
    from demos.frame_reference import fitted_frequency, rigid_modes

    frame = scene.body("frame")
    center = frame.center_of_mass
    ports = {name: frame[name].point for name in MOUNTS}
    exact, modes = rigid_modes(frame.mass, frame.inertia, np.array(list(ports.values())) - center, MOUNT_STIFFNESS)
    rates = KICK * modes.sum(axis=1)
    rigid = wf.Scene()
    body = rigid.add_rigid_body(
        frame.mass, frame.inertia, name="frame", center_of_mass=center, angular_velocity=rates[3:],
        velocity=rates[:3] - np.cross(rates[3:], center),
    )  # fmt: skip
    bushings(rigid, lambda name: body.at(ports[name]), None)
    result = wf.simulate(
        rigid, RIGID_DURATION, step=RIGID_STEP, integrator=wf.GeneralizedAlpha(1.0), save_every=5, progress=False
    )
    motion = result.body("frame")
    turned = 2.0 * motion.rotation[:, :3]  # rotation vector, to second order in it
    moved = motion.position + np.cross(turned, center)
    coordinates = np.hstack([moved, turned]) @ np.vstack([frame.mass * modes[:3], frame.inertia @ modes[3:]])
    return np.array([fitted_frequency(result.time, q) for q in coordinates.T]), exact


def checks(cells: Cells, scene: wf.Scene, result: wf.Result, still: wf.Result) -> list[Check]:
    """The figures of the run `result` and of its static state `still`."""
    from demos.frame_reference import facet_mean, static_displacement

    mesh, body = frame_mesh(cells), scene.body("frame")
    mounts = {name: body[name].point for name in MOUNTS}
    u = static_displacement(mesh, ALUMINIUM, mounts, MOUNT_STIFFNESS, scene.gravity, ("panel", PANEL_LOAD))
    seat = facet_mean(mesh, "seat", u)
    sink = still.sensor("seat").values[-1] - body["seat"].point
    carried = sum(still.force(name).force[-1, 2] for name in MOUNTS)
    gained, impulse = momentum(scene, result)
    pushed = 0.5 * PUSH_TAKES * float(np.linalg.norm(PUSH))  # mean of sin^2
    t, push_force = result.time, result.force("push").force
    found, exact = rigid_frequencies(scene)
    weight = body.mass * GRAVITY - PANEL_LOAD[2]
    return [
        Check("static: bushings carry", float(carried), weight, "weight and load", 1e-8, "N"),
        Check("static: sink of the seat", float(sink[2]), float(seat[2]), "full FE model", STATIC, "mm", 1e3),
        *(
            Check(f"rigid frequency {i + 1}", float(f), float(e), "closed form", FREQUENCY, "Hz")
            for i, (f, e) in enumerate(zip(found, exact, strict=True))
        ),
        Check("impulse of the push", float(np.linalg.norm(np.trapezoid(push_force, t, axis=0))), pushed, "closed form",
              IMPULSE, "N s"),
        Check("momentum less impulse, largest", float(np.abs(gained - impulse).max()), 0.0, "balance, over the push",
              IMPULSE, "N s", scale=pushed),
    ]  # fmt: skip


def main(out: str | Path = "out/frame_on_bushings", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write frame_on_bushings.h5, .rrd, .png and summary.json into `out`; 0 when all went well.

    quick: fewer cells and frames. Raises `InputError` for a folder that cannot be written.
    """
    from warpffrf.output.plots.panels import Panel

    folder = writable_folder(out)
    cells = QUICK if quick else FULL
    log.info("frame on bushings: reducing, equilibrium, %g ms of motion", DURATION * 1e3)
    scene = build(cells, progress=progress)
    still = wf.equilibrium(scene)
    result = wf.simulate(
        scene, DURATION, step=STEP, start="equilibrium", integrator=wf.GeneralizedAlpha(RHO_INF), progress=progress
    )
    ms = result.time * 1e3
    seat = (result.sensor("seat").values - scene.body("frame")["seat"].point) * 1e3
    gained, impulse = momentum(scene, result)
    force = {name: (ms, result.force(name).force[:, 2]) for name in MOUNTS}
    panels = [
        Panel("Displacement of the seat", "time [ms]", "[mm]", {a: (ms, seat[:, i]) for i, a in enumerate("xyz")}),
        Panel("Forces of the bushings on the frame, upwards", "time [ms]", "[N]", force),
        Panel("Momentum of the frame, upwards", "time [ms]", "[N s]", {"momentum gained": (ms, gained[:, 2])},
              {"impulse of all forces": (ms, impulse[:, 2])}),
        Panel("Equivalent stress below the seat", "time [ms]", "[MPa]",
              {"von Mises": (ms, result.sensor("stress").values[:, -1] * 1e-6)}),
    ]  # fmt: skip
    results = {"motion": result, "equilibrium": still}
    found = checks(cells, scene, result, still)
    return finish(folder / "frame_on_bushings", results, found, panels, frames=cells.frames)
