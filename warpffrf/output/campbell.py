r"""Campbell diagrams: natural frequencies of a machine against the speed of its rotation, with lines of orders.

`eigenmodes` has the modes about a state that turns, with gyroscopic, centrifugal and stiffening parts; here it is asked
at one speed after the other. Frequencies are those of `eigenmodes`: in world axes where what turns is rigid and
symmetric, else in axes that turn with the bodies, in which a force that stands in the world goes round once a turn.

**Branches.** Modes of neighbouring speeds are one curve where their shapes are alike: with the mass matrix M,

    MAC = |y_a^H M y_b|^2/(y_a^H M y_a  y_b^H M y_b),

pairs are those with the smallest sum of (1 - MAC) + |ln f_a/f_b|; below `ALIKE` a new curve begins.

**Whirl.** With the spin along n, e_1 x e_2 = n, a point goes round at u = u_1 e_1 + u_2 e_2 + u_3 n; the mean over the
points of the bodies that turn, weighed by their masses,

    w = sum -2 Im(conj(u_1) u_2) / sum |u|^2,

is 1 where all go round in circles in the sense of the spin (forward), -1 against it, 0 where they go to and fro.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from warpffrf.model import looks
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_array, require_count
from warpffrf.model.named_arguments import named_arguments
from warpffrf.model.scene import Scene
from warpffrf.output.modes_result import Modes, eigenmodes
from warpffrf.output.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray
TURN = 2.0 * np.pi
RIGID = 6  # motions of a body
ALIKE = 0.2  # MAC below which two modes are not one
SENSE = 0.1  # of the whirl: below it a mode goes neither forward nor backward
SAME_SPEED = 1e-3  # of the speed: a body that turns so much otherwise is said
ORDERS = (1.0, 2.0, 3.0)  # drawn unless others are given
SIZE = (8.0, 5.2)  # inches
FORWARD, BACKWARD, NEITHER, ORDER = "#1b6ca8", "#d1495b", "#6b7480", "0.55"


@dataclass(frozen=True)
class Crossing:
    """Where the curve `branch` meets an order: `speed` [rad/s], `frequency` [Hz], `whirl` [-] there."""

    branch: int
    order: float
    speed: float
    frequency: float
    whirl: float


@dataclass(frozen=True, eq=False, repr=False)
class Campbell(looks.Shown):
    """Modes against the speed of rotation; made by `campbell`. A row of the arrays is a speed, a column a curve, NaN
    where it has no mode among those asked for.

    `speeds` (s,) [rad/s], `frequencies` (s, b) [Hz], `damping_ratios` (s, b) [-], `whirl` (s, b) from -1, backward, to
    1, forward; `numbers` (s, b) of the modes in `modes` (s,), -1 where there is none. `co_rotating`: whether they are
    in axes that turn.
    """

    speeds: Array
    frequencies: Array
    damping_ratios: Array
    whirl: Array
    numbers: Array
    modes: list[Modes]
    co_rotating: bool
    notes: list[str] = field(default_factory=list)

    def _facts(self) -> dict[str, Any]:
        low, high = self.speeds.min(), self.speeds.max()
        return {"speeds": f"{len(self.speeds)} from {low:g} to {high:g} rad/s", "curves": self.frequencies.shape[1]}

    def critical_speeds(self, order: float = 1.0) -> list[Crossing]:
        """Where curves cross the line of `order`, f = order x speed/2 pi, by rising speed, linear between speeds."""
        rate = order * self.speeds / TURN
        found = []
        for b in range(self.frequencies.shape[1]):
            away = self.frequencies[:, b] - rate
            for s in np.flatnonzero((away[:-1] * away[1:] < 0.0) | ((away[:-1] == 0.0) & (self.speeds[:-1] > 0.0))):
                part = away[s] / (away[s] - away[s + 1])
                at = [float((1.0 - part) * v[s] + part * v[s + 1]) for v in (self.speeds, self.whirl[:, b])]
                found.append(Crossing(b, order, at[0], order * at[0] / TURN, at[1]))
        return sorted(found, key=lambda crossing: crossing.speed)

    def report(self, orders: Sequence[float] = (1.0,)) -> str:
        """Table of the frequencies by speed, marked f, b by the sense of their whirl, the critical speeds of `orders`,
        and notes."""
        axes = "axes that turn with the bodies" if self.co_rotating else "world axes"
        lines = [f"natural frequencies [Hz] against speed, {axes}", ""]
        lines.append("speed rad/s" + "".join(f"{f'curve {b}':>12}" for b in range(self.frequencies.shape[1])))
        for speed, row, whirl in zip(self.speeds, self.frequencies, self.whirl, strict=True):
            marks = [_sense(w)[0] if _sense(w) != "neither" else " " for w in whirl]
            cells = [f"{f:>10.5g} {m}" if np.isfinite(f) else 12 * " " for f, m in zip(row, marks, strict=True)]
            lines.append(f"{speed:>11.5g}" + "".join(f"{cell:>12}" for cell in cells))
        for order in orders:
            for c in self.critical_speeds(order):
                lines.append(f"order {order:g}: curve {c.branch} at {c.speed:.5g} rad/s, {c.frequency:.5g} Hz")
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    __str__ = report

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame`, a row for each mode: speed [rad/s], curve, mode, frequency [Hz], damping_ratio [-] and
        whirl [-]. Needs the optional package pandas, without which it raises ImportError."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_dataframe needs pandas: pip install 'warpffrf[tables]'") from error
        s, b = np.nonzero(self.numbers >= 0)
        columns = {
            "speed": self.speeds[s], "curve": b, "mode": self.numbers[s, b], "frequency": self.frequencies[s, b],
            "damping_ratio": self.damping_ratios[s, b], "whirl": self.whirl[s, b],
        }  # fmt: skip
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = {"speed": "rad/s", "frequency": "Hz", "damping_ratio": "-", "whirl": "-"}
        return frame

    def plot(self, ax: Axes | None = None, *, orders: Sequence[float] = ORDERS) -> Axes:
        """Draw the curves over the speed on the matplotlib axes `ax` (new ones when None) and return them: points of
        forward, backward and other modes in three colours, lines of `orders` dashed, their crossings marked."""
        axes: Any = _new_axes() if ax is None else ax
        rate = self.speeds / TURN
        for b in range(self.frequencies.shape[1]):
            axes.plot(rate, self.frequencies[:, b], color="0.8", lw=1.0, zorder=1)
        senses = np.array([[_sense(w) for w in row] for row in self.whirl])
        for name, color, mark in (("forward", FORWARD, "^"), ("backward", BACKWARD, "v"), ("neither", NEITHER, "o")):
            s, b = np.nonzero((senses == name) & np.isfinite(self.frequencies))
            if len(s):
                axes.plot(rate[s], self.frequencies[s, b], mark, color=color, ms=4.5, label=name, zorder=2)
        top = 1.08 * float(np.nanmax(self.frequencies, initial=0.0)) or 1.0
        last = float(rate.max())
        for order in orders:
            end = min(last, top / order) if order > 0.0 else last
            axes.plot([0.0, end], [0.0, order * end], "--", color=ORDER, lw=0.9, zorder=0)
            place: dict[str, Any] = {"xytext": (4, 0) if end == last else (4, -9), "textcoords": "offset points"}
            look: dict[str, Any] = {"fontsize": 8, "color": "0.35", "va": "center", "annotation_clip": False}
            axes.annotate(f"order {order:g}", (end, order * end), **place, **look)
            crossed = self.critical_speeds(order)
            axes.plot(
                [c.speed / TURN for c in crossed], [c.frequency for c in crossed], "o", ms=9.0, mfc="none",
                color="black", mew=0.8, zorder=3,
            )  # fmt: skip
        axes.set(xlim=(0.0, last or 1.0), ylim=(0.0, top))
        axes.set(xlabel="speed of rotation [turns/s]", ylabel="natural frequency [Hz]")
        turning = "axes that turn" if self.co_rotating else "world axes"
        axes.set_title(f"Campbell diagram, {turning}; circles: orders meet frequencies", fontsize=10)
        axes.grid(alpha=0.25)
        axes.legend(frameon=False, fontsize=8, loc="upper left", title="whirl", title_fontsize=8)
        return axes


def _sense(whirl: float) -> str:
    return "forward" if whirl > SENSE else "backward" if whirl < -SENSE else "neither"


def _new_axes() -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


@named_arguments
def campbell(
    build: Callable[[float], Scene | Result],
    speeds: Sequence[float] | Array,
    count: int = 12,
    *,
    progress: bool = False,
) -> Campbell:
    """Natural frequencies of a machine against the speed of its rotation: of the `count` lowest modes that have some,
    at each of `speeds` (s,) [rad/s].

    build(speed) makes the machine turning at the speed: a Scene, whose initial positions and velocities are meant, or
    the Result of a run or of `equilibrium`, whose last state is, for flexible bodies that the rotation stretches.
    progress: what takes long, on stderr. Raises InputError for speeds that do not rise or are negative, what is neither
    Scene nor Result, scenes of different bodies, and as `eigenmodes`. How it is done: `warpffrf.output.campbell`.
    """
    count = require_count(count, "campbell: count", 1)
    rates = require_array(speeds, "campbell: speeds", (None,))
    if not len(rates) or np.any(rates < 0.0) or np.any(np.diff(rates) <= 0.0):
        raise InputError("campbell: speeds must rise, and be 0 or more [rad/s]")
    if not callable(build):
        raise InputError(f"campbell: build must be a function of the speed that makes a scene, got {build!r}")
    modes = []
    for speed in rates:
        made = build(float(speed))
        if not isinstance(made, Scene | Result):
            raise InputError(f"campbell: build({speed:g}) must make a Scene or a Result, got {made!r}")
        scene, about = (made, "initial") if isinstance(made, Scene) else (made.scene, made)
        still = RIGID * len(scene.bodies)  # motions without stiffness at the most, which come first
        modes.append(eigenmodes(scene, count + still, about=about, progress=progress))
    if len({len(m.found.linear.M) for m in modes}) > 1:
        raise InputError("campbell: build must make the same bodies at every speed")
    return _linked(rates, modes, count, _doubts(rates, modes))


def _doubts(speeds: Array, modes: list[Modes]) -> list[str]:
    """What speaks against speeds and states."""
    notes = []
    passing = [speed for speed, found in zip(speeds, modes, strict=True) if any("not steady" in n for n in found.notes)]
    if passing:
        said = f"the state is not steady (bodies accelerate) at {len(passing)} of {len(speeds)} speeds"
        notes.append(f"{said}, from {passing[0]:.5g} rad/s on: the modes are those of the instant")
    turned = np.array([max((float(np.linalg.norm(w)) for w in _spins(m).values()), default=0.0) for m in modes])
    off = np.flatnonzero(np.abs(turned - speeds) > SAME_SPEED * np.maximum(speeds, 1.0))
    if len(off):
        notes.append(
            f"the fastest body turns otherwise than asked for at {len(off)} of {len(speeds)} speeds, as at "
            f"{turned[off[0]]:.5g} instead of {speeds[off[0]]:.5g} rad/s"
        )
    return notes


def _spins(modes: Modes) -> dict[str, Array]:
    """Angular velocities (3,) [rad/s, world] of the bodies that turn."""
    omega = modes.found.state["omega"][0]
    return {
        body.name: rot.matrix(modes.found.rotation[body.name]) @ omega[body.index]
        for body in modes.scene.bodies
        if body.name in modes.found.linear.turning
    }


def whirl_of(modes: Modes, i: int) -> float:
    """w of the module docstring of mode i; 0 where nothing turns, or what turns stands still in the mode."""
    about, size = 0.0, 0.0
    for name, spin in _spins(modes).items():
        body, n = modes.scene.body(name), spin / np.linalg.norm(spin)
        u = modes.displacement(i, name)
        if body.reduced is None:  # two points on its axis stand for it
            A, shape = rot.matrix(modes.found.rotation[name]), modes.shape(i, name)
            across = np.trace(body.inertia) - n @ (A @ body.inertia @ A.T) @ n  # J_1 + J_2
            arms = A @ body.center_of_mass + np.outer([1.0, -1.0], n) * np.sqrt(0.5 * across / body.mass)
            u = shape.translation + np.cross(shape.rotation, arms)
        e_1 = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
        e_1 /= np.linalg.norm(e_1)
        u_1, u_2 = u @ e_1, u @ np.cross(n, e_1)
        about += body.mass * float(np.mean(-2.0 * np.imag(u_1.conj() * u_2)))
        size += body.mass * float(np.mean(np.sum(np.abs(u) ** 2, axis=1)))
    return about / size if size > 0.0 else 0.0


def _linked(speeds: Array, modes: list[Modes], count: int, notes: list[str]) -> Campbell:
    """The first `count` modes with a frequency at each speed put into curves."""
    kept = [np.flatnonzero(m.frequencies > 0.0)[:count] for m in modes]
    curves = [{0: int(i)} for i in kept[0]]  # number of the speed -> mode, of every curve
    for s in range(1, len(modes)):
        open_ones = [c for c in curves if s - 1 in c]
        cost, alike = _costs(modes[s - 1], [c[s - 1] for c in open_ones], modes[s], kept[s])
        linked = {b: a for a, b in zip(*linear_sum_assignment(cost), strict=True) if alike[a, b] > ALIKE}
        for b, i in enumerate(kept[s]):
            if b in linked:
                open_ones[linked[b]][s] = int(i)
            else:
                curves.append({s: int(i)})
    numbers = np.full((len(modes), len(curves)), -1)
    for b, curve in enumerate(curves):
        numbers[list(curve), b] = list(curve.values())
    shape = numbers.shape
    frequencies, ratios, whirl = (np.full(shape, np.nan) for _ in range(3))
    for s, b in np.argwhere(numbers >= 0):
        i = int(numbers[s, b])
        frequencies[s, b], ratios[s, b] = modes[s].frequencies[i], modes[s].damping_ratios[i]
        whirl[s, b] = whirl_of(modes[s], i)
    co_rotating = any(m.found.linear.turning and m.found.linear.co_rotating for m in modes)
    return Campbell(speeds, frequencies, ratios, whirl, numbers, modes, co_rotating, notes)


def _costs(a: Modes, of_a: Sequence[int], b: Modes, of_b: Array) -> tuple[Array, Array]:
    """(modes of a, modes of b) what it costs to call two one curve, and their MAC."""
    T = b.found.linear.T
    M = T @ b.found.linear.M @ T.T
    x, y = a.found.linear.T @ a.found.vectors[:, list(of_a)], T @ b.found.vectors[:, of_b]
    mass = [np.real(np.einsum("in,ij,jn->n", v.conj(), M, v)) for v in (x, y)]
    alike = np.abs(x.conj().T @ M @ y) ** 2 / np.outer(*mass)
    ratio = np.abs(np.log(a.frequencies[list(of_a)][:, None] / b.frequencies[of_b]))
    return 1.0 - alike + ratio, alike
