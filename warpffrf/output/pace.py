"""Steps at the pace of the clock, for `Simulation.run(duration, real_time=...)`.

Step n of a run with the step h, from 1, ends at the time t_0 + n h of the clock: one that is ready before waits for it,
one that is ready after it is an overrun. Deadlines do not move, so that a late step is made up for by those that
follow, if they are faster than the clock, and simulated time never drifts from that of the clock by itself.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from warpffrf.model.errors import InputError


@dataclass
class Pace:
    """What became of the deadlines of a run in real time; clock() [s] and sleep(seconds) may be others than those of
    the machine.

    steps: made. overruns: those that were ready after their deadline. worst: the most that one was late [s]. busy: time
    that steps took, without waiting [s], of simulated [s]: their ratio is the load of the machine, 1 and more if it
    cannot keep up.
    """

    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)
    sleep: Callable[[float], object] = field(default=time.sleep, repr=False)
    steps: int = 0
    overruns: int = 0
    worst: float = 0.0
    busy: float = 0.0
    simulated: float = 0.0

    @property
    def load(self) -> float:
        """Time that steps took over the time that they simulate [-]."""
        return self.busy / self.simulated if self.simulated else 0.0

    def run(self, step: Callable[[], bool], duration: float, count: int) -> None:
        """Call `step` as often as `count` within `duration` [s], or until it returns False."""
        begin = self.clock()
        now = begin
        for n in range(1, count + 1):
            went_on, started, now = step(), now, self.clock()
            deadline = begin + n * duration / count
            self.steps += 1
            self.busy += now - started
            self.simulated += duration / count
            if now > deadline:
                self.overruns += 1
                self.worst = max(self.worst, now - deadline)
            if not went_on:
                return
            while now < deadline:
                self.sleep(deadline - now)
                now = self.clock()

    def __str__(self) -> str:
        return (
            f"{self.steps} steps, {self.overruns} overruns, the worst {1e3 * self.worst:.3g} ms late, "
            f"load {100 * self.load:.3g} %"
        )


def as_pace(real_time: bool | Pace) -> Pace | None:
    """The argument real_time as a Pace, None for False."""
    if isinstance(real_time, Pace):
        return real_time
    if not isinstance(real_time, bool):
        raise InputError(f"Simulation: real_time must be True or False, got {real_time!r}")
    return Pace() if real_time else None
