"""One run of a setting, and its cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.messages.status import Status
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.study.runs import with_options
from warpffrf.study.speed_against_error.choices import Setting, label_of
from warpffrf.study.speed_against_error.machines import Machines, applied, offline_seconds, run_options

REFUSED = "refused"


@dataclass
class Row:
    """A setting, the status of its runs, its `errors` as fractions, and its costs: `walls` and `graphs`, seconds of the
    time loop and in its graph per simulated second; for each run `set_up` [s] (compilation and building) and `after`
    [s] (checks at the end); `offline` [s] of its bodies."""

    setting: Setting
    status: str = ""
    reason: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    walls: list[float] = field(default_factory=list)
    graphs: list[float] = field(default_factory=list)
    set_up: list[float] = field(default_factory=list)
    after: list[float] = field(default_factory=list)
    offline: float = float("nan")

    @property
    def label(self) -> str:
        """The setting as text."""
        return label_of(self.setting)

    @property
    def timed(self) -> bool:
        """Whether its runs were completed and timed."""
        return self.status == Status.COMPLETED and bool(self.walls)

    @property
    def fastest(self) -> float:
        """Least wall time per simulated second: disturbances only increase times."""
        return min(self.walls)

    @property
    def median(self) -> float:
        """Median wall time per simulated second."""
        return median(self.walls)

    def plain(self) -> dict[str, Any]:
        """Everything except the setting, as plain data."""
        return {name: value for name, value in vars(self).items() if name != "setting"}


def run_setting(
    machines: Machines, setting: Setting, interval: float, duration: float, options: Mapping[str, Any]
) -> tuple[Result, Row]:
    """One run, saved every `interval` [s], and its costs without errors. Raises `InputError` for a setting that the
    scene does not support, KeyboardInterrupt if the run was interrupted."""
    scene, chosen = machines.scene(setting), run_options(setting)
    with applied(scene, setting):
        step = chosen.pop("step")
        arguments = with_options(options, save_every=round(interval / step), **chosen)
        result = simulate(scene, duration, step=step, progress=False, **arguments)
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    row = Row(setting, str(result.status), result.message, offline=offline_seconds(scene))
    counters, span = result.history.counters, float(result.time[-1] - result.time[0]) if len(result.time) else 0.0
    if span > 0.0:
        row.walls.append(float(counters["loop_seconds"]) / span)
        row.graphs.append(float(counters.get("seconds_in_graph", counters["loop_seconds"])) / span)
        row.set_up.append(float(counters["build_seconds"]))
        row.after.append(float(counters.get("finish_seconds", 0.0)))  # missing for the check integrators
    return result, row


def refused(setting: Setting, error: InputError) -> Row:
    """The row of a setting that the scene does not support."""
    return Row(setting, REFUSED, str(error))
