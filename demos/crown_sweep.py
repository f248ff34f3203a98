r"""Which crown do two rollers need? A sweep of 60 equilibria: crown by load by tilt.

Two steel rollers (R 20 mm, bores of 8 mm) are pressed together; the upper one is 16 mm long, the lower one 24 mm, and
both have the same crown, an arc of radius Rc. The upper roller is tilted by phi against the lower one, as by a shaft
that bends. The sweep varies the curvature 1/Rc of the crown from 0, straight rollers, to 1/(2 m), the load from 500 N
to 4 kN and the tilt from 0 to 1 mrad; the bodies are meshed in quadratic cells of 4 mm, eight times as wide as the
contact, and reduced once for each crown.

What to expect. Two crowns touch where their slopes are equal, z/Rc of one and phi - z/Rc of the other, at

    z = phi Rc/2

from the middle, and carry on Hertz's ellipse there, with R/2 and Rc/2 as relative radii, as long as the ellipse ends
before the roller does. A strong crown is insensitive to tilt, and has a short ellipse and a high pressure. A weak crown
has a long one, which a tilt moves over the end; a straight roller carries on its edges, which press into the longer
roller even without tilt. Between them there is a best crown: that with the smallest maximum of the pressure over all
loads and tilts.

At a sharp edge the pressure of the continuum is infinite. The values shown there are means over the cell at the end, a
tenth to a millimetre long, for comparison only.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, BORE_RADIUS, LENGTHS, CELL, LAYERS = 0.02, 0.008, (0.024, 0.016), 4e-3, 3  # m; of the lower and upper roller
HALF_LENGTH = 0.5 * min(LENGTHS)  # m
PAIR, WORKERS = "upper-lower", 2


@dataclass(frozen=True)
class Size:
    """The sweep: curvatures of the crown [1/m], loads [N] and tilts [rad]."""

    curvatures: tuple[float, ...] = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
    loads: tuple[float, ...] = (500.0, 1000.0, 2000.0, 4000.0)
    tilts: tuple[float, ...] = (0.0, 0.5e-3, 1e-3)


FULL, QUICK = Size(), Size(curvatures=(0.0, 1 / 8, 1 / 2), loads=(500.0, 4000.0), tilts=(0.0, 1e-3))


@functools.cache
def roller(length: float, curvature: float) -> Any:
    """A reduced roller with a crown; each worker reduces it once."""
    crown = {} if curvature == 0.0 else {"crown_radius": 1.0 / curvature}
    rim = wf.surfaces.CrownedCylinder(**crown) if crown else wf.surfaces.Cylinder()
    mesh = wf.mesh.roller(
        RADIUS, BORE_RADIUS, length, sectors=round(0.5 * np.pi * RADIUS / CELL) * 4, layers=LAYERS,
        axial=round(length / CELL), order=2, **crown,
    )  # fmt: skip
    return wf.reduce(
        mesh,
        STEEL,
        interfaces={"bore": "rigid"},
        contact={"rim": rim},
        modes=0,
        grid=wf.ContactGrid(contact_fixed=True),
        progress=False,
    )


def build(curvature: float, load: float, tilt: float) -> wf.Scene:
    """The scene of a row: bodies `lower` and `upper`, contact `upper-lower`; curvature of the crown [1/m], load [N],
    tilt [rad] of the upper roller's axis in the plane of both axes. The rollers just touch."""
    scene = wf.Scene()
    lower = scene.add_body(roller(LENGTHS[0], curvature), name="lower")
    upper = scene.add_body(
        roller(LENGTHS[1], curvature), name="upper", position=(0.0, 0.0, 2.0 * RADIUS + lift(curvature, tilt)),
        rotation=(np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt)),
    )  # fmt: skip
    scene.add(wf.Contact(upper["rim"], lower["rim"], kinematics="closest_point", name=PAIR))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"], name="seat"))
    scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0), name="guide"))
    scene.add(wf.forces.PointForce(upper["bore"], (0.0, 0.0, -load), name="press"))
    return scene


def place(curvature: float, tilt: float) -> float:
    """Distance [m] from the middle at which the unloaded rollers touch: phi Rc/2, or the end of the shorter one."""
    return min(0.5 * tilt / curvature, HALF_LENGTH) if curvature > 0.0 else HALF_LENGTH * (tilt > 0.0)


def lift(curvature: float, tilt: float) -> float:
    """Distance of the axes less 2 R [m] where the rollers just touch: phi z - z^2/Rc."""
    z = place(curvature, tilt)
    return tilt * z - curvature * z * z


def pressures(result: wf.Result) -> np.ndarray:
    """(rows,) Pa, the largest pressure across in each row of cells along the roller."""
    return result.contact(PAIR).mean_pressure[0].max(axis=0)


def rows_at(result: wf.Result) -> np.ndarray:
    """(rows,) m, the positions of these rows."""
    return np.atleast_2d(result.contact(PAIR).rows)[0]


def run(store: str | Path, size: Size = FULL, *, workers: int = WORKERS, progress: bool = True) -> Any:
    """The sweep, its rows computed by `workers` processes and kept in the folder `store`."""
    outputs = {
        "peak": f"last(contact_peak_pressure[{PAIR}])",
        "force": f"last(contact_force[{PAIR}])",
        "half_widths": f"last(contact_half_widths[{PAIR}])",
        "center": f"last(contact_center[{PAIR}])",
        "pressures": pressures,
        "rows": rows_at,
    }
    parameters = {"curvature": list(size.curvatures), "load": list(size.loads), "tilt": list(size.tilts)}
    return wf.study.sweep(
        build, parameters, outputs=outputs, run=wf.equilibrium, store=store, workers=workers, overwrite=True,
        progress=progress,
    )  # fmt: skip


def worst(found: Any) -> dict[float, int]:
    """Curvature -> the row with the largest pressure."""
    rows = {float(c): np.flatnonzero(found["curvature"] == c) for c in np.unique(found["curvature"])}
    return {c: int(of[np.argmax(found["peak"][of])]) for c, of in rows.items()}


def main(out: str | Path = "out/crown_sweep", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write the sweep crown_sweep.sweep, its page crown_sweep.html and picture, and crown_sweep.h5 and .rrd of the
    worst row of the best crown, into the folder `out`, and print the figures; quick: 12 rows instead of 60."""
    stem = Path(out) / "crown_sweep"
    found = run(f"{stem}.sweep", QUICK if quick else FULL, progress=progress)
    of_worst, peak = worst(found), found["peak"] / 1e6
    best = min(of_worst, key=lambda c: peak[of_worst[c]])
    row = {name: float(found[name][of_worst[best]]) for name in found.parameter_names}
    result = wf.equilibrium(build(**row), progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)
    found.page(f"{stem}.html", overwrite=True)

    drawn = [Panel("Largest pressure over all loads and tilts", "curvature of the crown, 1/Rc [1/m]", "[MPa]",
                   {"rollers": (np.array(list(of_worst)), peak[list(of_worst.values())])})]  # fmt: skip
    for tilt in (found["tilt"].min(), found["tilt"].max()):
        curves = {}
        for c, name in ((0.0, "straight"), (best, "the best"), (max(of_worst), f"Rc = {1.0 / max(of_worst):g} m")):
            at = (found["curvature"] == c) & (found["load"] == found["load"].max()) & (found["tilt"] == tilt)
            n = int(np.flatnonzero(at)[0])
            curves[name] = found["rows"][n] * 1e3, found["pressures"][n] / 1e6
        drawn.append(Panel(f"Along the rollers, 4 kN, tilt {tilt * 1e3:g} mrad", "z [mm]", "[MPa]", curves))
    save_panels(drawn, f"{stem}.png", overwrite=True)

    for c, n in of_worst.items():
        at = f"{found['load'][n]:g} N, {found['tilt'][n] * 1e3:g} mrad" + ("   the best" if c == best else "")
        print(f"{f'Rc = {1.0 / c:g} m' if c else 'straight':12} largest pressure {peak[n]:8.1f} MPa at {at}")
    print(found.response("peak", where={"load": row["load"], "tilt": row["tilt"]}).report())
    return [result]


if __name__ == "__main__":
    main()
