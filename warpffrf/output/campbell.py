r"""Campbell diagrams: natural frequencies of a machine against its rotational speed, with order lines.

`eigenmodes` computes the modes about a rotating state, with gyroscopic, centrifugal and stiffening terms; here it is
called for each speed. Its coordinates are fixed in the world if the rotating bodies are rigid and symmetric, and rotate
with the bodies otherwise. A diagram has both frames.

**Frames.** About the spin axis n, at the angle theta of the body, a mode with k circumferential waves is, in
cylindrical components, u exp(i m theta) exp(lambda t), with m = -k if the pattern rotates in the sense of the spin
(forward) and m = k if it rotates against it. With theta = Theta - W t at the angle Theta of the world,

    lambda_fixed = lambda - i m W:     forward f + k W/2 pi, backward f - k W/2 pi.

Bending of the whole rotor has k = 1; extension and torsion have k = 0 and the same frequency in both frames. With
forward frequencies counted positive, curves are continuous: one that passes zero in one of the frames changes its sense
there. k maximises the sum over slices of the skin of the body with the largest motion, |sum u exp(-i m theta)|^2; a
rigid body has k = 1 if tilting and lateral motion exceed spin and axial motion.

**Unbalance** is constant in the rotating frame: it excites where a forward curve of k = 1 crosses order 1 in the fixed
frame, which is zero frequency in the rotating frame.

**Branches.** Modes of neighbouring speeds form a curve if their shapes correlate: with the mass matrix M, in axes of
the bodies, backward modes by their conjugates,

    MAC = |y_a^H M y_b|^2/(y_a^H M y_a  y_b^H M y_b),

modes are paired by the smallest sum of (1 - MAC) + 2 |f_a - f_b|/(f_a + f_b), fixed frame; below `ALIKE` a new curve
begins. Motions without oscillation form no curve: overdamped motions, and changes of the spin speed alone.

**Whirl.** With the spin along n, e_1 x e_2 = n, a point moves by u = u_1 e_1 + u_2 e_2 + u_3 n; the mean over the
points of the rotating bodies, weighted by their masses,

    w = sum -2 Im(conj(u_1) u_2) / sum |u|^2,

is 1 for circular orbits in the sense of the spin (forward), -1 against it, and 0 for motion along a line.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_array, require_count, suggestion
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.scene import Scene
from warpffrf.output.modes_result import Modes, eigenmodes
from warpffrf.output.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray
TURN = 2.0 * np.pi
ALL = 10**9  # modes: the lowest ones in the fixed frame are not known in advance
ALIKE = 0.2  # MAC below which two modes belong to different curves
SENSE = 0.1  # of the whirl: below it a mode is neither forward nor backward
MOST_WAVES = 6  # largest number of circumferential waves considered
SLICES = 16  # of a body along its axis
PLAINLY = 1.05  # times the sum of fewer waves: required to accept more; few circumferential points are ambiguous
SPINS = 0.99  # of the kinetic energy in the spin of bodies: above it the mode is no curve
SLOW = 1e-2  # of the speed of rotation: smallest frequency of a curve
GROWS = 1e-5  # negative damping ratio that exceeds round-off
FRAMES = ("fixed", "rotating")
SAME_SPEED = 1e-3  # of the speed: larger deviations of a body are reported
ORDERS = (1.0, 2.0, 3.0)  # default order lines
UNBALANCE = 1.0  # its order
SIZE = (8.0, 5.2)  # inches
FORWARD, BACKWARD, NEITHER, ORDER = "#1b6ca8", "#d1495b", "#6b7480", "0.55"

log = logging.getLogger("warpffrf")


@dataclass(frozen=True)
class Crossing:
    """Crossing of the curve `branch` with an order line in the fixed frame: `speed` [rad/s], `frequency` [Hz], `whirl`
    [-]."""

    branch: int
    order: float
    speed: float
    frequency: float
    whirl: float


@dataclass(frozen=True, eq=False, repr=False)
class Campbell(reprs.Shown):
    """Modes against rotational speed; returned by `campbell`. Rows of the arrays are speeds, columns are curves, NaN
    where a curve has no mode among the requested ones.

    `speeds` (s,) [rad/s]; `frequencies` (s, b) [Hz], `damping_ratios` (s, b) [-] and `whirl` (s, b) from -1, backward,
    to 1, forward, in the fixed frame, the world; `rotating_frequencies` (s, b) [Hz] in axes that rotate with the
    bodies; `waves` (s, b): circumferential waves, 1 for bending of the rotor, 0 for extension or torsion, -1 without
    rotation; `numbers` (s, b) of the modes in `modes` (s,), -1 for none. `notes`: limitations of the diagram.
    """

    speeds: Array
    frequencies: Array
    damping_ratios: Array
    whirl: Array
    rotating_frequencies: Array
    waves: Array
    numbers: Array
    modes: list[Modes]
    notes: list[str] = field(default_factory=list)

    def _facts(self) -> dict[str, Any]:
        low, high = self.speeds.min(), self.speeds.max()
        return {"speeds": f"{len(self.speeds)} from {low:g} to {high:g} rad/s", "curves": self.frequencies.shape[1]}

    def critical_speeds(self, order: float = UNBALANCE) -> list[Crossing]:
        """Crossings of curves with the line of `order` in the fixed frame, f = order x speed/2 pi, by ascending speed,
        linear between speeds. Order 1 is unbalance, which rotates with the rotor and bends it: only curves with one
        circumferential wave and a forward component are included. For other orders all curves are."""
        rate = order * self.speeds / TURN
        found = []
        for b in range(self.frequencies.shape[1]):
            away = self.frequencies[:, b] - rate
            for s in np.flatnonzero((away[:-1] * away[1:] < 0.0) | ((away[:-1] == 0.0) & (self.speeds[:-1] > 0.0))):
                part = away[s] / (away[s] - away[s + 1])
                at = [float((1.0 - part) * v[s] + part * v[s + 1]) for v in (self.speeds, self.whirl[:, b])]
                if order == UNBALANCE and (self.waves[s + 1, b] != 1 or at[1] < SENSE - 1.0):
                    continue
                found.append(Crossing(b, order, at[0], order * at[0] / TURN, at[1]))
        return sorted(found, key=lambda crossing: crossing.speed)

    def report(self, orders: Sequence[float] = (UNBALANCE,)) -> str:
        """Limitations of the diagram, tables of the frequencies by speed in the fixed frame, marked f or b by the sense
        of whirl, and in rotating axes, and the critical speeds of `orders` in the fixed frame."""
        lines = [*(f"CAUTION: {note}" for note in self.notes), ""] if self.notes else []
        for frame, values in (("the fixed frame", self.frequencies), ("axes that turn", self.rotating_frequencies)):
            lines += [f"natural frequencies [Hz] against speed, {frame}", ""]
            lines.append("speed rad/s" + "".join(f"{f'curve {b}':>12}" for b in range(values.shape[1])))
            for speed, row, whirl in zip(self.speeds, values, self.whirl, strict=True):
                fixed = values is self.frequencies
                marks = [_sense(w)[0] if fixed and _sense(w) != "neither" else " " for w in whirl]
                cells = [f"{f:>10.5g} {m}" if np.isfinite(f) else 12 * " " for f, m in zip(row, marks, strict=True)]
                lines.append(f"{speed:>11.5g}" + "".join(f"{cell:>12}" for cell in cells))
            lines.append("")
        for order in orders:
            what = "order 1 (unbalance)" if order == UNBALANCE else f"order {order:g}"
            crossed = self.critical_speeds(order)
            for c in crossed:
                lines.append(f"{what}: curve {c.branch} at {c.speed:.5g} rad/s, {c.frequency:.5g} Hz, fixed frame")
            if not crossed:
                lines.append(f"{what}: crosses no curve")
        return "\n".join(lines)

    __str__ = report

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` with one row per mode: speed [rad/s], curve, mode, frequency [Hz], damping_ratio [-] and
        whirl [-] in the fixed frame, rotating_frequency [Hz], waves [-]. Raises ImportError without the optional
        package pandas."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_dataframe needs pandas: pip install 'warpffrf[tables]'") from error
        s, b = np.nonzero(self.numbers >= 0)
        columns = {
            "speed": self.speeds[s], "curve": b, "mode": self.numbers[s, b], "frequency": self.frequencies[s, b],
            "damping_ratio": self.damping_ratios[s, b], "whirl": self.whirl[s, b],
            "rotating_frequency": self.rotating_frequencies[s, b], "waves": self.waves[s, b],
        }  # fmt: skip
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = {"speed": "rad/s", "frequency": "Hz", "damping_ratio": "-", "whirl": "-"}
        frame.attrs["units"] |= {"rotating_frequency": "Hz", "waves": "-"}
        return frame

    def plot(self, ax: Axes | None = None, *, orders: Sequence[float] = ORDERS, frame: str = "fixed") -> Axes:
        """Draw the curves over the speed on the matplotlib axes `ax` (new ones if None) and return them: points of
        forward, backward and other modes in three colours; in the "fixed" `frame` with dashed lines of `orders` and
        their marked crossings, in the "rotating" one with the crossings of unbalance. Raises InputError for another
        frame."""
        if frame not in FRAMES:
            raise InputError(f"plot: frame is {frame!r}{suggestion(str(frame), FRAMES)}")
        axes: Any = _new_axes() if ax is None else ax
        fixed = frame == FRAMES[0]
        values = self.frequencies if fixed else self.rotating_frequencies
        rate = self.speeds / TURN
        for b in range(values.shape[1]):
            axes.plot(rate, values[:, b], color="0.8", lw=1.0, zorder=1)
        senses = np.array([[_sense(w) for w in row] for row in self.whirl])
        for name, color, mark in (("forward", FORWARD, "^"), ("backward", BACKWARD, "v"), ("neither", NEITHER, "o")):
            s, b = np.nonzero((senses == name) & np.isfinite(values))
            if len(s):
                axes.plot(rate[s], values[s, b], mark, color=color, ms=4.5, label=name, zorder=2)
        top = 1.08 * float(np.nanmax(values, initial=0.0)) or 1.0
        last = float(rate.max())
        for order in orders if fixed else ():
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
        if not fixed:
            met = [c.speed / TURN for c in self.critical_speeds()]
            axes.plot(met, np.zeros(len(met)), "o", ms=9.0, mfc="none", color="black", mew=0.8, clip_on=False)
        axes.set(xlim=(0.0, last or 1.0), ylim=(0.0, top))
        axes.set(xlabel="speed of rotation [rev/s]", ylabel="natural frequency [Hz]")
        seen, met = ("fixed frame", "orders meet curves") if fixed else ("axes that turn", "unbalance meets curves")
        axes.set_title(f"Campbell diagram, {seen}; circles: {met}", fontsize=10)
        if self.notes:
            said = f"caution: {self.notes[0].split(';')[0]}"
            axes.text(0.99, 0.01, said, transform=axes.transAxes, fontsize=8, color=BACKWARD, ha="right", va="bottom")
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
    """Natural frequencies of a machine against its rotational speed: the `count` lowest modes in the fixed frame at
    each of `speeds` (s,) [rad/s], in the fixed frame and in axes that rotate with the bodies.

    build(speed) returns the machine rotating at the speed [rad/s]: a Scene, whose initial positions and velocities are
    used, or the Result of a run or `equilibrium`, whose last state is used, for flexible bodies that the rotation
    stretches: the state must be steady. Violations are logged as warnings and listed at the top of the report.
    progress: report the progress on stderr. Raises InputError for speeds that do not ascend or are negative, a return
    value that is neither Scene nor Result, scenes of different bodies, and as `eigenmodes`. Method:
    `warpffrf.output.campbell`.
    """
    count = require_count(count, "campbell: count", 1)
    rates = require_array(speeds, "campbell: speeds", (None,))
    if not len(rates) or np.any(rates < 0.0) or np.any(np.diff(rates) <= 0.0):
        raise InputError("campbell: speeds must ascend, and be 0 or more [rad/s]")
    if not callable(build):
        raise InputError(f"campbell: build must be a function of the speed that returns a scene, got {build!r}")
    modes = []
    for speed in rates:
        made = build(float(speed))
        if not isinstance(made, Scene | Result):
            raise InputError(f"campbell: build({speed:g}) must return a Scene or a Result, got {made!r}")
        scene, about = (made, "initial") if isinstance(made, Scene) else (made.scene, made)
        modes.append(eigenmodes(scene, ALL, about=about, progress=progress))
    if len({len(m.found.linear.M) for m in modes}) > 1:
        raise InputError("campbell: build must return the same bodies at every speed")
    doubts = _doubts(rates, modes)
    for doubt in doubts:
        log.warning("campbell: %s", doubt)
    return _linked(rates, modes, count, doubts)


def _doubts(speeds: Array, modes: list[Modes]) -> list[str]:
    """Notes on speeds and states that violate the assumptions."""
    notes = []
    passing = [speed for speed, found in zip(speeds, modes, strict=True) if any("not steady" in n for n in found.notes)]
    if passing:
        said = f"the state is not steady (bodies accelerate, or stretch) at {len(passing)} of {len(speeds)} speeds"
        notes.append(
            f"{said}, from {passing[0]:.5g} rad/s on: the modes are those of the instant, and may be far off; let "
            "build return the Result of a run that has settled, with damping"
        )
    turned = np.array([max((float(np.linalg.norm(w)) for w in _spins(m).values()), default=0.0) for m in modes])
    off = np.flatnonzero(np.abs(turned - speeds) > SAME_SPEED * np.maximum(speeds, 1.0))
    if len(off):
        notes.append(
            f"the speed of the fastest body differs from the requested one at {len(off)} of {len(speeds)} speeds: "
            f"{turned[off[0]]:.5g} instead of {speeds[off[0]]:.5g} rad/s"
        )
    rates = [np.linalg.norm(list(_spins(m).values()), axis=1) for m in modes if _spins(m)]
    if any(rate.min() < (1.0 - SAME_SPEED) * rate.max() for rate in rates):
        notes.append(
            "bodies rotate at different speeds: a mode is transformed to the fixed frame with the speed of the body "
            "that it moves most"
        )
    return notes


def _spins(modes: Modes) -> dict[str, Array]:
    """Angular velocities (3,) [rad/s, world] of the rotating bodies."""
    omega = modes.found.state["omega"][0]
    return {
        body.name: rot.matrix(modes.found.rotation[body.name]) @ omega[body.index]
        for body in modes.scene.bodies
        if body.name in modes.found.linear.turning
    }


def whirl_of(modes: Modes, i: int) -> float:
    """w of the module docstring for mode i; 0 without rotation, or if the rotating bodies do not move in the mode."""
    about, size = 0.0, 0.0
    for name, spin in _spins(modes).items():
        body, n = modes.scene.body(name), spin / np.linalg.norm(spin)
        u = modes.displacement(i, name)
        if body.reduced is None:  # represented by two points on its axis
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


@dataclass(frozen=True)
class _Seen:
    """Mode `number` in both frames: signed eigenvalues [1/s], imaginary part positive for forward modes; `whirl` in the
    fixed frame, circumferential `waves`, and `shape` in axes of the bodies, the conjugate for backward modes."""

    number: int
    fixed: complex
    rotating: complex
    whirl: float
    waves: int
    shape: Array

    @property
    def frequency(self) -> float:
        """Hz, fixed frame."""
        return abs(self.fixed) / TURN


def _seen(modes: Modes, i: int) -> _Seen | None:
    """Mode i; None if it is no curve."""
    value, linear = complex(modes.eigenvalues[i]), modes.found.linear
    if value.imag <= 0.0:
        return None
    spins, shares = _spins(modes), modes.energy_shares(i)
    name = max(shares, key=lambda body: shares[body])
    shape = modes.found.vectors[:, i] if linear.co_rotating else _axes_of_bodies(modes).T @ modes.found.vectors[:, i]
    if name not in spins:
        return _Seen(i, value, value, 0.0, -1 if not spins else 0, shape)
    speed = float(np.linalg.norm(spins[name]))
    if abs(value) < SLOW * speed and _spin_share(modes, i, spins) > SPINS:
        return None
    waves, whirl = _waves(modes, i, name, spins[name] / speed)
    if waves == 1:
        whirl = whirl_of(modes, i)
    sense = -1.0 if waves and whirl < 0.0 else 1.0
    signed, shift = complex(value.real, sense * value.imag), 1j * waves * speed
    fixed, rotating = (signed + shift, signed) if linear.co_rotating else (signed, signed - shift)
    shape = shape.conj() if sense < 0.0 and abs(whirl) > SENSE else shape
    return _Seen(i, fixed, rotating, float(np.copysign(abs(whirl), fixed.imag)), waves, shape)


def _axes_of_bodies(modes: Modes) -> Array:
    """R (n, n): coordinates in axes of the bodies -> in the world's, for positions and rotations."""
    R = np.eye(len(modes.found.linear.M))
    for body in modes.scene.bodies:
        A = rot.matrix(modes.found.rotation[body.name])
        for first in (6 * body.index, 6 * body.index + 3):
            R[first : first + 3, first : first + 3] = A
    return R


def _energies(modes: Modes, i: int, name: str, n: Array) -> tuple[float, float, float]:
    """Rigid-body kinetic energies of mode i, times two: lateral and tilting, axial, and spin about n."""
    body, shape, A = modes.scene.body(name), modes.shape(i, name), rot.matrix(modes.found.rotation[name])
    v = shape.translation + np.cross(shape.rotation, A @ body.center_of_mass)
    J, spin = A @ body.inertia @ A.T, (shape.rotation @ n)
    leans = shape.rotation - spin * n
    aside = body.mass * np.sum(np.abs(v - (v @ n) * n) ** 2) + np.real(leans.conj() @ J @ leans)
    return float(aside), float(body.mass * np.abs(v @ n) ** 2), float((n @ J @ n) * np.abs(spin) ** 2)


def _spin_share(modes: Modes, i: int, spins: dict[str, Array]) -> float:
    """Fraction of the kinetic energy of mode i (y^H M y = 1) that is spin of the rotating bodies."""
    return sum(_energies(modes, i, name, spin / np.linalg.norm(spin))[2] for name, spin in spins.items())


def _waves(modes: Modes, i: int, name: str, n: Array) -> tuple[int, float]:
    """Circumferential waves k of mode i on the body `name` about n, and its forward minus backward part, -1 to 1."""
    body = modes.scene.body(name)
    if body.reduced is None:
        aside, along, spin = _energies(modes, i, name, n)
        return int(aside > along + spin), 0.0
    A = rot.matrix(modes.found.rotation[name])
    x = (body.reduced.surface.points - body.center_of_mass) @ A.T
    along = x @ n
    radial = x - along[:, None] * n
    radius = np.linalg.norm(radial, axis=1)
    off = radius > 1e-6 * radius.max()
    e_r = radial[off] / radius[off, None]
    e_t = np.cross(n, e_r)
    u = modes.displacement(i, name)[off]
    u = np.stack([np.sum(u * e_r, axis=1), np.sum(u * e_t, axis=1), u @ n])
    e_1 = e_r[0]
    theta = np.arctan2(e_r @ np.cross(n, e_1), e_r @ e_1)
    slices = np.floor(SLICES * (along[off] - along.min()) / max(float(np.ptp(along)), 1e-300)).clip(0, SLICES - 1)
    order = np.argsort(slices, kind="stable")
    _, starts, counts = np.unique(slices[order], return_index=True, return_counts=True)

    def part(m: int) -> float:
        sums = np.add.reduceat((u * np.exp(-1j * m * theta))[:, order], starts, axis=1)
        return float(np.sum(np.abs(sums) ** 2 / counts))

    best, most, whirl = 0, part(0), 0.0
    for k in range(1, MOST_WAVES + 1):
        forward, backward = part(-k), part(k)
        if forward + backward > PLAINLY * most:
            best, most, whirl = k, forward + backward, (forward - backward) / (forward + backward)
    return best, whirl


def _lowest(modes: Modes, count: int) -> list[_Seen]:
    """The `count` modes of lowest frequency in the fixed frame, ascending."""
    fastest = max((float(np.linalg.norm(w)) for w in _spins(modes).values()), default=0.0)
    reach = MOST_WAVES * fastest / TURN if modes.found.linear.co_rotating else 0.0
    found: list[_Seen] = []
    for i, frequency in enumerate(modes.frequencies):
        if len(found) >= count and frequency - reach > found[count - 1].frequency:
            break
        if (seen := _seen(modes, i)) is not None:
            found = sorted([*found, seen], key=lambda one: one.frequency)
    return found[:count]


def _linked(speeds: Array, modes: list[Modes], count: int, notes: list[str]) -> Campbell:
    """The lowest `count` modes at each speed linked to curves."""
    kept = [_lowest(m, count) for m in modes]
    curves = [{0: seen} for seen in kept[0]]  # for every curve: index of the speed -> mode
    for s in range(1, len(modes)):
        open_ones = [c for c in curves if s - 1 in c]
        cost, alike = _costs([c[s - 1] for c in open_ones], kept[s], modes[s])
        linked = {b: a for a, b in zip(*linear_sum_assignment(cost), strict=True) if alike[a, b] > ALIKE}
        for b, seen in enumerate(kept[s]):
            if b in linked:
                open_ones[linked[b]][s] = seen
            else:
                curves.append({s: seen})
    shape = (len(modes), len(curves))
    numbers, waves = np.full(shape, -1), np.full(shape, -1)
    frequencies, ratios, whirl, rotating = (np.full(shape, np.nan) for _ in range(4))
    for b, curve in enumerate(curves):
        for s, seen in curve.items():
            numbers[s, b], waves[s, b], whirl[s, b] = seen.number, seen.waves, seen.whirl
            frequencies[s, b], rotating[s, b] = seen.frequency, abs(seen.rotating) / TURN
            ratios[s, b] = -seen.fixed.real / abs(seen.fixed)
    if growing := _growing(speeds, ratios):
        log.warning("campbell: %s", growing)
    said = [*notes, growing] if growing else notes
    return Campbell(speeds, frequencies, ratios, whirl, rotating, waves, numbers, modes, said)


def _growing(speeds: Array, ratios: Array) -> str:
    """Text on curves with negative damping, or an empty string."""
    below = ratios < -GROWS
    found = [f"{b} from {speeds[np.argmax(below[:, b])]:.5g} rad/s on" for b in np.flatnonzero(below.any(axis=0))]
    if not found:
        return ""
    return (
        f"motions grow (negative damping): curve {', '.join(found)}; damping= of a rotating body is internal "
        "(rotating) damping, which destabilises whirl above the critical speed: dampers to the ground stabilise it"
    )


def _costs(a: list[_Seen], b: list[_Seen], at: Modes) -> tuple[Array, Array]:
    """(modes of a, modes of b) cost of linking two modes, and their MAC; b are modes of `at`."""
    if not a or not b:
        return np.zeros((len(a), len(b))), np.zeros((len(a), len(b)))
    R = np.eye(len(at.found.linear.M)) if at.found.linear.co_rotating else _axes_of_bodies(at)
    M = R.T @ at.found.linear.M @ R
    x, y = (np.stack([seen.shape for seen in side], axis=1) for side in (a, b))
    mass = [np.real(np.einsum("in,ij,jn->n", v.conj(), M, v)) for v in (x, y)]
    alike = np.abs(x.conj().T @ M @ y) ** 2 / np.outer(*mass)
    f, g = np.array([seen.frequency for seen in a])[:, None], np.array([seen.frequency for seen in b])
    return 1.0 - alike + 2.0 * np.abs(f - g) / np.maximum(f + g, 1e-300), alike
