"""`speed_error`: one scene with many settings, compared with a computed reference.

The reference has the finest step of the study divided by REFINED, the last value of every other choice, all inertia
terms if all flexible bodies have them, and the user's own values. A second reference with twice its step measures its
convergence: for a second-order method its own error is a third of their difference.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from warpffrf import __version__
from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import Progress
from warpffrf.output.result import Result
from warpffrf.study.runs import combined, run_of, with_options
from warpffrf.study.speed_against_error.choices import (
    BUILT_IN,
    Choices,
    Setting,
    can_stiffen,
    default_choices,
    given_choices,
    label_of,
)
from warpffrf.study.speed_against_error.errors import (
    check_points,
    common_interval,
    common_rows,
    contact_forces,
    errors_of,
    measures_of,
    motion_of,
)
from warpffrf.study.speed_against_error.folder import Folder
from warpffrf.study.speed_against_error.machines import DROPPED, Machines, load_before, sitting, source_of
from warpffrf.study.speed_against_error.outcome import SpeedError
from warpffrf.study.speed_against_error.runs import Row, refused, run_setting

REFINED = 4


@named_arguments
def speed_error(
    scene: Any,
    run: Callable[..., Result] | None = None,
    *,
    choices: Mapping[str, Sequence[Any]] | None = None,
    parameters: Mapping[str, Any] | None = None,
    reference: Mapping[str, Any] | None = None,
    measures: Sequence[str] | None = None,
    points: Mapping[str, Any] | None = None,
    rounds: int = 3,
    out: str | Path | None = None,
    overwrite: bool = False,
    progress: bool = True,
) -> SpeedError:
    """Run a scene with many settings, in `rounds` of changing order, and compare them with a reference.

    scene: a Scene, a function `build(**parameters)` that returns one, or a scene file, of which parameters are dotted
    names as of `--set`. run: functools.partial(wf.simulate, duration=..., step=..., ...); its arguments prevail over
    those of the table [simulate] of a file. choices {name: values}, from coarse
    to fine; None: see `choices`. reference: other values for the reference. points {body: (n, 3)} [m, user frame]:
    where displacement is compared. measures: which quantities are compared, None for
    all.
    progress: what is being done, on stderr. out: a folder, from which an interrupted study is continued; overwrite:
    replace it. Raises `InputError`.
    """
    source = source_of(scene, parameters or {})
    machines = Machines(source, parameters or {})
    call, given = ("simulate", {}) if run is None else run_of(run, "speed_error")
    if call != "simulate":
        raise InputError(f"speed_error: run must be a run in time, wf.simulate, got wf.{call}")
    options = {"start": "initial", **combined(source.options(), given)}
    for name in DROPPED:
        options.pop(name, None)
    if "duration" not in options or "step" not in options:
        raise InputError(
            "speed_error: give duration and step, run=functools.partial(wf.simulate, duration=..., step=...), or a "
            "scene file whose [simulate] has them"
        )
    duration = require_number(options.pop("duration"), "speed_error: duration", positive=True)
    base: Setting = {"step": require_number(options.pop("step"), "speed_error: step", positive=True)}
    options = with_options(options, save_every=1)  # rows are saved at the common times
    base |= {"local_modes": options["options"].local_modes, "integrator": options["options"].integrator}
    rounds = require_count(rounds, "speed_error: rounds", 1)
    built = machines.scene(base)
    names = measures_of(built, measures)
    places = check_points(points, [body.name for body in built.bodies])
    if choices is not None:
        source.check([name for name in choices if name not in BUILT_IN])
    plan = default_choices(built, base) if choices is None else given_choices(choices, base)
    finest = _reference_setting(plan, choices or {}, built, reference or {})
    steps = [setting["step"] for setting in plan.settings]
    interval = common_interval([*steps, 2.0 * finest["step"]], duration)
    identity = {
        "title": source.title, "scene": built.content_hash(), "version": __version__, "duration": duration,
        "saved_every": interval, "options": {k: str(v) for k, v in options.items()}, "measures": list(names),
        "parameters": {k: str(v) for k, v in machines.parameters.items()}, "reference": label_of(finest),
        "points": {name: x.tolist() for name, x in places.items()},
    }  # fmt: skip
    folder = Folder(out, identity, overwrite=overwrite)
    load, timed = load_before(), folder.times()
    bar = Progress("speed-error", 2 + rounds * len(plan.settings), enabled=progress, unit="run")
    try:
        kept = folder.reference()
        if kept is None:
            best, _ = run_setting(machines, finest, interval, duration, options)
            bar.update(1)
            coarse, _ = run_setting(machines, {**finest, "step": 2.0 * finest["step"]}, interval, duration, options)
            for result in (best, coarse):
                if common_rows(result.time, interval, duration) is None:
                    raise InputError(f"speed_error: the reference run ended early, {result.status}: {result.message}; "
                                     "give it other values, reference={...}")  # fmt: skip
            at, at_coarse = (common_rows(r.time, interval, duration) for r in (best, coarse))
            assert at is not None and at_coarse is not None
            apart = errors_of(coarse, at_coarse, best, at, names, places)
            apart.pop("energy", None)
            folder.keep_reference(best, {"label": label_of(finest), "apart": apart})
            kept = best, folder.content["reference"]
        bar.update(2)
        best, facts = kept
        at = common_rows(best.time, interval, duration)
        assert at is not None
        how = interval, duration, options
        try:
            rows = _rounds(machines, plan, folder, bar, rounds, how, (best, at, names, places))
        finally:  # also for an interrupted sitting
            if folder.times() > timed:
                folder.keep_machine(sitting(load))
    finally:
        bar.close()
    names = tuple(n for n in names if n == "energy" or n in facts["apart"])  # the others are zero in the reference
    series = {row.label: found for row in rows if (found := folder.series(row.label)) is not None}
    return SpeedError(source.title, names, rows, facts, plan.left_out, series, folder.machines())


def _reference_setting(plan: Choices, choices: Mapping[str, Any], scene: Any, asked: Mapping[str, Any]) -> Setting:
    finest = {**plan.settings[0], **{name: values[-1] for name, values in choices.items()}}
    finest["step"] = min(setting["step"] for setting in plan.settings) / REFINED
    flexible = [body for body in scene.bodies if body.reduced is not None]
    if flexible and all(body.reduced.inertia_terms is not None for body in flexible):
        finest["inertia"] = "full"
    if any(map(can_stiffen, flexible)):
        finest["stiffening"] = True
    return {**finest, **asked}


def _rounds(
    machines: Machines, plan: Choices, folder: Folder, bar: Progress, rounds: int, how: Any, against: Any
) -> list[Row]:
    """All settings in rounds, each from a different start and every second one backwards; stored runs are not
    repeated."""
    (interval, duration, options), (best, at, names, places) = how, against
    rows = {label_of(s): Row(s, **(folder.row(label_of(s)) or {})) for s in plan.settings}
    order, done = list(rows), 2
    for number in range(rounds):
        shift = number * len(order) // rounds
        turn = (order[shift:] + order[:shift])[:: -1 if number % 2 else 1]
        for label in turn:
            row = rows[label]
            if not row.status or (row.timed and len(row.walls) <= number):
                try:
                    result, now = run_setting(machines, row.setting, interval, duration, options)
                except InputError as error:
                    rows[label] = refused(row.setting, error)
                else:
                    if not row.status:
                        found = common_rows(result.time, interval, duration)
                        if result.status == "completed" and found is not None:
                            now.errors = errors_of(result, found, best, at, names, places)
                            folder.keep_series(label, _series(result, found, names, places))
                        rows[label] = now
                    else:
                        row.walls += now.walls
                        row.graphs += now.graphs
                        row.set_up += now.set_up
                        row.after += now.after
                folder.keep_row(label, rows[label].plain())
            done += 1
            bar.update(done)
    return list(rows.values())


def _series(result: Any, rows: Any, names: Sequence[str], places: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if "force" in names:
        found["force"] = contact_forces(result, rows)
    motion = motion_of(result, rows, places)
    found["displacement"] = motion.world - motion.world[:1]
    if motion.elastic.size:
        found["deformation"] = motion.elastic
    return found
