"""The report of a run: its statements, which `Report.text` prints and the page of the run tabulates.

Items. Entries of the report on lumped contacts, oil films, small-sliding contacts, joints, force elements and sensors:
the final value and the largest one.

Counters. Solver statistics, in plain words, to which keys of `History.counters` are mapped. Counters of events that
need not occur, such as halved steps, are listed only if they are not zero.

Round-off is not printed as a figure: lengths of 1e-16 m are set to zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from warpffrf.model.errors import InputError, suggestion
from warpffrf.online.history.history import BudgetLine
from warpffrf.output.budget.budget import budget_text
from warpffrf.output.budget.figures import UNKNOWN, error_text, errors
from warpffrf.output.contact.hertz import HertzPoint, flexible_sides, hertz
from warpffrf.output.geometry.scene_view import PairView
from warpffrf.output.report.fold import Entry, Figure, Pairs, folded, folded_notes
from warpffrf.output.round_off import FORCE, LENGTH, SHARE, idle_energy, largest_force, without_round_off

KINDS = {
    "line": "a line across the width",
    "line_around": "a line along the arc",
    "point": "a point contact",
    "flat": "flat faces",
}

CARRIERS = {"nodes": "nodes of the contact grid", "cells": "cells of the patch"}


@dataclass(frozen=True)
class Report:
    """What a report states, in its order: status and counters, contacts with finite sliding at the last saved step,
    other items, energy, error budget, and notes."""

    run: list[Figure]
    contacts: list[Entry]
    items: list[Entry]
    energy: list[Figure]
    budget: list[BudgetLine]
    notes: list[str]
    pairs: Pairs

    def text(self) -> str:
        """Plain text, one fact per line."""
        lines = _listed(self.run)
        lines += [line for entry in self.contacts for line in entry.lines()]
        for kind in dict.fromkeys(entry.kind for entry in self.items):
            own = [line for entry in self.items if entry.kind == kind for line in entry.lines()]
            more = 0 if self.pairs == "all" else max(len(own) - MOST_LINES, 0)
            lines += own[: len(own) - more]
            lines += [f'... and {more} more lines of {kind}s; use report(pairs="all")'] if more else []
        lines += [*_listed(self.energy), *self._budget_lines()]
        return "\n".join([*lines, *(["notes"] if self.notes else []), *(f"  - {note}" for note in self.notes)])

    def _budget_lines(self) -> list[str]:
        if not self.budget or self.unknown:
            return [f"error budget      {self.unknown}"] if self.unknown else []
        head = "estimated error of each result: all sources together, and the largest of them"
        told = [f"  {line}" for entry in self.errors() for line in entry.lines()]
        return [*budget_text(self.budget), head, *told]

    @property
    def unknown(self) -> str:
        """The reason why there is no error budget, or ""."""
        one = len(self.budget) == 1 and self.budget[0].source == UNKNOWN
        return self.budget[0].basis if one else ""

    def errors(self) -> list[Entry]:
        """The error of each quantity, by owner; similar owners grouped."""
        entries = []
        for owner, kinds in errors(self.budget).items():
            kind, _, name = owner.partition(" '")
            names = (name.removesuffix("'"),) if name else ()
            entries.append(Entry(kind or "run", names, [Figure("", error_text(kinds), inline=True)]))
        kinds = list(dict.fromkeys(entry.kind for entry in entries))
        return folded(sorted(entries, key=lambda entry: kinds.index(entry.kind)), self.pairs)


def report_of(result: Any, progress: bool = False, pairs: Pairs = "folded") -> Report:
    """Status, counters, contacts at the last saved step with the Hertz solution, joints, forces, sensors, energy
    balance, error budget and notes. progress: report the progress of the error budget, if it is computed here. pairs:
    similar entries are "folded" into one, or "all" are listed (`fold`). Raises InputError for another word."""
    if pairs not in get_args(Pairs):
        raise InputError(f"report: pairs is {pairs!r}{suggestion(str(pairs), get_args(Pairs))}")
    history = result.history
    notes = folded_notes(history.notes, pairs)
    run = [Figure("status", f"{result.status}" + (f": {result.message}" if result.message else ""))]
    if len(result.time) == 0:
        return Report([*run, Figure("no step was saved", "")], [], [], [], [], notes, pairs)
    run.append(Figure("time", f"{result.time[0]:.6g} to {result.time[-1]:.6g} s, {len(result.time)} rows saved"))
    run += counter_figures(history)
    run += [Figure(file.what, str(file)) for file in result.written]
    contacts = [
        Entry("contact", (name,), _contact(result.contact(name)), sort=same_surfaces(result.view.pairs[name]))
        for name in result.finite_sliding_names
    ]
    items, budget = folded(_items(result), pairs), result.error_budget(progress=progress)
    return Report(run, folded(contacts, pairs), items, _energy(result), budget, notes, pairs)


def _listed(figures: Iterable[Figure]) -> list[str]:
    return [f"{figure.label:<17} {figure.text}".rstrip() for figure in figures]


def _energy(result: Any) -> list[Figure]:
    """Scale and residual of the energy balance, work of friction, and fluctuation due to contact grids."""
    figures = [Figure("energy scale", f"{result.energy_scale:.6g} J, the largest energy of the run")]
    residual, idle = result.energy_residual, idle_energy(result)
    if result.energy_scale <= idle:
        text = f"not computed: nothing moves, energies are round-off of forces times lengths, {idle:.2g} J"
    else:
        text = f"{residual[-1]:+.3e} at the end, {np.ptp(residual):.3e} peak to peak, over the energy scale"
    figures.append(Figure("energy residual", text))
    defect, friction = (result.energy.get(line) for line in ("contact_grid", "friction"))
    if friction is not None and np.any(np.nan_to_num(friction) != 0.0):
        figures.append(Figure("friction", f"{friction[-1]:+.6g} J, work of friction since the start"))
    if result.finite_sliding_names and defect is not None and result.energy_scale > idle and np.isfinite(defect[-1]):
        share = f"{defect[-1] / result.energy_scale:+.3e} of the energy scale"
        text = f"{share}, energy fluctuation because the patch moves over discrete nodes"
        figures.append(Figure("contact grid", text))
    return figures


def _contact(contact: Any) -> list[Figure]:
    friction = _friction(contact) if contact.has_friction else []
    if not contact.touching[-1]:
        return [Figure("", "open in the last row", inline=True), *friction]
    width, middle = contact.half_widths[-1] * 1e6, without_round_off(contact.center_of_pressure[-1], LENGTH) * 1e6
    patch = f"{width[0]:.5g} um along the arc, {width[1]:.5g} um along the axis, area "
    patch += f"{contact.patch_area[-1] * 1e6:.5g} mm2, centre at {middle[0]:.4g} and {middle[1]:.4g} um"
    peak = f"{contact.mid_peak_pressure[-1] / 1e6:.5g} MPa {_section(contact)}, "
    peak += f"{contact.peak_pressure[-1] / 1e6:.5g} MPa anywhere"
    approach = without_round_off(contact.approach[-1], LENGTH) * 1e6
    return [
        Figure("", f"last row, {KINDS[contact.patch_kind]}", inline=True),
        Figure("force", f"{contact.force_magnitude[-1]:.6g} N", ("force",)),
        Figure("half-width", f"{contact.half_width[-1] * 1e6:.5g} um", ("half-widths",)),
        Figure("patch", patch, ("half-widths",)),
        Figure("peak pressure", peak, ("peak pressure",)),
        Figure("approach", f"{approach:.5g} um", ("approach",)),
        Figure("loaded", f"{int(contact.active_nodes[-1])} {CARRIERS[contact.loaded]}"),
        Figure("Hertz", _hertz(contact)),
        *_stress(contact),
        *friction,
    ]


def _hertz(contact: Any) -> str:
    """The Hertz solution at the last load, or the reason why there is none."""
    try:
        found = hertz(contact, -1)
    except InputError as error:
        return f"not computed: {error}"
    if isinstance(found, HertzPoint):
        a, b = found.semi_axes
        values = f"semi-axes {a * 1e6:.5g} and {b * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa, approach "
        return values + f"{found.approach * 1e6:.5g} um at the computed load {found.load:.5g} N"
    values = f"half-width {found.half_width * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa "
    return values + f"at the computed line load {found.line_load / 1e3:.5g} N/mm at mid-width"


def _stress(contact: Any) -> list[Figure]:
    """Accuracy of the stresses below a line contact, for bodies with stress points."""
    with_stress = {body.name for body, _ in flexible_sides(contact.view) if body.reduced.stress}
    if contact.patch_kind != "line" or not with_stress:
        return []
    texts = [
        e.reason
        or f"of '{name}' von Mises to {e.von_mises:.1%}, its depth to {e.depth:.0%} "
        f"({e.spacings:.2g} spacings of nodes in the half-width)"
        for name, e in contact.stress_errors(-1).items()
        if name in with_stress
    ]
    return [Figure("stress below", text) for text in texts]


def _section(contact: Any) -> str:
    return "through the centre" if contact.patch_kind == "point" else "at mid-width"


def _friction(contact: Any) -> list[Figure]:
    friction = contact.friction
    shares = friction.stick_area[-1], friction.slip_area[-1]
    creepage, warning = without_round_off(friction.creepage[-1], SHARE), friction.warning()
    force, moment = friction.tangential_force[-1], friction.spin_moment[-1]
    force, moment = (without_round_off(value, SHARE * contact.force_magnitude[-1]) for value in (force, moment))
    spin = without_round_off(friction.spin_creepage[-1], SHARE)
    rolls, per_metre = "not rolling", "not rolling"
    if not np.any(np.isnan(creepage)):
        rolls = f"{creepage[0]:+.4e} longitudinal, {creepage[1]:+.4e} lateral, {spin:+.4e} rad/m of spin"
        per_metre = (
            f"{friction.t_gamma[-1]:.5g} N by forces and creepages, {friction.power_per_metre[-1]:.5g} N by the "
        )
        per_metre += "friction power over the rolling speed"
    adhesion = f", area of adhesion {shares[0] / sum(shares):.0%}" if sum(shares) > 0.0 else ""
    traction = f"{np.linalg.norm(force):.6g} N tangential, {friction.traction_coefficient[-1]:.5g} of the load"
    creep = f"Fx {force[0]:+.5g} N longitudinal, Fy {force[1]:+.5g} N lateral, "
    creep += f"Mz {moment:+.4g} N m of spin, on '{contact.view.first_body.name}'"
    power = f"{friction.power[-1]:.5g} W, largest of the run {np.nanmax(friction.power):.5g} W"
    wear = f"{friction.wear_peak[-1] / 1e6:.5g} W/mm2 at most, {friction.wear_rate[-1]:.5g} W in all "
    cells = f"{friction.cells_per_step[-1]:.3g}, largest of the run {np.nanmax(friction.cells_per_step):.3g}"
    return [
        Figure("traction", traction, ("traction",)),
        Figure("creep forces", creep, ("traction",)),
        Figure("creepage", rolls, ("creepage",)),
        Figure("T-gamma", per_metre),
        Figure("stick, slip", f"{shares[0] * 1e6:.5g} and {shares[1] * 1e6:.5g} mm2{adhesion}"),
        Figure("friction power", power, ("friction power",)),
        Figure("wear index", f"{wear}(pressure times slip speed)", ("wear index",)),
        Figure("cells per step", cells),
        *([] if warning is None else [Figure("warning", warning)]),
    ]


STICK = 1  # friction state
MOST_LINES = 20  # lines of one kind: a report should fit on one screen


def _items(result: Any) -> list[Entry]:
    """One entry per lumped contact, oil film, contact with small sliding, joint, force element and sensor of a run with
    saved rows. Stresses are omitted: they are evaluated only on request."""
    history = result.history
    beside = max(largest_force(history), *(_largest_torque(getattr(history, kind)) for kind in ("joints", "forces")))
    return [
        *(
            Entry("lumped contact", (name,), _lumped(contact), sort=same_surfaces(result.view.lumped[name]))
            for name, contact in history.lumped_contacts.items()
        ),
        *(Entry("film", (name,), _film(film, history.time)) for name, film in history.films.items()),
        *(Entry("contact", (name,), _small_sliding(result.contact(name))) for name in result.small_sliding_names),
        *(Entry("joint", (name,), _joint(joint, beside)) for name, joint in history.joints.items()),
        *(Entry("force", (name,), _force(force, beside)) for name, force in history.forces.items()),
        *(Entry("sensor", (name,), _sensor(one), unit=one.unit) for name, one in history.sensors.items()),
    ]


def _largest_torque(owners: dict[str, Any]) -> float:
    """[N m] of joints or forces, as a force with an arm of 1 m."""
    return max((float(np.max(np.abs(one.torque), initial=0.0)) for one in owners.values()), default=0.0)


def same_surfaces(view: PairView) -> str:
    """What similar contacts must share, whatever their names: shapes and radii of both surfaces, and friction."""
    shapes = [f"{type(surface.shape).__name__} {surface.shape.radius:.9g}" for surface in (view.first, view.second)]
    return f"{shapes} {view.friction}"


def _size(vectors: Any, unit: str, beside: float = 0.0) -> str:
    """The length of a vector (T, 3) at the end, and its largest; values below SHARE of `beside`, a force [N] of the
    machine (for torques with an arm of 1 m), are round-off."""
    lengths = without_round_off(np.linalg.norm(vectors, axis=1), max(FORCE, SHARE * beside))
    return f"{lengths[-1]:.5g} {unit} (largest {np.max(lengths):.5g})"


def _joint(joint: Any, beside: float) -> list[Figure]:
    reaction = f"{_size(joint.force, 'N', beside)}, {_size(joint.torque, 'N m', beside)}"
    figures = [Figure("reaction", reaction, ("reaction", "reaction torque"), inline=True)]
    for coordinate in joint.names:
        unit = "rad" if coordinate.endswith("rotation") else "m"
        value = f"{joint.named(coordinate)[-1]:.6g} {unit}"
        figures.append(Figure(coordinate.replace("_", " "), value, inline=True))
    return figures


def _lumped(contact: Any) -> list[Figure]:
    approach = without_round_off(contact.approach, LENGTH) * 1e6
    figures = [
        Figure("force", _size(contact.force, "N"), ("force",), inline=True),
        Figure("approach", f"{approach[-1]:.5g} um (largest {np.max(approach):.5g})", ("approach",), inline=True),
    ]
    if np.any(contact.friction_force != 0.0):
        friction = f"{_size(contact.friction_force, 'N')}, slip {_size(contact.slip_velocity, 'm/s')}"
        figures.append(Figure("friction", friction, inline=True))
    if np.any(contact.moment != 0.0):
        figures.append(Figure("moment against rolling and pivoting", _size(contact.moment, "N m"), inline=True))
    return figures


def _film(film: Any, time: Any) -> list[Figure]:
    pressure, gap, power = film.largest_pressure * 1e-6, film.smallest_gap * 1e6, film.friction_power
    figures = [
        Figure("force", _size(film.force, "N"), ("force",)),
        Figure("peak pressure", f"{pressure[-1]:.5g} MPa (largest {np.max(pressure):.5g})", ("largest pressure",)),
        Figure("smallest film", f"{gap[-1]:.5g} um (least {np.min(gap):.5g})", ("smallest gap",)),
        Figure("friction power", f"{power[-1]:.5g} W (largest {np.max(power):.5g})", ("friction power",)),
    ]
    if not np.any(np.isnan(film.feed_flow)):
        flow = f"{_mean(film.feed_flow, time) * 1e6:.5g} cm3/s on average"
        figures.append(Figure("feeds", flow, ("feed flow",)))
    return [*(replace(figure, inline=True) for figure in figures), *_film_heat(film)]


def _film_heat(film: Any) -> list[Figure]:
    """Temperatures, and where the heat goes; nothing of an isothermal film."""
    if film.temperature is None:
        return []
    hottest = film.temperature.max(axis=(1, 2))
    parts = {"oil": film.heat_carried, "a": film.heat_to_a, "b": film.heat_to_b, "stored": film.heat_stored}
    gone = ", ".join(f"{name} {heat[-1]:.5g}" for name, heat in parts.items() if np.any(heat != 0.0))
    return [
        Figure(
            "temperature",
            f"{hottest[-1]:.5g} degC at the hottest place (largest {np.max(hottest):.5g}), oil enters at "
            f"{film.inlet_temperature[-1]:.5g}",
        ),
        Figure("heat", f"{film.heat_generated[-1]:.5g} W, to {gone}"),
    ]


def _small_sliding(contact: Any) -> list[Figure]:
    """Force and pressure, cells by state, slip and its energy loss, and sources of uncertainty."""
    force, peak = contact.normal_force, contact.peak_pressure * 1e-6
    count, area = contact.counts[-1], contact.slip_area * 1e6
    first = [
        Figure("normal force", f"{force[-1]:.5g} N (largest {np.max(force):.5g})", ("force",), inline=True),
        Figure("peak pressure", f"{peak[-1]:.5g} MPa (largest {np.max(peak):.5g})", ("peak pressure",), inline=True),
        Figure("", f"of {contact.cells} cells {count[0]} open, {count[1]} stick, {count[2]} slip", inline=True),
    ]
    ratio = contact.shift_distance / contact.size
    row, cell = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    slid, turned = (np.linalg.norm(values[-1]) for values in (contact.sliding, contact.turning))
    zone = contact.slip_zone()
    largest = contact.shift_distance[row, cell] * 1e6
    slips = f"largest {largest:.5g} um, {ratio[row, cell]:.2g} of the cell"
    slips += f"; as a whole {slid * 1e6:.5g} um and {turned:.3g} rad at the end"
    warnings = [Figure("warning", warning) for warning in contact.warnings()]
    if contact.friction == 0.0:
        return [*first, Figure("slid", slips), *warnings]
    share = float(np.nan_to_num(contact.slip_share).max())
    slips += f"; slipping area {area[-1]:.5g} mm2 (largest {np.max(area):.5g}), at most {share:.4g} of the loaded area"
    across = f", {zone.across:.2g} across" if np.isfinite(zone.across) else ""
    loss = f"{contact.loss[-1]:.5g} J by friction, in {zone.cells} cells{across}"
    return [*first, Figure("slid", slips), *_gross_slip(contact), Figure("loss", loss, ("loss",)), *warnings]


def _gross_slip(contact: Any) -> list[Figure]:
    """When, and with which resultant of friction, the faces begin to slide as a whole, if they do."""
    if np.isnan(begin := contact.gross_slip_time):
        return []
    row = int(np.searchsorted(contact.time, begin))
    force, torque = (float(np.linalg.norm(values[row])) for values in (contact.friction_force, contact.friction_torque))
    size = float(np.ptp(contact.points, axis=0).max())
    force, torque = without_round_off(force, SHARE * torque / size), without_round_off(torque, SHARE * force * size)
    text = f"slides as a whole from t = {begin:.6g} s, with {force:.5g} N along the faces"
    return [Figure("gross slip", f"{text} and {torque:.5g} N m about their centre")]


def _mean(values: Any, time: Any) -> float:
    """Mean over the run of values (T,) that are linear between the saved times (T,) [s]."""
    span = time[-1] - time[0]
    return float(np.trapezoid(values, time) / span if span > 0.0 else np.mean(values))


def _force(force: Any, beside: float) -> list[Figure]:
    loads = f"{_size(force.force, 'N', beside)}, {_size(force.torque, 'N m', beside)}"
    figures = [Figure("", loads, ("load", "torque"), inline=True)]
    if force.friction is not None:
        ends = "sticks" if force.friction.state[-1] == STICK else "slips"
        stuck = f"{ends} at the end, stuck in {np.mean(force.friction.state == STICK):.3g} of the saved rows"
        figures.append(Figure("", stuck, inline=True))
    return figures


def _sensor(sensor: Any) -> list[Figure]:
    last = ", ".join(f"{c} {v:.5g}" for c, v in zip(sensor.components, np.asarray(sensor.values)[-1], strict=True))
    return [Figure("", last, ("values",), inline=True)]


TOLD = {  # name of a counter -> its words in a report; always listed
    "steps": "steps",
    "build_seconds": "preparation [s]",
    "loop_seconds": "time stepping [s]",
    "finish_seconds": "evaluation [s]",
    "retained_columns": "retained unknowns",
}
EXPLAINED = {  # explanations of these words
    "build_seconds": "including compilation and loading of kernels",
    "seconds_in_graph": "kernels alone",
    "retained_columns": "6 per body, coupled modes, constraints",
}
IN_BRACKETS = {"loop_seconds": "seconds_in_graph"}
WHERE_THERE = {  # listed if not zero
    "rejected_steps": "halved steps",
    "coarse_steps": "coarse steps",
    "repeated_steps": "repeated steps",
    "impulsive_steps": "impulsive steps",
    "idle_steps": "idle steps",
    "restarted_steps": "implicit steps",
    "dense_fallbacks": "dense solves",
}
MEANINGS = {
    "rejected_steps": "repeated with half the step",
    "coarse_steps": "less accurate than required, at the smallest step",
    "repeated_steps": "repeated as impacts",
    "impulsive_steps": "with an impact",
    "idle_steps": "with a contact of negligible energy, which does not rebound",
    "restarted_steps": "by implicit Euler, at transitions of friction or pretension",
    "dense_fallbacks": "after a small pivot of the sparse solver",
}
IN_NEWTON = {"max_iterations", "mean_iterations"}


def counter_figures(history: Any) -> list[Figure]:
    """One figure per counter."""
    counters = history.counters
    figures, brackets = [], set(IN_BRACKETS.values())
    if len(history.iterations) > 1:
        every_step = counters.get("steps", 0) <= len(history.iterations) - 1  # otherwise rows sum over steps
        text = f"mean {history.iterations[1:].mean():.2f}, largest {int(history.iterations[1:].max())} iterations per "
        figures.append(Figure("newton", text + ("step" if every_step else "saved row")))
    for name, value in counters.items():
        if name in brackets or (name in IN_NEWTON and figures) or (name in WHERE_THERE and not value):
            continue
        words = TOLD.get(name) or WHERE_THERE.get(name) or name.replace("_", " ")
        meaning = EXPLAINED.get(name) or MEANINGS.get(name, "")
        if (inner := IN_BRACKETS.get(name, "")) in counters:
            meaning = f"{counters[inner]:.6g} of them {EXPLAINED[inner]}"
        figures.append(Figure(words, f"{value:.6g}" + (f", {meaning}" if meaning else "")))
    return figures
