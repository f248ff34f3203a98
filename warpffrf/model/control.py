r"""Controllers of a `Simulation`: sampled blocks between an output and an input.

A block is evaluated before a step, at the time t_n, from the outputs at t_n. Its input is the error

    e_n = reference(t_n) - measure(t_n),        or the measure itself without a reference,

and its command is what the inputs of the scene reach at the end of that step. The block itself is exact for an error
that is constant between two samples (zero-order hold): with x' = A x + B e, u = C x + D e and the sample time T,

    u_n = C x_n + D e_n,    x_{n+1} = Ad x_n + Bd e_n,    [Ad Bd; 0 1] = exp([A B; 0 0] T).

PID with a filtered derivative, u = kp e + ki int e dt + kd (e - x_f)/T_f with T_f x_f' = e - x_f, is such a block. With
limits its command is clipped, and its integral stands still while a larger integral would only exceed them further.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import Input, Signal, SignalLike, as_signal

__all__ = ["PID", "Controller", "StateSpace", "Table", "TransferFunction"]


def __dir__() -> list[str]:
    return __all__


class Sampled(ABC):
    """A block at its samples, with its `state`, a vector."""

    state: np.ndarray = np.zeros(0)

    @abstractmethod
    def command(self, error: np.ndarray) -> np.ndarray:
        """The commands of this sample; goes on to the next one."""


@named_arguments
class Controller:
    """Base of the controllers. measures: outputs by name, each one number; targets: `signals.Input`s, or their names;
    references: one number or signal for each measure, in its unit, or none; every: steps between two samples. Raises
    `InputError`."""

    def __init__(
        self, measures: Sequence[str], targets: Sequence[Input | str], references: Sequence[SignalLike], every: int
    ) -> None:
        label = type(self).__name__
        self.measures = tuple(measures)
        self.targets = tuple(target.name if isinstance(target, Input) else target for target in targets)
        for what, names in (("measure", self.measures), ("target", self.targets)):
            if not names or not all(isinstance(name, str) for name in names):
                raise InputError(f"{label}: {what} must be a name, or a signals.Input as target, got {names!r}")
        self.references: tuple[Signal, ...] = tuple(as_signal(one, f"{label}: reference") for one in references)
        if self.references and len(self.references) != len(self.measures):
            raise InputError(
                f"{label}: {len(self.references)} references for {len(self.measures)} measures; give one each, or none"
            )
        self.every = require_count(every, f"{label}: every", 1)

    def sampled(self, sample: float) -> Sampled:
        """A new block with the sample time `sample` [s]."""
        raise TypeError(f"{type(self).__name__} does not define its sampled block")


def error_of(controller: Controller, t: float, measured: np.ndarray) -> np.ndarray:
    """The input (n,) of a block at the time `t` [s]: references minus `measured` (n,), or the latter themselves."""
    if not controller.references:
        return measured
    return np.array([float(reference(t)) for reference in controller.references]) - measured


class _Linear(Sampled):
    """x_{n+1} = A x + B e, u = C x + D e."""

    def __init__(self, A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, state: np.ndarray) -> None:
        self.A, self.B, self.C, self.D, self.state = A, B, C, D, state

    def command(self, error: np.ndarray) -> np.ndarray:
        found = self.C @ self.state + self.D @ error
        self.state = self.A @ self.state + self.B @ error
        return found


class _Limited(_Linear):
    """A PID whose first state is its integral, with limits of its command."""

    limits: tuple[float, float] = (-np.inf, np.inf)

    def command(self, error: np.ndarray) -> np.ndarray:
        integral = self.state[0]
        wanted = super().command(error)
        found = np.clip(wanted, *self.limits)
        further = (wanted[0] - found[0]) * self.C[0, 0] * error[0] > 0.0
        if further:
            self.state[0] = integral
        return found


@named_arguments
class StateSpace(Controller):
    """x' = A x + B e, u = C x + D e, with A (n, n), B (n, m), C (k, n), D (k, m), of m measures and k targets, and
    `initial` x (n,), zero if it is not given. reference: one for each measure, or none. A (0, 0) for gains alone.
    Raises `InputError`."""

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        D: Matrix,
        *,
        measures: Sequence[str],
        targets: Sequence[Input | str],
        references: Sequence[SignalLike] = (),
        initial: Vector | None = None,
        every: int = 1,
    ) -> None:
        super().__init__(measures, targets, references, every)
        label, m, k = type(self).__name__, len(self.measures), len(self.targets)
        self.A = np.zeros((0, 0)) if not len(A) else require_array(A, f"{label}: A", (None, None))
        n = len(self.A)
        if self.A.shape != (n, n):
            raise InputError(f"{label}: A must be square, got {self.A.shape}")
        empty = {"B": np.zeros((0, m)), "C": np.zeros((k, 0))} if n == 0 else {}
        self.B, self.C, self.D = (
            empty[name] if name in empty else require_array(given, f"{label}: {name}", shape)
            for name, given, shape in (("B", B, (n, m)), ("C", C, (k, n)), ("D", D, (k, m)))
        )
        self.initial = np.zeros(n) if initial is None else require_array(initial, f"{label}: initial", (n,))

    def sampled(self, sample: float) -> Sampled:
        return _Linear(*self._discrete(sample), self.initial.copy())

    def _discrete(self, sample: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """A, B, C, D for an error that is constant between samples."""
        from scipy.linalg import expm

        n, m = self.B.shape
        whole = np.zeros((n + m, n + m))
        whole[:n, :n], whole[:n, n:] = self.A, self.B
        both = np.asarray(expm(sample * whole))
        return both[:n, :n], both[:n, n:], self.C, self.D


@named_arguments
class TransferFunction(StateSpace):
    """u/e = numerator/denominator, coefficients of descending powers of s, of one measure and one target; the numerator
    has at most the degree of the denominator. Raises `InputError`.

    >>> lead = wf.control.TransferFunction([0.1, 1.0], [0.01, 1.0], measure="joint_coordinate[hinge]", target="torque")
    """

    def __init__(
        self,
        numerator: Vector,
        denominator: Vector,
        *,
        measure: str,
        target: Input | str,
        reference: SignalLike | None = None,
        every: int = 1,
    ) -> None:
        from scipy.signal import tf2ss

        b = np.trim_zeros(require_array(numerator, "TransferFunction: numerator", (None,)), "f")
        a = np.trim_zeros(require_array(denominator, "TransferFunction: denominator", (None,)), "f")
        if not len(a) or len(b) > len(a):
            raise InputError(
                "TransferFunction: the numerator has a higher degree than the denominator, or that is zero; filter it, "
                "with further factors of the denominator"
            )
        b = b if len(b) else np.zeros(1)
        A, B, C, D = tf2ss(b, a) if len(a) > 1 else ([], [], [], [[b[0] / a[0]]])
        super().__init__(
            A, B, C, D, measures=[measure], targets=[target], references=_given(reference), every=every,
        )  # fmt: skip


@named_arguments
class PID(StateSpace):
    """kp e + ki (integral of e) + kd (filtered derivative of e), e = reference - measure.

    filter_time [s]: time constant of the derivative's filter, needed with kd. limits: smallest and largest command;
    beyond them the integral stands still. Units: those of the target over those of the measure, for ki per second, for
    kd times seconds. Raises `InputError`.

    >>> drive = wf.control.PID(
    ...     "body_angular_velocity_y[rotor]", wf.signals.Input("motor torque"), reference=10.0, kp=2.0, ki=5.0
    ... )
    """

    def __init__(
        self,
        measure: str,
        target: Input | str,
        *,
        reference: SignalLike = 0.0,
        kp: float = 0.0,
        ki: float = 0.0,
        kd: float = 0.0,
        filter_time: float | None = None,
        limits: tuple[float, float] | None = None,
        every: int = 1,
    ) -> None:
        self.kp, self.ki, self.kd = (
            require_number(gain, f"PID: {name}") for name, gain in (("kp", kp), ("ki", ki), ("kd", kd))
        )
        if self.kd != 0.0 and filter_time is None:
            raise InputError(
                "PID: the derivative needs a filter_time [s], some steps long: a sampled error has steps; or feed back "
                "a measured velocity with a second controller"
            )
        T = 1.0 if filter_time is None else require_number(filter_time, "PID: filter_time", positive=True)
        self.limits = (-np.inf, np.inf)
        if limits is not None:
            self.limits = _bounds(limits)
        super().__init__(
            [[0.0, 0.0], [0.0, -1.0 / T]], [[1.0], [1.0 / T]], [[self.ki, -self.kd / T]], [[self.kp + self.kd / T]],
            measures=[measure], targets=[target], references=[reference], every=every,
        )  # fmt: skip

    def sampled(self, sample: float) -> Sampled:
        found = _Limited(*self._discrete(sample), self.initial.copy())
        found.limits = self.limits
        return found


@named_arguments
class Table(Controller):
    """A curve: the command at `errors` (n,), increasing, is that of `commands` (n,), linear in between and constant
    beyond. Raises `InputError`."""

    def __init__(
        self,
        errors: Vector,
        commands: Vector,
        *,
        measure: str,
        target: Input | str,
        reference: SignalLike | None = None,
        every: int = 1,
    ) -> None:
        super().__init__([measure], [target], _given(reference), every)
        self.errors = require_array(errors, "control.Table: errors", (None,))
        self.commands = require_array(commands, "control.Table: commands", (len(self.errors),))
        if len(self.errors) < 2 or np.any(np.diff(self.errors) <= 0.0):
            raise InputError("control.Table: errors must be at least two numbers that increase")

    def sampled(self, sample: float) -> Sampled:
        return _Curve(self.errors, self.commands)


class _Curve(Sampled):
    def __init__(self, x: np.ndarray, y: np.ndarray) -> None:
        self.x, self.y = x, y

    def command(self, error: np.ndarray) -> np.ndarray:
        return np.interp(error, self.x, self.y)


def _given(reference: SignalLike | None) -> list[SignalLike]:
    return [] if reference is None else [reference]


def _bounds(limits: Any) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in limits)
    except (TypeError, ValueError):
        raise InputError(f"PID: limits must be two numbers, the smallest and the largest, got {limits!r}") from None
    if not low < high:
        raise InputError(f"PID: limits must be two numbers, the smallest and the largest, got {limits!r}")
    return low, high
