r"""Which crown do two rollers need? A sweep of 60 equilibria: crown by load by tilt.

Two steel rollers (R 20 mm, bores of 8 mm) are pressed together; the upper one is 16 mm long, the lower one 24 mm, and
both have the same crown, an arc of radius Rc. The upper roller leans by phi against the lower one, as a shaft that
bends or a seat that is out of true has it. The sweep varies the curvature 1/Rc of the crown from 0, straight rollers,
to 1/(2 m), the load from 500 N to 4 kN and the tilt from 0 to 1 mrad; the bodies are meshed in quadratic cells of 4 mm,
eight times as wide as the contact, and reduced once for each crown.

What to expect. Two crowns touch where their slopes are the same, z/Rc from one and phi - z/Rc from the other, at

    z = phi Rc/2

from the middle, and carry on Hertz's ellipse there, with R/2 and Rc/2 as relative radii, as long as the ellipse ends
before the roller does. A strong crown does not care about tilt, and has a short ellipse and a high pressure. A weak
crown has a long one, that a tilt moves over the end; a straight roller carries on its edges, which press into the
longer roller even without tilt. Between them there is a best crown: that whose largest pressure over all loads and
tilts is least.

At a sharp edge the pressure of the continuum is infinite. What is shown there are means over the cell at the end, a
tenth to a millimetre long, so that straight rollers are worse than their figures. Compare them, do not rely on them.
"""

from __future__ import annotations

import functools
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact
from warpffrf.output.plots.panels import COLORS, Panel
from warpffrf.study.sweeps.outcome import Sweep
from warpffrf.study.sweeps.reading.plot import panels_of

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, BORE_RADIUS, LENGTHS, CELL, LAYERS = 0.02, 0.008, (0.024, 0.016), 4e-3, 3  # m; of the lower and upper roller
HALF_LENGTH = 0.5 * min(LENGTHS)  # m
MODULUS = contact_modulus(STEEL, STEEL)
PAIR = "upper-lower"
WORKERS = 2
STORE = "crown_sweep.sweep"
BALANCE = 1e-6  # of the load
WITHIN = 0.85  # of the half-length: an ellipse that ends there is Hertz's; nearer to the end the roller is softer
PEAK, AXIS = (
    0.01,
    0.015,
)  # of peak pressure and half-axis along: eleven strips across, 21 to 27 rows on the whole length
PLACE = 0.05  # of phi Rc/2: the rollers give way under the moment
SHARP = 1.1  # times the best crown's largest pressure, which straight rollers have, and more
EDGE = 1.1  # times the pressure in the middle, which the end of a straight roller has without tilt, and more


@dataclass(frozen=True)
class Size:
    """The sweep: curvatures of the crown [1/m], loads [N] and tilts [rad]."""

    curvatures: tuple[float, ...] = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
    loads: tuple[float, ...] = (500.0, 1000.0, 2000.0, 4000.0)
    tilts: tuple[float, ...] = (0.0, 0.5e-3, 1e-3)


FULL, QUICK = Size(), Size(curvatures=(0.0, 1 / 8, 1 / 2), loads=(500.0, 4000.0), tilts=(0.0, 1e-3))


@functools.cache
def roller(length: float, curvature: float) -> Any:
    """A roller with a crown, reduced."""
    crown = {} if curvature == 0.0 else {"crown_radius": 1.0 / curvature}
    rim = wf.surfaces.CrownedCylinder(**crown) if crown else wf.surfaces.Cylinder()
    mesh = wf.mesh.roller(
        RADIUS, BORE_RADIUS, length, sectors=round(0.5 * np.pi * RADIUS / CELL) * 4, layers=LAYERS,
        axial=round(length / CELL), order=2, **crown,
    )  # fmt: skip
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": rim}, modes=0, contact_fixed=True, progress=False
    )


def build(curvature: float, load: float, tilt: float) -> wf.Scene:
    """The scene of a row: bodies `lower` and `upper`, pair `upper-lower`; curvature of the crown [1/m], load [N],
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
    """How much farther apart [m] the axes are then than 2 R: phi z - z^2/Rc."""
    z = place(curvature, tilt)
    return tilt * z - curvature * z * z


def hertz(curvature: float, load: float) -> EllipticContact:
    """The contact of two crowns that do not end."""
    return EllipticContact(load, 0.5 * RADIUS, 0.5 / curvature, MODULUS)


# --- what is kept of a run


def pressures(result: wf.Result) -> np.ndarray:
    """(rows,) Pa, the largest pressure across in each row of cells along the roller."""
    return result.contact(PAIR).mean_pressure[0].max(axis=0)


def rows_at(result: wf.Result) -> np.ndarray:
    """(rows,) m, where these rows are."""
    return np.atleast_2d(result.contact(PAIR).rows)[0]


OUTPUTS = {
    "peak": f"last(contact_peak_pressure[{PAIR}])",
    "force": f"last(contact_force[{PAIR}])",
    "half_widths": f"last(contact_half_widths[{PAIR}])",
    "center": f"last(contact_center[{PAIR}])",
    "pressures": pressures,
    "rows": rows_at,
}


def run(store: str | Path, size: Size = FULL, *, workers: int = WORKERS, progress: bool = True) -> Sweep:
    """The sweep."""
    parameters = {"curvature": list(size.curvatures), "load": list(size.loads), "tilt": list(size.tilts)}
    return wf.study.sweep(
        build, parameters, outputs=OUTPUTS, equilibrium={}, store=store, workers=workers, overwrite=True,
        progress=progress,
    )  # fmt: skip


# --- what it says


def worst(found: Sweep) -> dict[float, int]:
    """Of each curvature the row with the largest pressure."""
    curvature, peak = found["curvature"], found["peak"]
    rows = {float(c): np.flatnonzero(curvature == c) for c in np.unique(curvature)}
    return {c: int(of[np.argmax(peak[of])]) for c, of in rows.items()}


def best(found: Sweep) -> float:
    """The curvature [1/m] whose largest pressure is least."""
    peak, rows = found["peak"], worst(found)
    return min(rows, key=lambda c: peak[rows[c]])


def within(found: Sweep) -> list[int]:
    """The rows whose ellipse ends before the rollers do."""
    table = zip(found["curvature"], found["load"], found["tilt"], strict=True)
    return [
        n for n, (c, load, tilt) in enumerate(table)
        if c > 0.0 and place(c, tilt) + hertz(c, load).half_axes[1] <= WITHIN * HALF_LENGTH
    ]  # fmt: skip


def checks(found: Sweep, again: wf.Result) -> list[Check]:
    """Of all rows, beside statics, Hertz and the geometry of two crowns; of the best crown; `again`: its worst row, run
    by itself."""
    peak, load, tilt, curvature = (found[name] for name in ("peak", "load", "tilt", "curvature"))
    rows = within(found)
    exact = [hertz(curvature[n], load[n]) for n in rows]
    of_peak = [peak[n] / h.peak_pressure - 1.0 for n, h in zip(rows, exact, strict=True)]
    of_axis = [found["half_widths"][n, 1] / h.half_axes[1] - 1.0 for n, h in zip(rows, exact, strict=True)]
    leaning = [n for n in rows if tilt[n] > 0.0]
    of_place = [-found["center"][n, 1] / place(curvature[n], tilt[n]) - 1.0 for n in leaning]
    of_force = np.linalg.norm(found["force"], axis=1) / load - 1.0
    least, of_worst = best(found), worst(found)
    edges = found["pressures"][(curvature == 0.0) & (tilt == 0.0)]
    at_edge = [float(row[0] / row[np.isfinite(row)][np.isfinite(row).sum() // 2]) for row in edges]
    completed = found.counts.get("completed", 0)
    ratio = peak[of_worst[0.0]] / peak[of_worst[least]]
    return [
        Check("rows that were completed", completed, found.count, "all", 0.0),
        Check("force of all rows, off by", _largest(of_force), 0.0, "statics", BALANCE, scale=1.0),
        Check(f"peak pressure of {len(rows)} rows, off by", _largest(of_peak), 0.0, "Hertz", PEAK, scale=1.0),
        Check(f"half-axis along of {len(rows)} rows, off by", _largest(of_axis), 0.0, "Hertz", AXIS, scale=1.0),
        Check(f"place of {len(leaning)} tilted rows, off by", _largest(of_place), 0.0, "phi Rc/2", PLACE, scale=1.0),
        Check("straight: end over middle, cut at", min(*at_edge, EDGE), EDGE, "edges", 0.0),
        Check("straight: largest peak over the best's, cut at", min(ratio, SHARP), SHARP, "edges under tilt", 0.0),
        Check("best crown, largest peak: run by itself", float(again.contact(PAIR).peak_pressure[-1]),
              float(peak[of_worst[least]]), "the sweep, bit for bit", 0.0, "MPa", 1e-6),
    ]  # fmt: skip


def _largest(errors: Sequence[float] | np.ndarray) -> float:
    """That of the largest size."""
    return float(max(errors, key=abs))


def table(found: Sweep) -> str:
    """Of each crown its radius, its drop at the ends and the worst of its rows, as text."""
    lines = [f"{'crown radius [m]':>18}{'drop at the ends [um]':>24}{'largest peak [MPa]':>21}   at"]
    load, tilt, peak, least = found["load"], found["tilt"], found["peak"], best(found)
    for c, n in worst(found).items():
        radius, drop = f"{1.0 / c:.4g}" if c else "straight", 0.5e6 * HALF_LENGTH**2 * c
        at = f"{load[n]:g} N, {tilt[n] * 1e3:g} mrad" + ("   the best" if c == least else "")
        lines.append(f"{radius:>18}{drop:>24.3g}{peak[n] * 1e-6:>21.1f}   {at}")
    return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class Marked:
    """A panel with a line at the best curvature."""

    panel: Any
    at: float

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        self.panel.draw(ax)
        line = ax.axvline(self.at, color=COLORS[2], lw=1.8, ls="--", zorder=1.5)
        ax.legend([line, *ax.get_legend_handles_labels()[0]], ["best crown", *ax.get_legend_handles_labels()[1]],
                  fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)  # fmt: skip
        ax.set(xlabel="curvature of the crown, 1/Rc [1/m]", ylabel="load [N]")


def panels(found: Sweep) -> list:
    """Maps of the peak pressure at each tilt, the largest over each crown, and pressure along the rollers at the
    largest load, level and tilted."""
    curvature, load, tilt, peak = (found[name] for name in ("curvature", "load", "tilt", "peak"))
    of_worst, least = worst(found), best(found)
    maps, _ = panels_of(found, "peak", x="curvature", y="load", col="tilt")
    drawn: list[Any] = [Marked(panel, least) for panel in maps]
    c = np.array(list(of_worst))
    largest = peak[list(of_worst.values())] * 1e-6
    level = [float(peak[(curvature == value) & (tilt == 0.0)].max()) * 1e-6 for value in c]
    drawn.append(
        Panel("Largest peak pressure of each crown", "curvature of the crown, 1/Rc [1/m]", "[MPa]",
              {"over all loads and tilts": (c, largest), "over all loads, no tilt": (c, np.array(level))},
              points={f"the best, Rc = {1.0 / least:g} m" if least else "the best, straight":
                      (np.array([least]), largest[c == least])}),
    )  # fmt: skip
    for angle in (tilt.min(), tilt.max()):
        curves = {}
        for value, name in ((0.0, "straight"), (least, "the best"), (c.max(), f"Rc = {1.0 / c.max():g} m")):
            n = int(np.flatnonzero((curvature == value) & (load == load.max()) & (tilt == angle))[0])
            curves[name] = found["rows"][n] * 1e3, found["pressures"][n] * 1e-6
        title = f"Along the rollers, {load.max() * 1e-3:g} kN, tilt {angle * 1e3:g} mrad"
        drawn.append(Panel(title, "z [mm]", "largest pressure [MPa]", curves))
    return drawn


def main(out: str | Path = "out/crown_sweep", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo; the sweep is crown_sweep.sweep in `out`, with its page crown_sweep.html; crown_sweep.h5 and .rrd
    are the worst row of the best crown, .png and summary.json are of all rows. 0 when all checks passed.

    quick: 12 rows instead of 60. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    count = len(size.curvatures) * len(size.loads) * len(size.tilts)
    log.info("crown sweep: %d equilibria by %d workers", count, WORKERS)
    found = run(folder / STORE, size, progress=progress)
    if found.counts != {"completed": count}:
        log.error("not all rows were completed:\n%s", found.report())
        return 1
    n = worst(found)[best(found)]
    row = {name: float(found[name][n]) for name in found.parameter_names}
    again = wf.equilibrium(build(**row), progress=progress)
    code = finish(folder / "crown_sweep", {"best": again}, checks(found, again), panels(found), frames=1)
    print(table(found))
    print(found.response("peak", where={"load": row["load"], "tilt": row["tilt"]}).report())
    print(f"the whole sweep: {found.page(folder / 'crown_sweep.html', overwrite=True)}")
    return code
