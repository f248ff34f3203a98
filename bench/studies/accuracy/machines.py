"""The machines: those of the studies of speed against error, two simple ones, two that showed that rules of `accuracy=`
overshot or missed an error, and two that no rule has been tuned on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import warpffrf as wf
from demos import crowned_on_raceway as crowned
from demos import frame_on_bushings as frame
from demos import rolling_friction as rolling
from demos import slider_crank as crank
from demos import spinning_beam as beam
from demos import two_rollers as rollers
from scenes import bearing as bearings
from scenes import tilted_roller as tilted
from studies.accuracy.budget_check import BARS, colliding_bars, driven_mass, pendulum
from studies.speed_error_pages import bearing as bearing_study
from studies.speed_error_pages import rolling_friction as friction_study
from studies.speed_error_pages import slider_crank as crank_study
from studies.speed_error_pages import two_rollers as roller_study
from studies.speed_error_pages.reduced import roller
from warpffrf.model.contact import CELL_ERROR, CELL_ERRORS

FINER = 8  # times the steps that were chosen, in the reference
AT_REST: dict[str, Any] = {"start": "equilibrium"}


@dataclass(frozen=True)
class Machine:
    """A machine, how long it runs [s], from where, points of flexible bodies whose motion is looked at, and errors for
    which `cells` of contacts are tried. The reference has `finer` times the steps that were chosen, and cells for the
    error `exact`, or what half of the least chosen one asks for."""

    title: str
    build: Callable[[], wf.Scene]
    duration: float
    options: dict[str, Any] = field(default_factory=dict)
    points: dict[str, Any] = field(default_factory=dict)
    measures: tuple[str, ...] | None = None
    cells: tuple[float, ...] = (CELL_ERRORS[1], 0.01, CELL_ERROR)
    finer: int = FINER
    exact: float | None = None


def _rolling() -> wf.Scene:
    """The rolling-friction demo on a mesh of 4 mm, its grid and cells left to the program."""
    scene = rolling.build(rolling.BIG_CELLS, progress=False)
    (contact,) = scene.contacts
    contact.grid, contact.cells = "auto", None
    return scene


def _bearing() -> wf.Scene:
    """The bearing of six rollers on the coarser rings of its study."""
    ready = bearings.rings(bearing_study.ROLLERS, bearing_study.REFERENCE_CELLS.half_width, contact_fixed=True)
    return bearings.run_up(bearing_study.ROLLERS, ready, bearing_study.RAMP)


MACHINES: dict[str, Machine] = {
    "pendulum": Machine("a pendulum", pendulum, 4.0),
    "driven_mass": Machine("a mass on a spring, driven", driven_mass, 4.0),
    "two_rollers": Machine(
        "two rollers, spun up and loaded",
        lambda: rollers.machine(roller(False), load_step_at=roller_study.LOAD_STEP),
        roller_study.RUN,
        AT_REST,
    ),
    "pressed_rollers": Machine(
        "the rollers without rolling",
        lambda: rollers.machine(roller(False), load_step_at=roller_study.LOAD_STEP, speed=0.0),
        roller_study.RUN,
        AT_REST,
    ),
    "slider_crank": Machine(
        "slider-crank, elastic rod", lambda: crank.machine(crank.rod_body(crank.FULL, progress=False)),
        crank_study.RUN,
        points={"rod": [(0.0, 0.0, 0.5 * crank.SECTION)]},
    ),
    "colliding_bars": Machine("two bars collide", colliding_bars, BARS),
    "bearing": Machine(
        "bearing of six rollers", _bearing, bearing_study.RUN, AT_REST, cells=(CELL_ERRORS[1], CELL_ERROR), finer=4,
        exact=0.003,
    ),
    "rolling_friction": Machine(
        "rolling with friction", _rolling, friction_study.RUN, AT_REST, points=friction_study.AT_RIM,
        cells=CELL_ERRORS[1:],
    ),
    "spinning_beam": Machine(
        "a slender beam spun up",
        lambda: beam.build(inertia="auto", stiffening=False, progress=False),
        beam.SPIN_UP + beam.FULL.at_speed,
        points={"beam": [(beam.LENGTH, 0.0, 0.0)]},
    ),
    "crowned_on_raceway": Machine(
        "crowned roller on a raceway",
        lambda: crowned.build(progress=False),
        crowned.LOADING + crowned.WAITING + crowned.SPIN_UP + crowned.TURNING,
        AT_REST,
    ),
    "frame_on_bushings": Machine(
        "a frame on bushings, pushed",
        lambda: frame.build(progress=False),
        frame.DURATION,
        AT_REST,
        points={"frame": [(*frame.MOUNT_AT["rear_right"], 0.0)]},
    ),
    "tilted_roller": Machine(
        "a crowned roller that tilts on a plane",
        lambda: tilted.build(tilted.QUICK, progress=False),
        tilted.TILTING + tilted.WAITING + tilted.TURNING,
        AT_REST,
    ),
}  # fmt: skip
