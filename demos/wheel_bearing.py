r"""The bearing of a car's wheel in a corner: two rows of balls share the side force and its moment.

A double-row angular-contact ball bearing, its rows back to back and preloaded, carries the hub of a wheel. The tyre's
force acts at the road, 0.31 m below: the wheel's load upwards, and in a corner a side force along the axis, whose
moment about the bearing is much larger than one row could balance alone. Back to back, the lines of contact of both
rows meet the axis

    s = b + d_pw tan(alpha)

apart, nearly three times the distance b of the rows, and there the rows support the hub as two bearings do: straight on
each carries half of the load at its top, in a corner one of them carries the moment at its top, the other one at its
bottom, that with the side force in addition. The wheel's load is shifted to the outer wheels, here by half of the side
force.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, Polar, save_panels

NAME, COUNT = "wheel bearing", 14  # balls of a row
GEOMETRY = wf.bearings.BallGeometry(
    elements=COUNT, ball_diameter=12.7e-3, pitch_diameter=62e-3, osculation=0.52, contact_angle=np.radians(36.0),
    rows=2, row_spacing=24e-3, width=42e-3, bore=36e-3, outside_diameter=88e-3,
)  # fmt: skip
PRELOAD = 8e-6  # m: each row is pressed by it
TYRE, WEIGHT, SIDE, SHIFT = 0.31, 4500.0, 3500.0, 0.5  # m, N, N, share of the side force
ROWS = {"row at -y": slice(0, COUNT), "row at +y": slice(COUNT, 2 * COUNT)}


@dataclass(frozen=True)
class Size:
    """Steps from no side force to the largest."""

    steps: int = 14


FULL, QUICK = Size(), Size(steps=4)


def build() -> wf.Scene:
    """The scene: body `hub`, bearing `wheel bearing` whose outer ring is the ground, force `tyre`; at the time t the
    side force is t of the largest."""
    scene = wf.Scene()
    hub = scene.add_rigid_body(20.0, (0.6, 1.0, 0.6), name="hub")
    scene.add_bearing(
        NAME, GEOMETRY, first=(0, 0, -1), inner=hub, outer=scene.ground,
        axial_preload=wf.bearings.PreloadOffset(PRELOAD),
    )  # fmt: skip
    side, up, moment = (
        wf.signals.Table([0.0, 1.0], [low, high])
        for low, high in ((0.0, SIDE), (WEIGHT, WEIGHT + SHIFT * SIDE), (0.0, TYRE * SIDE))
    )
    scene.add(wf.forces.PointForce(hub, (0.0, side, up), name="tyre"))
    scene.add(wf.forces.PointTorque(hub, (moment, 0.0, 0.0), name="moment of the tyre"))
    return scene


def panels(result: wf.Result) -> list[Panel]:
    """Loads and pressures of both rows and the tilt against the side force, and the load zones at its largest."""
    found, side = result.bearing(NAME), 1e-3 * SIDE * result.time
    label, peak = "side force [kN]", found.peak_pressure["inner"]
    closed = np.linspace(0.0, 2.0 * np.pi, COUNT + 1)

    def zone(row: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        loads = {name: found.outer_load[row, part] / 1e3 for name, part in ROWS.items()}
        return {name: (closed, np.append(Q, Q[0])) for name, Q in loads.items()}

    return [
        Polar("Load zones, straight on", "angle from the road", "[kN]", zone(0)),
        Polar(f"Load zones, {1e-3 * SIDE:g} kN of side force", "angle from the road", "[kN]", zone(-1)),
        Panel("Most loaded ball", label, "[kN]",
              {name: (side, found.outer_load[:, part].max(axis=1) / 1e3) for name, part in ROWS.items()}),
        Panel("Peak pressure, inner ring", label, "[MPa]",
              {name: (side, peak[:, part].max(axis=1) / 1e6) for name, part in ROWS.items()}),
        Panel("Tilt of the hub", label, "[mrad]", {"hub": (side, 1e3 * np.hypot(*found.tilt[:, :2].T))}),
        Panel("Loaded balls", label, "[-]",
              {name: (side, np.count_nonzero(found.outer_load[:, part], axis=1)) for name, part in ROWS.items()}),
    ]  # fmt: skip


def main(out: str | Path = "out/wheel_bearing", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write wheel_bearing.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer steps."""
    stem, size = Path(out) / "wheel_bearing", QUICK if quick else FULL
    result = wf.static(build(), 1.0, step=1.0 / size.steps, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)

    found = result.bearing(NAME)
    for row in (0, len(result.time) // 2, -1):
        loads = ", ".join(f"{name} {found.outer_load[row, part].max():6.0f} N" for name, part in ROWS.items())
        print(f"side force {SIDE * result.time[row]:5.0f} N: most loaded ball {loads}, "
              f"tilt {1e3 * np.hypot(*found.tilt[row, :2]):5.3f} mrad")  # fmt: skip
    return [result]


if __name__ == "__main__":
    main()
