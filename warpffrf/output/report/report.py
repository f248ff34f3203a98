"""The text report of a run.

Items. Lines of the report on lumped contacts, oil films, small-sliding contacts, joints, force elements and sensors:
the final value and the largest one.

Counters. Lines of the report on solver statistics, in plain words. Keys of `History.counters` are mapped to these
words. Counters of events that need not occur, such as halved steps, are listed only if they are not zero.

Round-off is not printed as a figure: lengths of 1e-16 m are set to zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, get_args

import numpy as np

from warpffrf.model.errors import InputError, suggestion
from warpffrf.output.budget.budget import budget_text
from warpffrf.output.budget.figures import UNKNOWN, figure_text
from warpffrf.output.contact.hertz import HertzPoint, flexible_sides, hertz
from warpffrf.output.geometry.scene_view import PairView
from warpffrf.output.report.fold import Block, Pairs, folded, folded_notes

KINDS = {
    "line": "a line across the width",
    "line_around": "a line along the arc",
    "point": "a point contact",
    "flat": "flat faces",
}

CARRIERS = {"nodes": "nodes of the contact grid", "cells": "cells of the patch"}


def report_text(result: Any, progress: bool = False, pairs: Pairs = "folded") -> str:
    """Status, counters, contacts at the last saved step with the Hertz solution, joints, forces, sensors, energy
    balance and notes: plain text, one fact per line. progress: report the progress of the error budget, if it is
    computed here. pairs: similar entries are "folded" into one, or "all" are listed (`fold`)."""
    if pairs not in get_args(Pairs):
        raise InputError(f"report: pairs is {pairs!r}{suggestion(str(pairs), get_args(Pairs))}")
    history = result.history
    lines = [f"status            {result.status}" + (f": {result.message}" if result.message else "")]
    if len(result.time) == 0:
        return "\n".join([*lines, "no step was saved", *_notes(history, pairs)])
    lines.append(f"time              {result.time[0]:.6g} to {result.time[-1]:.6g} s, {len(result.time)} rows saved")
    lines += counter_lines(history)
    lines += [f"{file.what:<17} {file}" for file in result.written]
    contacts = [
        Block(name, _contact_lines(result.contact(name)), same_surfaces(result.view.pairs[name]))
        for name in result.finite_sliding_names
    ]
    lines += [line for block in folded(contacts, "contact", pairs) for line in block]
    lines += item_lines(result, pairs)
    lines.append(f"energy scale      {result.energy_scale:.6g} J, the largest energy of the run")
    residual, idle = result.energy_residual, idle_energy(result)
    if result.energy_scale <= idle:
        lines.append(
            "energy residual   not computed: nothing moves, energies are round-off of forces times lengths, "
            f"{idle:.2g} J"
        )
    else:
        lines.append(
            f"energy residual   {residual[-1]:+.3e} at the end, {np.ptp(residual):.3e} peak to peak, over the energy "
            "scale"
        )
    defect = history.energy.get("contact_grid")
    friction = history.energy.get("friction")
    if friction is not None and np.any(np.nan_to_num(friction) != 0.0):
        lines.append(f"friction          {friction[-1]:+.6g} J, work of friction since the start")
    if result.finite_sliding_names and defect is not None and result.energy_scale > idle and np.isfinite(defect[-1]):
        lines.append(
            f"contact grid      {defect[-1] / result.energy_scale:+.3e} of the energy scale, energy fluctuation "
            "because the patch moves over discrete nodes"
        )
    return "\n".join([*lines, *_budget_lines(result, progress, pairs), *_notes(history, pairs)])


def _budget_lines(result: Any, progress: bool, pairs: Pairs) -> list[str]:
    """The error budget; it is computed here if necessary and possible."""
    lines = result.error_budget(progress=progress)
    if len(lines) == 1 and lines[0].source == UNKNOWN:
        return [f"error budget      {lines[0].basis}"]
    kinds: dict[str, list[Block]] = {}
    for owner, line in figure_text(lines):
        kind, _, name = owner.partition(" '")
        kinds.setdefault(kind, []).append(Block(name.rstrip("'"), [line]))
    figures = [f"  {block[0]}" for kind, blocks in kinds.items() for block in folded(blocks, kind, pairs)]
    head = "estimated error of each result: all sources together, and the largest of them"
    return [*budget_text(lines), head, *figures]


def _contact_lines(contact: Any) -> list[str]:
    head = f"contact '{contact.name}'"
    friction = _friction_lines(contact) if contact.has_friction else []
    if not contact.touching[-1]:
        return [f"{head}: open in the last row", *friction]
    width, middle = contact.half_widths[-1] * 1e6, without_round_off(contact.center_of_pressure[-1], LENGTH) * 1e6
    lines = [
        f"{head}: last row, {KINDS[contact.patch_kind]}",
        f"  force           {contact.force_magnitude[-1]:.6g} N",
        f"  half-width      {contact.half_width[-1] * 1e6:.5g} um",
        f"  patch           {width[0]:.5g} um along the arc, {width[1]:.5g} um along the axis, area "
        f"{contact.patch_area[-1] * 1e6:.5g} mm2, centre at {middle[0]:.4g} and {middle[1]:.4g} um",
        f"  peak pressure   {contact.mid_peak_pressure[-1] / 1e6:.5g} MPa {_section(contact)}, "
        f"{contact.peak_pressure[-1] / 1e6:.5g} MPa anywhere",
        f"  approach        {without_round_off(contact.approach[-1], LENGTH) * 1e6:.5g} um",
        f"  loaded          {int(contact.active_nodes[-1])} {CARRIERS[contact.loaded]}",
    ]
    try:
        found = hertz(contact, -1)
    except InputError as error:
        return [*lines, f"  Hertz           not computed: {error}", *_stress_lines(contact), *friction]
    if isinstance(found, HertzPoint):
        a, b = found.semi_axes
        values = f"semi-axes {a * 1e6:.5g} and {b * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa, approach "
        values += f"{found.approach * 1e6:.5g} um at the computed load {found.load:.5g} N"
    else:
        values = f"half-width {found.half_width * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa "
        values += f"at the computed line load {found.line_load / 1e3:.5g} N/mm at mid-width"
    return [*lines, f"  Hertz           {values}", *_stress_lines(contact), *friction]


def _stress_lines(contact: Any) -> list[str]:
    """Accuracy of the stresses below a line contact, for bodies with stress points."""
    with_stress = {body.name for body, _ in flexible_sides(contact.view) if body.reduced.stress}
    if contact.patch_kind != "line" or not with_stress:
        return []
    return [
        f"  stress below    {e.reason}"
        if e.reason
        else f"  stress below    of '{name}' von Mises to {e.von_mises:.1%}, its depth to {e.depth:.0%} "
        f"({e.spacings:.2g} spacings of nodes in the half-width)"
        for name, e in contact.stress_errors(-1).items()
        if name in with_stress
    ]


def _section(contact: Any) -> str:
    return "through the centre" if contact.patch_kind == "point" else "at mid-width"


def _friction_lines(contact: Any) -> list[str]:
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
    lines = [
        f"  traction        {np.linalg.norm(force):.6g} N tangential, "
        f"{friction.traction_coefficient[-1]:.5g} of the load",
        f"  creep forces    Fx {force[0]:+.5g} N longitudinal, Fy {force[1]:+.5g} N lateral, "
        f"Mz {moment:+.4g} N m of spin, on '{contact.view.first_body.name}'",
        f"  creepage        {rolls}",
        f"  T-gamma         {per_metre}",
        f"  stick, slip     {shares[0] * 1e6:.5g} and {shares[1] * 1e6:.5g} mm2{adhesion}",
        f"  friction power  {friction.power[-1]:.5g} W, largest of the run {np.nanmax(friction.power):.5g} W",
        f"  wear index      {friction.wear_peak[-1] / 1e6:.5g} W/mm2 at most, {friction.wear_rate[-1]:.5g} W in all "
        "(pressure times slip speed)",
        f"  cells per step  {friction.cells_per_step[-1]:.3g}, largest of the run "
        f"{np.nanmax(friction.cells_per_step):.3g}",
    ]
    return lines if warning is None else [*lines, f"  warning         {warning}"]


def _notes(history: Any, pairs: Pairs) -> list[str]:
    return ["notes"] + [f"  - {note}" for note in folded_notes(history.notes, pairs)] if history.notes else []


STICK = 1  # friction state
MOST_LINES = 20  # lines of one kind: a report should fit on one screen


def item_lines(result: Any, pairs: Pairs = "folded") -> list[str]:
    """One line per lumped contact, oil film, joint, force element and sensor of a run with saved rows, and several per
    contact with small sliding; similar ones grouped, and at most `MOST_LINES` of a kind, unless `pairs` is "all".
    Stresses are omitted: they are evaluated only on request."""
    history = result.history
    beside = max(largest_force(history), *(_largest_torque(getattr(history, kind)) for kind in ("joints", "forces")))
    kinds = {
        "lumped contact": {
            name: Block(name, [_lumped(name, contact)], same_surfaces(result.view.lumped[name]))
            for name, contact in history.lumped_contacts.items()
        },
        "film": {name: Block(name, [_film(name, film, history.time)]) for name, film in history.films.items()},
        "contact": {name: Block(name, _small_sliding(result.contact(name))) for name in result.small_sliding_names},
        "joint": {name: Block(name, [_joint(name, joint, beside)]) for name, joint in history.joints.items()},
        "force": {name: Block(name, [_force(name, force, beside)]) for name, force in history.forces.items()},
        "sensor": {name: Block(name, [_sensor(name, sensor)]) for name, sensor in history.sensors.items()},
    }
    found: list[str] = []
    for kind, blocks in kinds.items():
        lines = [line for block in folded(list(blocks.values()), kind, pairs) for line in block]
        more = 0 if pairs == "all" else max(len(lines) - MOST_LINES, 0)
        found += lines[: len(lines) - more]
        found += [f'... and {more} more lines of {kind}s; use report(pairs="all")'] if more else []
    return found


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


def _joint(name: str, joint: Any, beside: float) -> str:
    line = f"joint '{name}': reaction {_size(joint.force, 'N', beside)}, {_size(joint.torque, 'N m', beside)}"
    for coordinate in joint.names:
        unit = "rad" if coordinate.endswith("rotation") else "m"
        line += f"; {coordinate.replace('_', ' ')} {joint.named(coordinate)[-1]:.6g} {unit}"
    return line


def _lumped(name: str, contact: Any) -> str:
    line = f"lumped contact '{name}': force {_size(contact.force, 'N')}"
    approach = without_round_off(contact.approach, LENGTH) * 1e6
    line += f"; approach {approach[-1]:.5g} um (largest {np.max(approach):.5g})"
    if np.any(contact.friction_force != 0.0):
        line += f"; friction {_size(contact.friction_force, 'N')}, slip {_size(contact.slip_velocity, 'm/s')}"
    if np.any(contact.moment != 0.0):
        line += f"; moment against rolling and pivoting {_size(contact.moment, 'N m')}"
    return line


def _film(name: str, film: Any, time: Any) -> str:
    pressure, gap, power = film.largest_pressure * 1e-6, film.smallest_gap * 1e6, film.friction_power
    line = f"film '{name}': force {_size(film.force, 'N')}"
    line += f"; peak pressure {pressure[-1]:.5g} MPa (largest {np.max(pressure):.5g})"
    line += f"; smallest film {gap[-1]:.5g} um (least {np.min(gap):.5g})"
    line += f"; friction power {power[-1]:.5g} W (largest {np.max(power):.5g})"
    if np.any(np.isnan(film.feed_flow)):
        return line
    return line + f"; feeds {_mean(film.feed_flow, time) * 1e6:.5g} cm3/s on average"


def _small_sliding(contact: Any) -> list[str]:
    """Force and pressure, cells by state, slip and its energy loss, and sources of uncertainty."""
    force, peak = contact.normal_force, contact.peak_pressure * 1e-6
    count, area = contact.counts[-1], contact.slip_area * 1e6
    line = f"contact '{contact.name}': normal force {force[-1]:.5g} N (largest {np.max(force):.5g})"
    line += f"; peak pressure {peak[-1]:.5g} MPa (largest {np.max(peak):.5g})"
    line += f"; of {contact.cells} cells {count[0]} open, {count[1]} stick, {count[2]} slip"
    ratio = contact.shift_distance / contact.size
    row, cell = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    slid, turned = (np.linalg.norm(values[-1]) for values in (contact.sliding, contact.turning))
    zone = contact.slip_zone()
    largest = contact.shift_distance[row, cell] * 1e6
    slips = f"  slid            largest {largest:.5g} um, {ratio[row, cell]:.2g} of the cell"
    slips += f"; as a whole {slid * 1e6:.5g} um and {turned:.3g} rad at the end"
    warnings = [f"  warning         {warning}" for warning in contact.warnings()]
    if contact.friction == 0.0:
        return [line, slips, *warnings]
    slips += f"; slipping area {area[-1]:.5g} mm2 (largest {np.max(area):.5g})"
    across = f", {zone.across:.2g} across" if np.isfinite(zone.across) else ""
    loss = f"  loss            {contact.loss[-1]:.5g} J by friction, in {zone.cells} cells{across}"
    return [line, slips, loss, *warnings]


def _mean(values: Any, time: Any) -> float:
    """Mean over the run of values (T,) that are linear between the saved times (T,) [s]."""
    span = time[-1] - time[0]
    return float(np.trapezoid(values, time) / span if span > 0.0 else np.mean(values))


def _force(name: str, force: Any, beside: float) -> str:
    line = f"force '{name}': {_size(force.force, 'N', beside)}, {_size(force.torque, 'N m', beside)}"
    if force.friction is None:
        return line
    ends = "sticks" if force.friction.state[-1] == STICK else "slips"
    return f"{line}; {ends} at the end, stuck in {np.mean(force.friction.state == STICK):.3g} of the saved rows"


def _sensor(name: str, sensor: Any) -> str:
    last = ", ".join(f"{c} {v:.5g}" for c, v in zip(sensor.components, np.asarray(sensor.values)[-1], strict=True))
    return f"sensor '{name}' [{sensor.unit}]: {last}"


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


def counter_lines(history: Any) -> list[str]:
    """One line per counter."""
    counters = history.counters
    lines, brackets = [], set(IN_BRACKETS.values())
    if len(history.iterations) > 1:
        every_step = counters.get("steps", 0) <= len(history.iterations) - 1  # otherwise rows sum over steps
        lines.append(
            f"newton            mean {history.iterations[1:].mean():.2f}, "
            f"largest {int(history.iterations[1:].max())} iterations per {'step' if every_step else 'saved row'}"
        )
    for name, value in counters.items():
        if name in brackets or (name in IN_NEWTON and lines) or (name in WHERE_THERE and not value):
            continue
        words = TOLD.get(name) or WHERE_THERE.get(name) or name.replace("_", " ")
        meaning = EXPLAINED.get(name) or MEANINGS.get(name, "")
        if (inner := IN_BRACKETS.get(name, "")) in counters:
            meaning = f"{counters[inner]:.6g} of them {EXPLAINED[inner]}"
        lines.append(f"{words:<17} {value:.6g}" + (f", {meaning}" if meaning else ""))
    return lines


LENGTH = 1e-14  # m: far below an atom; round-off of lengths of 0.1 m is about 1e-17
FORCE = 1e-15  # N or N m: below any real load, above the round-off of sums that vanish
SHARE = 1e-12  # of the largest force of the machine, and of that force times 1 m: round-off of sums
AT_REST = 1e-9  # of force times length: smaller energies are residuals of the iteration


def without_round_off(value: Any, least: float) -> Any:
    """`value`, numbers of any shape, with those below `least` set to zero."""
    return np.where(np.abs(value) < least, 0.0, value)[()]


def idle_energy(result: Any) -> float:
    """Energy [J] below which energies are round-off: the largest force of the run times the largest distance of a body
    from the origin, times `AT_REST`."""
    return AT_REST * largest_force(result.history) * _largest(b.position for b in result.history.bodies.values())


def largest_force(history: Any) -> float:
    """The largest force component [N] of the run, over contacts, joints and force elements."""
    return _largest(one.force for kind in _KINDS for one in getattr(history, kind).values())


def _largest(arrays: Iterable[Any]) -> float:
    return max((float(np.nanmax(np.abs(array), initial=0.0)) for array in arrays), default=0.0)


_KINDS = ("contacts", "lumped_contacts", "films", "joints", "forces")
