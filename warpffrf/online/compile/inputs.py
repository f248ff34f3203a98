r"""Inputs of a scene on the device: signals whose pieces change between steps.

A signal that follows an `Input` u has two pieces on the device. If u was u_0 and is set to u_1 at the time t, before a
step that ends at t + h,

    u(t + x) = u_0 + (u_1 - u_0) x/h,   0 <= x < h,        u_1 afterwards

(first-order hold). A force then is continuous, so that the integrator keeps its order and the ledger its balance, and
halved or repeated steps find the same function. A signal of k integrals continues with its derivatives:

    S(t + x) = sum_{j<k} S^(j)(t) x^j/j! + u_0 x^k/k! + (u_1 - u_0)/h x^(k+1)/(k+1)!,

which after the step is expanded about its end. With a velocity given by an Input the position is continuous with its
slope; a position given by an Input has a kink at each change, and is exact at the ends of steps.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from math import factorial
from operator import itemgetter
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.pieces import TERMS, FromInput, Input, Polynomial, Signal, shifted

MARK = "input_"  # prefix of arrays in a checkpoint
Piece = tuple[float, tuple[float, ...]]  # its break [s] and coefficients


def device_pieces(signal: FromInput) -> tuple[np.ndarray, np.ndarray]:
    """Breaks and coefficients of the two pieces of a signal at its initial value: the second never begins."""
    breaks, c = signal.polynomial()
    return np.array([breaks[0], np.inf]), np.concatenate([c, np.zeros((1, TERMS))])


class DeviceInputs:
    """The inputs of a compiled scene. `values`: of each by name, as set last; `last`: when one was set [s].

    signals: the topic of the model; following: number and signal of all that follow an input. Pieces of the run so far
    are kept for its History (`resolved`).
    """

    def __init__(self, signals: Any, following: Sequence[tuple[int, FromInput]]) -> None:
        self.inputs: dict[str, Input] = {signal.source.name: signal.source for _, signal in following}
        self.values = {name: source.initial for name, source in self.inputs.items()}
        self.last = -np.inf
        if len(self.inputs) < len({(s.name, s.initial, s.unit) for s in (signal.source for _, signal in following)}):
            known = ", ".join(map(repr, self.inputs))
            raise InputError(f"scene: two different Inputs have one name (of {known}); use one of them, or rename it")
        self._signals = signals
        self._follow: dict[str, list[tuple[int, FromInput, list[Piece]]]] = {name: [] for name in self.inputs}
        self._places: list[tuple[int, list[Piece]]] = []
        self._known: dict[tuple[str, float, int], list[Piece]] = {}
        if not following:
            return
        start = signals.start.numpy()
        self._breaks, self._c = signals.breaks.numpy(), signals.coefficient.numpy()  # views on the CPU
        for number, signal in following:
            at = int(start[number])
            pieces: list[Piece] = [(float(self._breaks[at]), tuple(self._c[at].tolist()))]
            self._follow[signal.source.name].append((at, signal, pieces))
            self._places.append((at, pieces))
            self._known[signal.source.name, signal.factor, signal.integrals] = pieces

    def set(self, values: Mapping[str, float], begin: float, end: float) -> None:
        """Let inputs, by name, reach `values` linearly within the step from `begin` to `end` [s]."""
        for name, new in values.items():
            old = self.values[name]
            for at, signal, pieces in self._follow[name]:
                ramp, after = _ramp(signal, pieces[-1], old, new, begin, end - begin)
                if len(pieces) > 1 and pieces[-1][0] >= begin:
                    pieces.pop()
                pieces += [(begin, ramp), (end, after)]
                self._breaks[at], self._breaks[at + 1] = begin, end
                for i, number in enumerate(ramp):  # higher coefficients are zero from the beginning
                    self._c[at, i] = number
                for i, number in enumerate(after):
                    self._c[at + 1, i] = number
            self.values[name] = new
        self.last = begin
        self._upload()

    def _upload(self) -> None:
        """To a device that is not the host."""
        if not self._signals.breaks.device.is_cpu:
            self._signals.breaks.assign(self._breaks)
            self._signals.coefficient.assign(self._c)

    def resolved(self, signal: Signal, since: float = -np.inf) -> Signal:
        """`signal` itself, or with the values of its input in the run so far, from the time `since` [s] on."""
        if not isinstance(signal, FromInput):
            return signal
        pieces = self._known.get((signal.source.name, signal.factor, signal.integrals))
        if pieces is None:
            return signal
        pieces = pieces[max(bisect_right(pieces, since, key=itemgetter(0)) - 1, 0) :]
        breaks = [begin for begin, _ in pieces]
        c = np.zeros((len(pieces), TERMS))
        for row, (_, numbers) in zip(c, pieces, strict=True):
            row[: len(numbers)] = numbers
        return Polynomial([*breaks, breaks[-1] + 1.0], c)

    # --- checkpoints

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Values and pieces; empty without inputs."""
        if not self.inputs:
            return {}
        at = np.array([place for place, _ in self._places])[:, None] + np.arange(2)
        found = {"value": np.array(list(self.values.values())), "breaks": self._breaks[at], "c": self._c[at]}
        return {MARK + name: np.array(array) for name, array in found.items()}

    def resume(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Values and pieces of a checkpoint of the same scene; one without any leaves them as they are."""
        if not self.inputs or MARK + "value" not in checkpoint:
            return
        values, breaks, c = (np.asarray(checkpoint[MARK + name]) for name in ("value", "breaks", "c"))
        self.values = dict(zip(self.values, values.tolist(), strict=True))
        for (at, pieces), b, rows in zip(self._places, breaks, c, strict=True):
            if np.array_equal(self._breaks[at : at + 2], b) and np.array_equal(self._c[at : at + 2], rows):
                continue  # as they are: the pieces before remain known
            self._breaks[at : at + 2], self._c[at : at + 2] = b, rows
            both = zip(b.tolist(), rows.tolist(), strict=True)
            pieces[:] = [(begin, tuple(row)) for begin, row in both if np.isfinite(begin)]
        self.last = float(breaks[:, 0].max())
        self._upload()


def _ramp(
    signal: FromInput, piece: Piece, old: float, new: float, begin: float, h: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Coefficients in the step, and after it; `piece`: the last one so far, which holds at `begin`."""
    f, k = signal.factor, signal.integrals
    if k == 0:
        return (f * old, f * (new - old) / h), (f * new,)
    c = np.zeros(TERMS)
    c[: len(piece[1])] = piece[1]
    c = shifted(c, begin - piece[0])
    c[k:] = 0.0
    c[k], c[k + 1] = f * old / factorial(k), f * (new - old) / h / factorial(k + 1)
    after = shifted(c, h)
    after[k] = f * new / factorial(k)
    return tuple(c[: k + 2].tolist()), tuple(after[: k + 1].tolist())
