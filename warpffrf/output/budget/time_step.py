r"""The error of the time step of a run, from parts of it that are repeated with twice the step.

A second-order method has the error e = c h^2 in every quantity, so that two solutions from the same state with h and 2
h differ by

    d = 4 e - e = 3 e

(Richardson). If the step of an impact dominates, for impulsive contacts, the order is one, d = 2 e - e; for runs with
such steps e = d/2 is used, which is accurate to a factor of 2.

A run of up to `marks.WHOLE` steps is repeated as a whole, at half of its cost. For a longer run windows are repeated, a
hundredth each: `SPREAD` evenly spaced ones, which represent the rest of the run, and the `BUSIEST`, in which
accelerations change most from row to row, which represent only themselves. In a window both solutions start from the
state of the run (see `marks`), so that their difference grows from zero. With the root mean squares d_1 and d_2 of the
first and second half of a window of length L, in a run of length T and a quantity of the frequency w = |Qdot|/|Q|,

    d_2/d_1 below SETTLED       forced or damped: the error has its size, d
    above QUADRATIC             free, and the window shorter than a period: a force error f gives d = f L^2/2 first and
                                then f t/(2 w), hence d T/L max(1, min(1/(w L), T/L)) at the end of the run
    between, w L > TWO_PERIODS  free, grows with time: d T/L
    between, else               undecided: the geometric mean of both, d root(T/L)

and a linear growth from zero has the root mean square 1/root(3) of its last value.

A vibration that neither step resolves is damped by the integrator and does not appear in the difference. So the first
`PART` of a run, with vibrations excited by its start, and the one in which accelerations change most are also repeated
with a `FINER`th of the step (16/15 of this d is e at order two, but such a d is the error itself). With d_1 and d_2 of
the halves of such a part the difference is extrapolated with d_2/d_1 = r <= 1 from half to half, so that for the whole
run

    e^2 = (L/2T) d_1^2 (1 + r^2 + r^4 + ...),       2 T/L terms.

The largest of these and of the above counts. Vibrations excited elsewhere are not detected: for machines that can have
them, of modes and of bodies on their contacts, the line states the frequency limit, 1/(2 pi 2 h).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.messages.progress import Progress
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import BudgetLine, History
from warpffrf.online.samples import COARSER, FINER, Again, Samples
from warpffrf.output.budget.figures import figures
from warpffrf.output.budget.quantities import Quantity, quantities
from warpffrf.output.geometry.scene_view import SceneView

SPREAD, BUSIEST = 4, 2  # windows
SETTLED, QUADRATIC = 1.8, 4.0  # d_2/d_1 is 1 if settled, 2.6 for t, 5.6 for t^2
TWO_PERIODS = 4.0 * np.pi
LAST = 1.4  # last value over d_2: 1.3 for t, 1.6 for t^2
SECOND_ORDER, FIRST_ORDER = float(COARSER**2 - 1), float(COARSER)  # d/e, the latter between its two bounds
PART, FEWEST, MOST = 32, 8, 400  # of the run, within these limits of steps
RESOLVED = 1.0  # rad of a vibration in the longer step: beyond it the method has no asymptotic order
SAME_TIME = 1e-3  # of the step: smaller differences of times are round-off
SOURCE = "time step"
CURE = "a smaller step"

Array = np.ndarray


def time_step_lines(history: History, view: SceneView, engine: Engine, *, progress: bool) -> list[BudgetLine]:
    """One line for each quantity of a run with `marks`; `engine`: of the run, for further steps."""

    def of(history: History) -> dict[str, Quantity]:
        return {**figures(history, view), **quantities(history)}

    marks: Samples = history.samples
    begin = float(marks.states[marks.first]["clk"]["time"][0]) if marks.states else 0.0
    reached = marks.first + round((history.time[-1] - begin) / marks.step)
    windows = [(a, b) for a, b in marks.windows(reached) if b - a >= COARSER]
    parts = [(marks.first, reached)] if marks.whole and reached - marks.first >= COARSER else windows
    if not parts:
        return [BudgetLine(SOURCE, "all results", np.nan, "the run is too short for a second one with twice the step")]
    chosen = [0] if marks.whole else _windows(history, marks, parts)
    found: list[Again] = []
    bar = Progress("error budget: time step", len(chosen) + 2, enabled=progress, unit="part")
    for n, i in enumerate(chosen):
        again = marks.again(engine, *parts[i])
        if again is None:
            bar.close()
            return [BudgetLine(SOURCE, "all results", np.nan, "with twice the step the run fails", "a smaller step")]
        found.append(again)
        bar.update(n + 1)
    own = of(history)
    if marks.whole:
        lines = _by_whole(history, own, found[0].coarse.time, of(found[0].coarse))
    else:
        both = [(of(_fine(again)), of(again.coarse)) for again in found]
        lines = [
            _by_windows(history, quantity, found, both, marks.step, _divisor(history)) for quantity in own.values()
        ]
    steps = min(max((reached - marks.first) // PART, min(FEWEST, reached - marks.first)), MOST)
    parts_of = (reached - marks.first) / steps
    lines = _with_finer(lines, own, _both(marks.finer(engine, marks.first, steps), of), parts_of, "the beginning")
    bar.update(len(chosen) + 1)
    if windows:
        busiest = windows[int(np.argmax(busyness(history, _begins(marks, windows))))][0]
        again = marks.finer(engine, busiest, min(steps, reached - busiest))
        lines = _with_finer(lines, own, _both(again, of), parts_of, "the busiest part")
    bar.close()
    unseen = _unseen(history, marks.step)
    return [
        replace(line, basis=line.basis + own[line.of].beside + unseen) if line.of in own else line for line in lines
    ]


Found = dict[str, Quantity]


def _both(again: tuple[History, History] | None, of: Callable[[History], Found]) -> tuple[Found, Found] | None:
    return None if again is None else (of(again[0]), of(again[1]))


def _fine(again: Again) -> History:
    """The rows of a window computed with the step of the run."""
    if again.fine is None:
        raise TypeError("a window has rows of both steps")
    return again.fine


def _with_finer(
    lines: list[BudgetLine], own: Found, again: tuple[Found, Found] | None, parts: float, part: str
) -> list[BudgetLine]:
    """`lines`, unless one of `parts` of the run with a shorter step gives a larger error."""
    if again is None:
        return lines
    fine, finer = again
    found = []
    for line in lines:
        if line.of in fine and line.of in finer:
            d = replace(fine[line.of], most=own[line.of].most).apart(finer[line.of].values)
            size = going_on(d, parts) / own[line.of].size
            if not line.size >= size:
                line = replace(line, size=size, basis=f"{part} of the run repeated with 1/{FINER} of the step")
        found.append(line)
    return found


def going_on(d: Array, parts: float) -> float:
    """Root mean square over a run of differences that are d (n,) in the first of its `parts` and continue at the same
    rate."""
    half = max(len(d) // 2, 1)
    first, second = (float(np.sqrt(np.mean(x**2))) if len(x) else 0.0 for x in (d[:half], d[half:]))
    if first == 0.0:
        return second / np.sqrt(2.0 * parts)
    r = min(second / first, 1.0)
    terms = float(np.sum(r ** (2.0 * np.arange(math.ceil(2.0 * parts)))))
    return first * np.sqrt(terms / (2.0 * parts))


def _unseen(history: History, step: float) -> str:
    """Text on vibrations that the steps do not resolve, for a machine that can have them."""
    highest = RESOLVED / (2.0 * np.pi * COARSER * step)
    touching = bool(history.contacts or history.lumped_contacts or history.films or history.small_sliding)
    if not touching and not any(np.any(body.reduced.frequencies > highest) for body in _flexible(history)):
        return ""
    return f"; vibrations above {highest:.3g} Hz, which it does not resolve, are not included"


def _flexible(history: History) -> list[Any]:
    return [body for body in history.scene.bodies if body.reduced is not None]


def _divisor(history: History) -> float:
    """d/e of the run."""
    return FIRST_ORDER if history.counters.get("impulsive_steps") else SECOND_ORDER


def _by_whole(history: History, own: Found, time: Array, coarse: Found) -> list[BudgetLine]:
    """Errors from a complete second run; rows at `time` (T,) [s] saved by both are compared."""
    step = float(np.median(np.diff(time))) if len(time) > 1 else float(time[0])
    at = np.searchsorted(history.time, time - SAME_TIME * step)
    same = (at < len(history.time)) & (
        np.abs(history.time[np.minimum(at, len(history.time) - 1)] - time) < SAME_TIME * step
    )
    if not np.any(same):
        return [BudgetLine(SOURCE, "all results", np.nan, "no saved step has an even number; use save_every of 1 or 2")]
    lines = []
    for name, quantity in own.items():
        if name not in coarse:
            continue
        d = quantity.apart(coarse[name].values[same], at[same])
        size = float(np.sqrt(np.mean(d**2))) / quantity.size / _divisor(history)
        lines.append(BudgetLine(SOURCE, name, size, "the run repeated with twice the step", CURE))
    return lines


def _windows(history: History, marks: Samples, parts: Sequence[tuple[int, int]]) -> list[int]:
    """Indices of the windows to repeat, the evenly spaced ones first."""
    spread = [int(x) for x in (np.arange(SPREAD) + 0.5) / SPREAD * len(parts)]
    busy = busyness(history, _begins(marks, parts))
    others = [int(i) for i in np.argsort(-busy, kind="stable") if i not in spread]
    return [*dict.fromkeys(spread), *others[:BUSIEST]]


def _begins(marks: Samples, parts: Sequence[tuple[int, int]]) -> list[float]:
    """Start times of the windows [s]."""
    return [float(marks.states[a]["clk"]["time"][0]) for a, _ in parts]


def busyness(history: History, begins: Sequence[float]) -> Array:
    """For windows that begin at `begins` [s], the largest change of accelerations between saved rows, over the largest
    of the body."""
    change = np.zeros(max(len(history.time) - 1, 0))
    for motion in history.bodies.values():
        for values in (motion.acceleration, motion.angular_acceleration, motion.modal_acceleration):
            largest = float(np.abs(np.nan_to_num(values)).max(initial=0.0))
            if largest > 0.0:
                step = np.abs(np.diff(np.nan_to_num(values), axis=0)).max(axis=1) / largest
                change = np.maximum(change, step)
    window = np.searchsorted(begins, 0.5 * (history.time[1:] + history.time[:-1]), side="right") - 1
    found = np.zeros(len(begins))
    np.maximum.at(found, np.maximum(window, 0), change)
    return found


def _by_windows(
    history: History, quantity: Quantity, found: Sequence[Again], both: Sequence[tuple[Found, Found]], step: float,
    divisor: float,
) -> BudgetLine:  # fmt: skip
    """Errors from windows, the first `SPREAD` of them evenly spaced."""
    T = float(history.time[-1] - history.time[0])
    w = frequency(history.time, quantity.values)
    settled, grown, rest = 0.0, [], T
    squares = []
    for number, again in enumerate(found):
        fine, coarse = (each.get(quantity.name) for each in both[number])
        length = (again.end - again.begin) * step
        if fine is None or coarse is None:  # the quantity has no rows in the window
            d = np.zeros(2)
        else:
            rows = slice(COARSER - 1, None, COARSER)
            d = replace(fine, most=quantity.most).apart(coarse.values, rows) / divisor
        square = float(np.mean(d**2))
        if number < SPREAD:
            squares.append(square)
            grown.append(at_end(d, length, T, w))
        else:
            settled += square * length
            rest -= length
    settled = np.sqrt((settled + rest * np.mean(squares)) / T)
    size = float(np.hypot(settled, np.mean(grown) / np.sqrt(3.0))) / quantity.size
    basis = f"{len(found)} parts of the run, {len(found) / 100:.0%} of it, once more with twice the step"
    return BudgetLine(SOURCE, quantity.name, size, basis, CURE)


def frequency(time: Array, values: Array) -> float:
    """|Qdot|/|Q - mean of Q| [rad/s] of a quantity, from its saved rows."""
    if len(time) < 3:
        return 0.0
    size = np.sqrt(np.mean(np.sum((values - values.mean(axis=0)) ** 2, axis=1)))
    rate = np.sqrt(np.mean(np.sum(np.diff(values, axis=0) ** 2, axis=1) / np.diff(time) ** 2))
    return float(rate / size) if size > 0.0 else 0.0


def at_end(d: Array, length: float, T: float, w: float) -> float:
    """Differences d (n,) over a window of `length` [s], extrapolated to the end of a run of T [s], for a quantity of
    frequency w [rad/s]; 0 for those that do not grow."""
    half = len(d) // 2
    first, second = (float(np.sqrt(np.mean(x**2))) if len(x) else 0.0 for x in (d[:half], d[half:]))
    if second <= SETTLED * first:
        return 0.0
    last, windows, turn = LAST * second, T / length, w * length
    if second > QUADRATIC * first:
        return last * windows * max(1.0, min(1.0 / max(turn, 1e-300), windows))
    return last * (windows if turn > TWO_PERIODS else np.sqrt(windows))
