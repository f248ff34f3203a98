r"""Loops of force against displacement: loss per cycle, equivalent damping, stiffness against load.

Channels. One scalar history of a run, by the name of its owner and its component, as an axis of a loop.

("push", "x")              x of a force, a joint's reaction, a contact or film [N], of a body's position [m]
("push", "torque_z")       a torque [N m]
("tip", "x")               a component of a sensor
"hinge"                    a joint's coordinate, a sensor with one component, a spring with one deformation
("joint", "hinge", "x")    with its kind, if items of several kinds have the name
array (T,)                 any history

Cycles. Times at which cycles begin and end, and values between saved steps.

Hysteresis. Force against displacement over a run: loops, their losses, equivalent damping, stiffness against load.

For a cycle from t_0 to t_1, with the force F that does work on the displacement x, linear between saved steps,

    W = int F dx = sum_i (F_i + F_(i+1)) (x_(i+1) - x_i) / 2,       the ends joined        work [J]
    D = |W|                                                         loss per cycle [J]
    F_a = (max F - min F)/2,   x_a = (max x - min x)/2              amplitudes
    k_s = F_a / x_a                                                 secant stiffness
    U = F_a x_a / 2                                                 of a spring k_s the strain energy at the reversal
    zeta = D / (4 pi U)                                             equivalent damping ratio [-]

zeta is the damping ratio of the linear oscillator of stiffness k_s with the same loss per cycle at the same amplitude
and at its eigenfrequency (L. S. Jacobsen, Trans. ASME 52 (1930) 169). An elastic loop has 0; sliding at a constant
friction bound has D = 4 F_a x_a, the bounding box of the loop, and 2/pi, the maximum. U does not include the energy of
constant preloads, because only ranges enter. The sign of W is that of the given force, a reaction or an applied one; D
has no sign.

Moments against angles are treated in the same way, in N m and rad. The trapezoidal rule is exact if force and
displacement are linear between saved steps; for a smooth loop of n equal steps it is too small by about (2 pi/n)^2/6.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.messages import reprs

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Channel:
    """Values (T,), their name, and their unit."""

    values: np.ndarray
    label: str
    unit: str


Components = dict[str, tuple[np.ndarray, str]]


def channel(result: Any, what: Any, unit: str, label: str) -> Channel:
    """The channel named by `what` (module docstring) in a `Result`; an array gets `label` and `unit`. Raises
    `InputError`, listing the available ones, for an unknown name, kind or component."""
    if not isinstance(what, str | tuple):
        values = np.asarray(what, dtype=float)
        if values.shape != (len(result.time),):
            raise InputError(
                f"hysteresis: {label} must have a value for each of the {len(result.time)} saved steps, got an array "
                f"of shape {values.shape}"
            )
        return Channel(values, label, unit)
    kind, name, component = _parts(what)
    found = [known for known, (names, _) in _OWNERS.items() if kind in (known, None) and name in names(result)]
    if not found:
        known = dict.fromkeys(n for k, (names, _) in _OWNERS.items() if kind in (k, None) for n in names(result))
        raise unknown_name(f"hysteresis: {kind or 'name'}", name, tuple(known))
    if len(found) > 1:
        raise InputError(f"hysteresis: {name!r} is a {' and a '.join(found)}; give ({found[0]!r}, {name!r}, component)")
    components = _OWNERS[found[0]][1](result, name)
    if component is None:
        own = [key for key in components if len(components) == 1 or key not in _VECTORS]
        if len(own) != 1:
            raise InputError(
                f"hysteresis: {found[0]} {name!r} has several components; give ({name!r}, component), one of "
                f"{', '.join(map(repr, components))}"
            )
        component = own[0]
    if component not in components:
        raise unknown_name(f"hysteresis: component of {found[0]} {name!r}", component, tuple(components))
    values, its_unit = components[component]
    return Channel(np.asarray(values, dtype=float), f"{name} {component}".replace("_", " "), its_unit)


def _parts(what: Any) -> tuple[str | None, str, str | None]:
    parts = (what,) if isinstance(what, str) else what
    if not 1 <= len(parts) <= 3 or not all(isinstance(part, str) for part in parts):
        raise InputError(
            f"hysteresis: give a name, (name, component), (kind, name, component) or an array, got {what!r}"
        )
    if len(parts) == 3:
        if parts[0] not in _OWNERS:
            raise unknown_name("hysteresis: kind", parts[0], tuple(_OWNERS))
        return parts[0], parts[1], parts[2]
    return None, parts[0], parts[1] if len(parts) == 2 else None


def _vectors(force: np.ndarray, torque: np.ndarray | None = None) -> Components:
    found: Components = {axis: (force[:, n], "N") for n, axis in enumerate(AXES)}
    if torque is not None:
        found |= {f"torque_{axis}": (torque[:, n], "N m") for n, axis in enumerate(AXES)}
    return found


_VECTORS = {*AXES, *(f"torque_{axis}" for axis in AXES)}  # components that are not the default of a bare name


def _joint(result: Any, name: str) -> Components:
    joint = result.joint(name)
    named: Components = {key: (joint.named(key), "rad" if key.endswith("rotation") else "m") for key in joint.names}
    return named | _vectors(joint.force, joint.torque)


def _force(result: Any, name: str) -> Components:
    force = result.force(name)
    count = force.deformation.shape[1]
    keys = ["deformation"] if count == 1 else [f"deformation_{n}" for n in range(count)]
    found = {key: (force.deformation[:, n], "m or rad") for n, key in enumerate(keys)}
    return found | _vectors(force.force, force.torque)


def _sensor(result: Any, name: str) -> Components:
    sensor = result.sensor(name)
    return {key: (values, sensor.unit) for key, values in zip(sensor.components, sensor.values.T, strict=True)}


def _contact(result: Any, name: str) -> Components:
    contact = result.contact(name)
    found = _vectors(contact.force, contact.torque)
    if name not in result.small_sliding_names:
        return found
    found |= {"normal_force": (contact.normal_force, "N")}
    found |= {f"sliding_{axis}": (contact.sliding[:, n], "m") for n, axis in enumerate(AXES)}
    return found | {f"turning_{axis}": (contact.turning[:, n], "rad") for n, axis in enumerate(AXES)}


def _body(result: Any, name: str) -> Components:
    position = result.body(name).position
    return {axis: (position[:, n], "m") for n, axis in enumerate(AXES)}


Owner = tuple[Callable[[Any], list[str]], Callable[[Any, str], Components]]
_OWNERS: dict[str, Owner] = {
    "force": (lambda r: list(r.history.forces), _force),
    "sensor": (lambda r: r.sensor_names, _sensor),
    "joint": (lambda r: list(r.history.joints), _joint),
    "contact": (lambda r: r.contact_names, _contact),
    "film": (lambda r: r.film_names, lambda r, n: _vectors(r.film(n).force, r.film(n).torque)),
    "body": (lambda r: list(r.history.bodies), _body),
}


SAME = 1e-9  # of the run: times closer than this are equal


def cycle_times(time: np.ndarray, cycles: float | Sequence[float] | np.ndarray, label: str) -> np.ndarray:
    """Begins and ends (n + 1,) [s] of n cycles: with a period [s] the whole cycles from the first saved time on, else
    the given times. Raises `InputError`, naming `label`, for a period that is not positive or longer than the run, and
    times that do not ascend."""
    given = np.asarray(cycles, dtype=float)
    span = float(time[-1] - time[0]) if len(time) else 0.0
    if given.ndim == 0:
        period = float(given)
        if not np.isfinite(period) or period <= 0.0:
            raise InputError(f"{label}: the period of a cycle must be positive, got {period:g} s")
        count = int(np.floor(span / period * (1.0 + SAME)))
        if count < 1:
            raise InputError(f"{label}: a cycle of {period:g} s is longer than the {span:g} s that were saved")
        return np.minimum(time[0] + period * np.arange(count + 1), time[-1])
    if given.ndim != 1 or len(given) < 2 or not np.all(np.diff(given) > 0.0):
        raise InputError(f"{label}: give the period of a cycle, or ascending times at which cycles begin and end")
    return given


def value_at(time: np.ndarray, values: np.ndarray, at: np.ndarray, label: str) -> np.ndarray:
    """`values` (T, ...) at the times `at` (n,) [s], linear between saved steps: (n, ...). Raises `InputError`, naming
    `label`, for times outside of the run."""
    if not len(time):
        raise InputError(f"{label}: the run has no saved row")
    slack = SAME * max(float(time[-1] - time[0]), abs(float(time[-1])))
    if not np.all((at >= time[0] - slack) & (at <= time[-1] + slack)):
        raise InputError(
            f"{label}: the saved steps go from {time[0]:g} to {time[-1]:g} s, and "
            f"{', '.join(f'{t:g}' for t in np.ravel(at))} s are asked for"
        )
    if len(time) == 1:
        return np.repeat(values, len(at), axis=0)
    after = np.clip(np.searchsorted(time, at), 1, len(time) - 1)
    share = np.clip((at - time[after - 1]) / (time[after] - time[after - 1]), 0.0, 1.0)
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return values[after - 1] * (1.0 - share) + values[after] * share


def piece(time: np.ndarray, values: np.ndarray, begin: float, end: float, label: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and `values` (T, ...) from `begin` to `end` [s], both included, with the saved steps in between."""
    ends = value_at(time, values, np.array([begin, end]), label)
    inside = (time > begin) & (time < end)
    return (np.concatenate([[begin], time[inside], [end]]), np.concatenate([ends[:1], values[inside], ends[1:]]))


log = logging.getLogger("warpffrf")

CLOSED = 0.05  # of the range: cycles that are open by more are reported
STANDS = 1e-9  # of the range of displacements: smaller steps have no tangent stiffness
LOOP, LAST = "#9db4c6", "#1b6ca8"
SECANT, TANGENT = "#1b6ca8", "#d1495b"


@dataclass(frozen=True, eq=False, repr=False)
class Loop(reprs.Shown):
    """One cycle: `time`, `force` and `displacement` (n,), as given; quantities as in the module docstring."""

    time: np.ndarray
    force: np.ndarray
    displacement: np.ndarray

    def _facts(self) -> dict[str, Any]:
        names = ("loss", "force_amplitude", "amplitude", "stiffness", "equivalent_damping", "open")
        return {name: f"{getattr(self, name):.4g}" for name in names}

    @cached_property
    def work(self) -> float:
        """int F dx over the cycle [J], with the ends joined by a straight line."""
        F, x = np.append(self.force, self.force[0]), np.append(self.displacement, self.displacement[0])
        return float(np.trapezoid(F - F.mean(), x - x.mean()))

    @property
    def loss(self) -> float:
        """Loss per cycle [J], the area of the loop."""
        return abs(self.work)

    @property
    def force_amplitude(self) -> float:
        """Half the range of the force [N, N m]."""
        return 0.5 * float(np.ptp(self.force))

    @property
    def amplitude(self) -> float:
        """Half the range of the displacement [m, rad]."""
        return 0.5 * float(np.ptp(self.displacement))

    @property
    def stiffness(self) -> float:
        """Secant stiffness between the reversals, F_a/x_a [N/m, N m/rad]; NaN without motion."""
        return self.force_amplitude / self.amplitude if self.amplitude > 0.0 else float("nan")

    @property
    def strain_energy(self) -> float:
        """U [J]: strain energy at the reversal of a spring with the secant stiffness."""
        return 0.5 * self.force_amplitude * self.amplitude

    @property
    def equivalent_damping(self) -> float:
        """Damping ratio D/(4 pi U) [-]; NaN without force or motion."""
        return equivalent_damping(self.loss, self.strain_energy)

    @property
    def open(self) -> float:
        """Distance between begin and end over the range [-], of displacement or force, whichever is larger: 0 for a
        closed loop; above a few hundredths loss and damping are not meaningful."""
        apart = [
            abs(float(v[-1] - v[0])) / float(np.ptp(v)) for v in (self.force, self.displacement) if np.ptp(v) > 0.0
        ]
        return max(apart, default=0.0)


def equivalent_damping(loss: float, strain_energy: float) -> float:
    """Damping ratio D/(4 pi U) [-] of a loss per cycle [J] and the peak strain energy of the cycle [J], such as the
    loss of a joint interface and the energy of its machine; NaN without strain energy."""
    return loss / (4.0 * np.pi * strain_energy) if strain_energy > 0.0 else float("nan")


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Stiffness against load along a history: `load` and `displacement` (T,), `secant` (T,) from the first row, (F -
    F_0)/(x - x_0), and `tangent` (T,) of the step before each row, dF/dx; NaN without motion."""

    load: np.ndarray
    displacement: np.ndarray
    secant: np.ndarray
    tangent: np.ndarray
    label: str  # of the load, with its unit
    unit: str  # of stiffness

    def draw(self, ax: Any) -> None:
        """Secant and tangent stiffness against the load, on matplotlib axes."""
        ax.plot(self.load, self.secant, ".-", lw=1.2, ms=3.5, color=SECANT, label="secant, from the first row")
        ax.plot(self.load, self.tangent, ".-", lw=1.0, ms=3.5, color=TANGENT, label="tangent, of each step")
        ax.set(xlabel=self.label, ylabel=f"stiffness [{self.unit}]")
        ax.set_ylim(bottom=min(0.0, float(np.nanmin(self.secant, initial=0.0))))
        ax.set_title("Stiffness against load", fontsize=10)
        ax.legend(frameon=False, fontsize=8)


@dataclass(frozen=True, eq=False, repr=False)
class Hysteresis(reprs.Shown):
    """A `force` (T,) [N, N m] against a `displacement` (T,) [m, rad] over the saved times (T,) [s], made by
    `Result.hysteresis`.
    force_label, displacement_label, force_unit, displacement_unit: words on axes."""

    time: np.ndarray
    force: np.ndarray
    displacement: np.ndarray
    force_label: str = "force"
    displacement_label: str = "displacement"
    force_unit: str = "N"
    displacement_unit: str = "m"

    def _facts(self) -> dict[str, Any]:
        time = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else "none"
        return {"force": self.force_label, "displacement": self.displacement_label, "time": time}

    def loop(self, begin: float | None = None, end: float | None = None) -> Loop:
        """The cycle between the times `begin` and `end` [s], None: the whole history; a warning where it is not closed.
        Raises `InputError` for times outside of it."""
        begin = float(self.time[0]) if begin is None else begin
        end = float(self.time[-1]) if end is None else end
        loop = self._loop(begin, end)
        if loop.open > CLOSED:
            log.warning(
                "hysteresis: the cycle from %.4g to %.4g s is open by %.2g of its range, so that its loss and damping "
                "are not meaningful; take times that are a period apart, or a later cycle", begin, end, loop.open
            )  # fmt: skip
        return loop

    def _loop(self, begin: float, end: float) -> Loop:
        time, both = piece(self.time, np.stack([self.force, self.displacement], axis=1), begin, end, "hysteresis")
        return Loop(time, both[:, 0], both[:, 1])

    def cycles(self, cycles: float | Sequence[float] | np.ndarray) -> list[Loop]:
        """Each cycle; cycles: their period [s], or times [s], as in `SmallSlidingResult.loss_per_cycle`."""
        edges = cycle_times(self.time, cycles, "hysteresis")
        return [self._loop(float(begin), float(end)) for begin, end in zip(edges[:-1], edges[1:], strict=True)]

    def stiffness(self, begin: float | None = None, end: float | None = None) -> Stiffness:
        """Secant and tangent stiffness between the times `begin` and `end` [s], such as of a slowly increasing load.
        Raises `InputError` for times outside of the run."""
        part = self._loop(float(self.time[0] if begin is None else begin), float(self.time[-1] if end is None else end))
        F, x = part.force, part.displacement
        least = STANDS * float(np.ptp(x))
        moved, step = x - x[0], np.diff(x)
        secant, tangent = np.full(len(x), np.nan), np.full(len(x), np.nan)
        np.divide(F - F[0], moved, out=secant, where=np.abs(moved) > least)
        np.divide(np.diff(F), step, out=tangent[1:], where=np.abs(step) > least)
        label = f"{self.force_label} [{self.force_unit}]"
        return Stiffness(F, x, secant, tangent, label, f"{self.force_unit}/{self.displacement_unit}")

    def draw(self, ax: Any, cycles: float | Sequence[float] | np.ndarray | None = None) -> None:
        """Draw force against displacement on matplotlib axes `ax`; with `cycles`, a period or times [s], the last cycle
        is drawn on top, with its loss and equivalent damping. `save_panels` accepts it like other plots."""
        ax.plot(self.displacement, self.force, lw=1.0, color=LOOP if cycles is not None else LAST)
        title = "Hysteresis"
        if cycles is not None:
            loop = self.cycles(cycles)[-1]
            x, F = np.append(loop.displacement, loop.displacement[0]), np.append(loop.force, loop.force[0])
            ax.plot(x, F, lw=1.5, color=LAST)
            title += f", last cycle: loss {loop.loss:.4g} J, equivalent damping {loop.equivalent_damping:.3g}"
        ax.set(
            xlabel=f"{self.displacement_label} [{self.displacement_unit}]",
            ylabel=f"{self.force_label} [{self.force_unit}]",
        )
        ax.axhline(0.0, color="0.85", lw=0.6, zorder=0)
        ax.set_title(title, fontsize=10)
