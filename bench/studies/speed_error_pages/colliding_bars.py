"""St Venant's impact of two bars: treatment of the local modes x number of modes x step."""

from __future__ import annotations

from functools import cache, partial

import warpffrf as wf
from studies.contact import colliding_bars as bars
from studies.speed_error_pages.study import Study, steps
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [2e-6, 1e-6, 5e-7, 2.5e-7]  # s; the time of contact is 200 of the coarsest
RUN = 4.4e-4  # s: the bars are apart again
MODES, QUICK_MODES = [10, 20, 50], [5, 10]  # of each bar
REFERENCE_MODES = 200
TREATMENTS = ["quasi_static", "exponential", "hht"]
ROUNDS = 2

_bar = cache(bars.bar)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""

    def colliding_bars(modes: int) -> wf.Scene:
        return bars.meeting(_bar(modes))

    numbers = QUICK_MODES if quick else MODES
    return wf.study.speed_error(
        colliding_bars,
        partial(wf.simulate, duration=RUN, step=STEPS[0]),
        progress=progress,
        rounds=ROUNDS,
        parameters={"modes": numbers[-1]},
        choices={"local_modes": TREATMENTS, "modes": numbers, "step": steps(STEPS, quick)},
        reference={"modes": 2 * numbers[-1] if quick else REFERENCE_MODES},
        measures=["force", "force_max", "displacement", "energy"],
    )


COLLIDING_BARS = Study(
    "colliding_bars",
    "Two bars that collide",
    f"[St Venant's impact](../studies/colliding_bars.md): two equal bars of {bars.LENGTH:g} m meet end to end at "
    f"{bars.SPEED:g} m/s, touch for {bars.EXACT.duration * 1e6:.0f} us under the constant force "
    f"{bars.EXACT.force:.0f} N, and exchange their velocities. Bodies are of the closed form of a rod, so that nothing "
    f"but `modes`, their number, and `local_modes`, what becomes of the rest, differs from the reference with "
    f"{REFERENCE_MODES} modes, whose local ones step by HHT. Damping is the default of a body, 10 % above half its "
    "highest frequency. The force is a rectangle in time: where it rises and falls no method has an error smaller than "
    "the step, the largest error `force_max` stays near the whole force where flanks fall into different steps, and "
    "`displacement`, where the bars are in the end, shows the impulse.",
    make,
)
