r"""A shaft pressed into a hub and rotated: micro-slip that spreads along the seat until all of it slips.

A solid shaft of 40 mm is 10 um larger in radius than the bore of its hub and as long as it. Assembled, the seat carries
Lame's pressure p = E d/(2 R) (1 - (R/Ro)^2), which is uniform: with Poisson's ratio zero nothing moves along the
axis, and shaft and hub end together, without an edge effect.

Then the shaft's end at one side is rotated against the hub's end at the other. Slip begins where the torque enters the
shaft, at 0.16 of the torque of whole slip T = 2 pi R^2 b mu p, later at the other end as well, and the zones grow
towards each other. The angle rises to that of 0.8 T, passes through a cycle, and increases until all slips.

What to expect: a shaft that was rotated does not return; without torque an angle remains, by Masing's rule
phi_1 - 2 phi(T_1/2). A press fit under an alternating torque thus loses energy in each cycle, and its seat frets. The
cells are flat: on arcs of 2 pi/N pressures are (pi/N)^2/3 too high and the torque of whole slip (pi/N)^2/6; a ring of
cells slips at once, so that the slip zone grows in steps of a ring.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import warpffrf as wf

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7850, name="steel that keeps its width")
RADIUS, OUTER_RADIUS, WIDTH = 0.02, 0.03, 0.04  # m
INTERFERENCE, FRICTION = 1e-5, 0.15  # m, -
PRESSURE = STEEL.youngs_modulus * INTERFERENCE / (2.0 * RADIUS) * (1.0 - (RADIUS / OUTER_RADIUS) ** 2)  # Pa, Lame
TORQUE = 2.0 * np.pi * RADIUS**2 * WIDTH * FRICTION * PRESSURE  # N m, of whole slip
PEAK, END = 0.25222135e-3, 0.36285460e-3  # rad: angles at 0.8 of that torque and where all slips first
BEYOND = 1.5  # of the latter, at the end
SEAT, TURN, ENTRY, HELD = "seat", "turn", "end_low", "end_high"


@dataclass(frozen=True)
class Size:
    """Quadratic cells around and along the seat, load steps of first loading."""

    sectors: int = 24
    axial: int = 12
    steps: int = 24


FULL, QUICK = Size(), Size(sectors=16, axial=8, steps=16)


def path(size: Size) -> np.ndarray:
    """The angles of the load steps [rad]: up, a cycle, and up until all slips."""
    n = size.steps
    parts = [(0.0, PEAK, n), (PEAK, -PEAK, 2 * n), (-PEAK, PEAK, 2 * n), (PEAK, BEYOND * END, n)]
    return np.concatenate([[0.0], *(np.linspace(*part[:2], part[2] + 1)[1:] for part in parts)])


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `shaft` and `hub`, small-sliding contact `seat`, joint `turn`, which is driven; a second per
    load step."""
    around: dict[str, Any] = {"sectors": size.sectors, "axial": size.axial}
    shaft = wf.reduce(
        wf.mesh.roller(RADIUS, 0.0, WIDTH, layers=1, **around), STEEL, interfaces={ENTRY: "average"},
        contact={SEAT: wf.surfaces.Matched(first="rim")}, modes=4, progress=progress,
    )  # fmt: skip
    sleeve = wf.mesh.sleeve(RADIUS, OUTER_RADIUS, WIDTH, layers=2, **around)
    sleeve = sleeve.select_plane(HELD, point=(0.0, 0.5 * WIDTH, 0.0), normal=(0.0, 1.0, 0.0))
    hub = wf.reduce(
        sleeve,
        STEEL,
        interfaces={HELD: "average"},
        contact={SEAT: wf.surfaces.Matched(first="bore")},
        modes=4,
        progress=progress,
    )
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    inner, outer = scene.add_body(shaft, name="shaft"), scene.add_body(hub, name="hub")
    scene.add(wf.joints.Fixed(scene.ground, outer[HELD], name="held"))
    turn = scene.add(wf.joints.Revolute(scene.ground, inner[ENTRY], axis=(0.0, 1.0, 0.0), name=TURN))
    angles = path(size)
    by_step = wf.signals.Table(np.arange(len(angles), dtype=float), angles)
    scene.add(wf.joints.Drive(turn, by_step, quantity="position", name="spanner"))
    scene.add(
        wf.Contact(
            inner[SEAT], outer[SEAT], sliding=wf.SmallSliding(interference=INTERFERENCE), friction=FRICTION, name=SEAT
        )
    )
    return scene


def run(scene: wf.Scene, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    """All load steps, from the assembled fit."""
    return wf.static(scene, float(len(path(size)) - 1), step=1.0, progress=progress)


def main(out: str | Path = "out/press_fit", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write press_fit.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells, fewer load
    steps."""
    stem, size = Path(out) / "press_fit", QUICK if quick else FULL
    result = run(build(size, progress=progress), size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=40 if quick else 150, overwrite=True)

    seat, n = result.contact(SEAT), size.steps
    torque, angle = result.joint(TURN).torque[:, 1], result.joint(TURN).coordinate
    slips = int(np.argmin(np.abs(torque[: n + 1] - 0.55 * TORQUE)))
    figure, (loop, some, more) = plt.subplots(1, 3, figsize=(15.0, 4.0), layout="constrained")
    loop.plot(np.degrees(angle) * 1e3, torque, label="run")
    loop.axhline(TORQUE, color="black", ls="--", label="all slips, Lame")
    loop.set(xlabel="angle [mdeg]", ylabel="torque [N m]", title="Torque: up, a cycle, until all slips")
    loop.legend(frameon=False)
    for axes, row in ((some, slips), (more, n)):
        result.plot("stick_slip", axes, row=row)
        axes.set(title=f"Unrolled at {torque[row] / TORQUE:.2f} of the torque of whole slip", aspect="auto")
        axes.set(xlabel="around [mm]", ylabel="along the axis [mm]")
    figure.savefig(f"{stem}.png")
    plt.close(figure)

    down = slice(n, 3 * n + 1)
    remains = np.degrees(np.interp(0.0, torque[down][::-1], angle[down][::-1])) * 1e3
    loss = seat.loss_between(float(n), float(5 * n))
    work = result.hysteresis(torque, angle).loop(float(n), float(5 * n)).loss
    print(f"pressure of the seat           {seat.pressure[0].mean() / 1e6:8.4f} MPa   Lame {PRESSURE / 1e6:8.4f}")
    print(f"torque of whole slip           {torque[-1]:8.3f} N m   2 pi R^2 b mu p {TORQUE:8.3f}")
    print(f"angle that remains             {remains:8.4f} mdeg  Masing 3.6819")
    print(f"loss per cycle                 {loss * 1e3:8.4f} mJ    Masing 58.934, work of the torque {work * 1e3:.3f}")
    return [result]


if __name__ == "__main__":
    main()
