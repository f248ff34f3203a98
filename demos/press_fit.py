r"""A shaft pressed into a hub and turned: micro-slip that spreads along the seat until all of it slips.

A solid shaft of 40 mm is 10 um larger in radius than the bore of its hub, as long as it. Assembled, the seat carries
Lame's pressure (`tests/references/closed_forms/joints.py`), everywhere the same: with Poisson's ratio zero nothing
moves along the axis, and shaft and hub end together, so that no edge presses. A shaft that stands out presses 30 % more
on the first 5 mm (`tests/demos/test_press_fit.py`).

Then the shaft's end at one side is turned against the hub's end at the other. Both averaging interfaces spread a torque
as Saint-Venant's torsion does, by r, so that the rods of shaft and hub begin at once. Slip begins where the torque
enters the shaft, at 0.16 of the torque of whole slip, later at the other end, too, and the zones grow towards each
other; the closed form is derived in `tests/references/closed_forms/turned_fit.py`. It has shear lag and no notch:
where the shaft ends inside its hub tractions are singular, so that the last ring there slips before its time. The
angle goes up to that of 0.8 of the slip torque, through a cycle, and on until all slips, at T = 2 pi R^2 b mu p.

A shaft that was turned does not come back: without torque an angle remains, which Masing's rule has as
phi_1 - 2 phi(T_1/2). A press fit under a torque that comes and goes so loses energy in each cycle, and its seat frets.

What the cells are off: they are flat. A lap takes the mean of displacements along its cell's normal and presses along
it; on arcs of 2 pi/N both are short by (pi/N)^2/6, so that pressures are (pi/N)^2/3 too high and the torque of whole
slip (pi/N)^2/6. A ring slips as one, so that the slip zone grows in steps of a ring.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import PressFit, TurnedFit
from warpffrf.output.plots import laps as plots
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

Array = np.ndarray
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7850, name="steel that keeps its width")
FIT = PressFit(radius=0.02, outer_radius=0.03, interference=1e-5, width=0.04, friction=0.15, shaft=STEEL)
TURNED = TurnedFit(FIT)
PEAK, BEYOND = 0.8, 1.5  # of the slip torque, in the cycle; of its angle, at the end
WHOLE = 1.0 - 1e-12  # of the slip torque
SHOWN = (0.3, 0.55, 0.8)  # of the slip torque: where the seat is drawn
SEAT, TURN, ENTRY, HELD = "seat", "turn", "end_low", "end_high"
PRESSURE = 0.015  # flat cells, 16 around: 1.3 %
TORQUE = 0.01  # likewise 0.64 %
ZONE = 1.0  # of a ring, which slips as one
SLIP, ANGLE, LOSS = 0.03, 0.01, 0.02  # of the largest slip, the largest angle, the loss; of 8 rings
LEDGER = 5e-3  # of the loss: a loop of straight lines between load steps


@dataclass(frozen=True)
class Size:
    """Quadratic cells around and along the seat, load steps of first loading, frames of the recording."""

    sectors: int = 24
    axial: int = 12
    steps: int = 24
    frames: int = 150


FULL, QUICK = Size(), Size(sectors=16, axial=8, steps=16, frames=40)


def path(size: Size) -> Array:
    """The angles of the load steps [rad]: up, a cycle, and on until all slips."""
    peak, end = (float(TURNED.loading(share * FIT.slip_torque)) for share in (PEAK, WHOLE))
    n = size.steps
    parts = [(0.0, peak, n), (peak, -peak, 2 * n), (-peak, peak, 2 * n), (peak, BEYOND * end, n)]
    return np.concatenate([[0.0], *(np.linspace(*part[:2], part[2] + 1)[1:] for part in parts)])


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `shaft` and `hub`, lap `seat`, joint `turn`, which is driven; a second a load step."""
    around: dict[str, Any] = {"sectors": size.sectors, "axial": size.axial}
    shaft = wf.reduce(
        wf.mesh.roller(FIT.radius, 0.0, FIT.width, layers=1, **around), STEEL, interfaces={ENTRY: "average"},
        laps={SEAT: "rim"}, modes=4, progress=progress,
    )  # fmt: skip
    sleeve = wf.mesh.sleeve(FIT.radius, FIT.outer_radius, FIT.width, layers=2, **around)
    sleeve = sleeve.select_plane(HELD, point=(0.0, 0.5 * FIT.width, 0.0), normal=(0.0, 1.0, 0.0))
    hub = wf.reduce(
        sleeve, STEEL, interfaces={HELD: "average"}, laps={SEAT: "bore"}, modes=4, progress=progress
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    inner, outer = scene.add_body(shaft, name="shaft"), scene.add_body(hub, name="hub")
    scene.add(wf.joints.Fixed(scene.ground, outer[HELD], name="held"))
    turn = scene.add(wf.joints.Revolute(scene.ground, inner[ENTRY], axis=(0.0, 1.0, 0.0), name=TURN))
    angles = path(size)
    by_step = wf.signals.Table(np.arange(len(angles), dtype=float), angles)
    scene.add(wf.joints.Drive(turn, by_step, quantity="position", name="spanner"))
    scene.add(wf.Lap(inner[SEAT], outer[SEAT], friction=FIT.friction, interference=FIT.interference, name=SEAT))
    return scene


def run(scene: wf.Scene, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    """All load steps, from the assembled fit."""
    return wf.simulate(scene, float(len(path(size)) - 1), step=1.0, kind="static", progress=progress)


@dataclass(frozen=True, eq=False)
class Turned:
    """A run by its load steps: angle [rad] and torque [N m] (T,); `steps` of first loading."""

    result: wf.Result
    steps: int

    @property
    def lap(self) -> Any:
        """The seat."""
        return self.result.lap(SEAT)

    @property
    def torque(self) -> Array:
        """(T,) N m, on the shaft."""
        return self.result.joint(TURN).torque[:, 1]

    @property
    def angle(self) -> Array:
        """(T,) rad."""
        return self.result.joint(TURN).coordinate

    @property
    def y(self) -> Array:
        """(c,) m of the cells, from the entry."""
        return self.lap.points[:, 1] + 0.5 * FIT.width

    def rings(self, values: Array) -> tuple[Array, Array]:
        """Places (rings,) [m] and means over the rings of `values` (c,)."""
        number, first, ring = np.unique(np.round(self.y, 9), return_index=True, return_inverse=True)
        return self.y[first], np.bincount(ring, weights=values) / np.bincount(ring, minlength=len(number))

    @property
    def zone(self) -> Array:
        """(T,) m, how far the seat slips from the entry."""
        slips = np.array([self.rings(state == 2)[1] for state in self.lap.state]) > 0.5
        return np.cumprod(slips, axis=1).sum(axis=1) * FIT.width / slips.shape[1]

    @property
    def friction(self) -> Array:
        """(T, rings) means around of the traction along the sense of rotation, over mu p of the assembled seat."""
        lap = self.lap
        around = np.cross((0.0, 1.0, 0.0), lap.frames[:, 0])
        along = np.einsum("ckx,cx->ck", lap.frames[:, 1:], around)
        traction = np.einsum("tck,ck->tc", lap.traction, along) / (FIT.friction * lap.pressure[0])
        return np.array([self.rings(row)[1] for row in traction])

    def row_at(self, share: float) -> int:
        """The load step of first loading next to a share of the slip torque."""
        return int(np.argmin(np.abs(self.torque[: self.steps + 1] - share * FIT.slip_torque)))

    @property
    def remains(self) -> float:
        """Angle [rad] that remains without torque after first loading."""
        down = slice(self.steps, 3 * self.steps + 1)
        return float(np.interp(0.0, self.torque[down][::-1], self.angle[down][::-1]))


def checks(turned: Turned) -> list[Check]:
    """The figures of the run."""
    n, torque, angle, lap = turned.steps, turned.torque, turned.angle, turned.lap
    up, ring = slice(1, n + 1), FIT.width / len(turned.rings(turned.y)[0])
    peak = float(torque[n])
    expected = np.array([TURNED.zones(T)[0] for T in torque[up]])
    away = np.abs(turned.zone[up] - expected).max()
    places, slips = turned.rings(lap.shift_distance[n])
    exactly = TURNED.slip(places, peak)
    work = cycle(turned).loss
    loss = lap.loss_between(float(n), float(5 * n))
    twist = np.abs(angle[up] - TURNED.loading(torque[up])).max()
    remains = float(TURNED.unloading(0.0, peak))
    pressed = lap.pressure[0]
    degrees, masing = float(np.degrees(1.0)), "closed form, Masing"
    return [
        Check("assembled: largest pressure", float(pressed.max()), FIT.pressure, "Lame", PRESSURE, "MPa", 1e-6),
        Check("assembled: smallest pressure", float(pressed.min()), FIT.pressure, "Lame", PRESSURE, "MPa", 1e-6),
        Check("torque of whole slip", float(torque[-1]), FIT.slip_torque, "2 pi R^2 b mu p", TORQUE, "N m"),
        Check("slip zone at the entry off by", float(away), 0.0, "closed form, over a ring", ZONE, "mm", 1e3,
              scale=ring),
        Check("slip along the seat off by", float(np.abs(slips - exactly).max()), 0.0, "closed form, over the largest",
              SLIP, "um", 1e6, scale=float(exactly.max())),
        Check("angle at first loading off by", float(twist), 0.0, "closed form, over the largest", ANGLE, "mdeg",
              1e3 * degrees, scale=float(angle[n])),
        Check("angle that remains without torque", turned.remains, remains, masing, LOSS, "mdeg", 1e3 * degrees),
        Check("loss per cycle", loss, TURNED.cycle_loss(peak), masing, LOSS, "mJ", 1e3),
        Check("work of the torque in a cycle", work, loss, "loss of the cells", LEDGER, "mJ", 1e3),
    ]  # fmt: skip


def cycle(turned: Turned) -> Any:
    """The cycle of torque against angle."""
    return turned.result.hysteresis(turned.torque, turned.angle).loop(float(turned.steps), float(5 * turned.steps))


# --- pictures


@dataclass(frozen=True, eq=False)
class Unrolled:
    """The cells of the seat that stick and slip at a load step."""

    turned: Turned
    row: int

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        plots.state(self.turned.lap, ax, self.row)
        share = self.turned.torque[self.row] / FIT.slip_torque
        ax.set_title(f"The seat unrolled at {share:.2f} of the torque of whole slip", fontsize=10)
        ax.set(xlabel="around [mm]", ylabel="along the axis [mm]", aspect="auto")


@dataclass(frozen=True, eq=False)
class FrictionMap:
    """Friction of the rings, place along the seat over load steps, in colours from -1 to 1 of what it can be."""

    turned: Turned

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        rows = self.turned.friction
        edges = np.linspace(0.0, 1e3 * FIT.width, rows.shape[1] + 1)
        steps = np.arange(len(rows) + 1) - 0.5
        colors = ax.pcolormesh(steps, edges, rows.T, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
        ax.figure.colorbar(colors, ax=ax, label="friction around, over mu p [-]")
        for turn in self.turned.steps * np.array([1, 3, 5]):
            ax.axvline(turn, color="0.2", lw=0.7, ls=":")
        ax.set(xlabel="load step", ylabel="from where the torque enters [mm]")
        ax.set_title("Friction along the seat: up, down, up, on", fontsize=10)


def panels(turned: Turned) -> list[Any]:
    """Torque against angle; slip along the seat, how far it goes, friction along it; the seat from above."""
    n, torque, angle, lap = turned.steps, turned.torque, turned.angle, turned.lap
    peak = float(torque[n])
    degrees = 1e3 * np.degrees(1.0)
    most = FIT.slip_torque
    up, around = np.linspace(0.0, WHOLE * most, 60), np.linspace(-peak, peak, 60)
    whole = np.array([0.0, float(angle[-1])])
    rows = [turned.row_at(share) for share in SHOWN]
    fine, places = np.linspace(0.0, FIT.width, 201), turned.rings(turned.y)[0]
    shares = torque[: n + 1] / most
    curve = np.linspace(0.0, WHOLE, 101)
    zones = np.array([TURNED.zones(share * most) for share in curve])
    return [
        Panel("Torque: up, a cycle, until all slips", "angle [mdeg]", "torque [N m]",
              {"run": (degrees * angle, torque)},
              {"all slips, Lame": (degrees * whole, np.full(2, most)),
               "first loading": (degrees * TURNED.loading(up), up),
               "cycle, Masing": (degrees * np.concatenate([TURNED.unloading(around[::-1], peak),
                                                          TURNED.reloading(around, peak)]),
                                 np.concatenate([around[::-1], around]))}),
        Panel("Slip along the seat at first loading", "from where the torque enters [mm]", "slip [um]",
              {f"T = {torque[i] / most:.2f} of whole slip": (1e3 * fine, 1e6 * TURNED.slip(fine, torque[i]))
               for i in rows},
              points={f"run, {torque[i] / most:.2f}": (1e3 * places, 1e6 * turned.rings(lap.shift_distance[i])[1])
                      for i in rows}),
        Panel("How far the seat slips at first loading", "torque, of whole slip [-]", "from the entry [mm]",
              {"entry": (curve, 1e3 * zones[:, 0]), "other end": (curve, 1e3 * (FIT.width - zones[:, 1]))},
              points={"run, whole rings": (shares, 1e3 * turned.zone[: n + 1])}),
        Panel("Friction along the seat at first loading", "from where the torque enters [mm]", "over mu p [-]",
              {f"T = {torque[i] / most:.2f} of whole slip": (1e3 * fine, TURNED.carried(fine, torque[i]) / TURNED.limit)
               for i in rows},
              limits=(0.0, 1.6), points={f"run, {torque[i] / most:.2f}": (1e3 * places, turned.friction[i])
                                        for i in rows}),
        FrictionMap(turned),
        Unrolled(turned, rows[-1]),
    ]  # fmt: skip


def main(out: str | Path = "out/press_fit", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write press_fit.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells, fewer load steps. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("press fit: %d rings of %d cells, then %d load steps", size.axial, size.sectors, len(path(size)) - 1)
    result = run(build(size, progress=progress), size, progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    turned = Turned(result, size.steps)
    return finish(folder / "press_fit", {"turned": result}, checks(turned), panels(turned), frames=size.frames)
