"""Amplitude-dependent damping of a mode by friction in small-sliding contacts: damping ratio, frequency, loops, a table
and a plot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.reduced.inertia import interface_motion, interface_slope
from warpffrf.online.vibrations.eigenmodes import SceneModes
from warpffrf.online.vibrations.rubbing import Cycle, equivalent, rubbing_mode

UNSETTLED = 0.02  # of the loss per cycle: change between consecutive cycles
FEWEST_CYCLES = 3  # the first starts at rest, the third is compared with the second
FEWEST_STEPS = 8
STILL = 1e-6  # of the largest displacement of a body: smaller ones are nodes of the mode
SIZE = (6.4, 4.2)  # inches


@dataclass(frozen=True, eq=False)
class EquivalentDamping:
    """A mode of a scene with friction in small-sliding contacts, at k amplitudes; returned by
    `Modes.equivalent_damping`.

    The linear oscillator with `frequency` and `damping_ratio` has the same stiffness and the same loss per cycle. The
    ratio includes only the small-sliding contacts: `Modes.damping_ratios` of the mode must be added.
    """

    mode: int
    linear_frequency: float  # Hz, all cells stick
    place: str  # where `amplitude` is measured
    unit: str  # of `amplitude`: m, or m kg^(1/2) of the mode's coordinate
    amplitude: np.ndarray  # (k,) at `place`
    coordinate: np.ndarray  # (k,) m kg^(1/2), of the mode, whose modal mass is 1
    damping_ratio: np.ndarray  # (k,) zeta = D/(4 pi U)
    frequency: np.ndarray  # (k,) Hz, of the secant stiffness
    loss: np.ndarray  # J, D per cycle
    energy: np.ndarray  # (k,) J, U of the amplitude
    contact_loss: dict[str, np.ndarray]  # contact -> (k,) J, its part of D
    slipping: dict[str, np.ndarray]  # contact -> (k,) fraction of its cells that slip or open in the cycle
    loops: list[Cycle]  # (k,) the last cycle at each amplitude: `coordinate` and `load` of the mode
    notes: list[str] = field(default_factory=list)

    def report(self) -> str:
        """Table over the amplitudes, and notes: plain text."""
        lines = [
            f"mode {self.mode}, {self.linear_frequency:.6g} Hz with all cells stuck; amplitude at {self.place}", "",
            f"{'amplitude ' + self.unit:>20}  {'damping %':>10}  {'frequency Hz':>12}  {'loss J':>10}  slipping",
        ]  # fmt: skip
        for i, a in enumerate(self.amplitude):
            slips = ", ".join(f"{name} {100.0 * share[i]:.0f} %" for name, share in self.slipping.items())
            lines.append(
                f"{a:>20.4g}  {100.0 * self.damping_ratio[i]:>10.4g}  {self.frequency[i]:>12.6g}  "
                f"{self.loss[i]:>10.4g}  {slips}"
            )
        if self.notes:
            lines += ["", *(f"note: {note}" for note in self.notes)]
        return "\n".join(lines)

    __str__ = report

    def plot(self, ax: Any = None) -> Any:
        """Draw the damping ratio over the amplitude, both logarithmic, on the matplotlib axes `ax` (new ones if None);
        returns them."""
        if ax is None:
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure

            figure = Figure(figsize=SIZE, layout="constrained")
            FigureCanvasAgg(figure)
            ax = figure.add_subplot()
        order = np.argsort(self.amplitude)
        rubs = order[self.damping_ratio[order] > 0.0]
        ax.loglog(self.amplitude[rubs], 100.0 * self.damping_ratio[rubs], marker="o")
        ax.set(
            xlabel=f"amplitude at {self.place} [{self.unit}]", ylabel="damping ratio of contact friction [%]",
            title=f"Mode {self.mode}, {self.linear_frequency:.5g} Hz",
        )  # fmt: skip
        ax.grid(visible=True, which="both", alpha=0.3)
        return ax


def equivalent_damping(
    modes: SceneModes,
    i: int,
    amplitude: float | Sequence[float] | np.ndarray,
    *,
    at: PortLike | None,
    cycles: int,
    steps: int,
) -> EquivalentDamping:
    """See `Modes.equivalent_damping`."""
    label = "equivalent_damping"
    cycles = require_count(cycles, f"{label}: cycles", FEWEST_CYCLES)
    steps = require_count(steps, f"{label}: steps", FEWEST_STEPS)
    if steps % 4:
        raise InputError(f"{label}: steps must be a multiple of four, to include both ends of a cycle, got {steps}")
    given = require_array(amplitude if np.ndim(amplitude) else [amplitude], f"{label}: amplitude", (None,))
    if not len(given):
        raise InputError(f"{label}: give one amplitude at least")
    for a in given:
        require_number(float(a), f"{label}: amplitude", positive=True)
    mode = rubbing_mode(modes, i)
    port = None if at is None else as_port(at, f"{label}: at")
    unit = 1.0 if port is None else _displacement(modes, i, port)
    loops = [mode.cycle(a / unit, cycles, steps) for a in given]
    numbers = np.array([equivalent(loop, a / unit) for loop, a in zip(loops, given, strict=True)])
    notes = []
    for a, loop, loss in zip(given, loops, numbers[:, 0], strict=True):
        change = abs(loss - loop.before)
        if change > UNSETTLED * loss and change > 0.0:
            notes.append(
                f"amplitude {a:.4g}: the loss still varies from cycle to cycle ({loop.before:.4g} J, then {loss:.4g} "
                "J); take more cycles"
            )
    if not np.all(numbers[:, 0] > 0.0):
        notes.append("without slip the loss is zero; smaller cells resolve micro-slip below the cell size")
    names = [contact.name for contact in modes.scene.small_sliding]
    return EquivalentDamping(
        mode=i, linear_frequency=mode.omega / (2.0 * np.pi),
        place="the mode's coordinate" if port is None else port.label,
        unit="m kg^(1/2)" if port is None else "m", amplitude=given, coordinate=given / unit, loss=numbers[:, 0],
        energy=numbers[:, 1], damping_ratio=numbers[:, 2], frequency=numbers[:, 3] / (2.0 * np.pi),
        contact_loss={name: np.array([loop.loss[name] for loop in loops]) for name in names},
        slipping={name: np.array([loop.slipping[name] for loop in loops]) for name in names}, loops=loops, notes=notes,
    )  # fmt: skip


def _displacement(modes: SceneModes, i: int, port: Port) -> float:
    """Magnitude [m] of the displacement of a port in mode i."""
    if port.point is None or port.body.name not in modes.shapes:
        raise InputError(
            "equivalent_damping: at must be a place on a body that moves, body['interface'] or body.at((x, y, z)), "
            f"got {port.label}"
        )
    name = port.body.name
    shape, A = modes.shapes[name][i], rot.matrix(modes.rotation[name])
    place, own = port.point, np.zeros(3)
    if port.interface_name is not None and len(shape.modal):
        q = modes.modal[name]
        place = place + interface_motion(port.body, port.interface_name, q)[:3]
        own = np.real(shape.modal) @ interface_slope(port.body, port.interface_name, q)[:, :3]
    moved = np.real(shape.translation) + np.cross(np.real(shape.rotation), A @ place) + A @ own
    size = float(np.linalg.norm(moved))
    if size <= STILL * max(float(np.linalg.norm(np.real(s[i].translation))) for s in modes.shapes.values()):
        raise InputError(f"equivalent_damping: {port.label} does not move in mode {i}; measure the amplitude elsewhere")
    return size
