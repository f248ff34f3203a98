r"""A flexible frame on four bushings, pushed at a seat: concentrated loads on a simplified car body.

An aluminium cage of square bars, 1.6 x 0.8 x 0.4 m, rests on four rubber bushings (full 6 x 6 law, here diagonal)
under the corners of its floor. Three kinds of interfaces take the loads: the *rigid* mounts connect to the bushings,
the *averaging* seat, which leaves its bar free to deform, takes a force, and a *free* panel, which keeps every node, a
load spread over its nodes. From the static state under gravity and the load of the panel, a push of 20 ms on the seat
excites the frame; the dampers of the bushings bring it to rest.

What to expect. The static state is that of the full finite-element model with every node of the mesh: the modes contain
the static response to every load at an interface, so that the reduction has no error here. The bushings carry weight
and load. The momentum gained is the impulse of all forces, m (v(t) - v(0)) = int F dt: that of the push is the mean of
sin^2 times its peak and its duration.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

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


@dataclass(frozen=True)
class Cells:
    """Cells along each free length of the bars between the joints; an odd number across, for a middle one."""

    along: int = 4
    across: int = 5
    up: int = 2
    order: int = 2


FULL, QUICK = Cells(), Cells(along=2, across=3, up=1)


def frame_mesh(cells: Cells = FULL) -> wf.mesh.Mesh:
    """The cage with facet sets of its mounts, `seat` (middle of the floor) and `panel` (middle of the roof's rear)."""
    Lx, Ly, Lz = SIZE
    x = _lines([0.0, 0.5 * (Lx - BAR), Lx - BAR], cells.along)
    y = _lines([0.0, Ly - BAR], cells.across)
    z = _lines([0.0, Lz - BAR], cells.up)
    X, Y, Z = np.meshgrid(*(np.isclose(np.diff(line), BAR) for line in (x, y, z)), indexing="ij")
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
    below = (0.5 * SIZE[0], 0.5 * SIZE[1], 0.0)  # the under side of the bar that carries the seat
    frame = wf.reduce(
        frame_mesh(cells), ALUMINIUM, modes=20, stress={"below": [below]}, cache=False, progress=progress,
        interfaces={**dict.fromkeys(MOUNTS, "rigid"), "seat": "average", "panel": "free"},
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
    """The push over time, sin^2 with its peak in the middle, as a spline; zero before and after."""
    x = np.linspace(0.0, 1.0, PUSH_SAMPLES)
    values = np.linalg.norm(PUSH) * np.sin(np.pi * x) ** 2
    return wf.signals.Table(PUSH_AT + PUSH_TAKES * x, values, cubic=True, hold=True)


def main(out: str | Path = "out/frame_on_bushings", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write frame_on_bushings.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer cells and
    frames."""
    stem, scene = Path(out) / "frame_on_bushings", build(QUICK if quick else FULL, progress=progress)
    integrator = wf.integrators.GeneralizedAlpha(RHO_INF)
    result = wf.simulate(
        scene, DURATION, step=STEP, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=progress
    )
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 300, overwrite=True)

    ms, force = result.time * 1e3, {name: result.force(name).force for name in (*MOUNTS, "push")}
    seat = (result.sensor("seat").values - scene.body("frame")["seat"].point) * 1e3
    save_panels([
        Panel("Displacement of the seat", "time [ms]", "[mm]", {a: (ms, seat[:, i]) for i, a in enumerate("xyz")}),
        Panel("Forces of the bushings on the frame, upwards", "time [ms]", "[N]",
              {name: (ms, force[name][:, 2]) for name in MOUNTS}),
        Panel("Equivalent stress below the seat", "time [ms]", "[MPa]",
              {"von Mises": (ms, result.sensor("stress").values[:, -1] * 1e-6)}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    weight = scene.body("frame").mass * GRAVITY - PANEL_LOAD[2]
    impulse = np.linalg.norm(np.trapezoid(force["push"], result.time, axis=0))
    print(f"bushings carry at rest {sum(force[name][0, 2] for name in MOUNTS):.4f} N, weight and load {weight:.4f} N")
    print(f"impulse of the push {impulse:.4f} N s, its integral {0.5 * PUSH_TAKES * np.linalg.norm(PUSH):.4f} N s")
    print(f"the seat moves by up to {np.abs(seat - seat[0]).max():.3f} mm and ends {abs(seat[-1, 2] - seat[0, 2]):.1e} "
          "mm from rest")  # fmt: skip
    return [result]


if __name__ == "__main__":
    main()
